//! The plan for a scene of surfaces, media and lights.

mod contents;
mod findings;
mod warnings;

use super::{Decisions, Effect, Kernel, Method, Plan, RadiativeFeatures, Reason};
use crate::scene::{Panel, Radiative, Scattering};
use contents::{Contents, DENSITY, SCATTERING};

/// The plan for a scene of surfaces, media and lights: the cheapest kernel that is exact for it.
pub(super) fn plan<'s>(panel: &'s Panel, scene: &'s Radiative, forced: &[Effect]) -> Plan<'s> {
    let key_lines = &panel.key_lines;
    let contents = Contents::of(scene, key_lines);
    let decisions = Decisions::new(|effect| contents.finding(effect), forced, key_lines);
    let on = |effect| decisions.is_on(effect);

    let of_media = [
        Effect::Absorption,
        Effect::Emission,
        Effect::ChromaticCoefficients,
        Effect::AnisotropicPhase,
        Effect::Heterogeneity,
        Effect::MediumShadow,
    ];
    let vacuum_media = of_media.into_iter().any(|effect| forced.contains(&effect));
    let features = RadiativeFeatures {
        media: contents.extinction || contents.emission.is_some() || vacuum_media,
        vacuum_media,
        surfaces: on(Effect::Surfaces),
        emission: on(Effect::Emission),
        chromatic: on(Effect::ChromaticCoefficients),
        anisotropic: on(Effect::AnisotropicPhase),
        heterogeneous: on(Effect::Heterogeneity),
    };
    let scatters = on(Effect::SingleScattering) || on(Effect::MultipleScattering);
    let (kernel, mut why) = contents.kernel(features, scatters);
    let method = match kernel {
        Kernel::LineOfSight {
            scatters: false, ..
        } if !contents.emission_is_integrated() => Method::ClosedForm,
        Kernel::LineOfSight { .. } => Method::Quadrature,
        _ => Method::PathTracing,
    };
    if scatters && !contents.is_scattered() {
        why.reason = format!("forced, although {}", why.reason);
    }
    Plan {
        warnings: contents.warnings(&decisions),
        ..Plan::of(panel, decisions, kernel, method, why)
    }
}

impl<'s> Contents<'s> {
    /// The cheapest kernel that is exact, with the reason. A forced effect never changes the kernel: the path tracer
    /// averages over the pixel, and would change the image.
    fn kernel(&self, features: RadiativeFeatures, scatters: bool) -> (Kernel<'s>, Reason) {
        let scene = self.scene;
        let line_of_sight = Kernel::LineOfSight {
            scene,
            features,
            scatters,
        };
        let path_tracer = |max_order| Kernel::PathTracer {
            scene,
            features,
            max_order,
        };
        let asked = SCATTERING.to_owned();
        let (kernel, key, reason) = match (scene.scattering, self.heterogeneous.first()) {
            (_, Some(&index)) if !self.is_scattered() => {
                let key = self.key_of(index, DENSITY);
                match self.integrable {
                    true => (
                        line_of_sight,
                        key,
                        "no scattering, and every density has an integral along a line",
                    ),
                    false => (
                        path_tracer(Some(0)),
                        key,
                        "no scattering, but noise has no integral along a line: it is tracked",
                    ),
                }
            }
            (_, None) if !self.is_scattered() => (
                line_of_sight,
                match self.scatters() {
                    true => asked,
                    false => self.no_scattering().0,
                },
                "no scattering, and media are homogeneous along each segment of a line",
            ),
            (Scattering::Multiple(max_order), _) => (
                path_tracer(max_order),
                asked,
                "multiple scattering is an integral over paths of any length",
            ),
            _ if self.is_one_integral() => (
                line_of_sight,
                asked,
                "single scattering from point, spot and directional lights is one integral \
                 along the line of sight",
            ),
            _ => (
                path_tracer(Some(1)),
                asked,
                "single scattering from extended lights, in heterogeneous media, past surfaces or by \
                 mirrors is more than one integral",
            ),
        };
        (kernel, Reason::of(key, reason, self.key_lines))
    }
}
