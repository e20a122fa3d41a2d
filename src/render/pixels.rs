//! The pixel loop, and panels side by side.

use super::classified::curve;
use super::classified::kernels::{self, Parts};
use super::counters::{Counters, Uncounted, Work};
use super::footprint::{Footprint, footprint};
use super::forecast::{Forecast, forecast};
use super::plan::{Kernel, Plan};
use super::radiative::kernels::{ByLineOfSight, ByPathTracing, with_parts};
use super::radiative::path_tracer::Fault;
use crate::film::Film;
use crate::math::Moments;
use crate::scene::{Classified, Model, Panel, Radiative, Scene};
use rayon::prelude::*;
use std::iter::StepBy;
use std::marker::PhantomData;
use std::ops::Range;
use std::time::Duration;
use thiserror::Error;

/// Told how far an image is, from any thread. A closure is told of every step.
pub trait Watch: Sync {
    /// An image begins that takes this many steps: one for each pixel, and one for every
    /// 1024 samples within it. Where it ends early, fewer are taken.
    fn begin(&self, _steps: u64) {}

    /// A step is done.
    fn step(&self);

    /// How long may be measured, at each panel, how long it will take; without, nothing is.
    fn may_measure(&self) -> Option<Duration> {
        None
    }

    /// How long a panel will take.
    fn measured(&self, _forecast: &Forecast) {}
}

impl<F: Fn() + Sync> Watch for F {
    fn step(&self) {
        self();
    }
}

/// Who watches an image being made.
pub type Progress<'p> = &'p dyn Watch;

/// Samples of a pixel that count as a step: a millisecond where a path takes a microsecond.
pub(super) const SAMPLES_A_STEP: u32 = 1024;

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
    /// An image that there is no memory for.
    #[error(
        "no memory for an image of {width} × {height} pixels: {:.2} GiB are held while it is \
         rendered and written; make film.width and film.height smaller",
        *bytes as f64 / f64::from(1 << 30)
    )]
    Memory {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Most that is held at a time.
        bytes: u64,
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
    /// Whoever asked for the image wants it no longer.
    #[error("the image was given up before it was finished")]
    Stopped,
}

/// Renders `scene` by the `plans` of its panels. The bits of the result depend on nothing else:
/// not on the number of threads, not on the build.
pub fn render(
    scene: &Scene,
    plans: &[Plan],
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    render_with::<Uncounted>(scene, plans, &Extent::whole(progress))
        .map(|(film, _)| Rendering { film, work: vec![] })
}

/// A coarse image of `scene`, made of fewer pixels or larger ones.
///
/// # Errors
///
/// Those of [`render`] for the pixels rendered, and [`RenderError::Stopped`] once `stopped` says
/// so: it is asked before every row, from any thread.
pub fn render_coarse(
    scene: &Scene,
    plans: &[Plan],
    detail: Detail,
    stopped: &(dyn Fn() -> bool + Sync),
) -> Result<Film, RenderError> {
    let extent = Extent {
        detail,
        stopped,
        progress: &|| (),
    };
    render_with::<Uncounted>(scene, plans, &extent).map(|(film, _)| film)
}

/// Which pixels of an image are rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// All.
    Whole,
    /// In each panel one column and row in this many, the first half as far from the edge as from
    /// the next. Each pixel has the bits that it has in the whole image.
    Lattice(usize),
    /// In each panel blocks of this many columns and rows, as one pixel each; what is left over at
    /// the right and the bottom is left out. Path tracing samples the whole block, so that the
    /// result is the mean of its pixels; whatever casts one ray casts it through the upper left
    /// pixel.
    Blocks(usize),
}

impl Detail {
    /// The columns, or rows, in `size` of them that are rendered, or that blocks begin with.
    pub fn places(self, size: usize) -> StepBy<Range<usize>> {
        let (first, end, step) = match self {
            Detail::Whole => (0, size, 1),
            Detail::Lattice(every) => ((every / 2).min(size.saturating_sub(1)), size, every),
            Detail::Blocks(edge) => (0, size - size % edge, edge),
        };
        (first..end).step_by(step)
    }

    /// Edge of what a pixel is a mean of, in pixels of the whole image.
    fn edge(self) -> f64 {
        match self {
            Detail::Whole | Detail::Lattice(_) => 1.0,
            Detail::Blocks(edge) => edge as f64,
        }
    }
}

/// How much of an image is rendered.
struct Extent<'e> {
    detail: Detail,
    /// Whether to end early; asked before every row.
    stopped: &'e (dyn Fn() -> bool + Sync),
    progress: Progress<'e>,
}

