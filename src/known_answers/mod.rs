//! Known answers: scenes whose radiance along every ray has a closed form, or is an integral in one
//! dimension.
//!
//! A [`Formula`] takes coefficients, shapes and lights from the scene itself, so that the two cannot
//! drift apart, and refuses a scene that it does not describe. The suite's family `known-answers`
//! has its goldens from here: renderers are held to the answer, not to a sampled image.
//!
//! Nothing here is shared with the renderers but the camera: rays are cut by bodies, light is
//! attenuated and scattered in formulas of their own.
//!
//! One formula is one file, with its derivation and source; a new one is a line of [`CATALOGUE`].

mod absorbing_grid;
mod airlight;
mod bodies;
mod catalogue;
mod emission_absorption;
mod exponential_integral;
mod formula;
mod furnace;
mod half_space;
mod image;
mod lit_body;
mod phase_function;
mod plane_layer;
mod requirements;
mod slab;

pub use catalogue::{CATALOGUE, NAMES};
pub use formula::Formula;

pub use image::{Footprint, KnownImage};
