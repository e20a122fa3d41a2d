//! The output: an error per pixel, and summary statistics.

use crate::math::Sum;

/// FLIP errors of an image, each in [0, 1], row-major, top row first. At least one pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap(pub(super) Vec<f64>);

impl ErrorMap {
    /// The errors, row-major, top row first.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// Mean error: the single number to use if one must be used, say the authors (note
    /// "Hindsight" on the paper's project page).
    pub fn mean(&self) -> f64 {
        let sum: Sum = self.0.iter().copied().collect();
        sum.value() / self.0.len() as f64
    }

    /// Largest error of a pixel, in [0, 1].
    pub fn max(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }

    /// The smallest error v such that the pixels with errors up to v carry at least `percent`
    /// of the sum of all errors, `percent` in [0, 100]. A plain percentile ignores a small fault in
    /// a large correct image; this one does not.
    pub fn weighted_percentile(&self, percent: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let total: Sum = sorted.iter().copied().collect();
        let share = percent.clamp(0.0, 100.0) / 100.0 * total.value();
        let mut carried = Sum::default();
        sorted
            .iter()
            .copied()
            .find(|&error| {
                carried.add(error);
                carried.value() >= share
            })
            .unwrap_or(sorted[sorted.len() - 1])
    }
}

/// The errors in the magma palette, from black for 0 to pale yellow for 1: 8-bit sRGB, row-major,
/// top row first.
pub fn magma(errors: &ErrorMap) -> Vec<[u8; 3]> {
    let colour = |error: &f64| colorous::MAGMA.eval_continuous(*error).into_array();
    errors.values().iter().map(colour).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(values: &[f64]) -> ErrorMap {
        ErrorMap(values.to_vec())
    }

    #[test]
    fn weighted_percentiles_count_error_and_not_pixels() {
        // 96 good pixels, four bad ones that carry all the error.
        let mut values = vec![0.0; 96];
        values.extend([0.125, 0.125, 0.25, 0.5]);
        let errors = map(&values);
        assert_eq!(errors.weighted_percentile(25.0), 0.125);
        assert_eq!(errors.weighted_percentile(50.0), 0.25);
        assert_eq!(errors.weighted_percentile(51.0), 0.5);
        assert_eq!(errors.weighted_percentile(100.0), 0.5);
        assert_eq!(errors.weighted_percentile(0.0), 0.0);
        assert_eq!(map(&[0.0, 0.0]).weighted_percentile(99.0), 0.0);
    }

    #[test]
    fn mean_and_max() {
        let errors = map(&[0.25, 0.0, 0.5, 0.25]);
        assert_eq!((errors.mean(), errors.max()), (0.25, 0.5));
    }

    #[test]
    fn no_error_is_black_and_full_error_pale_yellow() {
        let ends = magma(&ErrorMap(vec![0.0, 1.0]));
        // The ends of the palette of S. van der Walt and N. Smith.
        assert_eq!(ends, [[0, 0, 4], [252, 253, 191]]);
    }
}
