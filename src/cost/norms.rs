//! Sizes of an error.

use super::results::Norms;
use crate::math::Sum;

/// Errors of many rays and channels, taken in one by one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    count: u64,
    absolute: Sum,
    squares: Sum,
    fourths: Sum,
    largest: f64,
}

impl Errors {
    /// Takes one more in. One that is no number makes all norms infinite.
    pub fn add(&mut self, error: f64) {
        let size = if error.is_nan() {
            f64::INFINITY
        } else {
            error.abs()
        };
        self.count += 1;
        self.absolute.add(size);
        self.squares.add(size * size);
        self.fourths.add(size * size * (size * size));
        self.largest = self.largest.max(size);
    }

    /// Their sizes, in units of `scale > 0`.
    pub fn norms(&self, scale: f64) -> Norms {
        let count = self.count.max(1) as f64;
        // A compensated sum of infinities is no number; and who asked nobody knows nothing.
        if self.largest.is_infinite() || self.count == 0 {
            return Norms {
                l1: f64::INFINITY,
                l2: f64::INFINITY,
                max: f64::INFINITY,
                uncertainty: 0.0,
            };
        }
        let mean = self.squares.value() / count;
        let spread = (self.fourths.value() / count - mean * mean).max(0.0);
        Norms {
            l1: self.absolute.value() / count / scale,
            l2: (self.squares.value() / count).sqrt() / scale,
            max: self.largest / scale,
            uncertainty: if mean > 0.0 {
                0.5 * (spread / count).sqrt() / mean
            } else {
                0.0
            },
        }
    }
}

/// Root mean square of `values`: the unit of relative errors. 1 if all are 0.
pub fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
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
        let mut errors = Errors::default();
        for error in [3.0, -4.0, 0.0] {
            errors.add(error);
        }
        let norms = errors.norms(2.0);
        assert_eq!(norms.l1, 7.0 / 6.0);
        assert_eq!(norms.l2, (25.0_f64 / 3.0).sqrt() / 2.0);
        assert_eq!(norms.max, 2.0);
    }

    #[test]
    fn what_is_no_number_is_not_lost() {
        let mut errors = Errors::default();
        errors.add(f64::NAN);
        errors.add(0.0);
        assert_eq!(errors.norms(1.0).l2, f64::INFINITY);
    }
}
