//! Progress reports of a rendering.

/// An observer of a rendering, called from any thread. A closure is called at every step.
pub trait Watch: Sync {
    /// An image of this many steps begins: one for each pixel, and one for every 1024 samples
    /// within it. A rendering that stops early takes fewer.
    fn begin(&self, _steps: u64) {}

    /// A step is done.
    fn step(&self);
}

impl<F: Fn() + Sync> Watch for F {
    fn step(&self) {
        self();
    }
}

/// The observer of a rendering.
pub(crate) type Progress<'p> = &'p dyn Watch;

/// Samples of a pixel that count as a step: a millisecond where a path takes a microsecond.
pub(super) const SAMPLES_A_STEP: u32 = 1024;

/// The steps of `pixels` with `samples` each.
pub(super) fn steps_of(pixels: u64, samples: u32) -> u64 {
    pixels * u64::from(1 + samples / SAMPLES_A_STEP)
}
