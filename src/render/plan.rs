//! The effects that a scene needs, decided once per image.
//!
//! The [`Plan`] is the only way from a scene to a kernel. For each effect it says whether it is
//! simulated and why; the kernel does exactly that. It is made from the values of the
//! scene alone: an effect is *elided* where a value that is exactly 0, two values that are exactly
//! equal, or the range of a grid prove that it changes no bit, and *omitted* where the scene does
//! not ask for it, which makes another picture. There are no thresholds.
//!
//! | effect | on | provably null, elided | not asked for, omitted |
//! | --- | --- | --- | --- |
//! | surfaces | there is one | there is none | |
//! | absorption | a medium has `sigma_a` above 0; some value of a volume has an opacity | `sigma_a` is 0 in every medium, or every density; every value, by the range of the grid, has opacity 0 | |
//! | emission | a medium has `emission`; some value has an opacity | as absorption | |
//! | single scattering | something scatters light (a medium has `sigma_s`, a surface reflects), and there is light to scatter | nothing scatters light, or there is no light | `scattering = "none"` |
//! | multiple scattering | the same | the same | `scattering = "none"` or `"single"`; beyond `max_bounces` |
//! | medium shadow | a medium attenuates light between a light and what scatters it; `[classified.shadow]` and an opacity | nothing is scattered, or no light but the environment is there, or no medium absorbs or scatters; every value has opacity 0 | no `[classified.shadow]` |
//! | surface shadow | a surface stands somewhere, and light is scattered | nothing is scattered, or no light but the environment is there, or there is no surface | |
//! | gradient shading | `[classified.phong]`, and the density has a gradient | the grid is constant, or no axis has three nodes; ambient 1, diffuse 0, specular 0; every value has opacity 0 | no `[classified.phong]` |
//! | heterogeneity | the density of a medium with any coefficient or emission varies in space; the values of a volume do | every density is constant (a grid by its range); every value has opacity 0 | |
//! | chromatic coefficients | `sigma_a` or `sigma_s` of a medium differs between channels | all three are equal in every medium | |
//! | anisotropic phase | a medium that scatters has `g` other than 0 | `g` is 0, or `sigma_s` is, in every medium; light is not scattered | |
//!
//! Projections and isosurfaces (`modes`) absorb and shade only as far as they have surfaces or attenuation; isosurfaces that
//! no ray can pass are elided, all else is on.
//!
//! A grid of one value is a homogeneous medium to every kernel, equal to it up to rounding.
//!
//! Effects that a model does not have (surfaces in a classified volume, gradient shading in media)
//! are elided, too. An effect that is null can be [forced](Plan::forcing): the same bits for more
//! work. A key without any effect is a [warning](Plan::warnings).

mod canonical_text;
mod classified;
mod decision;
mod effect;
mod kernel;
mod method;
mod modes;
mod radiative;
mod several;

pub use decision::{Decision, Reason};
pub use effect::{Effect, State};
pub use kernel::{Kernel, RadiativeFeatures, RayCasterFeatures};
pub use method::{Estimator, Method};

use crate::scene::{Curve, Mode, Model, Panel, Sampling, Scene};
use decision::{Decisions, EffectFinding};
use serde::Serialize;

/// A part of an effect that is omitted at the scene's request, with the bound on its bias.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Approximation {
    /// The part left out, in words.
    pub without: String,
    /// The key of the scene behind it.
    pub field: &'static str,
    /// The line of that key in the scene file.
    pub line: Option<usize>,
    /// Largest error of a channel of a pixel, radiance.
    pub bias: f64,
}

/// The effects simulated in a panel, and the kernel that renders it.
#[derive(Clone, Debug)]
pub struct Plan<'s> {
    /// The panel that is rendered.
    pub panel: &'s Panel,
    /// A decision for each of [`Effect::ALL`].
    pub decisions: Vec<Decision>,
    /// Parts of simulated effects that are omitted at the scene's request.
    pub approximations: Vec<Approximation>,
    /// Keys of the scene file without any effect, and emitters that are inside out.
    pub warnings: Vec<Reason>,
    /// The estimator of a pixel's radiance.
    pub estimator: Estimator,
    /// The code that renders the image.
    pub kernel: Kernel<'s>,
}

/// An effect to be forced that the scene does not request: forcing it would change the image.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{effect} is not part of this scene, and forcing it would change the picture: {reason}")]
pub struct PlanError {
    /// The effect to be forced.
    pub effect: Effect,
    /// Reason why it is off.
    pub reason: String,
}

