//! The effects that a plan decides about.

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
