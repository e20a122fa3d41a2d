//! The plan for a classified scene of several volumes, surfaces or clips.
//!
//! One kernel for samples and one for the integral: only what a scene does not have or ask
//! for is left out.

use super::EffectFinding::{Absent, NotAsked};
use super::classified::{PHONG, SHADOW, VOLUME, early_termination, matters, without_effect};
use super::{Decisions, Effect, EffectFinding, Estimator, Kernel, Method, Plan, Reason};
use crate::scene::{Classified, KeyLines, Panel};

const SURFACE: &str = "classified.surface";
const CLIP: &str = "classified.clip";

/// The plan for a scene with [objects](crate::scene::Objects).
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Classified, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    let decisions = Decisions::new(|effect| finding(scene, effect), forced, key_lines);
    let objects = scene.counted_objects();
    let (kernel, method, reason) = if scene.is_continuous() {
        let reason = "are integrated along each ray, without samples".to_owned();
        (Kernel::Integral(scene), Method::Quadrature, reason)
    } else if scene.is_merged() {
        let reason = "are merged along each ray, their samples each one step apart".to_owned();
        (Kernel::Several(scene), Method::RayCasting, reason)
    } else if scene.conventions.common_steps && scene.volume_count() > 1 {
        let (_, step) = scene.common_box_and_step();
        let reason =
            format!("are sampled by common steps of {step}, the shortest, one over the next");
        (Kernel::Conventional(scene), Method::RayCasting, reason)
    } else {
        let reason = "are composited along each ray by other conventions".to_owned();
        (Kernel::Conventional(scene), Method::RayCasting, reason)
    };
    Plan {
        panel,
        decisions: decisions.0,
        approximations: early_termination(scene, key_lines).into_iter().collect(),
        warnings: without_effect(scene, key_lines)
            .into_iter()
            .chain(idle_clips(scene, key_lines))
            .collect(),
        estimator: Estimator {
            method,
            why: Reason::of(VOLUME, format!("{objects} {reason}"), key_lines),
        },
        kernel,
    }
}

/// Warnings of clips that keep all of what they are for.
pub(super) fn idle_clips(scene: &Classified, key_lines: &KeyLines) -> impl Iterator<Item = Reason> {
    scene.clips_that_cut_nothing().map(|number| {
        let message = "this clip cuts nothing: all of its volumes is on the side that it keeps";
        Reason::of(format!("{CLIP}[{number}]"), message, key_lines)
    })
}

fn finding(scene: &Classified, effect: Effect) -> EffectFinding {
    let surfaces = &scene.objects.surfaces;
    match effect {
        Effect::Surfaces if surfaces.is_empty() => Absent("the scene has no surfaces"),
        Effect::Surfaces => matters(SURFACE, "surfaces end rays"),
        Effect::Absorption => matters(VOLUME, "volumes absorb light"),
        Effect::Emission => matters(VOLUME, "volumes have colours"),
        Effect::SingleScattering | Effect::MultipleScattering => {
            Absent("the classified model has no scattering; shading replaces it")
        }
        Effect::SurfaceShadow if surfaces.is_empty() => Absent("the scene has no surfaces"),
        Effect::MediumShadow | Effect::SurfaceShadow if scene.shadow.is_none() => NotAsked(SHADOW),
        Effect::MediumShadow => matters(SHADOW, "volumes attenuate light"),
        Effect::SurfaceShadow => matters(SHADOW, "surfaces block light"),
        Effect::GradientShading => {
            let own = scene.objects.volumes.iter().map(|volume| &volume.phong);
            match own.chain([&scene.phong]).flatten().next() {
                Some(_) => matters(PHONG, "a volume is shaded by its gradient"),
                None => NotAsked(PHONG),
            }
        }
        Effect::Heterogeneity => matters(VOLUME, "values of volumes are looked up"),
        Effect::ChromaticCoefficients => Absent("opacity is the same for all colours"),
        Effect::AnisotropicPhase => Absent("the classified model has no phase function"),
    }
}
