//! The pixel loop, and panels side by side.

use super::curve;
use super::kernel::{self, Parts};
use super::path_tracer::Fault;
use super::plan::{Kernel, Plan};
use super::radiative_kernel::{ByLineOfSight, ByPathTracing, with_parts};
use super::work::{Counters, Uncounted, Work};
use crate::film::Film;
use crate::math::Moments;
use crate::scene::{Classified, Model, Panel, Radiative, Scene};
use rayon::prelude::*;
use std::marker::PhantomData;
use thiserror::Error;

/// Told of every finished row of pixels, from any thread.
pub type Progress<'p> = &'p (dyn Fn() + Sync);

/// A finished image.
#[derive(Clone, Debug)]
pub struct Rendering {
    /// The panels, side by side.
    pub film: Film,
    /// Work done, panel by panel, where it was counted.
    pub work: Vec<Counters>,
}

/// A renderer that broke its own promise.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RenderError {
    /// A path without an end.
    #[error(
        "a path of pixel ({column}, {row}) was turned 2^26 times and still carried light: \
         nothing in the scene takes enough of it away. Let a medium or surface absorb some, \
         leave a way out, or set max_bounces"
    )]
    Endless {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// A bound on the density of a medium that is none.
    #[error(
        "the density of a medium was above its bound {violations} times, first in pixel \
         ({column}, {row}): the image would be wrong in a way that nobody sees. This is a fault of \
         volref; please report it with the scene"
    )]
    Majorant {
        /// How often, in all pixels, each of which ends with its first such path.
        violations: u64,
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// A light that a ray runs into, where radiance has no bound.
    #[error(
        "pixel ({column}, {row}) is infinitely bright: a light without extent lies on its line \
         of sight, in matter that scatters, or nearer to what it lights than numbers can tell. \
         Move the light or the camera a little, or make it a small emitting sphere"
    )]
    Divergent {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// Radiance, or the square of its noise, beyond the numbers of an image.
    #[error(
        "pixel ({column}, {row}) is brighter than an image of 32-bit numbers can hold: its \
         radiance, or the square of its noise, is above 3.4e38. Choose another unit of radiance: \
         divide every radiance, irradiance, intensity and emission by the same number"
    )]
    TooBright {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
    },
    /// A pixel that is no radiance.
    #[error(
        "pixel ({column}, {row}) is {value:?}: radiance must be finite and not negative. \
         This is a fault of volref; please report it with the scene"
    )]
    NoRadiance {
        /// Column, from the left.
        column: usize,
        /// Row, from the top.
        row: usize,
        /// Red, green, blue, opacity.
        value: [f32; 4],
    },
}

/// Renders `scene` by the `plans` of its panels. The bits of the result depend on nothing else:
/// not on the number of threads, not on the build.
pub fn render(
    scene: &Scene,
    plans: &[Plan],
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    render_with::<Uncounted>(scene, plans, progress)
        .map(|(film, _)| Rendering { film, work: vec![] })
}

/// [`render`], counting work. Same bits.
pub fn render_counted(
    scene: &Scene,
    plans: &[Plan],
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    render_with::<Counters>(scene, plans, progress).map(|(film, work)| Rendering { film, work })
}

fn render_with<W: Work>(
    scene: &Scene,
    plans: &[Plan],
    progress: Progress<'_>,
) -> Result<(Film, Vec<W>), RenderError> {
    assert_eq!(scene.panels.len(), plans.len(), "a plan for each panel");
    let mut films = Vec::new();
    let mut works = Vec::new();
    for (panel, plan) in scene.panels.iter().zip(plans) {
        let (film, work) = render_panel(panel, plan, progress)?;
        films.push(film);
        works.push(work);
    }
    let film = Film::side_by_side(&films);
    match film.first_without_radiance() {
        None => Ok((film, works)),
        // Finite, or it had been refused before, but not as a number of 32 bits.
        Some(([column, row], value)) if value.contains(&f32::INFINITY) => {
            Err(RenderError::TooBright { column, row })
        }
        Some(([column, row], value)) => Err(RenderError::NoRadiance { column, row, value }),
    }
}

