//! Limits of pbrt: what it lacks and Mitsuba has, losses to floats of 32 bits, and values that it clamps.

use super::export_scene::ExportScene;
use super::forms::Form;
use super::nested_media::{NestedMedium, PlacedGrid, key_of};
use super::refusal::Faults;
use crate::optics::{Light, Phase};
use crate::scene::Radiative;
use crate::volume::Interpolation;
use std::ops::Range;

/// The smallest extent of a shape, times the largest coordinate of it or of the eye.
///
/// Coordinates are rounded to 2⁻²⁴ of themselves when they are read (`parser.cpp`, `parseFloat`)
/// and once more when the scene is moved to the eye (`cameras.cpp`, `CameraTransform`). Both faces
/// of a body together are off by 2⁻²² of the coordinates: 1/64 of the smallest extent.
const SMALLEST: f64 = 1.0 / (1 << 16) as f64;

/// The lengths with which pbrt can calculate. Normals are cross products of edges or derivatives,
/// divided by their lengths (`shapes.h`, `Triangle::InteractionFromIntersection`;
/// `interaction.h`, `SurfaceInteraction`), so that fourth powers of lengths are to be normal numbers
/// of 32 bits, from 2⁻¹²⁶ to 2¹²⁸: of a triangle |a × b|² ≥ 2⁻¹²⁶ and, of a ball, (2π² r²)² < 2¹²⁸, which is
/// r < 2²⁹·⁸. Beyond, normals are 0 or no numbers; before, a triangle counts as degenerate.
pub(super) const LENGTHS: Range<f64> = 1.0 / (1 << 30) as f64..(1 << 29) as f64;

/// The largest |g|: beyond, pbrt takes this one (`util/scattering.h`, `HenyeyGreenstein`;
/// `util/sampling.cpp`, `SampleHenyeyGreenstein`).
const SHARPEST: f64 = 0.99;

/// The most mean free paths across a body.
///
/// A path is continued from a place rounded to 2⁻²⁴ of the coordinates (`media.h`, `SampleT_maj`):
/// in bodies as large as their coordinates, up to 6e-4 of a free path at each bounce.
const THICKEST: f64 = 1e4;

/// Names what of a scene pbrt lacks, or its numbers cannot hold.
pub(super) fn check(scene: &Radiative, export: &ExportScene, faults: &mut Faults) {
    for (index, light) in scene.lights.iter().enumerate() {
        let Light::Spot(spot) = light else { continue };
        if spot.inner() < spot.outer() {
            let what = "a spotlight whose edge falls off linearly in the angle; pbrt's falls off \
                        in another way: make inner_angle the outer_angle";
            faults.add(format!("radiative.light[{index}]"), what);
        }
    }
    let eye = export.view.eye.abs().max_element();
    for surface in &export.surfaces {
        check_extent(&surface.key, &surface.form, eye, faults);
    }
    for (at, nested) in export.nested_media.list.iter().enumerate() {
        let key = key_of(nested.index);
        if nested.interface.is_none() {
            check_extent(&key, &nested.form, eye, faults);
        }
        let phase = nested.medium.phase;
        let g = phase.mean_cosine();
        if nested.scatters() && !matches!(phase, Phase::HenyeyGreenstein(_)) {
            let what =
                format!("the phase function {phase}: pbrt has that of Henyey and Greenstein");
            faults.add(&key, what);
        } else if nested.scatters() && g.abs() > SHARPEST {
            let what = format!("g = {g}: pbrt takes any beyond {SHARPEST} as {SHARPEST}");
            faults.add(&key, what);
        }
        let is_nearest = |grid: &PlacedGrid| grid.density.interpolation() == Interpolation::Nearest;
        if nested.grid.as_ref().is_some_and(is_nearest) {
            faults.add(&key, "a grid with the value of the nearest node");
        }
        if nested.grid.is_none() && export.nested_media.mixture(at).parts.len() > 1 {
            let what = "a medium within another of a different g: one phase function is at a place";
            faults.add(&key, what);
        }
        let paths = free_paths(nested);
        if paths > THICKEST {
            let what = format!(
                "{paths:.1e} mean free paths across it, where pbrt's 32-bit numbers tell places \
                 apart for {THICKEST:e}; lower sigma_a and sigma_s, or make it smaller"
            );
            faults.add(key, what);
        }
    }
}

fn check_extent(key: &str, form: &Form, eye: f64, faults: &mut Faults) {
    let (across, reach) = (form.across(), form.reach().max(eye));
    if across < SMALLEST * reach || !LENGTHS.contains(&across) {
        let what = format!(
            "an extent of {across:.3e} at coordinates up to {reach:.3e}, which pbrt's 32-bit numbers do not hold; move the \
             scene to the origin, or choose another unit of length"
        );
        faults.add(key, what);
    }
}

/// Mean free paths across a medium at most, as though it were everywhere as dense as where it is
/// densest.
fn free_paths(nested: &NestedMedium) -> f64 {
    let densest = nested.grid.as_ref().map_or(1.0, |grid| {
        let values = grid.density.grid().values().iter();
        f64::from(values.copied().fold(0.0, f32::max))
    });
    let sigma_t = nested.medium.coefficients.sigma_t().max_element();
    sigma_t * densest * nested.form.across()
}
