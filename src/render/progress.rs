//! Progress of a rendering, reported to whoever waits for it.

use std::time::Duration;

/// An observer of a rendering, called from any thread. A closure is called at every step.
pub trait Watch: Sync {
    /// An image begins that takes this many steps: one for each pixel, and one for every
    /// 1024 samples within it. Where it ends early, fewer are taken.
    fn begin(&self, _steps: u64) {}

    /// A step is done.
    fn step(&self);

    /// Time that may be spent, at each panel, on a [`Forecast`]; without, none is made.
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
pub type Progress<'p> = &'p dyn Watch;

/// Time that a panel will take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Seconds, on all threads together.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
    /// Pixels of the panel.
    pub pixels: u64,
    /// Samples of each; 1 where it is not sampled.
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
