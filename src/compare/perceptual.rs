//! The perceptual gate: 8-bit images that look the same.

use super::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};
use super::gate::{Gate, Metric, metrics};
use super::image_gate::{Conditions, ImageGate};
use super::judgement::Judgement;
use super::picture::{Picture, PictureError};

/// Largest weighted 99th percentile of FLIP that passes.
///
/// An honest 8-bit writer may round the other way, and be off by one code anywhere. Over thirty
/// images, dark and bright, grey and coloured, the worst such image (one code more in every
/// pixel of a channel) reaches 0.060; half a pixel of shift on smooth smoke reaches 0.080.
/// `tests/library/flip_scale.rs` measures both sides.
pub const MOST_P99: f64 = 0.065;

/// Largest mean of FLIP that passes. The same worst honest images reach 0.057.
pub const MOST_MEAN: f64 = 0.06;

/// 8-bit images that look the same.
#[derive(Clone, Copy, Debug)]
pub struct Perceptual;

impl Gate for Perceptual {
    fn name(&self) -> &'static str {
        "perceptual"
    }

    fn rule(&self) -> &'static str {
        "The image is 8-bit, so only visible differences count: FLIP ranges from 0 (identical) to 1 \
         (maximally different)."
    }

    fn metrics(&self) -> &'static [Metric] {
        &metrics! {
            "flip_mean" => "Mean of FLIP; passes up to 0.06.";
            "flip_weighted_p99" => "Weighted 99th percentile of FLIP; passes up to 0.065.";
            "flip_max" => "FLIP of the worst pixel.";
        }
    }
}

impl ImageGate for Perceptual {
    fn judge(
        &self,
        reference: &Picture,
        test: &Picture,
        conditions: &Conditions<'_>,
    ) -> Result<Judgement, PictureError> {
        let [reference, test] = [reference, test].map(|image| image.srgb(conditions.exposure));
        Ok(judge(&reference?, &test?))
    }

    fn default_for(&self) -> Option<&'static str> {
        Some("a pair with a .png")
    }

    fn default_reason(&self, reference: &Picture, test: &Picture) -> Option<&'static str> {
        let codes = |picture: &Picture| matches!(picture, Picture::Codes(_));
        (codes(reference) || codes(test)).then_some("")
    }

    fn depends_on_exposure(&self) -> bool {
        true
    }
}

/// Judges `test` by `reference`; both of one size.
fn judge(reference: &SrgbImage, test: &SrgbImage) -> Judgement {
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
    Judgement::new(&Perceptual, passed, reason, &metrics)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_metrics_say_the_limits() {
        let [mean, p99] = [0, 1].map(|index: usize| Perceptual.metrics()[index].1);
        assert!(mean.contains(&format!("passes up to {MOST_MEAN}.")));
        assert!(p99.contains(&format!("passes up to {MOST_P99}.")));
    }
}
