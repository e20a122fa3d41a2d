//! The memory of an image.

use super::plan::{Kernel, Plan};
use super::radiative::path_tracer::PathFault;
use crate::math::Moments;
use crate::scene::Sampling;

/// Memory of an image, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Footprint {
    /// The finished image: radiance, and opacity or variance.
    pub image: u64,
    /// No more than this is held at once for its pixels, while it is rendered and written as EXR. The scene, its volumes
    /// and what is made of them are not counted.
    pub most: u64,
}

/// The memory of the image of `plans`.
pub fn footprint(plans: &[Plan<'_>], sampling: Sampling) -> Footprint {
    let sum = |bytes_of: &dyn Fn(&Plan<'_>) -> usize| {
        let bytes = plans.iter().map(|plan| {
            let pixels = (plan.panel.width * plan.panel.height) as u64;
            pixels.saturating_mul(bytes_of(plan) as u64)
        });
        bytes.fold(0, u64::saturating_add)
    };
    // All rows, and the image that they are put together to.
    let rendering = sum(&|plan| match plan.kernel {
        Kernel::PathTracer { .. } => 2 * size_of::<Result<[Moments; 3], PathFault>>(),
        _ => 2 * size_of::<([f32; 4], f64)>(),
    });
    let image = sum(&|plan| match plan.kernel {
        Kernel::PathTracer { .. } if plan.samples(sampling) > 1 => size_of::<[f32; 6]>(),
        Kernel::PathTracer { .. } | Kernel::LineOfSight { .. } => size_of::<[f32; 3]>(),
        _ => size_of::<[f32; 4]>(),
    });
    // Panels side by side, the channels of the file with the numbers of samples, and its bytes, which may be no fewer.
    let writing = image
        .saturating_mul(3)
        .saturating_add(2 * sum(&|_| size_of::<u32>()));
    Footprint {
        image,
        most: image.saturating_add(rendering).max(writing),
    }
}
