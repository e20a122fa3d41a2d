//! Counting work, compiled in only when asked for.

use super::plan::Effect;
use serde::Serialize;

/// Units of work a kernel can count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Density of a field at a point.
    DensityLookup,
    /// Stored gradient at a point.
    GradientLookup,
    /// Gradient of a node, computed to be stored.
    GradientComputed,
    /// A cell or block of a grid asked whether it is empty.
    CellWalked,
    /// A ray towards a light, to see how much of it arrives.
    ShadowRay,
    /// Value of a phase function that prefers a direction.
    PhaseEvaluation,
    /// A tentative collision of a flight with no matter.
    NullCollision,
    /// A ray tested against a surface.
    SurfaceTest,
    /// A random number.
    RandomDraw,
    /// What a stretch of matter lets through: an exponential, or a power of a transparency.
    Attenuation,
    /// The same for a second and third channel of colour.
    ChannelAttenuation,
    /// What a place or stretch of matter sends out.
    EmissionTerm,
    /// Light turned for the first time on its way from the eye.
    FirstTurn,
    /// Light turned once more.
    FurtherTurn,
}

impl Event {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Event; 14] = [
        Event::DensityLookup,
        Event::GradientLookup,
        Event::GradientComputed,
        Event::CellWalked,
        Event::ShadowRay,
        Event::PhaseEvaluation,
        Event::NullCollision,
        Event::SurfaceTest,
        Event::RandomDraw,
        Event::Attenuation,
        Event::ChannelAttenuation,
        Event::EmissionTerm,
        Event::FirstTurn,
        Event::FurtherTurn,
    ];

    /// The name of its counter in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Event::DensityLookup => "density_lookups",
            Event::GradientLookup => "gradient_lookups",
            Event::GradientComputed => "gradients_computed",
            Event::CellWalked => "cells_walked",
            Event::ShadowRay => "shadow_rays",
            Event::PhaseEvaluation => "phase_evaluations",
            Event::NullCollision => "null_collisions",
            Event::SurfaceTest => "surface_tests",
            Event::RandomDraw => "random_draws",
            Event::Attenuation => "attenuations",
            Event::ChannelAttenuation => "channel_attenuations",
            Event::EmissionTerm => "emission_terms",
            Event::FirstTurn => "first_turns",
            Event::FurtherTurn => "further_turns",
        }
    }

    /// The effects that do this work: where none of them is simulated, it is done not once.
    pub fn effects(self) -> &'static [Effect] {
        use Effect::*;
        match self {
            Event::DensityLookup | Event::CellWalked | Event::NullCollision => &[Heterogeneity],
            Event::GradientLookup | Event::GradientComputed => &[GradientShading],
            Event::ShadowRay => &[MediumShadow, SurfaceShadow],
            Event::PhaseEvaluation => &[AnisotropicPhase],
            Event::SurfaceTest => &[Surfaces],
            // Noise that only absorbs is tracked too.
            Event::RandomDraw => &[SingleScattering, MultipleScattering, Heterogeneity],
            // Extinction is absorption and scattering together.
            Event::Attenuation => &[
                Absorption,
                Emission,
                SingleScattering,
                MultipleScattering,
                MediumShadow,
            ],
            Event::ChannelAttenuation => &[ChromaticCoefficients],
            Event::EmissionTerm => &[Emission],
            Event::FirstTurn => &[SingleScattering],
            Event::FurtherTurn => &[MultipleScattering],
        }
    }
}

/// Something that is told of every unit of work. Kernels are compiled once for each
/// implementation: told to [`Uncounted`], they count nothing and spend nothing on it.
pub trait Work: Clone + Default + Send {
    /// That many units of work were done.
    fn count_times(&mut self, event: Event, times: u64);

    /// One unit of work was done.
    fn count(&mut self, event: Event) {
        self.count_times(event, 1);
    }

    /// The numbers of another row of pixels.
    fn add(&mut self, other: &Self);
}

/// No counting.
#[derive(Clone, Copy, Debug, Default)]
pub struct Uncounted;

impl Work for Uncounted {
    fn count_times(&mut self, _: Event, _: u64) {}
    fn add(&mut self, _: &Self) {}
}

/// How often each unit of work was done. The same on every run, for any number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counters {
    /// Densities looked up in a grid, shadow rays included.
    pub density_lookups: u64,
    /// Gradients looked up in a grid.
    pub gradient_lookups: u64,
    /// Gradients computed for the nodes of a grid.
    pub gradients_computed: u64,
    /// Blocks of a grid asked whether they are empty.
    pub cells_walked: u64,
    /// Rays towards a light, to see how much of it arrives.
    pub shadow_rays: u64,
    /// Values of a phase function that prefers a direction.
    pub phase_evaluations: u64,
    /// Collisions of a tracking method with no matter.
    pub null_collisions: u64,
    /// Rays tested against a surface.
    pub surface_tests: u64,
    /// Random numbers drawn.
    pub random_draws: u64,
    /// What stretches of matter let through, in one channel.
    pub attenuations: u64,
    /// The same for the second and third channel.
    pub channel_attenuations: u64,
    /// What places and stretches of matter send out.
    pub emission_terms: u64,
    /// Light turned for the first time on its way from the eye.
    pub first_turns: u64,
    /// Light turned once more.
    pub further_turns: u64,
}

impl Counters {
    /// How often `event` was counted.
    pub fn of(&self, event: Event) -> u64 {
        let mut counters = *self;
        *counters.counter(event)
    }

    fn counter(&mut self, event: Event) -> &mut u64 {
        match event {
            Event::DensityLookup => &mut self.density_lookups,
            Event::GradientLookup => &mut self.gradient_lookups,
            Event::GradientComputed => &mut self.gradients_computed,
            Event::CellWalked => &mut self.cells_walked,
            Event::ShadowRay => &mut self.shadow_rays,
            Event::PhaseEvaluation => &mut self.phase_evaluations,
            Event::NullCollision => &mut self.null_collisions,
            Event::SurfaceTest => &mut self.surface_tests,
            Event::RandomDraw => &mut self.random_draws,
            Event::Attenuation => &mut self.attenuations,
            Event::ChannelAttenuation => &mut self.channel_attenuations,
            Event::EmissionTerm => &mut self.emission_terms,
            Event::FirstTurn => &mut self.first_turns,
            Event::FurtherTurn => &mut self.further_turns,
        }
    }
}

impl Work for Counters {
    fn count_times(&mut self, event: Event, times: u64) {
        *self.counter(event) += times;
    }

    fn add(&mut self, other: &Counters) {
        for event in Event::ALL {
            *self.counter(event) += other.of(event);
        }
    }
}
