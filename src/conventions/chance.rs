//! Scenes whose images bound those of a renderer that leaves something to chance or to rounding.

use super::first_samples::scenes_of_first_samples;
use super::rounded_places::scenes_of_rounded_places;
use crate::scene::Scene;

/// `scene` with each choice that the caster leaves to chance or to rounding made in turn: `scene` alone if there is none.
pub(crate) fn scenes_by_chance(scene: &Scene) -> Vec<Scene> {
    let random = scenes_of_first_samples(scene);
    let scenes = random.or_else(|| scenes_of_rounded_places(scene));
    scenes.unwrap_or_else(|| vec![scene.clone()])
}
