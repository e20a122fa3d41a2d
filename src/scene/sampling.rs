//! How much chance a picture takes.

use super::SceneError;
use super::format::{Absent, Key, Kind, Literal, Table};
use super::reader::Reader;

/// The declaration of `[sampling]`.
pub(super) const SAMPLING: Table = Table {
    doc: "Random numbers; for radiative scenes only.",
    keys: &[
        Key {
            name: "samples",
            kind: Kind::Count(1, 1 << 31),
            absent: Absent::Default(Literal::Count(64)),
            doc: "Samples per pixel; four times as many halve the noise.",
        },
        Key {
            name: "seed",
            // The largest whole number that TOML promises to hold.
            kind: Kind::Count(0, i64::MAX as u64),
            absent: Absent::Default(Literal::Count(0)),
            doc: "Chooses the random numbers: the same seed gives the same image.",
        },
    ],
    rules: &[],
};

/// What `[sampling]` says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampling {
    pub samples: u32,
    pub seed: u64,
}

impl Sampling {
    pub(super) fn read(reader: &Reader<'_, '_>) -> Result<Sampling, Box<SceneError>> {
        let samples = reader.count("samples")?;
        Ok(Sampling {
            samples: u32::try_from(samples).expect("at most 2^31 by declaration"),
            seed: reader.count("seed")?,
        })
    }
}
