//! Sampling: samples per pixel and seed.

use super::format::whole_number;

/// Samples per pixel, at most.
const MOST_SAMPLES: u32 = 1 << 31;

/// Samples per pixel from the command line, with the limits and messages of `sampling.samples`.
pub fn samples(text: &str) -> Result<u32, String> {
    let count = whole_number("samples", text, 10, [1, MOST_SAMPLES.into()])?;
    Ok(u32::try_from(count).expect("at most MOST_SAMPLES"))
}

record! {
    #[derive(Clone, Copy, Debug)]
    pub(super) struct SamplingTable in "Random numbers; for radiative scenes only." {
        samples: u32 = or("64") Count(1, MOST_SAMPLES as u64),
            "Samples per pixel; four times as many halve the noise.";
        // The largest whole number that TOML promises to hold.
        seed: u64 = or("0") Count(0, i64::MAX as u64),
            "Chooses the random numbers: the same seed gives the same image.";
    }
}
