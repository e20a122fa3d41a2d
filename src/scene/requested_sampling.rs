//! Samples per pixel and random numbers of a rendering.

use super::Radiative;

/// Samples per pixel and random numbers of a rendering; by default those of the scene. No effect on
/// panels that are not sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sampling {
    /// Samples per pixel, at least 1, in place of those of the scene.
    pub samples: Option<u32>,
    /// Seed of the random numbers.
    pub seed: Seed,
}

/// Seed of the random numbers of a rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Seed {
    /// The seed of the scene, panel by panel.
    #[default]
    OfScene,
    /// The seed of the scene with this added, modulo 2⁶⁴: a replicate, independent of the scene's own
    /// rendering.
    Replicate(u64),
    /// The same for all panels.
    Given(u64),
}

impl Sampling {
    /// `samples` per pixel, with the random numbers of the scene.
    pub fn of_samples(samples: u32) -> Sampling {
        Sampling {
            samples: Some(samples),
            seed: Seed::OfScene,
        }
    }

    /// Samples per pixel of a panel.
    pub(crate) fn samples_of(self, scene: &Radiative) -> u32 {
        self.samples.unwrap_or(scene.samples)
    }

    /// Seed of the random numbers of a panel with this `scene`.
    pub(crate) fn seed_of(self, scene: &Radiative) -> u64 {
        match self.seed {
            Seed::OfScene => scene.seed,
            Seed::Replicate(number) => scene.seed.wrapping_add(number),
            Seed::Given(seed) => seed,
        }
    }
}
