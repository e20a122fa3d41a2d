//! The perceptual gate: 8-bit images that look the same.

use super::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};
use super::{Gate, Judgement};

/// Largest weighted 99th percentile of FLIP that passes.
///
/// An honest 8-bit writer may round the other way, and be off by one code anywhere. Over thirty
/// images, dark and bright, grey and coloured, the worst such image (one code more in every
/// pixel of a channel) reaches 0.060; half a pixel of shift on smooth smoke reaches 0.080.
/// `tests/flip_scale.rs` measures both sides.
pub const MOST_P99: f64 = 0.065;

/// Largest mean of FLIP that passes. The same worst honest images reach 0.057.
pub const MOST_MEAN: f64 = 0.06;

/// Judges `test` by `reference`; both of one size.
pub(super) fn judge(reference: &SrgbImage, test: &SrgbImage) -> Judgement {
    let errors = flip(reference, test, DEFAULT_PIXELS_PER_DEGREE)
        .expect("the images are of one size and the viewing distance is the default");
    let p99 = errors.weighted_percentile(99.0);
    let mean = errors.mean();
    let passed = p99 <= MOST_P99 && mean <= MOST_MEAN;
    let reason = format!(
        "FLIP: weighted 99th percentile {p99:.4} (at most {MOST_P99}), mean {mean:.4} (at most \
         {MOST_MEAN})"
    );
    let metrics = [
        ("flip_mean", mean),
        ("flip_weighted_p99", p99),
        ("flip_max", errors.max()),
    ];
    Judgement::new(Gate::Perceptual, passed, reason, &metrics)
}
