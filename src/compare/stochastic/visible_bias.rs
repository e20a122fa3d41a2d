//! The smallest visible bias in words: what two images that agree within noise do not exclude.

use super::super::advice::Undecided;
use super::super::judgement::Detectable;
use super::super::promise::Promise;
use super::percent;

/// Smallest bias that shows beyond the noise of two images.
pub(super) struct VisibleBias {
    /// Detectable bias of the mean of the image, relative.
    pub of_mean: f64,
    /// Detectable bias of single blocks, relative: the 90th percentile.
    pub of_blocks: f64,
    /// Deviation of the worst block, in words.
    pub noise: String,
}

impl VisibleBias {
    /// Sentence for two images that agree; `number` is that of the scene which matters most.
    pub fn in_words(&self, number: Option<&Detectable>) -> String {
        let of_number = number.map_or(String::new(), |it| format!("{}, ", it.words));
        format!(
            "no difference beyond noise; detectable bias {of_number}{} for the image mean, {} within \
             single blocks (90th percentile); {}",
            percent(self.of_mean),
            percent(self.of_blocks),
            self.noise
        )
    }

    /// Sentence for a bias that is larger than `required` for the mean and for blocks.
    pub fn too_large(&self, advice: &Undecided, required: [f64; 2], promise: &Promise) -> String {
        let [of_mean, of_block] = required;
        let why = if required == [promise.mean, promise.block.unwrap_or(f64::INFINITY)] {
            ""
        } else {
            " (less than usual, for the noise of the reference hides a quarter of it)"
        };
        let of_block = if of_block.is_finite() {
            let [seen, required] = [self.of_blocks, of_block].map(percent);
            format!("; of single blocks (90th percentile) {seen}, required {required}")
        } else {
            String::new()
        };
        format!(
            "too noisy to decide: detectable bias of the mean {}, required {}{of_block}{why}; {advice}; no \
             difference beyond noise: {}",
            percent(self.of_mean),
            percent(of_mean),
            self.noise
        )
    }
}
