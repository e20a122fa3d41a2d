//! Biases that a passing image must have been able to show.

/// Smallest promised bias, in units of the bias that the noise of the reference hides from any image. An image with a
/// fifteenth of the reference's samples keeps the promise, if all samples are alike: variances add up, and 1 + 15 = 4².
const TIMES_HIDDEN: f64 = 4.0;

/// Biases that an image which passes would have shown with probability one half, relative to the radiance plus
/// [`DARK`](super::stochastic::DARK).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promise {
    /// Bias of the mean of the image.
    pub mean: f64,
    /// Largest bias of the mean, where the noise of the reference makes it more than `mean`.
    pub mean_at_most: f64,
    /// Bias of nine tenths of the blocks of 8 × 8 pixels, or more where the noise of the reference
    /// hides that; `None` for any bias of a block.
    pub block: Option<f64>,
}

impl Promise {
    /// Promise of a bias of the mean of the image, whatever the noise of the reference.
    pub fn of_mean(bias: f64) -> Promise {
        Promise {
            mean: bias,
            mean_at_most: bias,
            block: None,
        }
    }

    /// The promise where more samples are to be had, unless the reference is too noisy for that: a quarter of the
    /// bias of the mean, and as much of blocks. For 2 % this is 0.5 % of the mean and 2 % of a block.
    pub fn decisive(self) -> Promise {
        Promise {
            mean: self.mean / 4.0,
            ..self
        }
        .with_blocks()
    }

    /// This promise with a bias of blocks that is four times that of the mean.
    pub(crate) fn with_blocks(self) -> Promise {
        Promise {
            block: Some(4.0 * self.mean),
            ..self
        }
    }

    /// Biases of the mean and of blocks that have to be visible where the noise of the reference alone hides
    /// those `[of_mean, of_block]`.
    pub(super) fn required(&self, [of_mean, of_block]: [f64; 2]) -> [f64; 2] {
        let mean = (TIMES_HIDDEN * of_mean).min(self.mean_at_most);
        let block = self
            .block
            .map_or(f64::INFINITY, |block| block.max(TIMES_HIDDEN * of_block));
        [mean.max(self.mean), block]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_with_noise_are_asked_for_less() {
        let plain = Promise::of_mean(0.02);
        assert_eq!(plain.required([0.01, 0.1]), [0.02, f64::INFINITY]);
        assert_eq!(plain.required([0.03, 0.1]), [0.02, f64::INFINITY]);

        let decisive = plain.decisive();
        assert_eq!(decisive.required([0.0, 0.0]), [0.005, 0.02]);
        assert_eq!(decisive.required([0.003, 0.01]), [4.0 * 0.003, 4.0 * 0.01]);
        // No more than the case itself does.
        assert_eq!(decisive.required([0.01, 0.0])[0], 0.02);
        let less = Promise::of_mean(0.05).decisive();
        assert_eq!((less.mean, less.block), (0.0125, Some(0.05)));
    }
}
