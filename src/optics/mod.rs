//! Surfaces and lights: what turns light where matter ends, and where light comes from.

mod fresnel;
mod light;
mod material;

pub use fresnel::{Split, reflected, split};
pub use light::{Directional, Light, Point, Spot, SpotError};
pub use material::{Material, Sides};
