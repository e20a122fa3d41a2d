//! From a scene to an image: the plan, the kernels, the pixel loop.
//!
//! [`classified`] casts rays through a grid with a transfer function, [`radiative`] follows light
//! among surfaces, media and lights: a folder for each model. [`plan`] decides which effects a
//! scene calls for. `image` renders the panels of a scene according to their plans, `pixels` is the loop over
//! the pixels of one; [`counters`] counts the work.
//!
//! A scene that lacks an effect does not pay for it: the [`Plan`] states what a scene calls for, and a renderer asks it
//! before each piece of work. What counts the work is compiled apart.

pub mod classified;
pub mod counters;
mod error;
mod footprint;
mod image;
mod pixels;
pub mod plan;
mod progress;
pub mod radiative;

pub use crate::scene::{Sampling, Seed};
pub(crate) use classified::curve::{self, PlotLayout};
pub use classified::depth::depth;
pub use counters::{Counters, Event};
pub use error::RenderError;
pub use footprint::{Footprint, footprint};
pub(crate) use image::render_part;
pub use image::{Rendering, render};
pub use pixels::Detail;
pub use plan::{Effect, Plan, State, plans};
pub(crate) use progress::Progress;
pub use progress::Watch;

#[cfg(test)]
#[path = "tests/hard_cases/mod.rs"]
mod hard_cases;
