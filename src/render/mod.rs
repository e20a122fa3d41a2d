//! From a scene to an image: the plan, the kernels, the pixel loop.
//!
//! For classified volumes read [`RayCaster::layers`](ray_caster::RayCaster::layers) first: it is
//! the renderer. Its parts have a file each: [`steps`], [`field`], [`compositing`],
//! [`volume_shadow`], [`empty_space`].
//!
//! For surfaces, media and lights read
//! [`PathTracer::radiance`](path_tracer::PathTracer::radiance). What a ray meets is in
//! [`surroundings`] and [`media_path`], what turns it in [`vertex`] and [`smooth`], how it finds
//! light in [`direct_light`], [`in_scattering`] and [`lit_places`]. [`line_of_sight`] does without
//! random numbers what can be done so.
//!
//! [`expected`] tells the work of an image beforehand, [`work`] counts it.
//!
//! [`matter`] holds the media, [`flight`] how far light flies through them, [`glow`] what they send
//! out. Where their density differs from place to place, [`tracking`] is the method, [`passage`]
//! the stretch of a ray that it works on, and [`tracker`] what it needs besides.
//!
//! # The kernels
//!
//! A kernel is the code of a renderer compiled for certain effects. They come in families; the
//! [`Plan`] picks one member for an image, once, in `kernel.rs` and `radiative_kernel.rs`. Each is
//! compiled once more to count its [`work`], but for what does the same either way. What runs
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

pub mod compositing;
pub mod curve;
pub mod direct_light;
pub mod draws;
pub mod effects;
pub mod empty_space;
pub mod expected;
pub mod field;
pub mod flight;
mod footprint;
mod forecast;
pub mod glow;
mod image;
pub mod in_scattering;
mod kernel;
pub mod line_of_sight;
pub mod lit_places;
pub mod matter;
pub mod media_path;
pub mod passage;
pub mod path_tracer;
pub mod plan;
mod radiative_kernel;
pub mod ray_caster;
pub mod smooth;
pub mod steps;
pub mod surroundings;
pub mod tracker;
pub mod tracking;
pub mod vertex;
pub mod volume_shadow;
pub mod work;

pub use expected::{Amount, Bound, Expected, Memory};
pub use footprint::{Footprint, footprint};
pub use forecast::Forecast;
pub use image::{
    Detail, Progress, RenderError, Rendering, Watch, render, render_coarse, render_counted,
};
pub use plan::{Effect, Plan, State};
pub use work::Counters;

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
