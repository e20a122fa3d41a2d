//! Conventions of other ray casters, and a ray caster that follows them.
//!
//! The conventions themselves, a row for each, are part of the language of scenes
//! ([`Conventions`](crate::scene::Conventions)). The [`RayCaster`] renders under any of them; under
//! those of volref it gives the image of [`reference::ray_caster`](crate::reference::ray_caster), to
//! the bit. A [`Profile`] is a file with the conventions of a renderer, the [`CATALOGUE`] what a search
//! for the conventions behind an image tries.

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
mod ray_caster;
mod rounded_places;
mod shading;
mod steps;
mod stored_values;
mod volume_caster;
mod work;

pub(crate) use catalogue::ConventionSet;
pub use catalogue::{CATALOGUE, Convention, STEP, under};
pub(crate) use chance::scenes_by_chance;
pub use chance::{bounds, images_by_chance, mean_of_places};
pub use image::render;
pub(crate) use normals::NodeGradients;
pub(crate) use profile::PROFILE;
pub use profile::Profile;
pub use ray_caster::RayCaster;
pub(crate) use ray_caster::kept;
pub use work::RayWork;
