//! The two reference renderers, to be read first, from top to bottom.
//!
//! [`ray_caster`] renders classified volumes, in one file, with short ones beside it: for those that a map
//! places, for `several_volumes` among surfaces, for the modes that composite no samples ([`projection`] and
//! [`isosurface`]), and for [`depth`]; [`path_tracer`] surfaces, media and lights,
//! with three short files beside it: media along a ray, vertices, random numbers. They are
//! the most direct implementation, following the method line by line with no optimisations:
//! [`render`](crate::render) is the fast program, and is tested against them. Classified volumes
//! agree to the bit, sampled images within their noise (`tests/library/reference.rs`).

mod clips;
pub mod depth;
pub mod isosurface;
pub(crate) mod media;
pub mod path_tracer;
mod placement;
pub mod projection;
pub(crate) mod random;
pub mod ray_caster;
mod several_volumes;
pub(crate) mod vertex;

use crate::film::Film;
use crate::scene::{Conventions, Mode, Model, Sampling, Scene};
use thiserror::Error;

/// The reason why a scene has no reference image.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ReferenceError {
    /// A panel that simulates no light.
    #[error(
        "the scene plots a transfer function and simulates no light; render it without --reference"
    )]
    Plot,
    /// A panel beyond what the plain renderers do.
    #[error("the scene asks for {0}, which no plain renderer has; render it without --reference")]
    Unknown(&'static str),
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

/// The image of `scene`, its panels side by side. Classified volumes are seen through the centres of
/// pixels; of surfaces, media and lights a pixel is the mean over its area, or, where
/// `through_centres` says so of a panel, what is seen through its centre.
pub fn render(
    scene: &Scene,
    sampling: Sampling,
    through_centres: &[bool],
) -> Result<Film, ReferenceError> {
    let mut films = Vec::new();
    for (panel, &through_centres) in scene.panels.iter().zip(through_centres) {
        let size = [panel.width, panel.height];
        films.push(match &panel.model {
            Model::Classified(scene) if scene.continuous => {
                return Err(ReferenceError::Unknown(
                    "the integral itself, without samples",
                ));
            }
            Model::Classified(scene) if scene.conventions != Conventions::default() => {
                return Err(ReferenceError::Unknown("other conventions"));
            }
            Model::Classified(scene) if scene.has_objects() => several_volumes::render(scene, size),
            Model::Classified(scene) => match &scene.mode {
                Mode::Composited => ray_caster::render(scene, size),
                Mode::Projection(projection) => projection::render(scene, projection, size),
                Mode::Isosurfaces(surfaces) => isosurface::render(scene, surfaces, size),
            },
            Model::Radiative(scene) => {
                let film = path_tracer::render(scene, size, sampling, through_centres);
                film.map_err(|pixel| ReferenceError::Endless {
                    column: pixel % panel.width,
                    row: pixel / panel.width,
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
