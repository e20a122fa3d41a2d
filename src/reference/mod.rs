//! The two reference renderers, to be read first: from top to bottom, one file each.
//!
//! [`ray_caster`] renders classified volumes, [`path_tracer`] surfaces, media and lights. They are
//! the most direct implementation, following the method line by line with no optimisations:
//! [`render`](crate::render) is the fast program, and is tested against them. Classified volumes
//! agree to the bit, sampled images within their noise (`tests/library/reference.rs`).

mod media;
pub mod path_tracer;
mod random;
pub mod ray_caster;
mod vertex;

use crate::film::Film;
use crate::render::{Sampling, plans};
use crate::scene::{Model, Scene};
use random::Exhausted;
use thiserror::Error;

/// The reason why a scene has no reference image.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ReferenceError {
    /// A panel that simulates no light.
    #[error(
        "the scene plots a transfer function and simulates no light; render it without --reference"
    )]
    Plot,
    /// A path that does not end.
    #[error(
        "a path of pixel ({column}, {row}) drew 2^26 random numbers without ending: the plain path \
         tracer cannot render this scene; render it without --reference"
    )]
    Endless {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// A pixel without a radiance.
    #[error("pixel ({column}, {row}) is {value:?}: radiance must be finite and not negative")]
    NoRadiance {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
        /// Red, green, blue, opacity.
        value: [f32; 4],
    },
}

/// The image of `scene`, its panels side by side. Pixels are sampled as in the fast renderers: the
/// radiance through the centre where they need no random numbers, else the mean over the pixel.
pub fn render(scene: &Scene, sampling: Sampling) -> Result<Film, ReferenceError> {
    let mut films = Vec::new();
    for (panel, plan) in scene.panels.iter().zip(plans(scene)) {
        let size = [panel.width, panel.height];
        films.push(match &panel.model {
            Model::Classified(scene) => ray_caster::render(scene, size),
            Model::Radiative(scene) => {
                let film = path_tracer::render(scene, size, sampling, !plan.is_sampled());
                film.map_err(|Exhausted { pixel }| ReferenceError::Endless {
                    column: pixel as usize % panel.width,
                    row: pixel as usize / panel.width,
                })?
            }
            Model::Curve(_) => return Err(ReferenceError::Plot),
        });
    }
    let film = Film::side_by_side(&films);
    match film.first_without_radiance() {
        None => Ok(film),
        Some(([column, row], value)) => Err(ReferenceError::NoRadiance { column, row, value }),
    }
}
