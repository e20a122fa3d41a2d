//! Errors of a row relative to its tolerance.

use crate::math::Moments;
use std::fmt::{Debug, Display};

/// Half a unit in the last place of 1: the largest relative error of one rounding.
pub const U: f64 = f64::EPSILON / 2.0;

/// Largest deviation of a sampled mean, in standard errors. One sound comparison in sixteen
/// thousand is farther off; seeds are fixed, and not among those.
pub const STANDARD_ERRORS: f64 = 4.0;

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
    pub fn within(&mut self, what: impl Display, found: f64, right: f64, allowed: f64) {
        let share = match found == right {
            true => 0.0,
            false if allowed.is_infinite() => f64::INFINITY,
            false => (found - right).abs() / allowed,
        };
        self.note(share, || {
            format!("{what}: {found:e}, right is {right:e} within {allowed:.1e}")
        });
    }

    /// `found` has to be `right` but for a `share` of it; without any, to the bit.
    pub fn relative(&mut self, what: impl Display, found: f64, right: f64, share: f64) {
        if share == 0.0 {
            self.exact(what, found, right);
        } else {
            self.within(what, found, right, share * right.abs());
        }
    }

    /// Requires `found` to be `right` up to this number of roundings.
    pub fn roundings(&mut self, what: impl Display, found: f64, right: f64, roundings: f64) {
        self.relative(what, found, right, roundings * U);
    }

    /// `found` has to be `right`, to the bit: what is printed tells numbers apart that are not the
    /// same, and 0 from −0.
    pub fn exact<T: PartialEq + Debug>(&mut self, what: impl Display, found: T, right: T) {
        let same = found == right && format!("{found:?}") == format!("{right:?}");
        let share = if same { 0.0 } else { f64::INFINITY };
        self.note(share, || {
            format!("{what}: {found:?}, right is exactly {right:?}")
        });
    }

    /// Requires both images to exist and to be equal, by a hash of their bits.
    pub(crate) fn same_picture(
        &mut self,
        what: impl Display,
        found: Option<String>,
        right: Option<String>,
    ) {
        self.holds(format_args!("{what}: there is a picture"), found.is_some());
        self.exact(what, found, right);
    }

    /// Requires a condition.
    pub fn holds(&mut self, what: impl Display, so: bool) {
        let share = if so { 0.0 } else { f64::INFINITY };
        self.note(share, || format!("not so: {what}"));
    }

    /// A mean of samples has to be `right` within [`STANDARD_ERRORS`].
    pub fn sampled(&mut self, what: impl Display, found: &Moments, right: f64) {
        let variance = found.variance_of_mean().unwrap_or(f64::NAN);
        self.within(what, found.mean(), right, STANDARD_ERRORS * variance.sqrt());
    }

    fn note(&mut self, share: f64, at: impl FnOnce() -> String) {
        self.comparisons += 1;
        let share = if share.is_nan() { f64::INFINITY } else { share };
        if share > self.share {
            self.share = share;
            self.worst = at();
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
        margin.exact("d", [1, 2], [1, 2]);
        assert_eq!((margin.share(), margin.passed()), (0.5, true));
        assert_eq!(margin.worst(), "a: 1.5e0, right is 1e0 within 1.0e0");
        margin.roundings("e", 1.0 + 2.0 * f64::EPSILON, 1.0, 2.0);
        assert_eq!((margin.share(), margin.passed()), (2.0, false));
    }

    #[test]
    fn what_is_no_number_is_infinitely_far_off() {
        let far_off: [&dyn Fn(&mut Margin); 8] = [
            &|margin| margin.within("a", f64::NAN, 1.0, 1.0),
            &|margin| margin.within("b", 1.0, 2.0, 0.0),
            &|margin| margin.within("c", f64::INFINITY, 1.0, f64::INFINITY),
            &|margin| margin.holds("d", false),
            &|margin| margin.within("f", 1.5, 1.0, f64::INFINITY),
            &|margin| margin.exact("g", 0.0, -0.0),
            &|margin| margin.same_picture("h", None, None),
            &|margin| margin.sampled("e", &Moments::default(), 1.0),
        ];
        for compare in far_off {
            let mut margin = Margin::default();
            compare(&mut margin);
            assert_eq!(margin.share(), f64::INFINITY, "{}", margin.worst());
        }
    }

    #[test]
    fn a_sampled_mean_is_judged_by_its_own_spread() {
        let samples = Moments::from_iter([0.0, 1.0, 0.0, 1.0]);
        let mut margin = Margin::default();
        margin.sampled("coin", &samples, 0.6);
        // A variance of 1/3 over four samples: a standard error of 0.2887.
        assert!((margin.share() - 0.1 / (4.0 / 12.0_f64.sqrt())).abs() < 1e-12);
    }
}
