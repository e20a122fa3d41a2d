//! Only the effects that a scene calls for are simulated.
//!
//! What is off does no work, in every scene of the suite ([`suite`]) and in every scene that can be put
//! together from effects ([`subsets`]); the code compiled for some effects gives the same bits as the
//! code for all. How much work is left is known beforehand ([`closed_forms`]), and an effect fades in
//! ([`continuity`]): there is no threshold below which it is taken for nothing.

mod closed_forms;
mod continuity;
pub mod scenes;
mod subsets;
mod suite;

use volref::render::{Effect, Event};

/// The effects that do such work: none of it is done where none of them is simulated.
fn effects_of(event: Event) -> &'static [Effect] {
    match event {
        Event::DensityLookup => &[Effect::Heterogeneity],
        Event::GradientLookup => &[Effect::GradientShading],
        Event::GradientComputed => &[Effect::GradientShading],
        Event::CellWalked => &[Effect::Heterogeneity],
        Event::ShadowRay => &[Effect::MediumShadow, Effect::SurfaceShadow],
        Event::PhaseEvaluation => &[Effect::AnisotropicPhase],
        Event::NullCollision => &[Effect::Heterogeneity],
        Event::SurfaceTest => &[Effect::Surfaces],
        Event::RandomDraw => &[
            Effect::SingleScattering,
            Effect::MultipleScattering,
            Effect::Heterogeneity,
        ],
        Event::Attenuation => &[
            Effect::Absorption,
            Effect::Emission,
            Effect::SingleScattering,
            Effect::MultipleScattering,
            Effect::MediumShadow,
        ],
        Event::ChannelAttenuation => &[Effect::ChromaticCoefficients],
        Event::EmissionTerm => &[Effect::Emission],
        Event::FirstScattering => &[Effect::SingleScattering],
        Event::FurtherScattering => &[Effect::MultipleScattering],
    }
}
