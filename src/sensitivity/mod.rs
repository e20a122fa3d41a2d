//! Sensitivities: the derivative of every pixel by a parameter of the scene.
//!
//! `number` is a parameter and how it is changed, `numbers` lists those of a scene, `derivative`
//! differentiates.
//!
//! A derivative is a difference of two renderings, `(I(θ + h) − I(θ − h))/2h`, with a stated error.
//! Where pixels are means of random samples, both sides use the same random numbers: what they have
//! in common cancels, and the error is that of the spread of independent pairs. A difference of
//! whole images also counts what a derivative inside the integral misses: light that is hidden or
//! seen at an edge which moves.
//!
//! Source of common random numbers: Glasserman & Yao 1992, Management Science 38, 884–908.

mod derivative;
mod number;
mod numbers;

pub use derivative::{Derivative, Differences, derivative};
pub use number::Number;
pub use numbers::{number, numbers, numbers_of_place};
