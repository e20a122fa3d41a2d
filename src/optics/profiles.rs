//! Extinction along a ray as a function of the distance `t`, where its integral has a closed
//! form.

use crate::geometry::Line;
use crate::math::{erf, erfc, exp};
use crate::optics::{optical_depth, source_factor};
use crate::volume::{DensityField, ExponentialLayer, LinearRamp};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Extinction `start + slope·t`, per length, not negative where it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearProfile {
    /// Extinction at `t = 0`, per length.
    pub start: f64,
    /// Its change per length.
    pub slope: f64,
}

impl LinearProfile {
    /// Along `line` through a ramp of density, for an extinction of 1 at density 1. Where the
    /// ramp ends the profile goes on below 0: see [`LinearProfile::positive_part`].
    pub fn along(line: &Line, ramp: &LinearRamp) -> LinearProfile {
        LinearProfile {
            start: ramp.value(line.origin),
            slope: ramp.gradient.dot(line.direction),
        }
    }

    /// The segment from `near` to `far ≥ near` without the part where the profile is below 0;
    /// `None` where all of it is.
    pub fn positive_part(&self, near: f64, far: f64) -> Option<(f64, f64)> {
        let positive = |t: f64| self.start + self.slope * t > 0.0;
        // Between a positive and another value the slope is not 0.
        let zero = (-self.start / self.slope).clamp(near, far);
        match (positive(near), positive(far)) {
            (true, true) => Some((near, far)),
            (true, false) => Some((near, zero)),
            (false, true) => Some((zero, far)),
            (false, false) => None,
        }
    }

    /// Optical depth from `near` to `far ≥ near`, both finite: mean extinction times length.
    pub fn optical_depth(&self, near: f64, far: f64) -> f64 {
        (self.start + self.slope * ((near + far) / 2.0)) * (far - near)
    }
}

/// Extinction `start·e^(−rate·t)`, per length: the atmosphere along a straight line, with
/// `rate` the rise per scale height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExponentialProfile {
    /// Extinction at `t = 0`, per length, `≥ 0`.
    pub start: f64,
    /// Decrease of its logarithm per length; negative where the ray goes into the dense part.
    pub rate: f64,
}

impl ExponentialProfile {
    /// Along `line` through a layer of density, for an extinction of 1 at density 1.
    pub fn along(line: &Line, layer: &ExponentialLayer) -> ExponentialProfile {
        ExponentialProfile {
            start: layer.density(line.origin),
            rate: layer.up.dot(line.direction) / layer.scale_height,
        }
    }

    /// Optical depth from `near` to `far ≥ near`; `far` may be infinite where the extinction
    /// falls. A ray that is level, or all but level, loses no digit.
    pub fn optical_depth(&self, near: f64, far: f64) -> f64 {
        let at_near = self.start * exp(-(self.rate * near));
        if far.is_infinite() && self.rate > 0.0 {
            return at_near / self.rate;
        }
        let length = far - near;
        optical_depth(at_near, length) * source_factor(exponent(self.rate, length))
    }
}

/// `rate·length` of either sign, 0 for a level ray of any length.
fn exponent(rate: f64, length: f64) -> f64 {
    if rate == 0.0 { 0.0 } else { rate * length }
}

/// Extinction `peak·e^(−(t − centre)²/(2 width²))`, per length: a Gaussian blob along any
/// straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianProfile {
    /// The largest extinction along the line, per length, `≥ 0`.
    pub peak: f64,
    /// Where it lies, world units.
    pub centre: f64,
    /// Standard deviation, world units, > 0.
    pub width: f64,
}

