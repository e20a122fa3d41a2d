//! The pixel loop, and panels side by side.

use super::curve;
use super::kernel::{self, Parts};
use super::plan::{Kernel, Plan};
use super::work::{Counters, Uncounted, Work};
use crate::film::Film;
use crate::scene::{Classified, Model, Panel, Scene};
use rayon::prelude::*;
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
        let (pixels, work) = render_panel(panel, plan, progress);
        films.push(Film::with_opacity(panel.width, panel.height, pixels));
        works.push(work);
    }
    let film = Film::side_by_side(&films);
    match film.first_without_radiance() {
        None => Ok((film, works)),
        Some(([column, row], value)) => Err(RenderError::NoRadiance { column, row, value }),
    }
}

fn render_panel<W: Work>(panel: &Panel, plan: &Plan, progress: Progress<'_>) -> (Vec<[f32; 4]>, W) {
    let pixels = Pixels {
        width: panel.width,
        height: panel.height,
        progress,
    };
    match (&panel.model, plan.kernel) {
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
        _ => unreachable!("the plan was made for another scene"),
    }
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
/// but their place, and are put together in order, so threads leave no trace.
pub(super) fn rows<W: Work>(
    pixels: &Pixels<'_>,
    pixel: impl Fn([usize; 2], &mut W) -> [f32; 4] + Sync,
) -> (Vec<[f32; 4]>, W) {
    let rows: Vec<(Vec<[f32; 4]>, W)> = (0..pixels.height)
        .into_par_iter()
        // Row by row: rows through the volume cost far more than rows beside it, and a thread
        // cannot help with a batch that another has begun.
        .with_max_len(1)
        .map(|row| {
            let mut work = W::default();
            let values = (0..pixels.width)
                .map(|column| pixel([column, row], &mut work))
                .collect();
            (pixels.progress)();
            (values, work)
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
