//! Progress reports of a rendering.

use std::time::Duration;

/// An observer of a rendering, called from any thread. A closure is called at every step.
pub trait Watch: Sync {
    /// An image of this many steps begins: one for each pixel, and one for every 1024 samples
    /// within it. A rendering that stops early takes fewer.
    fn begin(&self, _steps: u64) {}

    /// A step is done.
    fn step(&self);

    /// Time limit for a [`Forecast`] of each panel; `None` for no forecast.
    fn may_measure(&self) -> Option<Duration> {
        None
    }

    /// The forecast of a panel.
    fn measured(&self, _forecast: &Forecast) {}
}

impl<F: Fn() + Sync> Watch for F {
    fn step(&self) {
        self();
    }
}

/// The observer of a rendering.
pub(crate) type Progress<'p> = &'p dyn Watch;

/// Forecast of the time of a panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Seconds, on all threads together.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
    /// Pixels of the panel.
    pub pixels: u64,
    /// Samples per pixel; 1 if the image is not sampled.
    pub samples: u32,
}

impl Forecast {
    /// The steps of the panel that a [`Watch`] is called for.
    pub fn steps(&self) -> u64 {
        steps_of(self.pixels, self.samples)
    }
}

/// Samples of a pixel that count as a step: a millisecond where a path takes a microsecond.
pub(super) const SAMPLES_A_STEP: u32 = 1024;

/// The steps of `pixels` with `samples` each.
pub(super) fn steps_of(pixels: u64, samples: u32) -> u64 {
    pixels * u64::from(1 + samples / SAMPLES_A_STEP)
}
