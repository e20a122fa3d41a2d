//! What a scene calls for, decided once per image.
//!
//! The [`Plan`] is the only way from a scene to a kernel. For each effect it says whether it is
//! simulated and why; the kernel is compiled for exactly that.

mod classified;
mod radiative;

use crate::scene::{Compositing, Model, Panel};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// Something light does on its way to the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Surfaces around or inside the volume.
    Surfaces,
    /// Light taken away by the volume.
    Absorption,
    /// Light sent out by the volume.
    Emission,
    /// Light turned once from a source towards the eye.
    SingleScattering,
    /// Light turned more than once.
    MultipleScattering,
    /// Light taken away by the volume between a light and a point.
    MediumShadow,
    /// Light blocked by a surface between a light and a point.
    SurfaceShadow,
    /// Colour by the gradient of the field.
    GradientShading,
    /// A field that differs from place to place.
    Heterogeneity,
    /// Coefficients that differ between red, green and blue.
    ChromaticCoefficients,
    /// Scattering that prefers a direction.
    AnisotropicPhase,
}

impl Effect {
    /// All effects, in the order in which plans list them.
    pub const ALL: [Effect; 11] = [
        Effect::Surfaces,
        Effect::Absorption,
        Effect::Emission,
        Effect::SingleScattering,
        Effect::MultipleScattering,
        Effect::MediumShadow,
        Effect::SurfaceShadow,
        Effect::GradientShading,
        Effect::Heterogeneity,
        Effect::ChromaticCoefficients,
        Effect::AnisotropicPhase,
    ];

    /// The name used on the command line and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Effect::Surfaces => "surfaces",
            Effect::Absorption => "absorption",
            Effect::Emission => "emission",
            Effect::SingleScattering => "single-scattering",
            Effect::MultipleScattering => "multiple-scattering",
            Effect::MediumShadow => "medium-shadow",
            Effect::SurfaceShadow => "surface-shadow",
            Effect::GradientShading => "gradient-shading",
            Effect::Heterogeneity => "heterogeneity",
            Effect::ChromaticCoefficients => "chromatic-coefficients",
            Effect::AnisotropicPhase => "anisotropic-phase",
        }
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Effect {
    type Err = String;

    fn from_str(name: &str) -> Result<Effect, String> {
        Effect::ALL
            .into_iter()
            .find(|effect| effect.name() == name)
            .ok_or_else(|| {
                let names: Vec<_> = Effect::ALL.iter().map(|effect| effect.name()).collect();
                format!(
                    "unknown effect {name:?}; the effects are: {}",
                    names.join(", ")
                )
            })
    }
}

/// Whether an effect is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Simulated.
    On,
    /// Provably null in this scene: same bits, less work.
    Elided,
    /// Not asked for: a different picture than with it.
    Omitted,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            State::On => "on",
            State::Elided => "elided",
            State::Omitted => "omitted",
        })
    }
}

/// The decision about one effect.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Decision {
    /// Which effect.
    pub effect: Effect,
    /// Whether it is simulated.
    pub state: State,
    /// Why, in words.
    pub reason: String,
    /// The key of the scene behind it, where there is one.
    pub field: Option<&'static str>,
}

/// A part of an effect that is left out because the scene asks for it, and what that may cost.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Approximation {
    /// What is left out, in words.
    pub without: String,
    /// The key of the scene behind it.
    pub field: &'static str,
    /// No channel of a pixel is off by more, nor its opacity by more than the share.
    pub bias: f64,
}

/// What is simulated, and by which kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// A decision for each of [`Effect::ALL`].
    pub decisions: Vec<Decision>,
    /// What is left out of effects that are simulated, because the scene asks for it.
    pub approximations: Vec<Approximation>,
    /// The code that renders the image.
    pub kernel: Kernel,
}