/// Whether a light stands anywhere in the scene whose radiance may have no bound.
fn has_points(scene: &Radiative) -> bool {
    scene.lights.iter().any(|light| light.position().is_some())
}

fn render_panel<W: Work>(
    panel: &Panel,
    plan: &Plan,
    progress: Progress<'_>,
) -> Result<(Film, W), RenderError> {
    let (width, height) = (panel.width, panel.height);
    let pixels = Pixels {
        width,
        height,
        progress,
    };
    let (pixels, work) = match (&panel.model, plan.kernel) {
        (Model::Curve(plot), Kernel::Curve) => {
            (curve::draw(plot, panel.width, panel.height), W::default())
        }
        (Model::Classified(scene), Kernel::Background) => background(scene, &pixels),
        (
            Model::Classified(scene),
            Kernel::RayCaster {
                field,
                compositing,
                shading,
                shadow,
                skip_empty,
            },
        ) => {
            let parts = Parts {
                field,
                compositing,
                shading,
                shadow,
                skip_empty,
            };
            kernel::cast(scene, parts, &pixels)
        }
        (Model::Radiative(scene), Kernel::LineOfSight { parts, turned }) => {
            let task = ByLineOfSight {
                scene,
                parts,
                turned,
                pixels: &pixels,
                work: PhantomData,
            };
            let (pixels, work) = with_parts(parts, task);
            refuse_faults(scene, width, &pixels)?;
            let pixels = pixels.into_iter().flatten().collect();
            return Ok((Film::new(width, height, pixels), work));
        }
        (Model::Radiative(scene), Kernel::PathTracer { parts, limit }) => {
            let task = ByPathTracing {
                scene,
                parts,
                limit,
                pixels: &pixels,
                work: PhantomData,
            };
            let (pixels, work) = with_parts(parts, task);
            refuse_faults(scene, width, &pixels)?;
            let film = mean_of_samples([width, height], scene.samples, pixels);
            return Ok((film, work));
        }
        _ => unreachable!("the plan was made for another scene"),
    };
    Ok((Film::with_opacity(width, height, pixels), work))
}

/// Refuses an image, `width` pixels wide, of which any pixel came to nothing, for the first of
/// them.
fn refuse_faults<P>(
    scene: &Radiative,
    width: usize,
    pixels: &[Result<P, Fault>],
) -> Result<(), RenderError> {
    let faults = || {
        let faults = pixels.iter().enumerate();
        faults.filter_map(|(index, pixel)| Some((index, *pixel.as_ref().err()?)))
    };
    let Some((index, fault)) = faults().next() else {
        return Ok(());
    };
    let (column, row) = (index % width, index / width);
    Err(match fault {
        Fault::Endless => RenderError::Endless { column, row },
        Fault::Infinite if has_points(scene) => RenderError::Divergent { column, row },
        Fault::Infinite => RenderError::TooBright { column, row },
        Fault::Majorant(_) => RenderError::Majorant {
            violations: faults()
                .map(|(_, fault)| fault)
                // Of the pixels behind one without an end, chance decides which are traced.
                .take_while(|fault| *fault != Fault::Endless)
                .map(|fault| match fault {
                    Fault::Majorant(violations) => violations,
                    Fault::Infinite | Fault::Endless => 0,
                })
                .sum(),
            column,
            row,
        },
    })
}

/// The film of the means, and of how sure they are.
fn mean_of_samples(
    [width, height]: [usize; 2],
    samples: u32,
    pixels: Vec<Result<[Moments; 3], Fault>>,
) -> Film {
    let moments: Vec<_> = pixels.into_iter().flatten().collect();
    let mean = |pixel: &[Moments; 3]| pixel.map(|channel| channel.mean() as f32);
    let variance = |pixel: &[Moments; 3]| {
        pixel.map(|channel| {
            channel
                .variance_of_mean()
                .map_or(0.0, |variance| variance as f32)
        })
    };
    let means = moments.iter().map(mean).collect();
    if samples < 2 {
        return Film::new(width, height, means);
    }
    let variances = moments.iter().map(variance).collect();
    Film::with_noise(width, height, means, variances, samples)
}

