//! What a scene of surfaces, media and lights calls for.

mod contents;
mod findings;
mod walks;

use super::{Decisions, Effect, Estimator, Finding, Kernel, Method, Parts, Plan, Reason};
use crate::scene::{Panel, Radiative, Scattering};
use contents::{Contents, DENSITY, SCATTERING};

/// The plan for a scene of surfaces, media and lights: the cheapest kernel that is exact for it.
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Radiative, forced: &[Effect]) -> Plan<'s> {
    let places = &panel.places;
    let contents = Contents::of(scene, places);
    let decisions = Decisions::new(|effect| contents.finding(effect), forced, places);
    let on = |effect| decisions.is_on(effect);

    let of_media = [
        Effect::Absorption,
        Effect::Emission,
        Effect::ChromaticCoefficients,
        Effect::AnisotropicPhase,
        Effect::Heterogeneity,
        Effect::MediumShadow,
    ];
    let null_media = of_media.into_iter().any(|effect| forced.contains(&effect));
    let parts = Parts {
        media: contents.extinction || contents.emission.is_some() || null_media,
        null_media,
        surfaces: on(Effect::Surfaces),
        emission: on(Effect::Emission),
        chromatic: on(Effect::ChromaticCoefficients),
        anisotropic: on(Effect::AnisotropicPhase),
        heterogeneous: on(Effect::Heterogeneity),
    };
    let turned = on(Effect::SingleScattering) || on(Effect::MultipleScattering);
    let (kernel, mut why) = contents.kernel(parts, turned);
    let method = match kernel {
        Kernel::LineOfSight { turned: false, .. } if !contents.glow_is_integrated() => {
            Method::ClosedForm
        }
        Kernel::LineOfSight { .. } => Method::Quadrature,
        _ => Method::PathTracing,
    };
    if turned && !contents.light_is_turned() {
        why.reason = format!("forced, although {}", why.reason);
    }
    Plan {
        panel,
        approximations: vec![],
        warnings: contents.warnings(&decisions),
        estimator: Estimator { method, why },
        decisions: decisions.0,
        kernel,
    }
}

impl<'s> Contents<'s> {
    /// The cheapest kernel that is exact, and why it is that one. By what there is, not by what is
    /// forced: the path tracer looks through other places of a pixel than its centre.
    fn kernel(&self, parts: Parts, turned: bool) -> (Kernel<'s>, Reason) {
        let because = |field: String, reason: &str| Reason::of(field, reason, self.places);
        let scene = self.scene;
        let line_of_sight = Kernel::LineOfSight {
            scene,
            parts,
            turned,
        };
        if !self.light_is_turned() {
            let scattering = match self.nothing_turns() {
                Finding::Null(field, _) if !self.turns() => field,
                _ => SCATTERING.to_owned(),
            };
            return match self.heterogeneous.first() {
                Some(&index) if !self.integrable => (
                    Kernel::PathTracer {
                        scene,
                        parts,
                        limit: Some(0),
                    },
                    because(
                        self.key_of(index, DENSITY),
                        "light is not turned, but noise has no integral along a line: it is tracked",
                    ),
                ),
                Some(&index) if self.glow_is_integrated() => (
                    line_of_sight,
                    because(
                        self.key_of(index, DENSITY),
                        "light is not turned, and where what glows overlaps another medium, one \
                         of them varying, what it sends is integrated",
                    ),
                ),
                Some(&index) => (
                    line_of_sight,
                    because(
                        self.key_of(index, DENSITY),
                        "light is not turned, and every density has an integral along a line",
                    ),
                ),
                None => (
                    line_of_sight,
                    because(
                        scattering,
                        "light is not turned, and all is the same along each stretch of a line",
                    ),
                ),
            };
        }
        let asked = because;
        match self.scene.scattering {
            Scattering::Multiple(limit) => (
                Kernel::PathTracer {
                    scene,
                    parts,
                    limit,
                },
                asked(
                    SCATTERING.to_owned(),
                    "light turned more than once is an integral over paths of any length",
                ),
            ),
            _ if self.is_one_integral() => (
                line_of_sight,
                asked(
                    SCATTERING.to_owned(),
                    "light from lights without extent, turned once, is one integral along the line \
                     of sight",
                ),
            ),
            _ => (
                Kernel::PathTracer {
                    scene,
                    parts,
                    limit: Some(1),
                },
                asked(SCATTERING.to_owned(), self.why_no_integral()),
            ),
        }
    }

    /// Why light turned once is more than one integral along the line of sight.
    fn why_no_integral(&self) -> &'static str {
        if !self.scene.area_lights.is_empty() || self.environment {
            "light turned once comes from lights with extent: an integral over directions too"
        } else if self.emission.is_some() {
            "light turned once comes from media that glow: an integral over space too"
        } else if !self.heterogeneous.is_empty() {
            "light is turned once where the density differs from place to place: it is tracked"
        } else if self.scattering.is_some() && !self.scene.objects.is_empty() {
            "surfaces throw shadows into media, too narrow for an integral to be sure to meet them"
        } else {
            "mirrors and glass turn light in one direction only, which no integral meets"
        }
    }
}
