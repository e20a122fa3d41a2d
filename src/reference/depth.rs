//! Depth of a classified volume, as plainly as it can be written.
//!
//! A ray sees a volume over a range of distances. The sample `i` of the [ray caster](super::ray_caster), in the middle
//! of its step at the distance `tᵢ`, adds `aᵢ Tᵢ` to the opacity `α`. The mean depth weighs the distances by that; the
//! half depth is where opacity reaches one half, within a step of constant extinction:
//!
//! ```text
//! mean = Σᵢ tᵢ aᵢ Tᵢ / Σᵢ aᵢ Tᵢ
//! half = tᵢ + (x − ½) h,     Tᵢ (1 − aᵢ)ˣ = ½,     0 ≤ x ≤ 1
//! ```
//!
//! Along the view, a distance is multiplied by the cosine of the angle between the ray and the direction in which
//! the camera looks. A ray that meets no opacity has no depth, nor has one a half depth whose opacity stays below one
//! half: these are infinite.
//!
//! Source: Mildenhall et al. 2020, "NeRF: Representing scenes as neural radiance fields for view synthesis" (the weights
//! `aᵢ Tᵢ` as a distribution over distances: its mean and its median).

use super::placement;
use super::ray_caster::{midpoint, step_count};
use crate::film::Depth;
use crate::geometry::Ray;
use crate::math::ln;
use crate::scene::{Classified, Compositing};
use crate::volume::{Cell, NodeLine, Reconstruction as _};

/// Depth of each pixel, world units, row by row from the top.
pub fn render(scene: &Classified, [width, height]: [usize; 2], depth: Depth) -> Vec<f32> {
    let pixel = |index: usize| {
        let ray = scene
            .camera
            .ray([index % width, index / width], [width, height]);
        let cosine = ray.direction.dot(*scene.camera.forward());
        let scale = if depth.along_view { cosine } else { 1.0 };
        (scale * along(scene, &ray, depth.half)) as f32
    };
    (0..width * height).map(pixel).collect()
}

/// Depth along `ray`.
fn along(scene: &Classified, ray: &Ray, half: bool) -> f64 {
    let lattice = scene.grid.lattice();
    let inside = placement::in_volume(scene, ray);
    let Some(span) = lattice.bounds().span_of(&inside) else {
        return f64::INFINITY;
    };
    let line = NodeLine::new(inside, lattice);
    let count = step_count(span, scene.step);
    let (mut transmittance, mut weights, mut moments) = (1.0, 0.0, 0.0);
    for index in 0..count {
        let (t, length) = midpoint(span, scene.step, count, index);
        let density = (scene.interpolation).read(&*scene.grid, &Cell::around(lattice, line.at(t)));
        let opacity = scene.transfer_function.opacity(density, length);
        let after = transmittance * (1.0 - opacity);
        if half && after <= 0.5 {
            let part = ln(0.5 / transmittance) / ln(1.0 - opacity);
            return t + (part - 0.5) * length;
        }
        weights += transmittance * opacity;
        moments += t * transmittance * opacity;
        transmittance = after;
        if matches!(scene.compositing, Compositing::EarlyTermination(least) if after < least) {
            break;
        }
    }
    if half || weights == 0.0 {
        return f64::INFINITY;
    }
    moments / weights
}
