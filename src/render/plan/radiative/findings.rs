//! Findings on each effect in a scene of surfaces, media and lights.

use super::super::{Effect, EffectFinding};
use super::contents::*;
use crate::optics::Phase;
use crate::scene::{Body, Scattering};
use glam::DVec3;

impl Contents<'_> {
    /// The finding for an effect.
    pub fn finding(&self, effect: Effect) -> EffectFinding {
        use EffectFinding::{Absent, Null};
        match effect {
            Effect::Surfaces => self.of_surfaces(),
            Effect::SingleScattering => self.of_single_scattering(),
            Effect::MultipleScattering => self.of_multiple_scattering(),
            Effect::MediumShadow | Effect::SurfaceShadow
                if !(self.is_scattered() && self.lights) =>
            {
                self.no_ray_to_a_light()
            }
            Effect::MediumShadow => self.of_medium_shadow(),
            Effect::SurfaceShadow => self.of_surface_shadow(),
            Effect::GradientShading => Absent("media are not shaded"),
            _ if self.media == 0 => Null(
                MEDIUM.to_owned(),
                if self.scene.media.is_empty() {
                    "the scene has no media".to_owned()
                } else {
                    "the density is 0 everywhere in every medium".to_owned()
                },
            ),
            Effect::Absorption => self.of_a_medium(
                self.absorption,
                if self.absorption.is_none() && self.extinction {
                    BY_ALBEDO
                } else {
                    ABSORPTION
                },
                "a medium has sigma_a above 0",
                "sigma_a is 0 in every medium",
            ),
            Effect::Emission => self.of_a_medium(
                self.emission,
                EMISSION,
                "a medium has emission",
                "no medium has emission",
            ),
            Effect::Heterogeneity => self.of_heterogeneity(),
            Effect::ChromaticCoefficients => {
                let (index, keys) = self.chromatic.unzip();
                self.of_a_medium(
                    index,
                    keys.unwrap_or(COEFFICIENTS),
                    "coefficients differ between channels",
                    "coefficients are the same for all channels",
                )
            }
            Effect::AnisotropicPhase if !self.scatters() => self.no_scattering(),
            Effect::AnisotropicPhase if !self.is_scattered() => Null(
                SCATTERING.to_owned(),
                "the scene asks for no scattering".to_owned(),
            ),
            Effect::AnisotropicPhase => self.of_a_medium(
                self.anisotropic,
                PHASE,
                &self.anisotropic_phase(),
                match self.scattering {
                    None => "no medium scatters",
                    Some(_) => "g is 0 wherever light is scattered",
                },
            ),
        }
    }

    /// An effect that is on by the medium `index`, or null in all of them.
    fn of_a_medium(
        &self,
        index: Option<usize>,
        keys: &[&str],
        on: &str,
        null: &str,
    ) -> EffectFinding {
        match index {
            Some(index) => EffectFinding::Matters(self.key_of(index, keys), on.to_owned()),
            None => EffectFinding::Null(self.none_has(keys), null.to_owned()),
        }
    }

    /// The phase function of the first medium that scatters anisotropically.
    fn anisotropic_phase(&self) -> String {
        let phase = self
            .anisotropic
            .map(|index| self.scene.media[index].medium.phase);
        match phase {
            None | Some(Phase::HenyeyGreenstein(_)) => {
                "a scattering medium has nonzero g".to_owned()
            }
            Some(phase) => format!("a scattering medium has the phase function {phase}"),
        }
    }

    fn of_surfaces(&self) -> EffectFinding {
        let surfaces = SURFACE.to_owned();
        match self.surfaces {
            0 => EffectFinding::Null(surfaces, "the scene has no surfaces".to_owned()),
            1 => EffectFinding::Matters(surfaces, "one surface".to_owned()),
            many => EffectFinding::Matters(surfaces, format!("{many} surfaces")),
        }
    }

    fn of_heterogeneity(&self) -> EffectFinding {
        match self.heterogeneous[..] {
            [] => EffectFinding::Null(
                match self.scene.media[..] {
                    [Body { density: None, .. }] => format!("{MEDIUM}[0]"),
                    _ => self.none_has(DENSITY),
                },
                "every medium that attenuates or emits light is homogeneous".to_owned(),
            ),
            [index] => EffectFinding::Matters(
                self.key_of(index, DENSITY),
                match self.scene.media[index].density.as_ref() {
                    Some(density) if density.constant().is_some() => {
                        "the density is constant, but too small or large to be multiplied with \
                         the coefficients"
                    }
                    _ => "the density of a medium is heterogeneous",
                }
                .to_owned(),
            ),
            [first, ..] => EffectFinding::Matters(
                self.key_of(first, DENSITY),
                format!(
                    "the densities of {} media are heterogeneous",
                    self.heterogeneous.len()
                ),
            ),
        }
    }

    /// The reason why nothing scatters light, and the key behind it.
    pub fn no_scattering(&self) -> EffectFinding {
        let media = &self.scene.media;
        let scatters = |body: &Body| body.medium.coefficients.sigma_s() != DVec3::ZERO;
        let albedo = format!("{MEDIUM}[0].albedo");
        let null =
            |field: &str, reason: &str| EffectFinding::Null(field.to_owned(), reason.to_owned());
        match media[..] {
            _ if self.scattering.is_some() || self.reflection => {
                null(LIGHT, "the scene has no light to scatter")
            }
            [] => null(MEDIUM, "there is no medium, and no surface reflects"),
            _ if media.iter().any(scatters) => null(
                &self.none_has(DENSITY),
                "the density is 0 everywhere in every scattering medium, and no surface reflects",
            ),
            [ref body]
                if self.key_lines.has(&albedo)
                    && body.medium.coefficients.sigma_t() != DVec3::ZERO =>
            {
                null(&albedo, "albedo is 0, and no surface reflects")
            }
            [_] if self.key_lines.has(&albedo) => null(
                &format!("{MEDIUM}[0].sigma_t"),
                "sigma_t is 0, and no surface reflects",
            ),
            _ => null(
                &self.none_has(SCATTERS),
                "sigma_s is 0 in every medium, and no surface reflects",
            ),
        }
    }

    /// The reason why no shadow rays are cast.
    fn no_ray_to_a_light(&self) -> EffectFinding {
        let (field, reason) = match () {
            _ if !self.scatters() => return self.no_scattering(),
            _ if !self.is_scattered() => (SCATTERING, "the scene asks for no scattering"),
            _ => (
                LIGHT,
                "there is no light but the environment and emissive media",
            ),
        };
        EffectFinding::Null(field.to_owned(), reason.to_owned())
    }

    fn of_single_scattering(&self) -> EffectFinding {
        if !self.scatters() {
            return self.no_scattering();
        }
        if self.scene.scattering == Scattering::None {
            let reason = "not requested: no scattering";
            return EffectFinding::LeftOut(SCATTERING.to_owned(), reason.to_owned());
        }
        let reason = match (self.scattering.is_some(), self.reflection) {
            (true, true) => "media scatter and surfaces reflect",
            (true, false) => "a medium scatters",
            (false, _) => "a surface reflects",
        };
        EffectFinding::Matters(SCATTERING.to_owned(), reason.to_owned())
    }

    fn of_multiple_scattering(&self) -> EffectFinding {
        if !self.scatters() {
            return self.no_scattering();
        }
        let left_out =
            |field: &str, reason: String| EffectFinding::LeftOut(field.to_owned(), reason);
        match self.scene.scattering {
            Scattering::None => left_out(SCATTERING, "not requested: no scattering".to_owned()),
            Scattering::Single => left_out(
                SCATTERING,
                "not requested: single scattering only".to_owned(),
            ),
            Scattering::Multiple(Some(limit)) => left_out(
                MAX_BOUNCES,
                format!("scattering beyond order {limit} is left out"),
            ),
            Scattering::Multiple(None) => {
                EffectFinding::Matters(SCATTERING.to_owned(), "scattering of any order".to_owned())
            }
        }
    }

    fn of_medium_shadow(&self) -> EffectFinding {
        if !self.extinction {
            return EffectFinding::Null(
                self.none_has(ABSORPTION),
                "no medium absorbs or scatters".to_owned(),
            );
        }
        let index = self.absorption.or(self.scattering);
        let keys = self.absorption.map_or(SCATTERS, |_| ABSORPTION);
        EffectFinding::Matters(
            self.key_of(index.unwrap_or(0), keys),
            "media attenuate the light from light sources".to_owned(),
        )
    }

    fn of_surface_shadow(&self) -> EffectFinding {
        let surfaces = SURFACE.to_owned();
        match self.surfaces {
            0 => EffectFinding::Null(surfaces, "the scene has no surfaces".to_owned()),
            _ => EffectFinding::Matters(surfaces, "surfaces may occlude lights".to_owned()),
        }
    }
}
