//! Arithmetic of many digits: the judge of the last digit that an `f64` has, and of what it says
//! of boxes, spheres and grids.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

pub mod functions;
pub mod grids;
pub mod shapes;

pub type Big = FBig<HalfEven>;

/// Largest relative error of one rounding of an `f64`.
pub const U: f64 = f64::EPSILON / 2.0;

/// Bits that every operation keeps. An `f64` has 53; the formulas here are written so that no more
/// than another 50 cancel in them, and what is left judges a rounding to a part in ten thousand.
const BITS: usize = 120;

/// A finite number, exactly.
pub fn big(x: f64) -> Big {
    Big::try_from(x).unwrap().with_precision(BITS).value()
}

/// The nearest `f64`.
pub fn rounded(x: &Big) -> f64 {
    x.to_f64().value()
}

/// How far `found`, which has to be finite, is from `exact`.
pub fn apart(found: f64, exact: &Big) -> f64 {
    rounded(&(big(found) - exact)).abs()
}
