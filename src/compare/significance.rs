//! Significance of deviations.

use crate::math;
use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal, StudentsT};
use std::f64::consts::FRAC_1_SQRT_2;

/// Difference of two means in its own standard errors, given their variances: the normal form of
/// Welch's statistic. 0 for equal means, infinite for different means without variance.
///
/// Source: Welch 1947, Biometrika 34, 28–35.
pub fn deviation(difference: f64, variance: f64) -> f64 {
    if difference == 0.0 {
        return 0.0;
    }
    difference / variance.sqrt()
}

/// Probability that a standard normal number is at least as far from 0 as `z`, on either side.
pub fn two_sided(z: f64) -> f64 {
    math::erfc(z.abs() * FRAC_1_SQRT_2)
}

/// The `z` at which [`two_sided`] is `level`, in (0, 1).
pub fn critical(level: f64) -> f64 {
    -Normal::standard().inverse_cdf(0.5 * level)
}

/// [`two_sided`] for a deviation in standard errors that were estimated with that many degrees
/// of freedom.
pub(crate) fn two_sided_estimated(t: f64, degrees: f64) -> f64 {
    let student = StudentsT::new(0.0, 1.0, degrees).expect("degrees of freedom are positive");
    2.0 * student.sf(t.abs())
}

/// Degrees of freedom from which [`critical_estimated`] is a series: statrs's search does not end for
/// millions. What the series leaves out is 3 z⁷/(384 ν³), a hundred-thousandth at z = 8.
const MANY_DEGREES: f64 = 1e3;

/// The `t` at which [`two_sided_estimated`] is `level`.
///
/// Source of the series: Abramowitz & Stegun 1964, 26.7.5.
pub(crate) fn critical_estimated(level: f64, degrees: f64) -> f64 {
    if degrees >= MANY_DEGREES {
        let z = critical(level);
        let square = z * z;
        let first = z * (square + 1.0) / 4.0;
        let second = z * ((5.0 * square + 16.0) * square + 3.0) / 96.0;
        return z + (first + second / degrees) / degrees;
    }
    let student = StudentsT::new(0.0, 1.0, degrees).expect("degrees of freedom are positive");
    -student.inverse_cdf(0.5 * level)
}

/// Number of hypotheses with these probabilities to reject, such that a true one is rejected with
/// probability `level` at most, for any dependence between them: the k-th smallest of n is rejected
/// if all before it are and it is at most `level/(n + 1 − k)`.
///
/// Source: Holm 1979, Scandinavian Journal of Statistics 6, 65–70.
pub(crate) fn holm(probabilities: &[f64], level: f64) -> usize {
    let mut sorted = probabilities.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut left = sorted.len();
    let small = |p: &f64| {
        let rejected = *p * left as f64 <= level;
        left -= 1;
        rejected
    };
    sorted.iter().copied().take_while(small).count()
}

/// Probability that at least `count` of `trials` independent events of probability `each` happen.
pub fn at_least(count: u64, trials: u64, each: f64) -> f64 {
    let Some(fewer) = count.checked_sub(1) else {
        return 1.0;
    };
    Binomial::new(each, trials)
        .expect("a probability")
        .sf(fewer)
}

/// Probability that the sum of the squares of `count` standard normal numbers is at least as
/// extreme as `sum`: twice that of the shorter tail.
pub(crate) fn chi_square_two_sided(sum: f64, count: f64) -> f64 {
    let distribution = ChiSquared::new(count).expect("at least one number");
    (2.0 * distribution.cdf(sum).min(distribution.sf(sum))).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_means_deviate_by_nothing() {
        assert_eq!(deviation(0.0, 0.0), 0.0);
        assert_eq!(deviation(-1.0, 0.0), f64::NEG_INFINITY);
        assert_eq!(two_sided(f64::INFINITY), 0.0);
        assert_eq!(two_sided_estimated(f64::INFINITY, 63.0), 0.0);
    }

    /// The series, against the tail that it is to give back; and for any number of degrees.
    #[test]
    fn limits_of_many_degrees_of_freedom() {
        for level in [1e-2, 1e-6, 1e-9] {
            for degrees in [1e3, 4032.0, 1e5] {
                let t = critical_estimated(level, degrees);
                // A tail falls by t times a relative change of t, times t: 64 · 10⁻⁵ at t = 8.
                let found = two_sided_estimated(t, degrees);
                assert!(
                    (found / level - 1.0).abs() < 1e-3,
                    "{level} {degrees} {found}"
                );
            }
            let normal = critical(level);
            assert!((critical_estimated(level, 1e9) / normal - 1.0).abs() < 1e-7);
        }
    }

    #[test]
    fn holm_steps_down() {
        // 0.01 ≤ 0.05/4, 0.013 ≤ 0.05/3, but 0.03 > 0.05/2: and there it ends.
        let mixed = [0.03, 0.01, 0.04, 0.013];
        assert_eq!(holm(&mixed, 0.05), 2);
        assert_eq!(holm(&[0.02; 4], 0.05), 0);
        assert_eq!(holm(&[0.0; 4], 0.05), 4);
        assert_eq!(holm(&[], 0.05), 0);
    }

    #[test]
    fn tails_of_small_counts() {
        assert_eq!(at_least(0, 5, 0.5), 1.0);
        assert!((at_least(5, 5, 0.5) - 1.0 / 32.0).abs() < 1e-12);
        assert!((at_least(1, 2, 0.25) - 7.0 / 16.0).abs() < 1e-12);
    }

    #[test]
    fn critical_values_are_where_the_tails_are() {
        for level in [0.5, 1e-3, 1e-6, 1e-12] {
            assert!((two_sided(critical(level)) / level - 1.0).abs() < 1e-8);
            let t = critical_estimated(level, 63.0);
            assert!(
                (two_sided_estimated(t, 63.0) / level - 1.0).abs() < 1e-6,
                "{level}"
            );
        }
    }
}
