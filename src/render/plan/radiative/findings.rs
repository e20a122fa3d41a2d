//! Findings on each effect in a scene of surfaces, media and lights.

use super::super::{Decisions, Effect, EffectFinding, Reason, State};
use super::contents::*;
use super::walks;
use crate::geometry::{ClosedMesh, Luminous};
use crate::math::rng::Stream;
use crate::optics::{Density, Phase, Sides};
use crate::scene::{Body, Panel, Scattering};
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

    /// True if paths may scatter more often than anyone waits for.
    fn has_long_paths(&self) -> bool {
        let is_unbounded = match self.scene.scattering {
            Scattering::Multiple(limit) => {
                limit.is_none_or(|limit| f64::from(limit) > walks::MANY_SCATTERINGS)
            }
            _ => false,
        };
        is_unbounded && self.is_scattered()
    }

    /// The media in which paths scatter more often than anyone waits for, with the expected number.
    fn long_walks(&self) -> Vec<(usize, f64, &Body)> {
        if !self.has_long_paths() {
            return Vec::new();
        }
        let bodies = self.scene.media.iter().enumerate();
        bodies
            .map(|(index, body)| {
                let order = walks::scatterings_from_the_middle(self.scene, body);
                (index, order, body)
            })
            .filter(|(_, order, _)| *order > walks::MANY_SCATTERINGS)
            .collect()
    }

    /// Keys of the file without any effect, and media and surfaces that take longer than they may seem.
    pub fn warnings(&self, panel: &Panel, decisions: &Decisions) -> Vec<Reason> {
        let mut warnings = Vec::new();
        let mut warn = |key: String, message: String| {
            if self.key_lines.has(&key) {
                warnings.push(Reason::of(key, message, self.key_lines));
            }
        };
        let single = decisions.of(Effect::SingleScattering);
        if single.state == State::Elided && self.scene.scattering != Scattering::None {
            let reason = &single.why.reason;
            warn(
                SCATTERING.to_owned(),
                format!("scattering has no effect: {reason}"),
            );
            warn(
                MAX_BOUNCES.to_owned(),
                format!("max_bounces has no effect: {reason}"),
            );
        }
        for (index, body) in self.scene.media.iter().enumerate() {
            let (coefficients, emission) = (body.medium.coefficients, body.medium.emission);
            let at = format!("{MEDIUM}[{index}]");
            if coefficients.sigma_t() == DVec3::ZERO && emission == DVec3::ZERO {
                warn(
                    at,
                    "this medium has no effect: its coefficients and emission are 0".to_owned(),
                );
            } else if body.density.as_ref().is_some_and(Density::is_nothing) {
                warn(
                    at,
                    "this medium has no effect: its density is 0 everywhere".to_owned(),
                );
            } else if !body.medium.phase.is_isotropic() {
                let why_not = if coefficients.sigma_s() == DVec3::ZERO {
                    "this medium does not scatter"
                } else if !self.is_scattered() {
                    "no light is scattered in this scene"
                } else {
                    continue;
                };
                let key = self.key_of(index, &PHASE[..PHASE.len() - 1]);
                let name = key.rsplit('.').next().unwrap_or_default();
                warn(key.clone(), format!("{name} has no effect: {why_not}"));
            }
        }
        let gives_up = match self.scene.scattering {
            Scattering::Multiple(None) => "; rendering may fail, at a path of 2^26 scatterings",
            _ => "",
        };
        if self.has_long_paths() && walks::are_endless_between_surfaces(panel, self.scene) {
            let many = walks::MANY_SCATTERINGS;
            warn(
                SURFACE.to_owned(),
                format!(
                    "light is reflected between surfaces without end, as they absorb nothing and leave it no way \
                     out{gives_up}; `max_bounces = {many}` bounds the work, and leaves out scattering of higher order"
                ),
            );
        }
        for (index, order, body) in self.long_walks() {
            let key = self.key_of(index, SCATTERS);
            let depth = walks::depth_of_the_middle(self.scene, body);
            let far = if depth.is_finite() {
                format!("its middle is {depth:.3e} mean free paths deep")
            } else {
                "it has no end".to_owned()
            };
            let often = if order.is_finite() {
                format!("about {order:.1e} times")
            } else {
                "without end".to_owned()
            };
            let gives_up = if order > f64::from(Stream::BOUNCES) {
                gives_up
            } else {
                ""
            };
            warn(
                key,
                format!(
                    "light deep inside this medium is scattered {often}, as {far} and little is \
                     absorbed{gives_up}; `max_bounces = {}` bounds the work, and leaves out \
                     scattering of higher order",
                    walks::MANY_SCATTERINGS
                ),
            );
        }
        let count = self.scene.objects.len() + self.scene.area_lights.len();
        let emitters = (0..count).map(|index| format!("{SURFACE}[{index}].emitter"));
        let emitters = emitters.filter(|key| self.key_lines.has(key));
        for (light, key) in self.scene.area_lights.iter().zip(emitters) {
            if let (Luminous::Mesh(mesh), Sides::Front) = (&light.shape, light.sides)
                && ClosedMesh::is_inside_out(mesh)
            {
                warn(
                    key,
                    "the mesh of this emitter is inside out: it emits into its inside only, and is \
                     black from outside; to emit outwards, reverse the order of the corners of \
                     every face"
                        .to_owned(),
                );
            }
        }
        for (index, light) in self.scene.lights.iter().enumerate() {
            let at = format!("radiative.light[{index}]");
            if light.strength() == DVec3::ZERO {
                warn(at, "this light has no effect: it emits nothing".to_owned());
            } else if !self.is_scattered() {
                warn(
                    at,
                    "this light has no effect: nothing scatters its light towards the eye, and a \
                     point, spot or directional light is itself invisible"
                        .to_owned(),
                );
            }
        }
        warnings
    }
}
