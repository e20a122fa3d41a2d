//! Norms of errors.

use crate::math::Sum;
use serde::Serialize;

/// Size of an error over many rays and channels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Norms {
    /// Root mean square error, relative to the root mean square of what is right.
    pub l2: f64,
    /// Its relative standard error, as far as these rays stand for others.
    pub uncertainty: f64,
}

/// Norms of `errors` of three channels, pixel by pixel, in units of `scale > 0`; infinite if an error is NaN, or if
/// there are none. Errors of the channels of a pixel are correlated: there are fewer independent errors than numbers.
pub fn norms(errors: impl Iterator<Item = f64>, scale: f64) -> Norms {
    let (mut squares, mut fourths, mut count) = (Sum::default(), Sum::default(), 0.0_f64);
    for error in errors {
        count += 1.0;
        squares.add(error * error);
        fourths.add(error * error * (error * error));
    }
    let mean = squares.value() / count;
    if !mean.is_finite() {
        return Norms {
            l2: f64::INFINITY,
            uncertainty: 0.0,
        };
    }
    let spread = (fourths.value() / count - mean * mean).max(0.0);
    Norms {
        l2: mean.sqrt() / scale,
        uncertainty: if mean > 0.0 {
            0.5 * (3.0 * spread / count).sqrt() / mean
        } else {
            0.0
        },
    }
}

/// Root mean square of `values`: the unit of relative errors. 1 if all are 0.
pub(crate) fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (mut squares, mut count) = (Sum::default(), 0.0);
    for value in values {
        squares.add(value * value);
        count += 1.0;
    }
    match squares.value() {
        0.0 => 1.0,
        sum => (sum / count).sqrt(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_three_errors() {
        let norms = norms([3.0, -4.0, 0.0].into_iter(), 2.0);
        assert_eq!(norms.l2, (25.0_f64 / 3.0).sqrt() / 2.0);
    }

    #[test]
    fn what_is_no_number_is_not_lost() {
        let norms = norms([f64::NAN, 0.0].into_iter(), 1.0);
        assert_eq!(norms.l2, f64::INFINITY);
    }
}
