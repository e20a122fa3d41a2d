//! Maps from uniform numbers in [0, 1) to directions and distances, with their densities.
//!
//! Every map stays finite and inside its domain at both ends of the random range, `u = 0` and `u =
//! 1 − 2^-53`, where its density is positive.

mod directions;
mod equiangular;
mod free_flight;
mod heuristic;
mod lobe;

pub(crate) use directions::from_cosine;
pub use directions::{Cone, cosine_hemisphere, cosine_hemisphere_pdf, sphere, sphere_pdf};
pub use equiangular::{Equiangular, LightOnRay};
pub use free_flight::{
    free_flight, optical_distance, truncated_free_flight_pdf, truncated_optical_distance,
};
pub(crate) use heuristic::power_heuristic;
pub(crate) use lobe::Lobe;
