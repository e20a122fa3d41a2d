//! Mistakes in classified scenes of several volumes, surfaces and clips.

use super::{Edit, Mistake, any, makes, set};
use crate::scene::{Fault, Kept};

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "last-drawn-in-front" => Classified(|scene| makes(scene, !scene.objects.volumes.is_empty(), Fault::LastInFront)),
        "each volume lies as a whole in front of those before it in the scene: where volumes overlap, sample all of them along the ray, and add their extinctions";
    "volumes-by-nearest-box" => Classified(|scene| makes(scene, !scene.objects.volumes.is_empty(), Fault::NearestBoxInFront)),
        "volumes are composited one after the other, that whose box is entered first in front: where they overlap, sample all of them along the ray, and add their extinctions";
    "opacities-of-volumes-added" => Classified(|scene| makes(scene, !scene.objects.volumes.is_empty(), Fault::OpacitiesAdded)),
        "where volumes overlap, their opacities are added: it is extinctions that add, so opacities are 1 - (1 - a)(1 - b)";
    "colours-of-volumes-unweighted" => Classified(|scene| makes(scene, !scene.objects.volumes.is_empty(), Fault::ColoursUnweighted)),
        "where volumes overlap, the mean of their colours has no weights: weigh each by its extinction";
    "step-of-first-volume" => Classified(|scene| {
        any(&mut scene.objects.volumes, |volume| set(&mut volume.step, scene.step))
    }),
        "every volume is sampled by the step of the first one: each has a step of its own, in its own voxels";
    "transfer-function-of-first-volume" => Classified(|scene| {
        let first = &scene.transfer_function;
        any(&mut scene.objects.volumes, |volume| set(&mut volume.transfer_function, first.clone()))
    }),
        "every volume has the colours and opacities of the first one: each has a transfer function of its own";
    "modulation-left-out" => Classified(|scene| scene.objects.modulation.take().is_some()),
        "the second number at each place, such as the length of the gradient, has no effect: multiply opacities by its factor";
    "classified-by-the-second-number" => Classified(|scene| {
        let modulation = scene.objects.modulation.as_ref();
        let second = modulation.map(|modulation| modulation.grid.clone());
        second.is_some_and(|grid| set(&mut scene.grid, grid))
    }),
        "colours and opacities are those of the second number: it gives the factor of opacities alone";
    "surfaces-behind-volumes" => Classified(|scene| makes(scene, !scene.objects.surfaces.is_empty(), Fault::SurfacesBehind)),
        "surfaces lie behind all volumes: a ray should end at the nearest surface, and sample nothing behind it";
    "surfaces-in-front-of-volumes" => Classified(|scene| makes(scene, !scene.objects.surfaces.is_empty(), Fault::SurfacesInFront)),
        "surfaces hide the volumes in front of them: a ray should sample what it passes on its way to a surface";
    "surfaces-cut-by-boxes" => Classified(|scene| makes(scene, !scene.objects.surfaces.is_empty(), Fault::SurfacesCutByBoxes)),
        "surfaces within or behind the box of a volume are missing: a volume that is drawn first must leave no depth at the faces of its box, where nothing may be";
    "surfaces-cast-no-shadow" => Classified(|scene| {
        makes(scene, !scene.objects.surfaces.is_empty() && scene.shadow.is_some(), Fault::NoShadowOfSurfaces)
    }),
        "surfaces cast no shadow: the light does not reach what is behind them";
    "no-shadow-on-surfaces" => Classified(|scene| {
        makes(scene, !scene.objects.surfaces.is_empty() && scene.shadow.is_some(), Fault::NoShadowOnSurfaces)
    }),
        "volumes cast no shadow on surfaces: what a surface reflects is dimmed by the volumes on the way of the light";
    "clips-ignored" => Classified(|scene| {
        let occurs = !scene.objects.clips.is_empty();
        scene.objects.clips.clear();
        occurs
    }),
        "volumes are not clipped: of each, only the side to which the normal of a plane points is left, or the inside of a box";
    "clips-turned-around" => Classified(|scene| {
        any(&mut scene.objects.clips, |clip| match &mut clip.kept {
            Kept::Side { normal, .. } => {
                *normal = -*normal;
                true
            }
            Kept::Inside(_) => false,
        })
    }),
        "the wrong side of a clip plane is left: the normal points to what is kept";
    "clipped-parts-cast-shadows" => Classified(|scene| {
        makes(scene, !scene.objects.clips.is_empty() && scene.shadow.is_some(), Fault::ShadowsUnclipped)
    }),
        "what is clipped away still casts a shadow: rays towards the light are cut by clips, too";
};