impl<'e> Extent<'e> {
    fn whole(progress: Progress<'e>) -> Extent<'e> {
        Extent {
            detail: Detail::Whole,
            stopped: &|| false,
            progress,
        }
    }
}

/// [`render`], counting work. Same bits.
pub fn render_counted(
    scene: &Scene,
    plans: &[Plan],
    progress: Progress<'_>,
) -> Result<Rendering, RenderError> {
    render_with::<Counters>(scene, plans, &Extent::whole(progress))
        .map(|(film, work)| Rendering { film, work })
}

fn render_with<W: Work>(
    scene: &Scene,
    plans: &[Plan],
    extent: &Extent<'_>,
) -> Result<(Film, Vec<W>), RenderError> {
    assert_eq!(scene.panels.len(), plans.len(), "a plan for each panel");
    let Footprint { most: bytes, .. } = footprint(scene, plans);
    if !has_memory(bytes) {
        let (width, height) = (scene.width(), scene.height());
        return Err(RenderError::Memory {
            width,
            height,
            bytes,
        });
    }
    let panels = scene.panels.iter().zip(plans);
    extent
        .progress
        .begin(panels.map(|(panel, plan)| steps(panel, plan)).sum());
    let mut films = Vec::new();
    let mut works = Vec::new();
    for (panel, plan) in scene.panels.iter().zip(plans) {
        let (film, work) = render_panel(panel, plan, extent)?;
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

/// Whether this many bytes can be had at once. They are given back untouched: it costs nothing, and
/// is found out before the work and not after it.
fn has_memory(bytes: u64) -> bool {
    let mut memory: Vec<u8> = Vec::new();
    usize::try_from(bytes).is_ok_and(|bytes| memory.try_reserve_exact(bytes).is_ok())
}

/// The steps that a watcher is told of.
fn steps(panel: &Panel, plan: &Plan) -> u64 {
    let pixels = (panel.width * panel.height) as u64;
    match (&panel.model, plan.kernel) {
        (_, Kernel::Background) => 0,
        (Model::Radiative(scene), Kernel::PathTracer { .. }) => steps_of(pixels, scene.samples),
        _ => steps_of(pixels, 1),
    }
}

/// The steps of `pixels` with `samples` each.
pub(super) fn steps_of(pixels: u64, samples: u32) -> u64 {
    pixels * u64::from(1 + samples / SAMPLES_A_STEP)
}

/// Whether a light stands anywhere in the scene whose radiance may have no bound.
fn has_points(scene: &Radiative) -> bool {
    scene.lights.iter().any(|light| light.position().is_some())
}

fn render_panel<W: Work>(
    panel: &Panel,
    plan: &Plan,
    extent: &Extent<'_>,
) -> Result<(Film, W), RenderError> {
    let samples = match (&panel.model, plan.kernel) {
        (Model::Radiative(scene), Kernel::PathTracer { .. }) => scene.samples,
        _ => 1,
    };
    let pixels = Pixels {
        width: panel.width,
        height: panel.height,
        samples,
        detail: extent.detail,
        stopped: extent.stopped,
        progress: extent.progress,
    };
    // Those of the film: the panel may have more.
    let [width, height] = [panel.width, panel.height].map(|size| extent.detail.places(size).len());
    let finished = |pixels: usize| match pixels == width * height {
        true => Ok(()),
        false => Err(RenderError::Stopped),
    };
    let (pixels, work) = match (&panel.model, plan.kernel) {
        (Model::Curve(plot), Kernel::Curve) => {
            let drawn = curve::draw(plot, &pixels);
            (pixels.those_rendered(&drawn), W::default())
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
            kernels::cast(scene, parts, &pixels)
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
            finished(pixels.len())?;
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
            finished(pixels.len())?;
            refuse_faults(scene, width, &pixels)?;
            let film = mean_of_samples([width, height], scene.samples, pixels);
            return Ok((film, work));
        }
        _ => unreachable!("the plan was made for another scene"),
    };
    finished(pixels.len())?;
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
    let count = pixels.columns().len() * pixels.rows().len();
    (vec![[r, g, b, 0.0]; count], W::default())
}

/// The pixels of one panel.
pub(super) struct Pixels<'p> {
    pub width: usize,
    pub height: usize,
    /// Samples of each; 1 where it is not sampled.
    pub samples: u32,
    pub detail: Detail,
    /// Whether the rows not yet begun are to be left out.
    pub stopped: &'p (dyn Fn() -> bool + Sync),
    pub progress: Progress<'p>,
}

impl Pixels<'_> {
    fn columns(&self) -> StepBy<Range<usize>> {
        self.detail.places(self.width)
    }

    fn rows(&self) -> StepBy<Range<usize>> {
        self.detail.places(self.height)
    }

    /// Edge of what a pixel is a mean of, in pixels of the whole image.
    pub fn edge(&self) -> f64 {
        self.detail.edge()
    }

    /// Of an image of all the pixels.
    fn those_rendered<P: Copy>(&self, image: &[P]) -> Vec<P> {
        self.rows()
            .flat_map(|row| {
                self.columns()
                    .map(move |column| image[row * self.width + column])
            })
            .collect()
    }
}

/// Pixels of a row that are evaluated one after the other.
struct Stretch {
    row: usize,
    columns: StepBy<Range<usize>>,
    /// Samples of a pixel, at most.
    most_samples: u32,
    /// Whether it is part of the image, or tells how long that will take.
    counts: bool,
}

/// Evaluates `pixel` for every pixel [column, row] that is rendered, of at most so many samples, rows in parallel.
/// Pixels depend on nothing but their place, and are put together in order, so threads leave no
/// trace; `scratch` makes memory that the pixels of a row may use one after the other.
///
/// This is compiled for every kernel, so it is the loop along a row and no more.
pub(super) fn rows<P: Send, S, W: Work>(
    pixels: &Pixels<'_>,
    scratch: impl Fn() -> S + Sync,
    pixel: impl Fn([usize; 2], u32, &mut S, &mut W) -> P + Sync,
) -> (Vec<P>, W) {
    in_parallel(pixels, &|stretch| {
        let mut work = W::default();
        let mut scratch = scratch();
        let mut values = Vec::with_capacity(stretch.columns.len());
        for column in stretch.columns {
            let place = [column, stretch.row];
            values.push(pixel(place, stretch.most_samples, &mut scratch, &mut work));
            if stretch.counts {
                pixels.progress.step();
            }
        }
        (values, work)
    })
}

/// Evaluates all rows in parallel and puts them together. What runs in parallel is a good part of
/// a kernel's code and the same for all: behind `dyn`, at one call a row, it is compiled once for
/// each kind of pixel.
fn in_parallel<P: Send, W: Work>(
    pixels: &Pixels<'_>,
    evaluate: &(dyn Fn(Stretch) -> (Vec<P>, W) + Sync),
) -> (Vec<P>, W) {
    if let Some(most) = pixels.progress.may_measure() {
        let probe = |[column, row]: [usize; 2]| {
            let of_one_sample = Stretch {
                row,
                columns: (column..column + 1).step_by(1),
                most_samples: 1,
                counts: false,
            };
            drop(evaluate(of_one_sample));
        };
        let size = [pixels.width, pixels.height];
        if let Some(forecast) = forecast(size, pixels.samples, most, &probe) {
            pixels.progress.measured(&forecast);
        }
    }
    let rows: Vec<usize> = pixels.rows().collect();
    let rows: Vec<(Vec<P>, W)> = rows
        .into_par_iter()
        // Row by row: rows through the volume cost far more than rows beside it, and a thread
        // cannot help with a batch that another has begun.
        .with_max_len(1)
        .map(|row| {
            if (pixels.stopped)() {
                return (Vec::new(), W::default());
            }
            evaluate(Stretch {
                row,
                columns: pixels.columns(),
                most_samples: pixels.samples,
                counts: true,
            })
        })
        .collect();
    let mut all = Vec::with_capacity(pixels.columns().len() * rows.len());
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
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicU64, Ordering};

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

