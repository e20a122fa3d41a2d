//! What a scene calls for, decided once per image.
//!
//! The [`Plan`] is the only way from a scene to a kernel. For each effect it says whether it is
//! simulated and why; the kernel is compiled for exactly that.

use crate::media::Phong;
use crate::scene::{Classified, Compositing, Interpolation, Model, Panel};
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

/// What is simulated, and by which kernel.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// A decision for each of [`Effect::ALL`].
    pub decisions: Vec<Decision>,
    /// The code that renders the image.
    pub kernel: Kernel,
}

/// The code that renders an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
            return f.write_str(match self {
                Kernel::Curve => "plot of the transfer function",
                _ => "background only",
            });
        };
        let field = match field {
            FieldKind::Nearest => "nearest",
            FieldKind::Trilinear => "trilinear",
            FieldKind::Constant => "constant density",
        };
        let order = match compositing {
            Compositing::FrontToBack => "front to back",
            Compositing::BackToFront => "back to front",
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
            Model::Radiative(_) => todo!(),
            Model::Classified(classified) => classified_plan(classified, forced),
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

    /// Whether the picture is made with random numbers: then samples and seed matter, and it
    /// has noise.
    pub fn is_sampled(&self) -> bool {
        match self.kernel {
            Kernel::Curve | Kernel::Background | Kernel::RayCaster { .. } => false,
        }
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

    /// Names of the effects that the scene could have asked for and did not.
    pub fn omitted(&self) -> Vec<String> {
        let omitted = self
            .decisions
            .iter()
            .filter(|decision| decision.state == State::Omitted);
        omitted
            .map(|decision| decision.effect.to_string())
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
    /// Asked for under this key, and it matters.
    Matters(&'static str, String),
    /// Asked for under this key, but provably null.
    Null(&'static str, String),
}

fn decide(effect: Effect, finding: Finding, forced: &[Effect]) -> Decision {
    let (state, reason, field) = match finding {
        Finding::Absent(reason) => (State::Elided, reason.to_owned(), None),
        Finding::NotAsked(field) => (
            State::Omitted,
            format!("not asked for: the scene has no [{field}]"),
            Some(field),
        ),
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
    let absent = Finding::Absent;
    let decisions = Effect::ALL
        .into_iter()
        .map(|effect| {
            decide(
                effect,
                absent("a plot of the transfer function has no light"),
                &[],
            )
        })
        .collect();
    Plan {
        decisions,
        kernel: Kernel::Curve,
    }
}

fn classified_plan(scene: &Classified, forced: &[Effect]) -> Plan {
    use Finding::{Absent, Matters, NotAsked, Null};
    let (least, most) = scene.grid.range();
    let constant = least == most;
    let transparent = scene.transfer_function.is_transparent_up_to(most);
    let nothing = || format!("every density, up to {most}, has opacity 0");

    let finding = |effect| match effect {
        Effect::Surfaces => Absent("the classified model has no surfaces"),
        Effect::Absorption | Effect::Emission if transparent => {
            Null("transfer_function", nothing())
        }
        Effect::Absorption => Matters("transfer_function", format!("densities up to {most}")),
        Effect::Emission => Matters(
            "transfer_function",
            "the colormap sends out light".to_owned(),
        ),
        Effect::SingleScattering | Effect::MultipleScattering => {
            Absent("the classified model scatters no light; shading stands in for it")
        }
        Effect::MediumShadow => match scene.shadow {
            None => NotAsked("classified.shadow"),
            Some(_) if transparent => Null("classified.shadow", nothing()),
            Some(_) => Matters(
                "classified.shadow",
                "densities darken what lies behind".to_owned(),
            ),
        },
        Effect::SurfaceShadow => Absent("the classified model has no surfaces"),
        Effect::GradientShading => match &scene.phong {
            None => NotAsked("classified.phong"),
            Some(_) if transparent => Null("classified.phong", nothing()),
            Some(_) if constant => Null(
                "classified.phong",
                "the density is constant: its gradient is 0".to_owned(),
            ),
            Some(_) if scene.grid.lattice().nodes().iter().all(|&nodes| nodes < 3) => Null(
                "classified.phong",
                "no axis has three nodes: the stored gradient is 0".to_owned(),
            ),
            Some(phong) if is_identity(phong) => Null(
                "classified.phong",
                "ambient 1, diffuse 0 and specular 0 leave colours as they are".to_owned(),
            ),
            Some(_) => Matters("classified.phong", "the density has a gradient".to_owned()),
        },
        Effect::Heterogeneity if transparent => Null("classified.volume", nothing()),
        Effect::Heterogeneity if constant => {
            Null("classified.volume", format!("every voxel holds {most}"))
        }
        Effect::Heterogeneity => Matters(
            "classified.volume",
            format!("densities from {least} to {most}"),
        ),
        Effect::ChromaticCoefficients => Absent("opacity is the same for all colours"),
        Effect::AnisotropicPhase => Absent("the classified model has no phase function"),
    };
    let decisions: Vec<_> = Effect::ALL
        .into_iter()
        .map(|effect| decide(effect, finding(effect), forced))
        .collect();
    let on = |effect| {
        decisions
            .iter()
            .any(|decision| decision.effect == effect && decision.state == State::On)
    };

    let kernel = if !decisions.iter().any(|decision| decision.state == State::On) {
        Kernel::Background
    } else {
        let field = match scene.interpolation {
            _ if constant && !on(Effect::Heterogeneity) => FieldKind::Constant,
            Interpolation::Nearest => FieldKind::Nearest,
            Interpolation::Trilinear => FieldKind::Trilinear,
        };
        Kernel::RayCaster {
            field,
            compositing: scene.compositing,
            shading: on(Effect::GradientShading),
            shadow: on(Effect::MediumShadow),
            // Where the volume is transparent everywhere, an effect was forced: its work is
            // wanted, so nothing is skipped.
            skip_empty: !transparent && scene.transfer_function.is_transparent_up_to(least),
        }
    };
    Plan { decisions, kernel }
}

/// Whether shading returns every colour unchanged, to the bit.
fn is_identity(phong: &Phong) -> bool {
    phong.ambient == 1.0 && phong.diffuse == 0.0 && phong.specular == 0.0
}
