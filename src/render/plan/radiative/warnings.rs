//! Warnings on a scene of surfaces, media and lights.

use super::super::decision::stated;
use super::super::{Decisions, Effect, Reason, State};
use super::contents::*;
use crate::geometry::{ClosedMesh, Luminous};
use crate::optics::{Density, Sides};
use crate::scene::{Body, Scattering};
use glam::DVec3;

/// A key of the scene, and a message.
type Warning = (String, String);

impl Contents<'_> {
    /// Keys of the file without any effect, and emitters that are inside out.
    pub fn warnings(&self, decisions: &Decisions) -> Vec<Reason> {
        let warnings = [
            self.ineffective_scattering(decisions),
            self.ineffective_media(),
            self.inverted_emitters(),
            self.ineffective_lights(),
        ];
        stated(warnings.into_iter().flatten(), self.key_lines).collect()
    }

    fn ineffective_scattering(&self, decisions: &Decisions) -> Vec<Warning> {
        let single = decisions.of(Effect::SingleScattering);
        if single.state != State::Elided || self.scene.scattering == Scattering::None {
            return vec![];
        }
        let reason = &single.why.reason;
        let keys = [(SCATTERING, "scattering"), (MAX_BOUNCES, "max_bounces")];
        let warning =
            |(key, name): (&str, &str)| (key.to_owned(), format!("{name} has no effect: {reason}"));
        keys.map(warning).into()
    }

    fn ineffective_media(&self) -> Vec<Warning> {
        let is_idle = |body: &Body| {
            let medium = body.medium;
            medium.coefficients.sigma_t() == DVec3::ZERO && medium.emission == DVec3::ZERO
                || body.density.as_ref().is_some_and(Density::is_nothing)
        };
        let media = self.scene.media.iter().enumerate();
        let idle = media.filter(|(_, body)| is_idle(body));
        let message =
            "this medium has no effect: its coefficients and emission, or its density, are 0";
        idle.map(|(index, _)| (format!("{MEDIUM}[{index}]"), message.to_owned()))
            .collect()
    }

    fn inverted_emitters(&self) -> Vec<Warning> {
        let count = self.scene.objects.len() + self.scene.area_lights.len();
        let emitters = (0..count).map(|index| format!("{SURFACE}[{index}].emitter"));
        let emitters = emitters.filter(|key| self.key_lines.has(key));
        let lights = self.scene.area_lights.iter().zip(emitters);
        let inverted = lights.filter(|(light, _)| {
            matches!((&light.shape, light.sides), (Luminous::Mesh(mesh), Sides::Front)
                if ClosedMesh::is_inside_out(mesh))
        });
        let message = "the mesh of this emitter is inside out: it emits into its inside only, and is \
                       black from outside; to emit outwards, reverse the order of the corners of \
                       every face";
        inverted.map(|(_, key)| (key, message.to_owned())).collect()
    }

    fn ineffective_lights(&self) -> Vec<Warning> {
        let lights = self.scene.lights.iter().enumerate();
        let warnings = lights.filter_map(|(index, light)| {
            let message = "this light has no effect: it emits nothing, or nothing scatters its light towards the eye, and \
                           a point, spot or directional light is itself invisible";
            let is_idle = light.strength() == DVec3::ZERO || !self.is_scattered();
            is_idle.then(|| (format!("radiative.light[{index}]"), message.to_owned()))
        });
        warnings.collect()
    }
}
