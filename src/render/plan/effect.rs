//! The effects that a plan decides about.

use serde::Serialize;
use std::fmt;
use std::str::FromStr;

/// An effect of light transport or of classified shading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Effect {
    /// Surfaces around or inside the volume.
    Surfaces,
    /// Absorption by the volume.
    Absorption,
    /// Emission by the volume.
    Emission,
    /// Light scattered or reflected once between its source and the eye.
    SingleScattering,
    /// Light scattered or reflected more than once.
    MultipleScattering,
    /// Attenuation by the volume between a light and a point.
    MediumShadow,
    /// Occlusion by a surface between a light and a point.
    SurfaceShadow,
    /// Shading by the gradient of the field.
    GradientShading,
    /// A heterogeneous density or field.
    Heterogeneity,
    /// Coefficients that differ between red, green and blue.
    ChromaticCoefficients,
    /// An anisotropic phase function.
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
