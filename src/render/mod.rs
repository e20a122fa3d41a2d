//! From a scene to an image: the plan, the kernels, the pixel loop.
//!
//! [`classified`] casts rays through a grid with a transfer function, [`radiative`] follows light
//! among surfaces, media and lights: a folder for each model. [`plan`] decides which effects a
//! scene calls for. `image` renders the panels of a scene according to their plans, `pixels` is the loop over
//! the pixels of one; [`counters`] counts the work.
//!
//! # The kernels
//!
//! Samples of classified volumes have one plain loop. For surfaces, media and lights
//! a kernel is the code of a renderer compiled for certain effects. They come in families; the
//! [`Plan`] picks one member for an image, once, in `radiative/kernels.rs`. Each is also
//! compiled in a second variant that counts its work. The code between a kernel and the threads is
//! compiled only once: duplicated for each kernel, it would be a third of all code.
//!
//! | family | kernels | compiled for | uncounted, KiB | counted | either | of all code |
//! |---|---|---|---|---|---|---|
//! | path tracer | 26 | media, surfaces, emission, colour, anisotropy, heterogeneity | 332 | 338 | 2 | 4.4 % |
//! | line of sight | 22 | media, surfaces, emission, colour, anisotropy, heterogeneity | 173 | 179 | 15 | 2.4 % |
//! | shared by both | – | the same | 493 | 495 | 231 | 7.9 % |
//!
//! Kernels for media without surfaces are for one homogeneous and convex medium alone.
//! For heterogeneous media there are no kernels without surfaces, and on the line of sight, where
//! they do not scatter, no anisotropic ones; without media, kernels are not specialised for the effects of media.
//! The kernel with all effects is the general one. Made by `scripts/kernel-sizes.sh` for x86-64; a
//! test checks the kernel counts.

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
pub(crate) use classified::curve::PlotLayout;
pub use classified::depth::{depth, first_opacity};
pub use counters::{Counters, Event};
pub use error::RenderError;
pub use footprint::{Footprint, Memory, footprint};
pub use image::{Rendering, render, render_counted};
pub(crate) use image::{render_coarse, render_coarse_counted, render_part};
pub use pixels::Detail;
pub use plan::{Effect, Plan, State, plans};
pub(crate) use progress::Progress;
pub use progress::Watch;

#[cfg(test)]
#[path = "tests/hard_cases/mod.rs"]
mod hard_cases;

/// Number of kernels in a family, as listed in the table above.
#[cfg(test)]
fn documented_kernels(family: &str) -> usize {
    let row = format!("//! | {family} | ");
    let row = include_str!("mod.rs")
        .lines()
        .find_map(|line| line.strip_prefix(&row));
    let number = row.and_then(|row| row.split(' ').next());
    number.expect("a row").parse().expect("a number")
}
