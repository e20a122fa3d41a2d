//! The perceptual gate: 8-bit images that look the same.

use super::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};
use super::gate::{Description, Gate, metrics};
use super::judgement::Judgement;

/// Largest weighted 99th percentile of FLIP that passes.
///
/// An honest 8-bit writer may round the other way, and be off by one code anywhere. Over thirty
/// images, dark and bright, grey and coloured, the worst such image (one code more in every
/// pixel of a channel) reaches 0.060; half a pixel of shift on smooth smoke reaches 0.080.
/// `tests/library/flip_scale.rs` measures both sides.
pub const MOST_P99: f64 = 0.065;

/// Largest mean of FLIP that passes. The same worst honest images reach 0.057.
pub const MOST_MEAN: f64 = 0.06;

pub(super) const DESCRIPTION: Description = Description {
    name: "perceptual",
    rule: "The image is 8-bit, so only visible differences count: FLIP ranges from 0 (identical) to 1 \
         (maximally different).",
    metrics: &metrics! {
        "flip_mean" => "Mean of FLIP; passes up to 0.06.";
        "flip_weighted_p99" => "Weighted 99th percentile of FLIP; passes up to 0.065.";
        "flip_max" => "FLIP of the worst pixel.";
    },
    default_for: Some("a pair with a .png"),
};

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_metrics_say_the_limits() {
        let [mean, p99] = [0, 1].map(|index: usize| DESCRIPTION.metrics[index].1);
        assert!(mean.contains(&format!("passes up to {MOST_MEAN}.")));
        assert!(p99.contains(&format!("passes up to {MOST_P99}.")));
    }
}
