//! Conventions of other ray casters, and a ray caster that follows them.
//!
//! The conventions themselves, a row for each, are part of the language of scenes
//! ([`Conventions`](crate::scene::Conventions)). The [`ray_caster`] renders under any of them; under
//! those of volref it gives the image of [`reference::ray_caster`](crate::reference::ray_caster), to
//! the bit. A [`Profile`] is a file with the conventions of a renderer, the [`CATALOGUE`] what a search
//! for the conventions behind an image tries. Projections and isosurfaces are sampled by the `FieldCaster`, under
//! those that they follow; several volumes, where their steps are common, by `CommonSteps`.

mod catalogue;
mod chance;
mod classifier;
mod field_caster;
mod first_samples;
mod image;
mod layer;
mod normals;
mod opacity;
mod profile;
pub mod ray_caster;
mod rounded_places;
mod several;
mod shading;
mod steps;
mod stored_values;
mod work;

pub(crate) use catalogue::ConventionSet;
pub use catalogue::{CATALOGUE, Convention, STEP, under};
pub(crate) use chance::scenes_by_chance;
pub(crate) use field_caster::FieldCaster;
pub(crate) use first_samples::bounds;
pub use first_samples::{FirstSamples, images_of_first_samples};
pub use image::render;
pub(crate) use normals::NodeGradients;
pub(crate) use profile::PROFILE;
pub use profile::Profile;
pub(crate) use ray_caster::kept;
pub use rounded_places::bounds_of_rounded_places;
pub(crate) use several::{CommonSteps, each_alone};
pub use stored_values::as_stored;
pub use work::RayWork;
