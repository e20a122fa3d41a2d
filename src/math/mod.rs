//! Elementary functions with the same bits on every platform, and sums that keep their digits.

mod cube_root;
mod elementary;
mod sum;

pub use cube_root::quick_cbrt;
pub use elementary::*;
pub use sum::Sum;
