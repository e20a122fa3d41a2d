//! The plan for a classified scene of several volumes, surfaces or clips.
//!
//! One kernel for samples and one for the integral: only what a scene does not have or ask
//! for is left out.

use super::classified::{
    NO_PHASE, NO_SCATTERING, ONE_OPACITY, PHONG, SHADOW, VOLUME, without_effect,
};
use super::decision::findings;
use super::{Decisions, Effect, EffectFinding, Kernel, Method, Plan, Reason};
use crate::scene::{Classified, Panel};

const SURFACE: &str = "classified.surface";

/// The plan for a scene with [objects](crate::scene::Objects).
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Classified, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    let decisions = Decisions::new(|effect| finding(scene, effect), forced, key_lines);
    let objects = scene.counted_objects();
    let (kernel, method, reason) = if scene.continuous {
        let reason = "are integrated along each ray, without samples";
        (Kernel::Integral(scene), Method::Quadrature, reason)
    } else if scene.is_merged() {
        let reason = "are merged along each ray, their samples each one step apart";
        (Kernel::Several(scene), Method::RayCasting, reason)
    } else {
        let reason = "are composited along each ray by other conventions";
        (Kernel::Conventional(scene), Method::RayCasting, reason)
    };
    let why = Reason::of(VOLUME, format!("{objects} {reason}"), key_lines);
    Plan {
        warnings: without_effect(scene, key_lines).into_iter().collect(),
        ..Plan::of(panel, decisions, kernel, method, why)
    }
}

fn finding(scene: &Classified, effect: Effect) -> EffectFinding {
    let has_surfaces = !scene.objects.surfaces.is_empty();
    let others = scene.objects.volumes.iter().map(|volume| volume.phong);
    let is_shaded = others.chain([scene.phong]).any(|phong| phong.is_some());
    findings! { effect;
        Surfaces | SurfaceShadow if !has_surfaces => absent("the scene has no surfaces");
        Surfaces => matters(SURFACE, "surfaces end rays");
        Absorption => matters(VOLUME, "volumes absorb light");
        Emission => matters(VOLUME, "volumes have colours");
        SingleScattering | MultipleScattering => absent(NO_SCATTERING);
        MediumShadow | SurfaceShadow if scene.shadow.is_none() => not_asked(SHADOW);
        MediumShadow => matters(SHADOW, "volumes attenuate light");
        SurfaceShadow => matters(SHADOW, "surfaces block light");
        GradientShading if is_shaded => matters(PHONG, "a volume is shaded by its gradient");
        GradientShading => not_asked(PHONG);
        Heterogeneity => matters(VOLUME, "values of volumes are looked up");
        ChromaticCoefficients => absent(ONE_OPACITY);
        AnisotropicPhase => absent(NO_PHASE);
    }
}
