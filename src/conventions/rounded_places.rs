//! All places that samples have in single precision.
//!
//! A place off by a rounding may fall into the next voxel or behind the back face, and a transmittance off by one
//! may end a ray or not, which changes a pixel by a sample. In a scene whose samples lie on faces of voxels, that is
//! so in every pixel.

use crate::math;
use crate::scene::{Compositing, Panel, Precision, Scene};

/// Half a unit in the last place of coordinates and opacities below 1.
const HALF_UNIT: f64 = 1.0 / (1 << 25) as f64;

/// Least distance that places are moved by, in steps: the ray and the point where it enters the volume are rounded,
/// too.
const LEAST: f64 = 1e-4;

/// `scene` with the places that samples have in single precision: `None` if no
/// convention says that a panel is rendered in it.
pub(super) fn scenes_of_rounded_places(scene: &Scene) -> Option<Vec<Scene>> {
    let mut volumes = scene.panels.iter().filter_map(Panel::classified);
    if volumes.all(|volume| volume.conventions.precision == Precision::F64) {
        return None;
    }
    // Moved by that much at the first sample, and that much more at each of the others.
    let moves = [[0.0, 0.0], [-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];
    let scenes = moves.map(|[first, each]| {
        scene.with_volumes(|volume| {
            let steps = volume.extent().world_bounds().size().length() / volume.step;
            // Places that are sums of steps gather a rounding with each of them.
            let gathered = HALF_UNIT * steps * steps;
            volume.conventions.first_sample += first * gathered.clamp(LEAST, 0.5);
            volume.step *= 1.0 + each * gathered / steps;
            if let Compositing::EarlyTermination(threshold) = &mut volume.compositing {
                // So do opacities; and one that is looked up in few bits is rounded up or down, behind
                // samples that let half of the light pass, or less.
                let bits = volume.conventions.lookup_bits.map(f64::from);
                let looked_up = bits.map_or(0.0, |bits| 0.25 * math::exp2(-bits));
                let off = (HALF_UNIT * steps + looked_up).min(0.5 * *threshold);
                *threshold += (first + each) * off;
            }
        })
    });
    Some(scenes.into())
}
