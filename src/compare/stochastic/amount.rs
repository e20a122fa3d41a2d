//! Chi-square test of the amount of noise: squared differences against stated variances.

use super::super::significance::chi_square_two_sided;
use super::blocks::{Block, Channel};
use super::comparison::Comparison;
use super::{Metrics, finite};

/// Factor by which the noise may be larger or smaller than stated, however unlikely: variances are
/// themselves estimates, and their ratio to the squares is not quite chi-square where channels
/// share their noise or samples are far from normal.
const AMOUNT: f64 = 2.0;

/// Fewest samples with which too much noise is tested for: light that arrives in fewer samples than
/// one in so many makes pixels differ by more than they know. Too little noise has no such excuse:
/// an event that is not seen raises no variance.
const ENOUGH: u32 = 64;

/// Variance of a pixel over the square of its rounding, below which rounding hides too much of it: what
/// is left of normal squares at four times the rounding is 0.66 of them, more than a half.
const HIDDEN: f64 = 16.0;

/// Mean over blocks and channels of their squares over their variance, and the number of pixels and
/// channels in it.
fn mean_ratio(blocks: &[Block], ratio: impl Fn(&Channel) -> (f64, f64)) -> Option<(f64, f64)> {
    let (mut sum, mut count) = (0.0, 0.0);
    for block in blocks {
        for channel in &block.channels {
            let (squares, variance) = ratio(channel);
            // A wild sample that 8 bits cut off holds most of both.
            let hidden = HIDDEN * channel.difference.rounding_squares;
            if variance > hidden && squares.is_finite() {
                sum += squares / variance * block.pixels() as f64;
                count += block.pixels() as f64;
            }
        }
    }
    (count > 0.0).then(|| (finite(sum / count), count))
}

/// Probability of an `amount` as far from 1: chi-square of `count` values over that number, where
/// the channels of a pixel may share their noise, as if there were a third of them.
fn probability(amount: f64, count: f64) -> f64 {
    chi_square_two_sided(amount * count / 3.0, count / 3.0)
}

pub(super) fn judge_amount(
    comparison: &Comparison<'_>,
    level: f64,
    metrics: &mut Metrics,
) -> Option<String> {
    let blocks = &comparison.blocks;
    let [Some(a), Some(b)] = comparison.numbers() else {
        return None;
    };
    let stated = |channel: &Channel| (channel.squares, channel.stated[0] + channel.stated[1]);
    let (amount, count) = mean_ratio(blocks, stated)?;
    metrics.push(("amount_of_noise", amount));
    metrics.push(("chi_square_probability", probability(amount, count)));
    if amount < 1.0 / AMOUNT && probability(amount, count) <= level {
        return Some(format!(
            "too little noise: differences of {amount:.2} times the variance that the images state; possible causes: \
             common random numbers, smoothing or denoising, a variance overstated for stratified samples"
        ));
    }
    let guarded = |channel: &Channel| (channel.squares, channel.variance.largest());
    let (amount, count) = mean_ratio(blocks, guarded)?;
    (a.min(b) >= ENOUGH && amount > AMOUNT && probability(amount, count) <= level).then(|| {
        format!(
            "squared differences are {amount:.2} times the variance given in the images, more than such noise \
             makes"
        )
    })
}
