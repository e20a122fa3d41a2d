//! Norms of errors.

use crate::math::Sum;
use serde::Serialize;

/// Sizes of an error over many rays and channels, relative to the root mean square of what is
/// right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Norms {
    /// Mean of the absolute error.
    pub l1: f64,
    /// Root mean square error.
    pub l2: f64,
    /// Largest error.
    pub max: f64,
    /// Relative standard error of the root mean square, as far as these rays stand for others.
    pub uncertainty: f64,
}

/// Norms of `errors` of three channels, pixel by pixel, in units of `scale > 0`. All are infinite if an error is NaN, or if
/// there are none. Errors of the channels of a pixel are correlated: there are fewer independent errors than numbers.
pub fn norms(errors: impl Iterator<Item = f64>, scale: f64) -> Norms {
    let (mut absolute, mut squares, mut fourths) = (Sum::default(), Sum::default(), Sum::default());
    let (mut largest, mut count) = (0.0_f64, 0.0_f64);
    for error in errors {
        let size = if error.is_nan() {
            f64::INFINITY
        } else {
            error.abs()
        };
        count += 1.0;
        absolute.add(size);
        squares.add(size * size);
        fourths.add(size * size * (size * size));
        largest = largest.max(size);
    }
    // A compensated sum of infinities is no number.
    if largest.is_infinite() || count == 0.0 {
        return Norms {
            l1: f64::INFINITY,
            l2: f64::INFINITY,
            max: f64::INFINITY,
            uncertainty: 0.0,
        };
    }
    let mean = squares.value() / count;
    let spread = (fourths.value() / count - mean * mean).max(0.0);
    Norms {
        l1: absolute.value() / count / scale,
        l2: (squares.value() / count).sqrt() / scale,
        max: largest / scale,
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
        assert_eq!(norms.l1, 7.0 / 6.0);
        assert_eq!(norms.l2, (25.0_f64 / 3.0).sqrt() / 2.0);
        assert_eq!(norms.max, 2.0);
    }

    #[test]
    fn what_is_no_number_is_not_lost() {
        let norms = norms([f64::NAN, 0.0].into_iter(), 1.0);
        assert_eq!(norms.l2, f64::INFINITY);
    }
}