fn background<W: Work>(scene: &Classified, pixels: &Pixels<'_>) -> (Vec<[f32; 4]>, W) {
    let [r, g, b] = scene.background.as_vec3().to_array();
    (
        vec![[r, g, b, 0.0]; pixels.width * pixels.height],
        W::default(),
    )
}

/// The pixels of one panel.
pub(super) struct Pixels<'p> {
    pub width: usize,
    pub height: usize,
    pub progress: Progress<'p>,
}

/// Evaluates `pixel` for every pixel [column, row], rows in parallel. Pixels depend on nothing
/// but their place, and are put together in order, so threads leave no trace; `scratch` makes
/// memory that the pixels of a row may use one after the other.
///
/// This is compiled for every kernel, so it is the loop along a row and no more.
pub(super) fn rows<P: Send, S, W: Work>(
    pixels: &Pixels<'_>,
    scratch: impl Fn() -> S + Sync,
    pixel: impl Fn([usize; 2], &mut S, &mut W) -> P + Sync,
) -> (Vec<P>, W) {
    in_parallel(pixels, &|row| {
        let mut work = W::default();
        let mut scratch = scratch();
        let mut values = Vec::with_capacity(pixels.width);
        for column in 0..pixels.width {
            values.push(pixel([column, row], &mut scratch, &mut work));
        }
        (values, work)
    })
}

/// Evaluates all rows in parallel and puts them together. What runs in parallel is a good part of
/// a kernel's code and the same for all: behind `dyn`, at one call a row, it is compiled once for
/// each kind of pixel.
fn in_parallel<P: Send, W: Work>(
    pixels: &Pixels<'_>,
    evaluate: &(dyn Fn(usize) -> (Vec<P>, W) + Sync),
) -> (Vec<P>, W) {
    let rows: Vec<(Vec<P>, W)> = (0..pixels.height)
        .into_par_iter()
        // Row by row: rows through the volume cost far more than rows beside it, and a thread
        // cannot help with a batch that another has begun.
        .with_max_len(1)
        .map(|row| {
            let row = evaluate(row);
            (pixels.progress)();
            row
        })
        .collect();
    let mut all = Vec::with_capacity(pixels.width * pixels.height);
    let mut total = W::default();
    for (values, work) in rows {
        all.extend(values);
        total.add(&work);
    }
    (all, total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Camera;
    use crate::optics::{Light, Point};
    use crate::scene::Scattering;
    use glam::DVec3;

    fn scene(lights: Vec<Light>) -> Radiative {
        Radiative {
            scattering: Scattering::Single,
            objects: vec![],
            area_lights: vec![],
            media: vec![],
            lights,
            environment: DVec3::ZERO,
            camera: Camera::new(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0).unwrap(),
            samples: 2,
            seed: 0,
        }
    }

    #[test]
    fn violated_bounds_are_counted_over_all_pixels_and_refused() {
        let mut pixels = vec![Ok(()); 8];
        pixels[4] = Err(Fault::Majorant(2));
        pixels[5] = Err(Fault::Majorant(40));
        let expected = Err(RenderError::Majorant {
            violations: 42,
            column: 1,
            row: 1,
        });
        assert_eq!(refuse_faults(&scene(vec![]), 3, &pixels), expected);
        // Whether what comes after a path without an end is traced is left to chance.
        pixels[6] = Err(Fault::Endless);
        pixels[7] = Err(Fault::Majorant(1));
        assert_eq!(refuse_faults(&scene(vec![]), 3, &pixels), expected);
    }

    #[test]
    fn only_a_light_without_extent_is_blamed_for_light_without_bound() {
        let pixels = [Ok(()), Err(Fault::Infinite)];
        let (column, row) = (1, 0);
        assert_eq!(
            refuse_faults(&scene(vec![]), 2, &pixels),
            Err(RenderError::TooBright { column, row })
        );
        let lamp = Light::Point(Point {
            position: DVec3::ZERO,
            intensity: DVec3::ONE,
        });
        assert_eq!(
            refuse_faults(&scene(vec![lamp]), 2, &pixels),
            Err(RenderError::Divergent { column, row })
        );
    }
}
