//! All places of the first sample of a ray, for renderers that choose it at random.
//!
//! The places are 33 of infinitely many: where a sample enters or leaves the volume between two of them,
//! bounds of their images are off by the part of its step that is not seen.

use crate::scene::{Fault, Panel, Scene};

/// Places of the first sample, at equal distances, the first and the last a whole step apart.
const PLACES: u32 = 33;

/// `scene` with each place of the first sample in turn; `None` if no ray has a random one.
pub(super) fn scenes_of_first_samples(scene: &Scene) -> Option<Vec<Scene>> {
    let mut volumes = scene.panels.iter().filter_map(Panel::classified);
    if !volumes.any(|volume| volume.conventions.is_random()) {
        return None;
    }
    let places = (0..PLACES).map(|place| f64::from(place) / f64::from(PLACES - 1));
    Some(places.map(|place| at_place(scene, place)).collect())
}

/// `scene` with every first sample, or first step, at `place`.
fn at_place(scene: &Scene, place: f64) -> Scene {
    scene.with_volumes(|volume| {
        let conventions = &mut volume.conventions;
        if conventions.has_random_place() {
            (conventions.jitter, conventions.unstated_first_sample) = (false, false);
            conventions.first_sample = place;
        }
        if conventions.first_step_jitter {
            conventions.first_step_jitter = false;
            conventions.fault = Some(Fault::FirstStep(place));
        }
    })
}