/// The plans for the panels of `scene`: everything provably null is elided.
pub fn plans(scene: &Scene) -> Vec<Plan<'_>> {
    scene.panels.iter().map(Plan::new).collect()
}

impl<'s> Plan<'s> {
    /// The plan for `panel`: everything provably null is elided.
    pub fn new(panel: &'s Panel) -> Plan<'s> {
        Plan::forcing(panel, &[]).expect("nothing is forced")
    }

    /// The plan for `panel` with the effects in `forced` simulated although they are provably
    /// null: same bits, more work. Fails for an effect that is not null but absent.
    pub fn forcing(panel: &'s Panel, forced: &[Effect]) -> Result<Plan<'s>, PlanError> {
        let plan = match &panel.model {
            Model::Curve(curve) => curve_plan(panel, curve),
            Model::Radiative(scene) => radiative::plan(panel, scene, forced),
            Model::Classified(scene) if scene.has_objects() => several::plan(panel, scene, forced),
            Model::Classified(scene) if scene.mode == Mode::Composited => {
                classified::plan(panel, scene, forced)
            }
            Model::Classified(scene) => modes::plan(panel, scene, forced),
        };
        for decision in &plan.decisions {
            if forced.contains(&decision.effect) && decision.state != State::On {
                let reason = decision.why.reason.clone();
                return Err(PlanError {
                    effect: decision.effect,
                    reason,
                });
            }
        }
        Ok(plan)
    }

    /// The plan of these `decisions`, without warnings.
    fn of(
        panel: &'s Panel,
        decisions: Decisions,
        kernel: Kernel<'s>,
        method: Method,
        why: Reason,
    ) -> Plan<'s> {
        let is_composited = !matches!(kernel, Kernel::Background(_) | Kernel::Integral(_));
        let scene = panel.classified().filter(|_| is_composited);
        let early = scene.and_then(|scene| classified::early_termination(scene, &panel.key_lines));
        Plan {
            panel,
            decisions: decisions.0,
            approximations: early.into_iter().collect(),
            warnings: vec![],
            estimator: Estimator { method, why },
            kernel,
        }
    }

    /// The effects of `panel` that are provably null and can be [forced](Plan::forcing): the others
    /// that are elided are none of its model.
    pub fn null_effects(panel: &Panel) -> Vec<Effect> {
        let decisions = Plan::new(panel).decisions.into_iter();
        decisions
            .filter(|decision| decision.state == State::Elided && decision.why.field.is_some())
            .map(|decision| decision.effect)
            .collect()
    }

    /// Whether an effect is simulated.
    pub fn is_on(&self, effect: Effect) -> bool {
        self.state(effect) == State::On
    }

    /// The decision about an effect.
    pub fn state(&self, effect: Effect) -> State {
        let decision = self
            .decisions
            .iter()
            .find(|decision| decision.effect == effect);
        decision.expect("a decision for each effect").state
    }

    /// Whether the image is a mean of random samples.
    pub fn is_sampled(&self) -> bool {
        matches!(self.kernel, Kernel::PathTracer { .. })
    }

    /// Whether the image is the integral of a classified volume, without samples.
    pub fn is_continuous(&self) -> bool {
        matches!(&self.panel.model, Model::Classified(scene)
            if scene.continuous && scene.mode == Mode::Composited)
    }

    /// Names of the effects that the scene could have requested and did not, and the omitted parts
    /// of others.
    pub fn omitted(&self) -> Vec<String> {
        let omitted = self
            .decisions
            .iter()
            .filter(|decision| decision.state == State::Omitted);
        let effects = omitted.map(|decision| decision.effect.to_string());
        let parts = self.approximations.iter();
        effects
            .chain(parts.map(|approximation| approximation.without.clone()))
            .collect()
    }

    /// Samples per pixel with `sampling`; 1 where the image is not sampled.
    pub(crate) fn samples(&self, sampling: Sampling) -> u32 {
        match self.kernel {
            Kernel::PathTracer { scene, .. } => sampling.samples_of(scene),
            _ => 1,
        }
    }
}

fn curve_plan<'s>(panel: &'s Panel, curve: &'s Curve) -> Plan<'s> {
    const NO_LIGHT: &str = "a plot of the transfer function has no light";
    let decisions = Decisions::new(|_| EffectFinding::absent(NO_LIGHT), &[], &panel.key_lines);
    let why = Reason::of("curve", NO_LIGHT, &panel.key_lines);
    Plan::of(panel, decisions, Kernel::Curve(curve), Method::Plot, why)
}
