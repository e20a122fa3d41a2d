//! Mean and variance of a series of samples.

/// Count, mean and sum of squared deviations, updated one sample at a time.
///
/// Deviations are taken from the running mean: the difference of sum of squares and squared sum
/// loses all digits where the spread is small compared with the mean.
///
/// Source: Welford 1962, Technometrics 4, 419–420.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    mean: f64,
    squared_deviations: f64,
}

impl Moments {
    /// Adds one sample.
    pub fn add(&mut self, sample: f64) {
        self.count += 1;
        let deviation = sample - self.mean;
        self.mean += deviation / self.count as f64;
        self.squared_deviations += deviation * (sample - self.mean);
    }

    /// Number of samples.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Arithmetic mean; 0 of no samples.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased estimate of the variance of the distribution, `Σ(x − mean)²/(n − 1)`; `None` for
    /// fewer than two samples.
    pub fn variance(&self) -> Option<f64> {
        (self.count >= 2).then(|| self.squared_deviations / (self.count - 1) as f64)
    }

    /// Unbiased estimate of the variance of the mean, the square of its standard error; `None` for
    /// fewer than two samples.
    pub fn variance_of_mean(&self) -> Option<f64> {
        self.variance().map(|variance| variance / self.count as f64)
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(samples: I) -> Self {
        let mut moments = Moments::default();
        for sample in samples {
            moments.add(sample);
        }
        moments
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_samples() {
        assert_eq!(Moments::default().variance(), None);
        let one = Moments::from_iter([3.0]);
        assert_eq!(
            (one.mean(), one.variance(), one.variance_of_mean()),
            (3.0, None, None)
        );
        let two = Moments::from_iter([1.0, 3.0]);
        assert_eq!(
            (two.mean(), two.variance(), two.variance_of_mean()),
            (2.0, Some(2.0), Some(1.0))
        );
    }
}
