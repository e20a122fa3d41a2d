//! The memory of an image.

use super::classified::empty_space;
use super::classified::several::gradients_computed;
use super::plan::{Kernel, Plan};
use super::radiative::media::tracked;
use super::radiative::path_tracer::PathFault;
use crate::math::Moments;
use crate::optics::Density;
use crate::scene::Sampling;
use serde::Serialize;

/// Memory of an image, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Footprint {
    /// The finished image: radiance, and opacity or variance.
    pub image: u64,
    /// Peak while it is rendered and written as EXR, including gradients and majorants. The scene
    /// and its volumes are not counted.
    pub most: u64,
}

/// Memory of data computed for an image and kept while it is rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Memory {
    /// Its contents.
    pub what: &'static str,
    /// Its size.
    pub bytes: usize,
}

/// The one that holds pixels.
const MOMENTS: &str = "moments of the samples";

/// Radiance, three `f32`; opacity is one more, and variance three.
const RADIANCE: usize = size_of::<[f32; 3]>();
const OPACITY: usize = size_of::<f32>();

/// The memory of the image of `plans`.
pub fn footprint(plans: &[Plan<'_>], sampling: Sampling) -> Footprint {
    let of_pixels = |plan: &Plan<'_>, bytes: usize| {
        let pixels = (plan.panel.width * plan.panel.height) as u64;
        pixels.saturating_mul(bytes as u64)
    };
    let of_film = |plan: &Plan<'_>| of_film(plan, sampling);
    let films = plans.iter().map(|plan| of_pixels(plan, of_film(plan)));
    let image: u64 = films.sum();
    let making = plans.iter().map(|plan| {
        let beside = plan.made_beside().into_iter();
        let beside: usize = beside.map(|memory| memory.bytes).sum();
        of_pixels(plan, while_rendered(plan, of_film(plan))).saturating_add(beside as u64)
    });
    // Each of the panels is held until the last is made.
    let rendering = image.saturating_add(making.max().unwrap_or(0));
    // Put side by side, as channels of `f32` with the number of samples among them, and as the
    // bytes of the file, which may be no smaller.
    let samples: u64 = plans
        .iter()
        .map(|plan| of_pixels(plan, size_of::<u32>()))
        .sum();
    let writing = image.saturating_mul(3).saturating_add(2 * samples);
    Footprint {
        image,
        most: rendering.max(writing),
    }
}

/// Bytes of a pixel of the finished panel.
fn of_film(plan: &Plan<'_>, sampling: Sampling) -> usize {
    match plan.kernel {
        Kernel::PathTracer { .. } if plan.samples(sampling) > 1 => 2 * RADIANCE,
        Kernel::PathTracer { .. } | Kernel::LineOfSight { .. } => RADIANCE,
        Kernel::Curve(_)
        | Kernel::Background(_)
        | Kernel::Integral(_)
        | Kernel::Field(_)
        | Kernel::Conventional(_)
        | Kernel::Several(_)
        | Kernel::RayCaster { .. } => RADIANCE + OPACITY,
    }
}

/// Peak bytes per pixel while the panel is rendered, beside the panels before it: all rows and the
/// image assembled from them, or that image and its film.
fn while_rendered(plan: &Plan<'_>, film: usize) -> usize {
    let (pixel, between) = match plan.kernel {
        Kernel::PathTracer { .. } => (
            size_of::<Result<[Moments; 3], PathFault>>(),
            size_of::<[Moments; 3]>(),
        ),
        // The plot is drawn in `f64`.
        Kernel::Curve(_) => (size_of::<[f64; 3]>(), size_of::<[f32; 4]>()),
        Kernel::LineOfSight { .. } => (size_of::<Result<[f32; 3], PathFault>>(), 0),
        Kernel::Integral(_) => (size_of::<([f32; 4], f64)>(), size_of::<[f32; 4]>()),
        Kernel::RayCaster { .. }
        | Kernel::Conventional(_)
        | Kernel::Field(_)
        | Kernel::Several(_)
        | Kernel::Background(_) => (size_of::<[f32; 4]>(), 0),
    };
    (2 * pixel).max(pixel + between + film)
}

impl Plan<'_> {
    /// Memory kept beside the pixels of the image: nothing that only an omitted effect needs.
    fn made_beside(&self) -> Vec<Memory> {
        let mut memory = self.memory();
        memory.retain(|memory| memory.what != MOMENTS);
        memory
    }

    /// Memory allocated for the image beside the scene and the image itself: nothing that only an omitted effect needs.
    pub fn memory(&self) -> Vec<Memory> {
        let mut memory = Vec::new();
        let mut add = |what, bytes| memory.push(Memory { what, bytes });
        match self.kernel {
            Kernel::RayCaster { scene, features } => {
                let lattice = scene.grid.lattice();
                if features.shading {
                    add(
                        "gradients of the nodes",
                        lattice.node_count() * size_of::<[f32; 3]>(),
                    );
                }
                if features.skip_empty {
                    add("distances to non-empty blocks", empty_space::bytes(lattice));
                }
            }
            Kernel::Several(scene) => {
                let nodes = gradients_computed(scene) as usize;
                if nodes > 0 {
                    add("gradients of the nodes", nodes * size_of::<[f32; 3]>());
                }
            }
            Kernel::Conventional(scene) => {
                let nodes = scene.grid.lattice().node_count();
                if scene.phong.is_some() && scene.conventions.gradient.is_stored() {
                    add("gradients of the nodes", nodes * size_of::<[f32; 3]>());
                }
                if scene.conventions.preclassified {
                    add(
                        "opacities and colours of the nodes",
                        nodes * size_of::<[f32; 4]>(),
                    );
                }
            }
            Kernel::Field(scene) => {
                if scene.phong.is_some() {
                    let nodes = scene.grid.lattice().node_count();
                    add("gradients of the nodes", nodes * size_of::<[f32; 3]>());
                }
            }
            Kernel::PathTracer { scene, .. } => {
                let bytes = tracked(&scene.media).map(Density::bytes_for_blocks).sum();
                if bytes > 0 {
                    add("majorants of densities", bytes);
                }
                let pixels = self.panel.width * self.panel.height;
                add(MOMENTS, pixels * size_of::<[Moments; 3]>());
            }
            Kernel::Curve(_)
            | Kernel::Background(_)
            | Kernel::Integral(_)
            | Kernel::LineOfSight { .. } => {}
        }
        memory
    }
}
