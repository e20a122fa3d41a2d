//! Elementary functions with the same bits on every platform, compensated sums, random numbers and
//! sampling.

mod cube_root;
mod direction;
mod elementary;
mod frame;
mod moments;
mod polynomial;
mod power_of_two;
pub mod quadrature;
pub mod rng;
pub mod sampling;
mod several;
mod srgb;
mod sum;

pub(crate) use cube_root::quick_cbrt;
pub use direction::Direction;
pub use elementary::*;
pub use frame::Frame;
pub use moments::Moments;
pub use polynomial::{polynomial, sign_changes};
pub(crate) use power_of_two::power_of_two_below;
pub(crate) use several::{exp_m1_of_several, ln_1p_of_several};
pub use srgb::{linear_to_srgb, srgb_to_linear};
pub use sum::Sum;
