//! Findings on each effect in a scene of surfaces, media and lights.

use super::super::decision::findings;
use super::super::{Effect, EffectFinding};
use super::contents::*;
use crate::optics::Phase;
use crate::scene::{Body, Scattering};
use glam::DVec3;

impl Contents<'_> {
    /// The finding for an effect.
    pub fn finding(&self, effect: Effect) -> EffectFinding {
        let (scene, heterogeneous) = (self.scene, &self.heterogeneous[..]);
        let (scatters, scattering) = (self.scatters(), scene.scattering);
        let is_scattered = self.is_scattered();
        let limit = scattering.max_bounces().unwrap_or(0);
        let (why_dark, dark) = self.no_scattering();
        // The first medium that has a property, or the key that shows that none has.
        let of = |index: Option<usize>, keys: &[&str]| match index {
            Some(index) => self.key_of(index, keys),
            None => self.none_has(keys),
        };
        let (absorption, chromatic) = (self.absorption, self.chromatic.unzip());
        let by_absorption = match absorption.is_none() && self.extinction {
            true => BY_ALBEDO,
            false => ABSORPTION,
        };
        let attenuating = absorption.map_or(SCATTERS, |_| ABSORPTION);
        findings! { effect;
            Surfaces if self.surfaces == 0 => null(SURFACE, "the scene has no surfaces");
            Surfaces if self.surfaces == 1 => matters(SURFACE, "one surface");
            Surfaces => matters(SURFACE, format!("{} surfaces", self.surfaces));

            SingleScattering | MultipleScattering if !scatters => null(why_dark, dark);
            SingleScattering | MultipleScattering if scattering == Scattering::None
                => left_out(SCATTERING, "not requested: no scattering");
            SingleScattering if self.scattering.is_some() && self.reflection
                => matters(SCATTERING, "media scatter and surfaces reflect");
            SingleScattering if self.scattering.is_some() => matters(SCATTERING, "a medium scatters");
            SingleScattering => matters(SCATTERING, "a surface reflects");
            MultipleScattering if scattering == Scattering::Single
                => left_out(SCATTERING, "not requested: single scattering only");
            MultipleScattering if scattering == Scattering::Multiple(None)
                => matters(SCATTERING, "scattering of any order");
            MultipleScattering => left_out(MAX_BOUNCES, format!("scattering beyond order {limit} is left out"));

            MediumShadow | SurfaceShadow if !scatters => null(why_dark, dark);
            MediumShadow | SurfaceShadow if !is_scattered => null(SCATTERING, NOT_ASKED);
            MediumShadow | SurfaceShadow if !self.lights
                => null(LIGHT, "there is no light but the environment and emissive media");
            MediumShadow if !self.extinction => null(self.none_has(ABSORPTION), "no medium absorbs or scatters");
            MediumShadow => matters(
                self.key_of(absorption.or(self.scattering).unwrap_or(0), attenuating),
                "media attenuate the light from light sources"
            );
            SurfaceShadow if self.surfaces == 0 => null(SURFACE, "the scene has no surfaces");
            SurfaceShadow => matters(SURFACE, "surfaces may occlude lights");
            GradientShading => absent("media are not shaded");

            Absorption | Emission | Heterogeneity | ChromaticCoefficients | AnisotropicPhase
                if self.media == 0 && scene.media.is_empty() => null(MEDIUM, "the scene has no media");
            Absorption | Emission | Heterogeneity | ChromaticCoefficients | AnisotropicPhase
                if self.media == 0 => null(MEDIUM, "the density is 0 everywhere in every medium");
            Absorption if absorption.is_some()
                => matters(of(absorption, by_absorption), "a medium has sigma_a above 0");
            Absorption => null(of(None, by_absorption), "sigma_a is 0 in every medium");
            Emission if self.emission.is_some() => matters(of(self.emission, EMISSION), "a medium has emission");
            Emission => null(of(None, EMISSION), "no medium has emission");
            Heterogeneity if heterogeneous.is_empty() && matches!(scene.media[..], [Body { density: None, .. }])
                => null(format!("{MEDIUM}[0]"), HOMOGENEOUS);
            Heterogeneity if heterogeneous.is_empty() => null(self.none_has(DENSITY), HOMOGENEOUS);
            Heterogeneity if heterogeneous.len() > 1 => matters(
                self.key_of(heterogeneous[0], DENSITY),
                format!("the densities of {} media are heterogeneous", heterogeneous.len())
            );
            Heterogeneity if scene.media[heterogeneous[0]].density.as_ref().is_some_and(|it| it.constant().is_some())
                => matters(
                    self.key_of(heterogeneous[0], DENSITY),
                    "the density is constant, but too small or large to be multiplied with the coefficients"
                );
            Heterogeneity
                => matters(self.key_of(heterogeneous[0], DENSITY), "the density of a medium is heterogeneous");
            ChromaticCoefficients if self.chromatic.is_some()
                => matters(of(chromatic.0, chromatic.1.unwrap_or(COEFFICIENTS)), "coefficients differ between channels");
            ChromaticCoefficients => null(of(None, COEFFICIENTS), "coefficients are the same for all channels");
            AnisotropicPhase if !scatters => null(why_dark, dark);
            AnisotropicPhase if !is_scattered => null(SCATTERING, NOT_ASKED);
            AnisotropicPhase if self.anisotropic.is_some()
                => matters(of(self.anisotropic, PHASE), self.anisotropic_phase());
            AnisotropicPhase if self.scattering.is_none() => null(of(None, PHASE), "no medium scatters");
            AnisotropicPhase => null(of(None, PHASE), "g is 0 wherever light is scattered");
        }
    }

    /// The phase function of the first medium that scatters anisotropically.
    fn anisotropic_phase(&self) -> String {
        let first = self
            .anisotropic
            .map(|index| self.scene.media[index].medium.phase);
        match first {
            None | Some(Phase::HenyeyGreenstein(_)) => {
                "a scattering medium has nonzero g".to_owned()
            }
            Some(phase) => format!("a scattering medium has the phase function {phase}"),
        }
    }

    /// The key behind that nothing scatters light, and the reason.
    pub fn no_scattering(&self) -> (String, &'static str) {
        let media = &self.scene.media;
        let scatters = |body: &Body| body.medium.coefficients.sigma_s() != DVec3::ZERO;
        let absorbs = |body: &Body| body.medium.coefficients.sigma_t() != DVec3::ZERO;
        let albedo = format!("{MEDIUM}[0].albedo");
        let has_albedo = self.key_lines.has(&albedo);
        match media[..] {
            _ if self.scattering.is_some() || self.reflection => {
                (LIGHT.to_owned(), "the scene has no light to scatter")
            }
            [] => (
                MEDIUM.to_owned(),
                "there is no medium, and no surface reflects",
            ),
            _ if media.iter().any(scatters) => (
                self.none_has(DENSITY),
                "the density is 0 everywhere in every scattering medium, and no surface reflects",
            ),
            [ref body] if has_albedo && absorbs(body) => {
                (albedo, "albedo is 0, and no surface reflects")
            }
            [_] if has_albedo => (
                format!("{MEDIUM}[0].sigma_t"),
                "sigma_t is 0, and no surface reflects",
            ),
            _ => (
                self.none_has(SCATTERS),
                "sigma_s is 0 in every medium, and no surface reflects",
            ),
        }
    }
}

const NOT_ASKED: &str = "the scene asks for no scattering";
const HOMOGENEOUS: &str = "every medium that attenuates or emits light is homogeneous";
