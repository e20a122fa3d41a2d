//! Limits of pbrt: losses to floats of 32 bits, and values that it clamps.

use super::export_scene::ExportScene;
use super::forms::Form;
use super::nested_media::{NestedMedium, key_of};
use super::refusal::Faults;
use std::ops::RangeInclusive;

/// The rounding of a number of 32 bits, relative to it.
const ROUNDING: f64 = 1.0 / (1 << 24) as f64;

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
const LENGTHS: RangeInclusive<f64> = 1.0 / (1 << 30) as f64..=(1 << 29) as f64;

/// The largest |g|: beyond, pbrt takes this one (`util/scattering.h`, `HenyeyGreenstein`;
/// `util/sampling.cpp`, `SampleHenyeyGreenstein`).
const SHARPEST: f64 = 0.99;

/// The most mean free paths across a body.
///
/// A path is continued from a place rounded to 2⁻²⁴ of the coordinates (`media.h`, `SampleT_maj`):
/// in bodies as large as their coordinates, up to 6e-4 of a free path at each bounce.
const THICKEST: f64 = 1e4;

/// Names what of a scene pbrt's numbers cannot hold.
pub(super) fn check(export: &ExportScene, faults: &mut Faults) {
    let eye = export.view.eye.abs().max_element();
    let mut extent = |key: &str, form: &Form| {
        let (extent, reach) = (form.extent(), form.reach().max(eye));
        if extent < SMALLEST * reach {
            let what = format!(
                "an extent of {extent:.3e} at coordinates up to {reach:.3e}, of which pbrt's \
                 32-bit numbers leave {:.0e} uncertain; move the scene to the origin",
                reach * ROUNDING
            );
            faults.add(key, what);
        } else if !(LENGTHS.contains(&extent) && reach <= *LENGTHS.end()) {
            let what = format!(
                "an extent of {extent:.3e} at coordinates up to {reach:.3e}: pbrt's 32-bit normals take \
                 lengths from {:.0e} to {:.0e}; choose another unit of length",
                LENGTHS.start(),
                LENGTHS.end()
            );
            faults.add(key, what);
        }
    };
    for surface in &export.surfaces {
        extent(&surface.key, &surface.form);
    }
    let list = &export.nested_media.list;
    for nested in list.iter().filter(|nested| nested.interface.is_none()) {
        extent(&key_of(nested.index), &nested.form);
    }
    for nested in list {
        let key = key_of(nested.index);
        let g = nested.medium.phase.mean_cosine();
        if nested.scatters() && g.abs() > SHARPEST {
            let what = format!("g = {g}: pbrt takes any beyond {SHARPEST} as {SHARPEST}");
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
