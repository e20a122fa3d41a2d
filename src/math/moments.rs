//! Mean and variance of a series of samples.

/// Count, mean and sum of squared deviations, updated one sample at a time.
///
/// Deviations are taken from the running mean: the difference of sum of squares and squared sum
/// loses all digits where the spread is small compared with the mean.
///
/// Sources: Welford 1962, Technometrics 4, 419–420; merging: Chan, Golub & LeVeque 1983,
/// The American Statistician 37, 242–247.
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

    /// The moments of both series together. The last bits depend on the partition of a series, so
    /// callers fix the parts and their order independently of the number of threads.
    pub fn merged(self, other: Moments) -> Moments {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let (here, there) = (self.count as f64, other.count as f64);
        let share = there / (here + there);
        let distance = other.mean - self.mean;
        Moments {
            count: self.count + other.count,
            mean: self.mean + distance * share,
            squared_deviations: self.squared_deviations
                + other.squared_deviations
                + distance * distance * (here * share),
        }
    }

    /// Number of samples.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Arithmetic mean; 0 of no samples.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Variance of the samples themselves, `Σ(x − mean)²/n`; 0 of no samples.
    pub fn population_variance(&self) -> f64 {
        self.squared_deviations / self.count.max(1) as f64
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
        assert_eq!(Moments::default().population_variance(), 0.0);
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

    #[test]
    fn merging_with_nothing_changes_nothing() {
        let some = Moments::from_iter([0.1, 0.7, 0.3]);
        assert_eq!(some.merged(Moments::default()), some);
        assert_eq!(Moments::default().merged(some), some);
    }

    #[test]
    fn parts_merge_to_the_whole() {
        let whole = Moments::from_iter([1.0, 2.0, 3.0, 4.0, 5.0, 9.0]);
        let parts = Moments::from_iter([1.0, 2.0]).merged(Moments::from_iter([3.0, 4.0, 5.0, 9.0]));
        assert_eq!((whole.count(), whole.mean()), (6, 4.0));
        assert_eq!((parts.count(), parts.mean()), (6, 4.0));
        assert_eq!(parts.squared_deviations, 40.0);
        assert!((whole.squared_deviations - 40.0).abs() <= 40.0 * 8.0 * f64::EPSILON);
    }
}
