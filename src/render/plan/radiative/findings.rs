//! What is known about each effect of a scene of surfaces, media and lights.

use super::super::{Decisions, Effect, Finding, Reason, State};
use super::contents::*;
use super::walks;
use crate::math::rng::Stream;
use crate::media::Density;
use crate::scene::{Body, Scattering};
use glam::DVec3;

impl Contents<'_> {
    /// What is known about an effect.
    pub fn finding(&self, effect: Effect) -> Finding {
        use Finding::{Absent, Null};
        match effect {
            Effect::Surfaces => self.of_surfaces(),
            Effect::SingleScattering => self.of_single_scattering(),
            Effect::MultipleScattering => self.of_multiple_scattering(),
            Effect::MediumShadow | Effect::SurfaceShadow
                if !(self.light_is_turned() && self.lights) =>
            {
                self.no_ray_to_a_light()
            }
            Effect::MediumShadow => self.of_medium_shadow(),
            Effect::SurfaceShadow => self.of_surface_shadow(),
            Effect::GradientShading => Absent("media are not shaded"),
            _ if self.media == 0 => Null(
                MEDIUM.to_owned(),
                match self.scene.media.is_empty() {
                    true => "the scene has no media".to_owned(),
                    false => "the density is 0 everywhere in every medium".to_owned(),
                },
            ),
            Effect::Absorption => self.of_a_medium(
                self.absorption,
                match self.absorption.is_none() && self.extinction {
                    true => BY_ALBEDO,
                    false => ABSORPTION,
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
            // However light would be turned: it is not.
            Effect::AnisotropicPhase if !self.turns() => self.nothing_turns(),
            Effect::AnisotropicPhase if !self.light_is_turned() => {
                Null(SCATTERING.to_owned(), "light is never turned".to_owned())
            }
            Effect::AnisotropicPhase => self.of_a_medium(
                self.anisotropic,
                PHASE,
                "a medium that scatters has g other than 0",
                match self.scattering {
                    None => "no medium scatters",
                    Some(_) => "g is 0 wherever light is scattered",
                },
            ),
        }
    }

    /// An effect that is on by the medium `index`, or null in all of them.
    fn of_a_medium(&self, index: Option<usize>, keys: &[&str], on: &str, null: &str) -> Finding {
        match index {
            Some(index) => Finding::Matters(self.key_of(index, keys), on.to_owned()),
            None => Finding::Null(self.none_has(keys), null.to_owned()),
        }
    }

    fn of_surfaces(&self) -> Finding {
        let surfaces = SURFACE.to_owned();
        match self.surfaces {
            0 => Finding::Null(surfaces, "the scene has no surfaces".to_owned()),
            1 => Finding::Matters(surfaces, "one surface".to_owned()),
            many => Finding::Matters(surfaces, format!("{many} surfaces")),
        }
    }

    fn of_heterogeneity(&self) -> Finding {
        match self.heterogeneous[..] {
            [] => Finding::Null(
                match self.scene.media[..] {
                    [Body { density: None, .. }] => format!("{MEDIUM}[0]"),
                    _ => self.none_has(DENSITY),
                },
                "every medium that takes or gives light is homogeneous".to_owned(),
            ),
            [index] => Finding::Matters(
                self.key_of(index, DENSITY),
                match self.scene.media[index].density.as_ref() {
                    Some(density) if density.constant().is_some() => {
                        "the density is constant, but too small or large to be multiplied with \
                         the coefficients"
                    }
                    _ => "the density of a medium differs from place to place",
                }
                .to_owned(),
            ),
            [first, ..] => Finding::Matters(
                self.key_of(first, DENSITY),
                format!(
                    "the densities of {} media differ from place to place",
                    self.heterogeneous.len()
                ),
            ),
        }
    }

    /// Why nothing turns light, and the key behind that.
    pub fn nothing_turns(&self) -> Finding {
        let media = &self.scene.media;
        let scatters = |body: &Body| body.medium.coefficients.sigma_s() != DVec3::ZERO;
        let albedo = format!("{MEDIUM}[0].albedo");
        let null = |field: &str, reason: &str| Finding::Null(field.to_owned(), reason.to_owned());
        match media[..] {
            _ if self.scattering.is_some() || self.reflection => {
                null(LIGHT, "the scene has no light that could be turned")
            }
            [] => null(MEDIUM, "there is no medium, and no surface reflects"),
            _ if media.iter().any(scatters) => null(
                &self.none_has(DENSITY),
                "the density is 0 everywhere in every medium that scatters, and no surface reflects",
            ),
            [ref body]
                if self.places.has(&albedo)
                    && body.medium.coefficients.sigma_t() != DVec3::ZERO =>
            {
                null(&albedo, "albedo is 0, and no surface reflects")
            }
            [_] if self.places.has(&albedo) => null(
                &format!("{MEDIUM}[0].sigma_t"),
                "sigma_t is 0, and no surface reflects",
            ),
            _ => null(
                &self.none_has(SCATTERS),
                "sigma_s is 0 in every medium, and no surface reflects",
            ),
        }
    }

    /// Why no light is asked how much of it arrives.
    fn no_ray_to_a_light(&self) -> Finding {
        let (field, reason) = match () {
            _ if !self.turns() => return self.nothing_turns(),
            _ if !self.light_is_turned() => (SCATTERING, "light is never turned"),
            _ => (
                LIGHT,
                "there is no light but the environment and what glows",
            ),
        };
        Finding::Null(field.to_owned(), reason.to_owned())
    }

    fn of_single_scattering(&self) -> Finding {
        if !self.turns() {
            return self.nothing_turns();
        }
        if self.scene.scattering == Scattering::None {
            let reason = "not asked for: light is never turned";
            return Finding::LeftOut(SCATTERING.to_owned(), reason.to_owned());
        }
        let reason = match (self.scattering.is_some(), self.reflection) {
            (true, true) => "media scatter and surfaces reflect",
            (true, false) => "a medium scatters",
            (false, _) => "a surface reflects",
        };
        Finding::Matters(SCATTERING.to_owned(), reason.to_owned())
    }

    fn of_multiple_scattering(&self) -> Finding {
        if !self.turns() {
            return self.nothing_turns();
        }
        let left_out = |field: &str, reason: String| Finding::LeftOut(field.to_owned(), reason);
        match self.scene.scattering {
            Scattering::None => left_out(
                SCATTERING,
                "not asked for: light is never turned".to_owned(),
            ),
            Scattering::Single => left_out(
                SCATTERING,
                "not asked for: light is turned once at most".to_owned(),
            ),
            Scattering::Multiple(Some(limit)) => left_out(
                MAX_BOUNCES,
                format!("beyond {limit} turns: light turned more often is left out"),
            ),
            Scattering::Multiple(None) => {
                Finding::Matters(SCATTERING.to_owned(), "any number of turns".to_owned())
            }
        }
    }

    fn of_medium_shadow(&self) -> Finding {
        if !self.extinction {
            return Finding::Null(
                self.none_has(ABSORPTION),
                "no medium takes light away".to_owned(),
            );
        }
        let index = self.absorption.or(self.scattering);
        let keys = self.absorption.map_or(SCATTERS, |_| ABSORPTION);
        Finding::Matters(
            self.key_of(index.unwrap_or(0), keys),
            "media take light away on its way from a light".to_owned(),
        )
    }

    fn of_surface_shadow(&self) -> Finding {
        let surfaces = SURFACE.to_owned();
        match self.surfaces {
            0 => Finding::Null(surfaces, "the scene has no surfaces".to_owned()),
            _ => Finding::Matters(surfaces, "surfaces stand in the way of lights".to_owned()),
        }
    }

    /// The media in which paths take more turns than anyone waits for, and that many.
    fn long_walks(&self) -> Vec<(usize, f64, &Body)> {
        let is_bounded = match self.scene.scattering {
            Scattering::Multiple(limit) => {
                limit.is_some_and(|limit| f64::from(limit) <= walks::MANY_TURNS)
            }
            _ => true,
        };
        if is_bounded || !self.light_is_turned() {
            return Vec::new();
        }
        let bodies = self.scene.media.iter().enumerate();
        bodies
            .map(|(index, body)| (index, walks::turns_from_the_middle(self.scene, body), body))
            .filter(|(_, turns, _)| *turns > walks::MANY_TURNS)
            .collect()
    }

    /// What the file asks for and cannot matter, or takes longer than it may seem.
    pub fn warnings(&self, decisions: &Decisions) -> Vec<Reason> {
        let mut warnings = Vec::new();
        let mut warn = |key: String, message: String| {
            if self.places.has(&key) {
                warnings.push(Reason::of(key, message, self.places));
            }
        };
        let single = decisions.of(Effect::SingleScattering);
        if single.state == State::Elided && self.scene.scattering != Scattering::None {
            let reason = &single.why.reason;
            warn(
                SCATTERING.to_owned(),
                format!("scattering asked, but {reason}"),
            );
            warn(
                MAX_BOUNCES.to_owned(),
                format!("max_bounces asked, but {reason}"),
            );
        }
        for (index, body) in self.scene.media.iter().enumerate() {
            let (coefficients, emission) = (body.medium.coefficients, body.medium.emission);
            let at = format!("{MEDIUM}[{index}]");
            if coefficients.sigma_t() == DVec3::ZERO && emission == DVec3::ZERO {
                warn(
                    at,
                    "a medium asked, but its coefficients and emission are 0".to_owned(),
                );
            } else if body.density.as_ref().is_some_and(Density::is_nothing) {
                warn(
                    at,
                    "a medium asked, but its density is 0 everywhere".to_owned(),
                );
            } else if body.medium.phase.0.g() != 0.0 {
                let why_not = match coefficients.sigma_s() == DVec3::ZERO {
                    true => "sigma_s (or albedo) of this medium is 0",
                    false if !self.light_is_turned() => "light is not turned here",
                    false => continue,
                };
                warn(format!("{at}.g"), format!("g asked, but {why_not}"));
            }
        }
        for (index, turns, body) in self.long_walks() {
            let key = self.key_of(index, SCATTERS);
            let depth = walks::depth_of_the_middle(self.scene, body);
            let far = match depth.is_finite() {
                true => format!("its middle is {depth:.3e} mean free paths deep"),
                false => "it has no end".to_owned(),
            };
            let often = match turns.is_finite() {
                true => format!("about {turns:.1e} times"),
                false => "without end".to_owned(),
            };
            let endless = self.scene.scattering == Scattering::Multiple(None);
            let gives_up = match endless && turns > f64::from(Stream::BOUNCES) {
                true => "; rendering may fail, at a path of 2^26 turns",
                false => "",
            };
            warn(
                key,
                format!(
                    "light that gets deep into this medium is turned {often}, as {far} and little \
                     is absorbed{gives_up}; `max_bounces = {}` bounds the work, and leaves out what \
                     is turned more often",
                    walks::MANY_TURNS
                ),
            );
        }
        for (index, light) in self.scene.lights.iter().enumerate() {
            let at = format!("radiative.light[{index}]");
            if light.strength() == DVec3::ZERO {
                warn(at, "a light asked, but it is dark".to_owned());
            } else if !self.light_is_turned() {
                warn(
                    at,
                    "a light asked, but nothing turns its light towards the eye, and a light \
                     without extent is not seen itself"
                        .to_owned(),
                );
            }
        }
        warnings
    }
}
