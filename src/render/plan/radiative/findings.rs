//! Findings on each effect in a scene of surfaces, media and lights.

use super::super::decision::findings;
use super::super::{Effect, EffectFinding};
use super::contents::*;
use crate::scene::Scattering;

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
        let absorption = self.absorption;
        findings! { effect;
            Surfaces if self.surfaces == 0 => null(SURFACE, "the scene has no surfaces");
            Surfaces => matters(SURFACE, "surfaces end rays");

            SingleScattering | MultipleScattering if !scatters => null(why_dark, dark);
            SingleScattering | MultipleScattering if scattering == Scattering::None
                => left_out(SCATTERING, "not requested: no scattering");
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
            MediumShadow if absorption.is_some()
                => matters(of(absorption, ABSORPTION), "media attenuate the light from light sources");
            MediumShadow => matters(of(self.scattering, SCATTERS), "media attenuate the light from light sources");
            SurfaceShadow if self.surfaces == 0 => null(SURFACE, "the scene has no surfaces");
            SurfaceShadow => matters(SURFACE, "surfaces may occlude lights");
            GradientShading => absent("media are not shaded");

            Absorption | Emission | Heterogeneity | ChromaticCoefficients | AnisotropicPhase
                if self.media == 0 && scene.media.is_empty() => null(MEDIUM, "the scene has no media");
            Absorption | Emission | Heterogeneity | ChromaticCoefficients | AnisotropicPhase
                if self.media == 0 => null(MEDIUM, "the density is 0 everywhere in every medium");
            Absorption if absorption.is_some()
                => matters(of(absorption, ABSORPTION), "a medium has sigma_a above 0");
            Absorption => null(of(None, ABSORPTION), "sigma_a is 0 in every medium");
            Emission if self.emission.is_some() => matters(of(self.emission, EMISSION), "a medium has emission");
            Emission => null(of(None, EMISSION), "no medium has emission");
            Heterogeneity if heterogeneous.is_empty()
                => null(MEDIUM, "every medium that attenuates or emits light is homogeneous");
            Heterogeneity
                => matters(self.key_of(heterogeneous[0], DENSITY), "the density of a medium is heterogeneous");
            ChromaticCoefficients if self.chromatic
                => matters(MEDIUM, "coefficients differ between channels");
            ChromaticCoefficients => null(MEDIUM, "coefficients are the same for all channels");
            AnisotropicPhase if !scatters => null(why_dark, dark);
            AnisotropicPhase if !is_scattered => null(SCATTERING, NOT_ASKED);
            AnisotropicPhase if self.anisotropic.is_some()
                => matters(of(self.anisotropic, PHASE), "a scattering medium has an anisotropic phase function");
            AnisotropicPhase if self.scattering.is_none() => null(of(None, PHASE), "no medium scatters");
            AnisotropicPhase => null(of(None, PHASE), "g is 0 wherever light is scattered");
        }
    }

    /// The key behind that nothing scatters light, and the reason.
    pub fn no_scattering(&self) -> (String, &'static str) {
        if self.scattering.is_some() || self.reflection {
            (LIGHT.to_owned(), "the scene has no light to scatter")
        } else if self.scene.media.is_empty() {
            (
                MEDIUM.to_owned(),
                "there is no medium, and no surface reflects",
            )
        } else {
            (
                self.none_has(SCATTERS),
                "no medium scatters, and no surface reflects",
            )
        }
    }
}

const NOT_ASKED: &str = "the scene asks for no scattering";
