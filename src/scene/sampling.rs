//! Sampling: samples per pixel and seed, of a scene and of a rendering.

use super::format::{Key, Kind, Table, whole_number};
use super::reader::Reader;
use super::{Radiative, SceneResult};

/// Samples per pixel, at most.
const MOST_SAMPLES: u32 = 1 << 31;

/// Samples per pixel from the command line, with the limits and messages of `sampling.samples`.
pub fn samples(text: &str) -> Result<u32, String> {
    let count = whole_number("samples", text, 10, [1, MOST_SAMPLES.into()])?;
    Ok(u32::try_from(count).expect("at most MOST_SAMPLES"))
}

/// The declaration of `[sampling]`.
pub(super) const SAMPLING: Table =
    Table::new("Random numbers; for radiative scenes only.").keys(&[
        Key::or("samples", Kind::Count(1, MOST_SAMPLES as u64), "64")
            .doc("Samples per pixel; four times as many halve the noise."),
        // The largest whole number that TOML promises to hold.
        Key::or("seed", Kind::Count(0, i64::MAX as u64), "0")
            .doc("Chooses the random numbers: the same seed gives the same image."),
    ]);

/// The values of `[sampling]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct SamplingTable {
    pub samples: u32,
    pub seed: u64,
}

impl SamplingTable {
    pub(super) fn read(reader: &Reader) -> SceneResult<SamplingTable> {
        let samples = reader.count("samples")?;
        Ok(SamplingTable {
            samples: u32::try_from(samples).expect("at most MOST_SAMPLES"),
            seed: reader.count("seed")?,
        })
    }
}

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
    /// That of the scene, panel by panel.
    #[default]
    OfScene,
    /// That of the scene with this added, modulo 2⁶⁴: a replicate, independent of the scene's own
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
    pub fn samples_of(self, scene: &Radiative) -> u32 {
        self.samples.unwrap_or(scene.samples)
    }

    /// Seed of a panel.
    pub fn seed_of(self, scene: &Radiative) -> u64 {
        match self.seed {
            Seed::OfScene => scene.seed,
            Seed::Replicate(number) => scene.seed.wrapping_add(number),
            Seed::Given(seed) => seed,
        }
    }
}
