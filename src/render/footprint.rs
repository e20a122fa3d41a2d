//! The memory that an image takes.

use super::plan::{Kernel, Plan};
use super::radiative::path_tracer::Fault;
use crate::math::Moments;
use crate::scene::{Model, Panel, Scene};

/// Bytes that an image takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Footprint {
    /// The finished image: radiance, and opacity or variance.
    pub image: u64,
    /// Most that is held at a time while it is rendered and written as EXR, what is made for it
    /// (gradients, bounds) with it. The scene and its volumes come to this.
    pub most: u64,
}

/// Radiance, three `f32`; opacity is one more, and variance three.
const RADIANCE: usize = size_of::<[f32; 3]>();
const OPACITY: usize = size_of::<f32>();

/// The memory that the image of `scene` takes by the `plans` of its panels.
pub fn footprint(scene: &Scene, plans: &[Plan]) -> Footprint {
    let panels = || scene.panels.iter().zip(plans);
    let of_pixels = |panel: &Panel, bytes: usize| {
        let pixels = (panel.width * panel.height) as u64;
        pixels.saturating_mul(bytes as u64)
    };
    let films = panels().map(|(panel, plan)| of_pixels(panel, of_film(panel, plan)));
    let image: u64 = films.sum();
    let making = panels().map(|(panel, plan)| {
        let beside = plan.made_beside(panel);
        let beside: usize = beside.iter().map(|memory| memory.bytes).sum();
        of_pixels(panel, while_rendered(panel, plan)).saturating_add(beside as u64)
    });
    // Each of the panels is held until the last is made.
    let rendering = image.saturating_add(making.max().unwrap_or(0));
    // Put side by side, as channels of `f32` with the number of samples among them, and as the
    // bytes of the file, which may be no smaller.
    let samples: u64 = panels()
        .map(|(panel, _)| of_pixels(panel, size_of::<u32>()))
        .sum();
    let writing = image.saturating_mul(3).saturating_add(2 * samples);
    Footprint {
        image,
        most: rendering.max(writing),
    }
}

/// Bytes of a pixel of the finished panel.
fn of_film(panel: &Panel, plan: &Plan) -> usize {
    match (&panel.model, plan.kernel) {
        (Model::Radiative(scene), Kernel::PathTracer { .. }) if scene.samples > 1 => 2 * RADIANCE,
        (Model::Radiative(_), _) => RADIANCE,
        _ => RADIANCE + OPACITY,
    }
}

/// Bytes of a pixel that are held at most while the panel is rendered, beside those before it:
/// all rows and what they are put together to, or that and what becomes of it.
fn while_rendered(panel: &Panel, plan: &Plan) -> usize {
    let (pixel, between) = match plan.kernel {
        Kernel::PathTracer { .. } => (
            size_of::<Result<[Moments; 3], Fault>>(),
            size_of::<[Moments; 3]>(),
        ),
        // The plot is drawn in `f64`.
        Kernel::Curve => (size_of::<[f64; 3]>(), size_of::<[f32; 4]>()),
        Kernel::LineOfSight { .. } => (size_of::<Result<[f32; 3], Fault>>(), 0),
        _ => (size_of::<[f32; 4]>(), 0),
    };
    (2 * pixel).max(pixel + between + of_film(panel, plan))
}