    /// Counts what it is told, and lets itself be told how long it takes.
    #[derive(Default)]
    struct Told {
        begun: AtomicU64,
        steps: AtomicU64,
        forecasts: Mutex<Vec<Forecast>>,
    }

    impl Watch for Told {
        fn begin(&self, steps: u64) {
            self.begun.fetch_add(steps, Ordering::Relaxed);
        }

        fn step(&self) {
            self.steps.fetch_add(1, Ordering::Relaxed);
        }

        fn may_measure(&self) -> Option<Duration> {
            Some(Duration::from_secs(600))
        }

        fn measured(&self, forecast: &Forecast) {
            self.forecasts.lock().unwrap().push(*forecast);
        }
    }

    /// As many steps are told as were announced, within pixels of many samples too; and to measure
    /// beforehand how long it takes changes neither a bit of the image nor what is counted.
    #[test]
    fn steps_are_those_announced_and_measuring_leaves_no_trace() {
        let fog = |samples: u32, scattering: &str| {
            format!(
                "[film]\nwidth = 6\nheight = 5\n[sampling]\nsamples = {samples}\n\
                 [camera]\neye = [0, 0, -3]\ntarget = [0, 0, 0]\n\
                 [radiative]\nenvironment = 1\nscattering = '{scattering}'\n\
                 [[radiative.medium]]\nsphere = {{ centre = [0, 0, 0], radius = 1 }}\n\
                 sigma_s = 1\nsigma_a = 0.5\n"
            )
        };
        for (text, steps, samples) in [
            (fog(1023, "multiple"), 30, 1023),
            (fog(2048, "multiple"), 90, 2048),
            (fog(4, "none"), 30, 1),
        ] {
            let scene = Scene::parse(&text, std::path::Path::new("scene.toml")).unwrap();
            let plans = [Plan::new(&scene.panels[0])];
            let told = Told::default();
            let watched = render_counted(&scene, &plans, &told).unwrap();
            assert_eq!(told.begun.into_inner(), steps);
            assert_eq!(told.steps.into_inner(), steps);
            let forecasts = told.forecasts.into_inner().unwrap();
            assert_eq!(forecasts.len(), 1);
            assert_eq!((forecasts[0].pixels, forecasts[0].samples), (30, samples));
            assert_eq!(forecasts[0].steps(), steps);
            assert!(forecasts[0].seconds > 0.0);
            let alone = render_counted(&scene, &plans, &|| ()).unwrap();
            assert_eq!(watched.film.pixel_hash(), alone.film.pixel_hash());
            assert_eq!(watched.work, alone.work);
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