/// The code that renders an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kernel {
    /// A plot; no light is simulated.
    Curve,
    /// Nothing lies before the background.
    Background,
    /// The ray caster, compiled for these parts.
    RayCaster {
        /// Reconstruction of the density.
        field: FieldKind,
        /// Order of compositing.
        compositing: Compositing,
        /// Phong shading.
        shading: bool,
        /// Volume shadow.
        shadow: bool,
        /// Leaps over regions known to be transparent.
        skip_empty: bool,
    },
    /// Closed forms and integrals along the line of sight, without random numbers.
    LineOfSight {
        /// What it is compiled for.
        parts: Parts,
        /// Whether light is turned, once.
        turned: bool,
    },
    /// Path tracing.
    PathTracer {
        /// What it is compiled for.
        parts: Parts,
        /// How often light is turned at most, if there is a limit.
        limit: Option<u32>,
    },
}

/// Parts of the kernels for surfaces and participating media.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// Media.
    pub media: bool,
    /// Media of no matter are asked where they are, like others.
    pub null_media: bool,
    /// Surfaces.
    pub surfaces: bool,
    /// Light that media send out.
    pub emission: bool,
    /// Coefficients that differ between channels.
    pub chromatic: bool,
    /// Phase functions that prefer a direction.
    pub anisotropic: bool,
    /// Media whose density differs from place to place.
    pub heterogeneous: bool,
}

/// Part of [`Plan::canonical_text`], by which goldens know the plan they were made by: a part
/// that goldens of old know nothing of shows only where it is on.
impl fmt::Debug for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut parts = f.debug_struct("Parts");
        parts
            .field("media", &self.media)
            .field("null_media", &self.null_media)
            .field("surfaces", &self.surfaces)
            .field("emission", &self.emission)
            .field("chromatic", &self.chromatic)
            .field("anisotropic", &self.anisotropic);
        if self.heterogeneous {
            parts.field("heterogeneous", &true);
        }
        parts.finish()
    }
}

impl fmt::Display for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            (self.surfaces, "surfaces"),
            (self.media, "media"),
            (self.emission, "emission"),
            (self.chromatic, "colour"),
            (self.anisotropic, "anisotropic scattering"),
            (self.heterogeneous, "varying density"),
        ];
        let names: Vec<_> = names
            .iter()
            .filter(|(on, _)| *on)
            .map(|(_, name)| *name)
            .collect();
        f.write_str(if names.is_empty() { "nothing" } else { "" })?;
        f.write_str(&names.join(", "))
    }
}

/// How a kernel comes by densities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Value of the nearest node.
    Nearest,
    /// Trilinear interpolation.
    Trilinear,
    /// The one density of the whole grid.
    Constant,
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Kernel::RayCaster {
            field,
            compositing,
            shading,
            shadow,
            skip_empty,
        } = self
        else {
            return match self {
                Kernel::Curve => f.write_str("plot of the transfer function"),
                Kernel::LineOfSight {
                    parts,
                    turned: false,
                } => {
                    write!(f, "line of sight: {parts}, by closed forms")
                }
                Kernel::LineOfSight {
                    parts,
                    turned: true,
                } => {
                    write!(
                        f,
                        "line of sight: {parts}, light turned once, by quadrature"
                    )
                }
                Kernel::PathTracer {
                    parts,
                    limit: Some(0),
                } => {
                    write!(f, "path tracer: {parts}, light not turned")
                }
                Kernel::PathTracer { parts, limit: None } => {
                    write!(f, "path tracer: {parts}, any number of turns")
                }
                Kernel::PathTracer {
                    parts,
                    limit: Some(limit),
                } => {
                    write!(f, "path tracer: {parts}, up to {limit} turns")
                }
                _ => f.write_str("background only"),
            };
        };
        let field = match field {
            FieldKind::Nearest => "nearest",
            FieldKind::Trilinear => "trilinear",
            FieldKind::Constant => "constant density",
        };
        let order = match compositing {
            Compositing::FrontToBack => "front to back".to_owned(),
            Compositing::EarlyTermination(below) => format!("front to back down to {below}"),
            Compositing::BackToFront => "back to front".to_owned(),
        };
        write!(f, "ray caster: {field}, {order}")?;
        f.write_str(if *shading { ", Phong" } else { ", unshaded" })?;
        f.write_str(if *shadow {
            ", volume shadow"
        } else {
            ", no shadow"
        })?;
        f.write_str(if *skip_empty {
            ", leaps over empty space"
        } else {
            ", every sample"
        })
    }
}

