//! Parameters of several volumes, surfaces and clips.

use super::classified;
use super::{Number, of_each};
use crate::scene::{Classified, Kept, Model};

/// Largest share of the box around all that an offset of a clip may be.
const OFFSET_STEP: f64 = 2e-3;

/// Parameters of each volume, surface and clip plane, and of what they share.
pub(super) fn numbers(scene: &Classified) -> Vec<Number> {
    let of_volume = |index: usize| {
        let alone = scene.alone(index);
        let own = classified::own(&alone).into_iter();
        own.map(|number| number.of_volume(index)).collect()
    };
    let mut numbers: Vec<Number> = of_each(scene.volume_count(), of_volume).collect();
    let objects = &scene.objects;
    numbers.extend(of_each(objects.surfaces.len(), |index| {
        let names = ["surface.colour", "colour of the surface", "surface"];
        let number = Number::volume(names, 0.5, move |scene, change| {
            let surface = scene.objects.surfaces.get_mut(index);
            surface.into_iter().for_each(|it| it.colour *= 1.0 + change);
        });
        vec![number.linear()]
    }));
    numbers.extend(clips(scene));
    numbers.extend(classified::shared(scene));
    numbers
}

/// Parameters of each clip plane.
pub(super) fn clips(scene: &Classified) -> impl Iterator<Item = Number> {
    let clips = &scene.objects.clips;
    let step = OFFSET_STEP * scene.diagonal();
    of_each(clips.len(), move |index| {
        let words = "place of the plane along its normal of the clip";
        let names = ["clip.offset", words, "clip"];
        let offset = Number::new(names, step, move |panel, change| {
            if let Model::Classified(scene) = &mut panel.model
                && let Some(clip) = scene.objects.clips.get_mut(index)
                && let Kept::Side { point, normal } = &mut clip.kept
            {
                *point += **normal * change;
                return scene.is_something_left().then_some(());
            }
            Some(())
        });
        // A box has no normal.
        let is_plane = matches!(clips[index].kept, Kept::Side { .. });
        let offset = is_plane.then_some(offset.per("world units"));
        offset.into_iter().collect()
    })
}
