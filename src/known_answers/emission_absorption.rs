//! Emission and absorption along a ray through homogeneous bodies.
//!
//! Without scattering `dL/dt = −σ_a L + j` is solved on each piece of the ray on which `σ_a` and `j`
//! are constant. Where bodies overlap both add up. Over a length s a piece adds
//! `j (1 − e^(−σ_a s)) / σ_a`, attenuated by all that is nearer, and behind the last shines the
//! environment.
//!
//! Source: Chandrasekhar 1960, *Radiative Transfer*, §7; Hottel & Sarofim 1967, *Radiative Transfer*,
//! ch. 6; Max 1995, IEEE TVCG 1(2), eq. 4.

use super::bodies::Convex;
use super::formula::{AlongRay, Formula, exact, transmittance};
use super::requirements::{absorbing, homogeneous, without_lights, without_surfaces};
use crate::geometry::Ray;
use crate::math;
use crate::math::quadrature::Integral;
use crate::scene::Radiative;
use glam::DVec3;

/// Bodies that emit and absorb before an environment.
pub const EMISSION_ABSORPTION: Formula = Formula {
    name: "emission-absorption",
    what: "Homogeneous balls and boxes that emit and absorb, before an environment: exponentials of \
           the lengths within them (Chandrasekhar 1960, §7).",
    of,
};

struct Part {
    shape: Convex,
    sigma: DVec3,
    emission: DVec3,
}

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    without_surfaces(scene)?;
    without_lights(scene)?;
    let mut parts = Vec::new();
    for body in &scene.media {
        let medium = homogeneous(body)?;
        absorbing(&medium.coefficients)?;
        parts.push(Part {
            shape: Convex::of(body)?,
            sigma: medium.coefficients.sigma_a(),
            emission: medium.emission,
        });
    }
    Ok(Box::new(move |ray| {
        Ok(along(&parts, scene.environment, ray))
    }))
}

fn along(parts: &[Part], environment: DVec3, ray: &Ray) -> Integral {
    let crossed: Vec<(&Part, [f64; 2])> = parts
        .iter()
        .filter_map(|part| Some((part, part.shape.span(ray.origin, *ray.direction)?)))
        .collect();
    let mut ends: Vec<f64> = crossed.iter().flat_map(|(_, span)| *span).collect();
    ends.sort_by(f64::total_cmp);
    let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
    for piece in ends.windows(2).filter(|piece| piece[0] < piece[1]) {
        let inside = crossed
            .iter()
            .filter(|(_, [near, far])| *near <= piece[0] && piece[1] <= *far);
        let (mut sigma, mut emission) = (DVec3::ZERO, DVec3::ZERO);
        for (part, _) in inside {
            sigma += part.sigma;
            emission += part.emission;
        }
        let length = piece[1] - piece[0];
        for c in 0..3 {
            let own = optical_depth(sigma[c], length);
            // Without absorption j s; endless media without it are refused by scenes.
            let emitted = if own == 0.0 {
                length
            } else {
                -math::exp_m1(-own) / sigma[c]
            };
            if emission[c] > 0.0 {
                radiance[c] += emission[c] * emitted * math::exp(-depth[c]);
            }
            depth[c] += own;
        }
    }
    exact(radiance + transmittance(depth) * environment)
}

/// 0 where nothing absorbs, over an infinite length too.
fn optical_depth(sigma: f64, length: f64) -> f64 {
    if sigma == 0.0 { 0.0 } else { sigma * length }
}
