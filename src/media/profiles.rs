//! Extinction along a ray as a function of the distance `t`, where its integral has a closed
//! form.

use crate::math::{erf, erfc, exp, ln_1p};
use crate::media::{optical_depth, source_factor};
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
    /// Optical depth from `near` to `far ≥ near`, both finite: mean extinction times length.
    pub fn optical_depth(&self, near: f64, far: f64) -> f64 {
        (self.start + self.slope * ((near + far) / 2.0)) * (far - near)
    }

    /// Distance from `t = 0` at which the optical depth reaches `depth ≥ 0`; `None` if the
    /// extinction falls to 0 before.
    ///
    /// `2τ / (σ₀ + √(σ₀² + 2kτ))`, the root of the quadratic in which nothing cancels where the
    /// slope is small or positive.
    pub fn distance(&self, depth: f64) -> Option<f64> {
        if depth == 0.0 {
            return Some(0.0);
        }
        let extinction_there_squared = self.start * self.start + 2.0 * self.slope * depth;
        let divisor = self.start + extinction_there_squared.max(0.0).sqrt();
        (extinction_there_squared >= 0.0 && divisor > 0.0).then(|| 2.0 * depth / divisor)
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

    /// Distance from `t = 0` at which the optical depth reaches `depth ≥ 0`:
    /// `−ln(1 − rate·τ/start)/rate`; `None` if all there is along the ray is less.
    pub fn distance(&self, depth: f64) -> Option<f64> {
        if depth == 0.0 {
            return Some(0.0);
        }
        if self.start == 0.0 {
            return None;
        }
        if self.rate == 0.0 {
            return Some(depth / self.start);
        }
        let share = self.rate * depth / self.start;
        (share < 1.0).then(|| -ln_1p(-share) / self.rate)
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
    /// Optical depth from `near` to `far ≥ near`, either of which may be infinite. On a stretch
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

    #[test]
    fn a_falling_extinction_can_run_out() {
        let falling = LinearProfile {
            start: 1.0,
            slope: -0.5,
        };
        // All of it is the triangle of height 1 over length 2.
        assert_eq!(falling.distance(1.0), Some(2.0));
        assert_eq!(falling.distance(1.0_f64.next_up()), None);
        let thinning = ExponentialProfile {
            start: 2.0,
            rate: 0.5,
        };
        assert_eq!(thinning.optical_depth(0.0, f64::INFINITY), 4.0);
        assert_eq!(thinning.distance(4.0), None);
    }

    #[test]
    fn vacuum_is_never_crossed_to_any_depth_but_none() {
        let linear = LinearProfile {
            start: 0.0,
            slope: 0.0,
        };
        let level = ExponentialProfile {
            start: 0.0,
            rate: 0.0,
        };
        assert_eq!(
            (linear.distance(0.0), linear.distance(0.1)),
            (Some(0.0), None)
        );
        assert_eq!(
            (level.distance(0.0), level.distance(0.1)),
            (Some(0.0), None)
        );
        assert_eq!(level.optical_depth(0.0, f64::INFINITY), 0.0);
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
