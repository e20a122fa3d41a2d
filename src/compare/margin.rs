//! Errors of an image relative to the tolerance of its known answer.

use std::fmt::Display;

/// Largest deviation of a sampled mean, in standard errors. One sound comparison in sixteen
/// thousand is farther off; seeds are fixed, and not among those.
pub(crate) const STANDARD_ERRORS: f64 = 4.0;

/// The worst of many comparisons, each error relative to its tolerance: 0 is exact, 1 the limit.
/// NaN counts as infinite error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Margin {
    share: f64,
    worst: String,
    comparisons: usize,
}

impl Margin {
    /// The largest error relative to its tolerance.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Description of the comparison with the largest error; empty without any error.
    pub fn worst(&self) -> &str {
        &self.worst
    }

    /// Whether anything was compared, and everything is within its tolerance.
    pub fn passed(&self) -> bool {
        self.comparisons > 0 && self.share <= 1.0
    }

    /// Requires `found` to be within `allowed` of `right`. Equal numbers, even infinite ones, have
    /// error 0.
    pub(crate) fn within(&mut self, what: impl Display, found: f64, right: f64, allowed: f64) {
        self.comparisons += 1;
        let share = match found == right {
            true => 0.0,
            false if allowed.is_infinite() => f64::INFINITY,
            false => (found - right).abs() / allowed,
        };
        let share = if share.is_nan() { f64::INFINITY } else { share };
        if share > self.share {
            self.share = share;
            self.worst = format!("{what}: {found:e}, right is {right:e} within {allowed:.1e}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_comparison_counts() {
        let mut margin = Margin::default();
        assert!(!margin.passed(), "nothing was compared");
        margin.within("a", 1.5, 1.0, 1.0);
        margin.within("b", 1.25, 1.0, 1.0);
        margin.within("c", f64::INFINITY, f64::INFINITY, 0.0);
        assert_eq!((margin.share(), margin.passed()), (0.5, true));
        assert_eq!(margin.worst(), "a: 1.5e0, right is 1e0 within 1.0e0");
        margin.within("d", 3.0, 1.0, 1.0);
        assert_eq!((margin.share(), margin.passed()), (2.0, false));
    }

    #[test]
    fn what_is_no_number_is_infinitely_far_off() {
        for (found, right, allowed) in [
            (f64::NAN, 1.0, 1.0),
            (1.0, 2.0, 0.0),
            (f64::INFINITY, 1.0, f64::INFINITY),
            (1.5, 1.0, f64::INFINITY),
        ] {
            let mut margin = Margin::default();
            margin.within("a", found, right, allowed);
            assert_eq!(margin.share(), f64::INFINITY, "{}", margin.worst());
        }
    }
}
