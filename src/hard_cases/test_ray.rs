//! The smooth test ray of the catalogue, on which estimators of transmittance are compared.

use super::scenes::LAST;
use crate::geometry::Span;
use crate::math::rng::Stream;
use crate::math::{Moments, sin};
use crate::render::radiative::sampler::{NumberRow, Sampler, SamplerRow};
use crate::render::radiative::tracking::{
    Control, Effort, MajorantSegment, Majorants, Small, Tentative, TentativeNumbers,
    delta_tracking, ratio_tracking,
};
use glam::DVec3;

/// Its length.
pub const LENGTH: f64 = 2.0;
/// Its transmittance.
pub const TRANSMITTANCE: f64 = 0.008_636_620_094_049_104;
/// `∫ σ² dt` along it.
pub const SQUARED: f64 = 12.725_548_890_177_333;

/// Its extinction at distance `t`.
pub fn smooth(t: f64) -> f64 {
    1.5 + sin(3.7 * t) + 0.6 * t * t
}

/// Extinction along a ray of [`LENGTH`] as a function, with one bound.
struct CurvedExtinction<'f> {
    sigma: &'f dyn Fn(f64) -> f64,
    bound: f64,
    done: bool,
}

impl Iterator for CurvedExtinction<'_> {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        if self.done {
            return None;
        }
        self.done = true;
        Some(MajorantSegment {
            span: Span {
                near: 0.0,
                far: LENGTH,
            },
            minorant: DVec3::ZERO,
            majorant: DVec3::splat(self.bound),
            emission: DVec3::ZERO,
        })
    }
}

impl Majorants for CurvedExtinction<'_> {
    fn extinction(&mut self, t: f64) -> DVec3 {
        DVec3::splat((self.sigma)(t))
    }
}

/// Estimates of a transmittance, and how often the bound was none.
pub struct Estimates {
    pub moments: Moments,
    pub violations: u64,
}

fn estimates(
    samples: u32,
    mut one: impl FnMut(&mut SamplerRow<'_>, &mut Effort) -> f64,
) -> Estimates {
    let mut effort = Effort::default();
    let values = (0..samples).map(|sample| {
        let mut sampler = Sampler::new(Stream::new(7, 0, sample));
        one(
            &mut sampler.tentative(NumberRow::Transmittance),
            &mut effort,
        )
    });
    let moments = Moments::from_iter(values);
    Estimates {
        moments,
        violations: effort.violations,
    }
}

/// By delta tracking: 1 for a flight that is not stopped, else 0.
pub fn by_delta(sigma: &dyn Fn(f64) -> f64, bound: f64, samples: u32) -> Estimates {
    estimates(samples, |numbers, effort| {
        let mut curve = CurvedExtinction {
            sigma,
            bound,
            done: false,
        };
        let first = numbers.next();
        let mut survived = DVec3::ONE;
        let flight = delta_tracking(&mut curve, 0, first, numbers, &mut survived, effort);
        f64::from(u8::from(flight.is_continue()))
    })
}

/// Extinction that is the same all along, by channel.
struct Even {
    sigma: DVec3,
    bound: f64,
    done: bool,
}

impl Iterator for Even {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        let span = Span {
            near: 0.0,
            far: LENGTH,
        };
        let segment = MajorantSegment {
            span,
            minorant: DVec3::ZERO,
            majorant: DVec3::splat(self.bound),
            emission: DVec3::ZERO,
        };
        let first = !std::mem::replace(&mut self.done, true);
        first.then_some(segment)
    }
}

impl Majorants for Even {
    fn extinction(&mut self, _: f64) -> DVec3 {
        self.sigma
    }
}

/// The last of all random numbers, every time, at a tenth of the mean optical distance.
struct LastNumber;

impl TentativeNumbers for LastNumber {
    fn next(&mut self) -> Tentative {
        Tentative {
            optical_distance: 0.1,
            u: LAST,
        }
    }
}

/// Delta tracking by the last of all random numbers: whether it collides, and the weights of what
/// did not.
pub fn by_last_number(sigma: DVec3, bound: f64) -> (bool, DVec3) {
    let mut even = Even {
        sigma,
        bound,
        done: false,
    };
    let (mut survived, mut effort) = (DVec3::ONE, Effort::default());
    let first = LastNumber.next();
    let flight = delta_tracking(
        &mut even,
        0,
        first,
        &mut LastNumber,
        &mut survived,
        &mut effort,
    );
    (flight.is_break(), survived)
}

/// By ratio tracking.
pub fn by_ratio(sigma: &dyn Fn(f64) -> f64, bound: f64, samples: u32) -> Estimates {
    estimates(samples, |numbers, effort| {
        let mut curve = CurvedExtinction {
            sigma,
            bound,
            done: false,
        };
        ratio_tracking(&mut curve, Control::Nothing, Small::Kept, numbers, effort).x
    })
}
