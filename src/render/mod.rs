//! From a scene to an image: the plan, the kernels, the pixel loop.
//!
//! [`classified`] casts rays through a grid with a transfer function, [`radiative`] follows light
//! among surfaces, media and lights: a folder for each model. [`plan`] decides what a scene calls
//! for, `pixels` runs a kernel over the image, [`counters`] counts its work and
//! [`predicted_work`] predicts it.
//!
//! # The kernels
//!
//! A kernel is the code of a renderer compiled for certain effects. They come in families; the
//! [`Plan`] picks one member for an image, once, in the `kernels.rs` of each model. Each is
//! compiled once more to count its work, but for what does the same either way. What runs
//! between a kernel and the threads is compiled once for all of them: a copy for each would be a
//! third of all that is compiled.
//!
//! | family | kernels | compiled for | uncounted, KiB | counted | either | of all code |
//! |---|---|---|---|---|---|---|
//! | ray caster | 72 | field (3), order (3), shading, shadow, empty space | 379 | 394 | 0 | 7.5 % |
//! | path tracer | 26 | media, surfaces, emission, colour, direction, varying density | 193 | 190 | 0 | 3.7 % |
//! | line of sight | 22 | media, surfaces, emission, colour, direction, varying density | 201 | 197 | 0 | 3.8 % |
//! | shared by the latter two | – | the same | 459 | 479 | 132 | 10.3 % |
//!
//! Where density varies, there are no kernels without surfaces, and on the line of sight, where
//! nothing is turned then, none that tell directions apart; without media, none that tell those apart
//! by what media do. The member for everything is the general kernel. Made by
//! `scripts/kernel-sizes.sh` for x86-64; a test holds the numbers of kernels.

pub mod classified;
pub mod counters;
mod error;
mod footprint;
mod forecast;
mod image;
mod pixels;
pub mod plan;
pub mod predicted_work;
mod progress;
pub mod radiative;
mod sampling;

pub use counters::{Counters, Event};
pub use error::RenderError;
pub use footprint::{Footprint, footprint};
pub use image::{Rendering, render, render_coarse, render_counted};
pub use pixels::Detail;
pub use plan::{Effect, Plan, State, plans};
pub use predicted_work::{Amount, Bound, Expected, Memory};
pub use progress::{Forecast, Progress, Watch};
pub use sampling::{Sampling, Seed};

/// How many kernels the table above says that a family has.
#[cfg(test)]
fn documented_kernels(family: &str) -> usize {
    let row = format!("//! | {family} | ");
    let row = include_str!("mod.rs")
        .lines()
        .find_map(|line| line.strip_prefix(&row));
    let number = row.and_then(|row| row.split(' ').next());
    number.expect("a row").parse().expect("a number")
}
