//! Elementary functions with the same bits on every platform, and sums that keep their digits.

mod cube_root;
mod elementary;
mod srgb;
mod sum;

pub use cube_root::quick_cbrt;
pub use elementary::*;
pub use srgb::{linear_to_srgb, srgb_to_linear};
pub use sum::Sum;