/// Why a plan cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// The scene does not ask for the effect; forcing it would be another picture.
    #[error(
        "{effect} is not part of this scene, and forcing it would change the picture: {reason}"
    )]
    NotAsked {
        /// The effect that was to be forced.
        effect: Effect,
        /// Why it is off.
        reason: String,
    },
}

impl Plan {
    /// The plan for `panel`: everything provably null is elided.
    pub fn new(panel: &Panel) -> Plan {
        Plan::forcing(panel, &[]).expect("nothing is forced")
    }

    /// The plan for `panel` with the effects in `forced` simulated although they are provably
    /// null: same bits, more work. Fails for an effect that is not null but absent.
    pub fn forcing(panel: &Panel, forced: &[Effect]) -> Result<Plan, PlanError> {
        let plan = match &panel.model {
            Model::Curve(_) => curve_plan(),
            Model::Radiative(radiative) => radiative::plan(radiative, forced),
            Model::Classified(classified) => classified::plan(classified, forced),
        };
        for decision in &plan.decisions {
            if forced.contains(&decision.effect) && decision.state != State::On {
                let reason = decision.reason.clone();
                return Err(PlanError::NotAsked {
                    effect: decision.effect,
                    reason,
                });
            }
        }
        Ok(plan)
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

    /// Names of the effects that the scene could have asked for and did not, and what is left out
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

    /// The plan as text that changes with anything it covers.
    pub fn canonical_text(&self) -> String {
        // The structure of the kernel, not the words it is described with.
        let mut text = format!("{:?}\n", self.kernel);
        for decision in &self.decisions {
            text.push_str(&format!("{} {}\n", decision.effect, decision.state));
        }
        text
    }
}

/// What is known about one effect of a scene.
enum Finding {
    /// The model has no such thing.
    Absent(&'static str),
    /// It could be asked for, under this key, and is not.
    NotAsked(&'static str),
    /// It is there, but this key leaves it out, for this reason.
    LeftOut(&'static str, String),
    /// Asked for under this key, and it matters.
    Matters(&'static str, String),
    /// Asked for under this key, but provably null.
    Null(&'static str, String),
}

/// A decision for each effect.
struct Decisions(Vec<Decision>);

impl Decisions {
    /// What follows from what is known about each effect, with those in `forced` simulated
    /// although they are null.
    fn new(finding: impl Fn(Effect) -> Finding, forced: &[Effect]) -> Decisions {
        let decide = |effect| decide(effect, finding(effect), forced);
        Decisions(Effect::ALL.into_iter().map(decide).collect())
    }

    fn is_on(&self, effect: Effect) -> bool {
        let mut on = self.0.iter().filter(|decision| decision.state == State::On);
        on.any(|decision| decision.effect == effect)
    }
}

fn decide(effect: Effect, finding: Finding, forced: &[Effect]) -> Decision {
    let (state, reason, field) = match finding {
        Finding::Absent(reason) => (State::Elided, reason.to_owned(), None),
        Finding::NotAsked(field) => (
            State::Omitted,
            format!("not asked for: the scene has no [{field}]"),
            Some(field),
        ),
        Finding::LeftOut(field, reason) => (State::Omitted, reason, Some(field)),
        Finding::Matters(field, reason) => (State::On, reason, Some(field)),
        Finding::Null(field, reason) if forced.contains(&effect) => (
            State::On,
            format!("forced, although null: {reason}"),
            Some(field),
        ),
        Finding::Null(field, reason) => (State::Elided, reason, Some(field)),
    };
    Decision {
        effect,
        state,
        reason,
        field,
    }
}

fn curve_plan() -> Plan {
    let finding = |_| Finding::Absent("a plot of the transfer function has no light");
    Plan {
        approximations: vec![],
        decisions: Decisions::new(finding, &[]).0,
        kernel: Kernel::Curve,
    }
}
