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
//! [`matter`] holds the media, [`flight`] how far light flies through them, [`glow`] what they send
//! out. Where their density differs from place to place, [`tracking`] is the method, [`passage`]
//! the stretch of a ray that it works on, and [`tracker`] what it needs besides.

pub mod compositing;
pub mod curve;
pub mod direct_light;
pub mod draws;
pub mod effects;
pub mod empty_space;
pub mod field;
pub mod flight;
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

pub use image::{Progress, RenderError, Rendering, render, render_counted};
pub use plan::{Effect, Plan, State};
pub use work::Counters;
