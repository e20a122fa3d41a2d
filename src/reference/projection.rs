//! Projections of a classified volume: one number for each ray, shown as a colour.
//!
//! With `f` the field on the ray, `t` the distance in the world, and the span from `a`, where the ray enters
//! the volume (or where the eye is), to `b`, where it leaves it:
//!
//! ```text
//! maximum               max f(t)
//! minimum               min f(t)
//! mean                  1/(b − a) ∫ f(t) dt
//! sum                   ∫ f(t) dt
//! attenuated maximum    max v(t) exp(−μ ∫ₐᵗ v(s) ds),     v = clamp((f − low) / (high − low), 0, 1)
//! ```
//!
//! Here the ray is sampled as by the ray caster, in the middle of steps `hᵢ`:
//!
//! ```text
//! max fᵢ     min fᵢ     Σ fᵢ hᵢ / Σ hᵢ     Σ fᵢ hᵢ     max vᵢ exp(−μ Σ vⱼ hⱼ over j < i)
//! ```
//!
//! The number is shown by the colours of the transfer function, or as a grey by its position in the window; the
//! attenuated maximum is such a position. A ray that misses the volume shows the background; the volume is opaque.
//! Clips (`clips.rs`) cut the span, so that two planes leave a slab: `a` and `b` lie where the ray enters and leaves
//! what they keep.
//!
//! Without samples (`compositing = "continuous"`) extrema are those over the whole span, its ends included,
//! and integrals are exact: `render::classified::modes`. There, too, tests divide the span by brute force.
//!
//! Sources: Wallis et al. 1989, "Three-dimensional display in nuclear medicine" (maximum); Max 1995, "Optical
//! models for direct volume rendering" (sum); `attenuated_mip` of vispy and napari, with lengths of the world.

use super::clips::kept;
use super::placement;
use super::ray_caster::{midpoint, step_count};
use crate::film::Film;
use crate::geometry::Ray;
use crate::math::exp;
use crate::scene::{Classified, Projected, Projection};
use crate::volume::{Cell, NodeLine};
use rayon::prelude::*;

/// The image of `scene` by `projection`; one ray through the centre of each pixel.
pub fn render(scene: &Classified, projection: &Projection, [width, height]: [usize; 2]) -> Film {
    let pixel = |index: usize| {
        let ray = scene
            .camera
            .ray([index % width, index / width], [width, height]);
        let (colour, opacity) = match number(projection, &samples(scene, &ray)) {
            Some(number) => (projection.colour(number, &scene.transfer_function), 1.0),
            None => (scene.background, 0.0),
        };
        [colour.x, colour.y, colour.z, opacity].map(|value| value as f32)
    };
    let pixels = (0..width * height).into_par_iter().map(pixel);
    Film::with_opacity(width, height, pixels.collect())
}

/// The number of a ray with these samples; none where it misses the volume.
fn number(projection: &Projection, samples: &[Sample]) -> Option<f64> {
    if samples.is_empty() {
        return None;
    }
    let values = samples.iter().map(|sample| sample.value);
    let integral = || {
        samples
            .iter()
            .map(|sample| sample.value * sample.length)
            .sum::<f64>()
    };
    Some(match projection.of {
        Projected::Maximum => values.fold(f64::NEG_INFINITY, f64::max),
        Projected::Minimum => values.fold(f64::INFINITY, f64::min),
        Projected::Mean => integral() / samples.iter().map(|sample| sample.length).sum::<f64>(),
        Projected::Sum => integral(),
        Projected::AttenuatedMaximum(attenuation) => {
            let (mut most, mut depth) = (0.0_f64, 0.0);
            for sample in samples {
                let position = projection.unit().position(sample.value);
                most = most.max(position * exp(-attenuation * depth));
                depth += position * sample.length;
            }
            most
        }
    })
}

/// A sample of the field.
pub(super) struct Sample {
    /// Distance from the eye.
    pub t: f64,
    /// Length of its step.
    pub length: f64,
    /// Value of the field.
    pub value: f64,
}

/// The samples of `ray`, from the eye on; none where it misses the volume.
pub(super) fn samples(scene: &Classified, ray: &Ray) -> Vec<Sample> {
    let lattice = scene.grid.lattice();
    let inside = placement::in_volume(scene, ray);
    let span = lattice.bounds().span_of(&inside);
    let Some(span) = span.and_then(|span| kept(scene, 0, ray, span)) else {
        return vec![];
    };
    let line = NodeLine::new(inside, lattice);
    let count = step_count(span, scene.step);
    let sample = |index: usize| {
        let (t, length) = midpoint(span, scene.step, count, index);
        let cell = Cell::around(lattice, line.at(t));
        let value = scene.interpolation.read(&*scene.grid, &cell);
        Sample { t, length, value }
    };
    (0..count).map(sample).collect()
}
