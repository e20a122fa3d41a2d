//! Sampling: samples per pixel and seed.

use super::SceneResult;
use super::format::{Key, Kind, Table, whole_number};
use super::reader::Reader;

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
