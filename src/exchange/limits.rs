//! Limits of pbrt: what it lacks and Mitsuba has, lengths that floats of 32 bits do not hold, and values that it clamps.

use super::export_scene::ExportScene;
use super::nested_media::{PlacedGrid, key_of};
use super::refusal::Faults;
use crate::optics::{Light, Phase};
use crate::scene::Radiative;
use crate::volume::Interpolation;
use std::ops::Range;

/// The lengths with which pbrt can calculate. Normals are cross products of edges or derivatives,
/// divided by their lengths (`shapes.h`, `Triangle::InteractionFromIntersection`;
/// `interaction.h`, `SurfaceInteraction`), so that fourth powers of lengths are to be normal numbers
/// of 32 bits, from 2⁻¹²⁶ to 2¹²⁸: of a triangle |a × b|² ≥ 2⁻¹²⁶ and, of a ball, (2π² r²)² < 2¹²⁸, which is
/// r < 2²⁹·⁸. Beyond, normals are 0 or no numbers; before, a triangle counts as degenerate.
pub(super) const LENGTHS: Range<f64> = 1.0 / (1 << 30) as f64..(1 << 29) as f64;

/// The largest |g|: beyond, pbrt takes this one (`util/scattering.h`, `HenyeyGreenstein`;
/// `util/sampling.cpp`, `SampleHenyeyGreenstein`).
const SHARPEST: f64 = 0.99;

/// Adds to `faults` what pbrt lacks of a scene, or its numbers cannot hold.
pub(super) fn check(scene: &Radiative, export: &ExportScene, faults: &mut Faults) {
    for (index, light) in scene.lights.iter().enumerate() {
        let Light::Spot(spot) = light else { continue };
        if spot.inner() < spot.outer() {
            let what = "a spotlight whose edge falls off linearly in the angle; pbrt's falls off \
                        in another way: make inner_angle the outer_angle";
            faults.add(format!("radiative.light[{index}]"), what);
        }
    }
    for (at, nested) in export.nested_media.list.iter().enumerate() {
        let key = key_of(nested.index);
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
            faults.add(key, what);
        }
    }
}
