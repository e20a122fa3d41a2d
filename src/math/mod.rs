//! Elementary functions with the same bits on every platform, and sums that keep their digits.

mod elementary;
mod sum;

pub use elementary::*;
pub use sum::Sum;
