//! Mistakes in classified scenes of several volumes, surfaces and clips.

use super::{Edit, Mistake, set};
use crate::scene::{Classified, Composition, Kept, ObjectShadows, SurfaceDepth};

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "last-drawn-in-front",
        advice: "each volume lies as a whole in front of those before it in the scene: where volumes overlap, sample all of them along the ray, and add their extinctions",
        edit: Edit::Classified(|scene| composed(scene, Composition::LastInFront)),
    },
    Mistake {
        name: "volumes-by-nearest-box",
        advice: "volumes are composited one after the other, that whose box is entered first in front: where they overlap, sample all of them along the ray, and add their extinctions",
        edit: Edit::Classified(|scene| composed(scene, Composition::NearestBox)),
    },
    Mistake {
        name: "opacities-of-volumes-added",
        advice: "where volumes overlap, their opacities are added: it is extinctions that add, so opacities are 1 - (1 - a)(1 - b)",
        edit: Edit::Classified(|scene| composed(scene, Composition::AddedOpacities)),
    },
    Mistake {
        name: "colours-of-volumes-unweighted",
        advice: "where volumes overlap, the mean of their colours has no weights: weigh each by its extinction",
        edit: Edit::Classified(|scene| composed(scene, Composition::MeanColours)),
    },
    Mistake {
        name: "step-of-first-volume",
        advice: "every volume is sampled by the step of the first one: each has a step of its own, in its own voxels",
        edit: Edit::Classified(|scene| {
            let step = scene.step;
            let mut occurs = false;
            for volume in &mut scene.objects.volumes {
                occurs |= set(&mut volume.step, step);
            }
            occurs
        }),
    },
    Mistake {
        name: "transfer-function-of-first-volume",
        advice: "every volume has the colours and opacities of the first one: each has a transfer function of its own",
        edit: Edit::Classified(|scene| {
            let first = scene.transfer_function.clone();
            let mut occurs = false;
            for volume in &mut scene.objects.volumes {
                occurs |= set(&mut volume.transfer_function, first.clone());
            }
            occurs
        }),
    },
    Mistake {
        name: "modulation-left-out",
        advice: "the second number at each place, such as the length of the gradient, has no effect: multiply opacities by its factor",
        edit: Edit::Classified(|scene| scene.objects.modulation.take().is_some()),
    },
    Mistake {
        name: "classified-by-the-second-number",
        advice: "colours and opacities are those of the second number: it gives the factor of opacities alone",
        edit: Edit::Classified(|scene| {
            let modulation = scene.objects.modulation.as_ref();
            let second = modulation.map(|modulation| modulation.grid.clone());
            second.is_some_and(|grid| {
                let occurs = *grid != *scene.grid;
                scene.grid = grid;
                occurs
            })
        }),
    },
    Mistake {
        name: "surfaces-behind-volumes",
        advice: "surfaces lie behind all volumes: a ray ends at the nearest surface, and what is behind it is not sampled",
        edit: Edit::Classified(|scene| placed(scene, SurfaceDepth::Behind)),
    },
    Mistake {
        name: "surfaces-in-front-of-volumes",
        advice: "surfaces hide the volumes before them: what a ray passes on its way to a surface lies in front of it",
        edit: Edit::Classified(|scene| placed(scene, SurfaceDepth::InFront)),
    },
    Mistake {
        name: "surfaces-cut-by-boxes",
        advice: "surfaces within or behind the box of a volume are missing: a volume that is drawn first must leave no depth at the faces of its box, where nothing may be",
        edit: Edit::Classified(|scene| placed(scene, SurfaceDepth::Box)),
    },
    Mistake {
        name: "surfaces-cast-no-shadow",
        advice: "surfaces cast no shadow: the light does not reach what is behind them",
        edit: Edit::Classified(|scene| {
            !scene.objects.surfaces.is_empty() && shadowed(scene, ObjectShadows::NoneOfSurfaces)
        }),
    },
    Mistake {
        name: "no-shadow-on-surfaces",
        advice: "volumes cast no shadow on surfaces: what a surface reflects is dimmed by the volumes on the way of the light",
        edit: Edit::Classified(|scene| {
            !scene.objects.surfaces.is_empty() && shadowed(scene, ObjectShadows::NoneOnSurfaces)
        }),
    },
    Mistake {
        name: "clips-ignored",
        advice: "volumes are not clipped: of each, only the side to which the normal of a plane points is left, or the inside of a box",
        edit: Edit::Classified(|scene| {
            let occurs = !scene.objects.clips.is_empty();
            scene.objects.clips.clear();
            occurs
        }),
    },
    Mistake {
        name: "clips-turned-around",
        advice: "the wrong side of a clip plane is left: the normal points to what is kept",
        edit: Edit::Classified(|scene| {
            let mut occurs = false;
            for clip in &mut scene.objects.clips {
                if let Kept::Side { normal, .. } = &mut clip.kept {
                    *normal = -*normal;
                    occurs = true;
                }
            }
            occurs
        }),
    },
    Mistake {
        name: "clipped-parts-cast-shadows",
        advice: "what is clipped away still casts a shadow: rays towards the light are cut by clips, too",
        edit: Edit::Classified(|scene| {
            !scene.objects.clips.is_empty() && shadowed(scene, ObjectShadows::Unclipped)
        }),
    },
];

fn composed(scene: &mut Classified, composition: Composition) -> bool {
    !scene.objects.volumes.is_empty() && set(&mut scene.conventions.composition, composition)
}

fn placed(scene: &mut Classified, depth: SurfaceDepth) -> bool {
    !scene.objects.surfaces.is_empty() && set(&mut scene.conventions.surface_depth, depth)
}

fn shadowed(scene: &mut Classified, shadows: ObjectShadows) -> bool {
    scene.shadow.is_some() && set(&mut scene.conventions.object_shadows, shadows)
}
