//! Materials of surfaces, and lights.

mod fresnel;
mod light;
mod material;

pub use fresnel::{Split, reflected, split};
pub use light::{Directional, Light, Point, Spot, SpotError};
pub use material::{Material, Sides};
