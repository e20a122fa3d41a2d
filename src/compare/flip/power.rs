//! Powers of differences.

use crate::math::{exp, ln};

/// `base^exponent` for `base ≥ 0` and `exponent ≥ 0`, and 0 for base 0 (equal colours stay equal
/// whatever the exponent).
///
/// The relative error is about `|exponent · ln base|` roundings, below 1e-14 for every difference
/// that is not itself a rounding error. `math::pow` has half a rounding, at three times the cost.
pub fn power(base: f64, exponent: f64) -> f64 {
    if base == 0.0 {
        0.0
    } else {
        exp(exponent * ln(base))
    }
}
