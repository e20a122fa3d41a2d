//! Comparisons of a row, each of which has to hold.

use crate::math::Moments;
use std::fmt::{Debug, Display};

/// Half a unit in the last place of 1: the largest relative error of one rounding.
pub const U: f64 = f64::EPSILON / 2.0;

/// Largest deviation of a sampled mean, in standard errors. One sound comparison in sixteen
/// thousand is farther off; seeds are fixed, and not among those.
pub const STANDARD_ERRORS: f64 = 4.0;

/// Compares what is found with what is right.
pub struct Margin;

impl Margin {
    /// Requires `found` to be within `allowed` of `right`. Equal numbers, even infinite ones, have
    /// error 0.
    pub fn within(&self, what: impl Display, found: f64, right: f64, allowed: f64) {
        let is_within = found == right || allowed.is_finite() && (found - right).abs() <= allowed;
        assert!(
            is_within,
            "{what}: {found:e}, right is {right:e} within {allowed:.1e}"
        );
    }

    /// `found` has to be `right` but for a `share` of it; without any, to the bit.
    pub fn relative(&self, what: impl Display, found: f64, right: f64, share: f64) {
        if share == 0.0 {
            self.exact(what, found, right);
        } else {
            self.within(what, found, right, share * right.abs());
        }
    }

    /// Requires `found` to be `right` up to this number of roundings.
    pub fn roundings(&self, what: impl Display, found: f64, right: f64, roundings: f64) {
        self.relative(what, found, right, roundings * U);
    }

    /// `found` has to be `right`, to the bit: what is printed tells numbers apart that are not the
    /// same, and 0 from −0.
    pub fn exact<T: PartialEq + Debug>(&self, what: impl Display, found: T, right: T) {
        let same = found == right && format!("{found:?}") == format!("{right:?}");
        assert!(same, "{what}: {found:?}, right is exactly {right:?}");
    }

    /// Requires both images to exist and to be equal, by a hash of their bits.
    pub fn same_picture(&self, what: impl Display, found: Option<String>, right: Option<String>) {
        assert!(found.is_some(), "{what}: there is no picture");
        self.exact(what, found, right);
    }

    /// Requires a condition.
    pub fn holds(&self, what: impl Display, so: bool) {
        assert!(so, "not so: {what}");
    }

    /// A mean of samples has to be `right` within [`STANDARD_ERRORS`].
    pub fn sampled(&self, what: impl Display, found: &Moments, right: f64) {
        let variance = found.variance_of_mean().unwrap_or(f64::NAN);
        self.within(what, found.mean(), right, STANDARD_ERRORS * variance.sqrt());
    }
}
