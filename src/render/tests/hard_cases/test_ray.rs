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
struct TestRay<'f> {
    sigma: &'f dyn Fn(f64) -> DVec3,
    segment: Option<MajorantSegment>,
}

impl TestRay<'_> {
    fn new(sigma: &dyn Fn(f64) -> DVec3, bound: f64) -> TestRay<'_> {
        let segment = MajorantSegment {
            span: Span::new(0.0, LENGTH),
            minorant: DVec3::ZERO,
            majorant: DVec3::splat(bound),
            emission: DVec3::ZERO,
        };
        TestRay {
            sigma,
            segment: Some(segment),
        }
    }

    /// Whether a flight of delta tracking collides, and the weights of what did not.
    fn flight(
        &mut self,
        numbers: &mut impl TentativeNumbers,
        effort: &mut Effort,
    ) -> (bool, DVec3) {
        let mut survived = DVec3::ONE;
        let first = numbers.next();
        let flight = delta_tracking(self, 0, first, numbers, &mut survived, effort);
        (flight.is_break(), survived)
    }
}

impl Iterator for TestRay<'_> {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        self.segment.take()
    }
}

impl Majorants for TestRay<'_> {
    fn extinction(&mut self, t: f64) -> DVec3 {
        (self.sigma)(t)
    }
}

/// Estimates of a transmittance, and how often the bound was none.
pub struct Estimates {
    pub moments: Moments,
    pub violations: u64,
}

fn estimates(
    sigma: &dyn Fn(f64) -> f64,
    bound: f64,
    samples: u32,
    one: impl Fn(&mut TestRay<'_>, &mut SamplerRow<'_>, &mut Effort) -> f64,
) -> Estimates {
    let mut effort = Effort::default();
    let sigma = |t| DVec3::splat(sigma(t));
    let values = (0..samples).map(|sample| {
        let mut sampler = Sampler::new(Stream::new(7, 0, sample));
        let mut numbers = sampler.tentative(NumberRow::Transmittance);
        one(&mut TestRay::new(&sigma, bound), &mut numbers, &mut effort)
    });
    Estimates {
        moments: Moments::from_iter(values),
        violations: effort.violations,
    }
}

/// By delta tracking: 1 for a flight that is not stopped, else 0.
pub fn by_delta(sigma: &dyn Fn(f64) -> f64, bound: f64, samples: u32) -> Estimates {
    estimates(sigma, bound, samples, |ray, numbers, effort| {
        let (collided, _) = ray.flight(numbers, effort);
        f64::from(u8::from(!collided))
    })
}

/// By ratio tracking.
pub fn by_ratio(sigma: &dyn Fn(f64) -> f64, bound: f64, samples: u32) -> Estimates {
    estimates(sigma, bound, samples, |ray, numbers, effort| {
        ratio_tracking(ray, Control::None, Small::Kept, numbers, effort).x
    })
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
    TestRay::new(&|_| sigma, bound).flight(&mut LastNumber, &mut Effort::default())
}