impl GaussianProfile {
    /// Optical depth from `near` to `far ≥ near`, either of which may be infinite. On a segment
    /// much shorter than the width the two error functions cancel: the error is a few roundings
    /// of `peak·width`, not of the result.
    pub fn optical_depth(&self, near: f64, far: f64) -> f64 {
        let a = (near - self.centre) / self.width * FRAC_1_SQRT_2;
        let b = (far - self.centre) / self.width * FRAC_1_SQRT_2;
        // Both ends on one side: the tails, whose difference keeps its digits.
        let share = if a > 0.0 {
            erfc(a) - erfc(b)
        } else if b < 0.0 {
            erfc(-b) - erfc(-a)
        } else {
            erf(b) - erf(a)
        };
        self.peak * self.width * (PI / 2.0).sqrt() * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Direction;
    use crate::volume::DensityField;
    use glam::DVec3;

    #[test]
    fn endless_and_empty_profiles() {
        let thinning = ExponentialProfile {
            start: 2.0,
            rate: 0.5,
        };
        assert_eq!(thinning.optical_depth(0.0, f64::INFINITY), 4.0);
        let level = ExponentialProfile {
            start: 0.0,
            rate: 0.0,
        };
        assert_eq!(level.optical_depth(0.0, f64::INFINITY), 0.0);
    }

    /// The steps of quadrature below: Simpson's rule on 4096 parts is off by some 1e-13 of the
    /// integral.
    fn by_quadrature(density: impl Fn(f64) -> f64, far: f64) -> f64 {
        let h = far / 4096.0;
        let part = |i: u32| {
            let t = f64::from(i) * h;
            (density(t) + 4.0 * density(t + h / 2.0) + density(t + h)) * h / 6.0
        };
        (0..4096).map(part).sum()
    }

    #[test]
    fn profiles_along_lines_are_those_of_the_field() {
        let line = |origin, towards| Line {
            origin,
            direction: *Direction::of(towards).unwrap(),
        };
        let slanted = line(DVec3::new(0.5, -1.0, 2.0), DVec3::new(2.0, 3.0, -6.0));
        let up = DVec3::new(1.0, 2.0, 2.0);
        let layer = ExponentialLayer::new(0.8, DVec3::new(0.0, 0.5, 0.0), up, 2.5).unwrap();
        for far in [0.5, 10.0] {
            let depth = ExponentialProfile::along(&slanted, &layer).optical_depth(0.0, far);
            let seen = by_quadrature(|t| layer.density(slanted.at(t)), far);
            assert!((depth / seen - 1.0).abs() < 1e-12, "{depth} for {seen}");
        }
        // Straight up the depth is σ₀ H (1 − e^(−L/H)).
        let straight = line(DVec3::new(0.0, 0.5, 0.0), up);
        let profile = ExponentialProfile::along(&straight, &layer);
        let depth = 0.8 * 2.5 * -crate::math::exp_m1(-4.0 / 2.5);
        assert!((profile.optical_depth(0.0, 4.0) / depth - 1.0).abs() < 1e-14);

        let ramp = LinearRamp {
            density: 1.0,
            origin: DVec3::ZERO,
            gradient: DVec3::new(0.25, 0.0, 0.5),
        };
        let profile = LinearProfile::along(&slanted, &ramp);
        let depth = profile.optical_depth(0.0, 4.0);
        let seen = by_quadrature(|t| ramp.density(slanted.at(t)), 4.0);
        assert!((depth / seen - 1.0).abs() < 1e-12, "{depth} for {seen}");
    }

    #[test]
    fn a_ramp_ends_where_it_reaches_zero() {
        let falling = LinearProfile {
            start: 1.0,
            slope: -0.5,
        };
        assert_eq!(falling.positive_part(0.0, 1.0), Some((0.0, 1.0)));
        assert_eq!(falling.positive_part(0.0, 8.0), Some((0.0, 2.0)));
        assert_eq!(falling.positive_part(2.0, 8.0), None);
        let rising = LinearProfile {
            start: -1.0,
            slope: 0.5,
        };
        assert_eq!(rising.positive_part(0.0, 8.0), Some((2.0, 8.0)));
        assert_eq!(rising.optical_depth(2.0, 8.0), 9.0);
        let nothing = LinearProfile {
            start: 0.0,
            slope: 0.0,
        };
        assert_eq!(nothing.positive_part(0.0, 8.0), None);
    }

    #[test]
    fn the_gaussian_tail_keeps_its_digits() {
        let blob = GaussianProfile {
            peak: 1.0,
            centre: 0.0,
            width: 1.0,
        };
        let (ahead, behind) = (
            blob.optical_depth(20.0, f64::INFINITY),
            blob.optical_depth(f64::NEG_INFINITY, -20.0),
        );
        assert_eq!(ahead, behind);
        // √(2π) times the upper tail of the normal distribution at 20, 2.7536241186062337e-89.
        let tail = (2.0 * PI).sqrt() * 2.753_624_118_606_233_7e-89;
        assert!((ahead / tail - 1.0).abs() < 1e-12);
    }
}
