//! Mistakes about media: absorption, scattering, emission, phase functions.

use super::{Edit, Mistake};
use crate::optics::{Asymmetry, Coefficients, Homogeneous};
use crate::scene::{Radiative, Scattering};
use glam::DVec3;
use std::f64::consts::{LN_2, LN_10};

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "phase-reversed" => Medium(|medium| phase(medium, |g| -g)),
        "the phase function has forward and backward exchanged: check the sign convention of your direction vectors; here g > 0 is forward, and the cosine is that between the directions of travel before and after";
    "phase-isotropic" => Medium(|medium| phase(medium, |_| 0.0)),
        "scattering is isotropic although g is not 0: check that g reaches the phase function, in its value and in the sampling";
    "absorption-scatters" => Medium(|medium| {
        coefficients(medium, |a, s| {
            if s == DVec3::ZERO {
                (a, s)
            } else {
                (DVec3::ZERO, a + s)
            }
        })
    }),
        "sigma_t is used for sigma_s: what is absorbed is scattered as well, so that the albedo is 1; multiply by sigma_s / sigma_t at every collision";
    "absorption-left-out" => Medium(|medium| coefficients(medium, |_, s| (DVec3::ZERO, s))),
        "sigma_s is used for sigma_t: nothing is absorbed; the extinction should be sigma_a + sigma_s";
    "scattering-left-out" => Medium(|medium| coefficients(medium, |a, _| (a, DVec3::ZERO))),
        "scattering is missing altogether: light that is scattered is neither taken from the ray nor sent elsewhere; the extinction should be sigma_a + sigma_s";
    "in-scattering-left-out" => Medium(|medium| coefficients(medium, |a, s| (a + s, DVec3::ZERO))),
        "light that is scattered is lost: the extinction is right, but no light is scattered into the ray; check that the medium is lit at all, by shadow rays and by further scattering";
    "absorption-and-scattering-exchanged" => Medium(|medium| coefficients(medium, |a, s| (s, a))),
        "sigma_a and sigma_s are swapped, or the albedo is 1 minus what it should be";
    "single-scattering" => Radiative(|scene| limited(scene, Scattering::Single)),
        "light is scattered only once: paths must continue after the first collision or reflection until they escape or are absorbed";
    "paths-cut" => Radiative(|scene| limited(scene, Scattering::Multiple(Some(4)))),
        "paths end after a few bounces (four look like this): raise the depth limit and terminate paths with Russian roulette, which is unbiased";
    "paths-cut-at-three" => Radiative(|scene| limited(scene, Scattering::Multiple(Some(3)))),
        "paths end after three bounces: raise the depth limit and terminate paths with Russian roulette, which is unbiased";
    "paths-cut-at-seven" => Radiative(|scene| limited(scene, Scattering::Multiple(Some(7)))),
        "paths end after seven bounces: raise the depth limit and terminate paths with Russian roulette, which is unbiased";
    "extinction-doubled" => Medium(|medium| coefficients(medium, |a, s| (a * 2.0, s * 2.0))),
        "media are twice as dense as they should be: is the optical depth counted twice, or a diameter taken for a radius?";
    "extinction-halved" => Medium(|medium| coefficients(medium, |a, s| (a * 0.5, s * 0.5))),
        "media are half as dense as they should be: coefficients are per world unit; is the distance through a medium measured in full?";
    "extinction-base-ten" => Medium(|medium| coefficients(medium, |a, s| (a * LN_10, s * LN_10))),
        "transmittance is 10^-depth in place of e^-depth: the coefficients are base e, not base 10";
    "extinction-base-two" => Medium(|medium| coefficients(medium, |a, s| (a * LN_2, s * LN_2))),
        "transmittance is 2^-depth in place of e^-depth: exp, not exp2";
    "media-left-out" => Radiative(|scene| {
        let occurs = !scene.media.is_empty();
        scene.media.clear();
        occurs
    }),
        "there is no medium in the picture: check that rays know which medium they are in, and that media boundaries are not treated as surfaces";
    "coefficients-grey" => Medium(|medium| {
        // The mean of equal numbers may be off by a rounding.
        let mean = |c: DVec3| {
            if c.min_element() == c.max_element() {
                c
            } else {
                DVec3::splat(c.element_sum() / 3.0)
            }
        };
        coefficients(medium, |a, s| (mean(a), mean(s)))
    }),
        "media have no colour: coefficients are the mean of their channels; they differ from channel to channel, and so does transmittance";
    "coefficients-of-red" => Medium(|medium| coefficients(medium, |a, s| (DVec3::splat(a.x), DVec3::splat(s.x)))),
        "the coefficients of red are used for all channels: distances may be sampled by one channel, but every channel needs its own transmittance over the pdf of that distance";
    "emission-left-out" => Medium(|medium| emission(medium, |_, _| DVec3::ZERO)),
        "media do not emit: emission is missing along the ray";
    "emission-times-absorption" => Medium(|medium| emission(medium, |emission, sigma_a| emission * sigma_a)),
        "emission is multiplied by sigma_a: here it is radiance per world length, not the radiance of a black body";
};

fn phase(medium: &mut Homogeneous, edit: fn(f64) -> f64) {
    let edit = |g: Asymmetry| Asymmetry::new(edit(g.g())).expect("no farther from 0 than it was");
    medium.phase = medium.phase.with_asymmetry(edit);
}

/// Edits absorption and scattering, in this order; leaves alone what would overflow.
fn coefficients(medium: &mut Homogeneous, edit: impl Fn(DVec3, DVec3) -> (DVec3, DVec3)) {
    let old = medium.coefficients;
    let (sigma_a, sigma_s) = edit(old.sigma_a(), old.sigma_s());
    medium.coefficients = Coefficients::new(sigma_a, sigma_s).unwrap_or(old);
}

fn emission(medium: &mut Homogeneous, edit: fn(DVec3, DVec3) -> DVec3) {
    medium.emission = edit(medium.emission, medium.coefficients.sigma_a());
}

/// Light is scattered less often than it should be.
fn limited(scene: &mut Radiative, scattering: Scattering) -> bool {
    let occurs = match (scene.scattering, scattering) {
        (Scattering::Multiple(_), Scattering::Single) => true,
        (Scattering::Multiple(old), Scattering::Multiple(new)) => {
            old.is_none_or(|old| new.is_some_and(|new| new < old))
        }
        _ => false,
    };
    if occurs {
        scene.scattering = scattering;
    }
    occurs
}
