//! The effects that a plan decides about.

use serde::Serialize;
use std::fmt;

/// Declares [`Effect`], each with its name.
macro_rules! effects {
    ($($(#[$doc:meta])* $effect:ident = $name:literal,)+) => {
        /// An effect of light transport or of classified shading.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Effect { $($(#[$doc])* $effect,)+ }

        impl Effect {
            /// All effects, in the order in which plans list them.
            pub const ALL: [Effect; [$($name),+].len()] = [$(Effect::$effect),+];

            /// The name used on the command line and in JSON.
            pub fn name(self) -> &'static str {
                match self { $(Effect::$effect => $name,)+ }
            }
        }
    };
}

effects! {
    /// Surfaces around or inside the volume.
    Surfaces = "surfaces",
    /// Absorption by the volume.
    Absorption = "absorption",
    /// Emission by the volume.
    Emission = "emission",
    /// Light scattered or reflected once between its source and the eye.
    SingleScattering = "single-scattering",
    /// Light scattered or reflected more than once.
    MultipleScattering = "multiple-scattering",
    /// Attenuation by the volume between a light and a point.
    MediumShadow = "medium-shadow",
    /// Occlusion by a surface between a light and a point.
    SurfaceShadow = "surface-shadow",
    /// Shading by the gradient of the field.
    GradientShading = "gradient-shading",
    /// A heterogeneous density or field.
    Heterogeneity = "heterogeneity",
    /// Coefficients that differ between red, green and blue.
    ChromaticCoefficients = "chromatic-coefficients",
    /// An anisotropic phase function.
    AnisotropicPhase = "anisotropic-phase",
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
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
