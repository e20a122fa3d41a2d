//! The stochastic gate: means of random samples, whose noise is known.
//!
//! Both images estimate the same radiance, so their difference is noise around zero, of a
//! variance that the images state. Seven questions, each with its share of the false alarms:
//!
//! - *The image*: is the mean of a channel too bright or too dark?
//! - *Blocks* of 8 × 8 pixels: is any of them, in any channel? A block has an eighth of the noise
//!   of a pixel and is nearer to normal. Holm's procedure pays for asking often.
//! - *Pixels*: do too many lie beyond five standard errors? By Chebyshev's inequality a pixel
//!   does with probability 1/25 at most, whatever the shape of its noise. This finds
//!   differences that cancel within blocks.
//! - *Pixels without noise*: where all samples of both images are equal, so must be the pixels,
//!   to a rounding. If all a samples of one are x and all b of the other y ≠ x, that had a
//!   probability of `p^a · (1 − p)^b` at most, which is largest at p = a/(a + b).
//! - *Copies*: more than half of the pixels that have noise are the same bit for bit.
//! - *The amount of noise*: the squares of the differences should sum to the variances, block by
//!   block (chi-square). Half as much is suspicious too: as if the images shared random numbers,
//!   or one had been smoothed. Too much is looked for from 64 samples a pixel on.
//! - *Neighbours*: are they off together? See the file `neighbours.rs`.
//!
//! # Whose variance
//!
//! From few samples a variance is not only imprecise: where light arrives rarely, a block that
//! missed it is too dark *and* says it has no noise. So a variance has two answers, and a
//! difference must be unlikely by both:
//!
//! - its *own*: the sum of what both images state. A block that is too bright by some rare
//!   events states them too, k events make it √k standard errors at most. With few samples it is
//!   itself random, so that Student's t judges, with a degree of freedom less than samples for
//!   each pixel.
//! - its *guard*: the finer image, that of more samples, has seen what is rare, and says how the
//!   noise is spread over the image. The noise of the coarser image is taken to be like it, times
//!   the ratio of samples, or times the ratio of the noise of both images on the whole where that
//!   is larger. This makes the gate blinder to an image of less noise per sample, never stricter.
//!
//! Where only one image states its noise, the own variance of a block is taken from the spread of
//! its differences, with a degree of freedom less than pixels. The ratio for the guard follows
//! from all blocks; it is the largest that these could have come from, and what that may fail to
//! cover has its own share of the false alarms. A difference that varies within a block then
//! counts as noise, and the questions about single pixels are not asked, except for copies.
//!
//! # Limits
//!
//! The sums over a block are taken for normal, at least in the lower tail, and what the finer
//! image has not seen, no variance knows. This asks of both images:
//!
//! - What makes noise in the test image must make some in the reference, too, in the same
//!   proportions: a renderer that finds a lamp by chance, judged by one that aims at it, is
//!   believed on the whole, not in each shadow.
//! - Where the test image states no variance, noise of events of which fewer than about 25 are
//!   expected in the whole image may be missing altogether (e^−22 is a share of the false
//!   alarms), and then cannot be estimated from it.
//!
//! Such images need more samples, not a wider gate.

mod amount;
mod blocks;
mod map;
mod neighbours;
mod pixels;
mod resolution;
mod variance;

pub use blocks::{BLOCK, DARK};
pub use map::{BlockMap, block_error, block_map};
pub use resolution::Undecided;

use super::significance::{deviation, holm, two_sided, two_sided_estimated};
use super::{Gate, Judgement, PictureError};
use crate::film::Film;
use amount::judge_amount;
use blocks::{Block, Channel, Comparison};
use neighbours::judge_neighbours;
use pixels::Pixels;
use resolution::Limits;

/// Probability that any case of a suite is rejected although nothing is wrong with it.
pub const FALSE_ALARM: f64 = 1e-6;

/// Shares into which the false alarms are divided: one for each question, and one for noise that
/// was underestimated.
const SHARES: f64 = 8.0;

/// What is printed of a deviation without bound: numbers of a judgement are finite.
const BOUNDLESS: f64 = 1e9;

/// Judges `test` by `reference`, one of `cases` comparisons that raise a false alarm with
/// probability [`FALSE_ALARM`] together. At least one must state its noise.
pub fn judge(reference: &Film, test: &Film, cases: usize) -> Result<Judgement, PictureError> {
    judge_at(reference, test, FALSE_ALARM / cases.max(1) as f64)
}

/// [`judge`] for a case that promises to see a bias of `promise` of the mean of the image plus
/// [`DARK`]. A pass that could not have seen it says so in [`Judgement::undecided`].
pub fn judge_case(
    reference: &Film,
    test: &Film,
    cases: usize,
    promise: f64,
) -> Result<Judgement, PictureError> {
    judge_with(
        reference,
        test,
        FALSE_ALARM / cases.max(1) as f64,
        Some(promise),
    )
}

/// [`judge`], with the probability of a false alarm of this one comparison.
pub fn judge_at(reference: &Film, test: &Film, level: f64) -> Result<Judgement, PictureError> {
    judge_with(reference, test, level, None)
}

fn judge_with(
    reference: &Film,
    test: &Film,
    level: f64,
    promise: Option<f64>,
) -> Result<Judgement, PictureError> {
    if reference.noise().is_none() && test.noise().is_none() {
        return Err(PictureError::NeedsNoise);
    }
    if let Some(different) = super::incomparable_films(Gate::Stochastic, reference, test) {
        return Ok(different);
    }
    let share = level / SHARES;
    let comparison = Comparison::new(reference, test, share);
    Ok(judgement(&comparison, share, promise))
}

type Metrics = Vec<(&'static str, f64)>;

/// Answers the questions, each at `level`.
fn judgement(comparison: &Comparison<'_>, level: f64, promise: Option<f64>) -> Judgement {
    let mut metrics = Metrics::new();
    let limits = Limits::new(comparison, level);
    let resolution = limits.resolution(1.0);
    let mean_resolution = limits.mean_resolution(1.0);
    metrics.push(("smallest_visible_bias", mean_resolution));
    metrics.push(("smallest_visible_block_bias", resolution));

    let mut faults = Vec::new();
    faults.extend(judge_whole(comparison, level, &mut metrics));
    let worst = Worst::new(comparison);
    faults.extend(worst.judge(level, &mut metrics));
    let pixels = Pixels::new(comparison);
    if let [Some(a), Some(b)] = comparison.samples() {
        faults.extend(pixels.judge_far(level, &mut metrics));
        faults.extend(pixels.judge_contrary([a, b], level, &mut metrics));
    }
    let copied = pixels.judge_copied(level, &mut metrics);
    // A copy has too little noise, which goes without saying.
    let amount = judge_amount(comparison, level, &mut metrics).filter(|_| copied.is_none());
    faults.extend(copied);
    faults.extend(amount);
    faults.extend(judge_neighbours(comparison, level, &mut metrics));

    let passed = faults.is_empty();
    let mut reason = if passed {
        format!(
            "the differences are noise; the worst of {} blocks and channels is off by {:.1} \
             standard errors; a bias of {:.2} % of the mean, or of {:.2} % of a block, would have \
             been seen",
            comparison.asked(),
            finite(worst.deviation().abs()),
            100.0 * mean_resolution,
            100.0 * resolution
        )
    } else {
        faults.join("; ")
    };
    let undecided = promise
        .filter(|_| passed)
        .and_then(|promise| limits.undecided(promise));
    if let (Some(undecided), Some(promise)) = (undecided, promise) {
        reason.push_str(&format!(
            ", not the {:.2} % of the mean that the case promises; {undecided}",
            100.0 * promise
        ));
    }
    Judgement {
        resolution: Some(resolution),
        mean_resolution: Some(mean_resolution),
        undecided,
        ..Judgement::new(Gate::Stochastic, passed, reason, &metrics)
    }
}

fn colour(channel: usize) -> &'static str {
    ["red", "green", "blue"][channel]
}

fn side(difference: f64) -> &'static str {
    if difference > 0.0 { "bright" } else { "dark" }
}

fn judge_whole(comparison: &Comparison<'_>, level: f64, metrics: &mut Metrics) -> Option<String> {
    let totals = comparison.totals();
    let pixels: usize = comparison.blocks.iter().map(Block::pixels).sum();
    let mean = |c: usize| totals[c].difference.value / pixels as f64;
    let deviations = totals.map(|total| comparison.deviation(&total));
    let names = [
        ("mean_difference_red", "mean_z_red"),
        ("mean_difference_green", "mean_z_green"),
        ("mean_difference_blue", "mean_z_blue"),
    ];
    for (c, (difference, z)) in names.into_iter().enumerate() {
        metrics.push((difference, mean(c)));
        metrics.push((z, finite(deviations[c])));
    }
    let probabilities = deviations.map(two_sided);
    let c = (0..3)
        .min_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]))
        .expect("three channels");
    (holm(&probabilities, level) > 0).then(|| {
        format!(
            "{} is too {} on the whole: its mean is off by {:.3e}, {}",
            colour(c),
            side(mean(c)),
            mean(c),
            standard_errors(deviations[c]),
        )
    })
}

/// The most unlikely of the blocks and channels.
struct Worst<'c> {
    block: &'c Block,
    channel: usize,
    /// Of all blocks and channels.
    probabilities: Vec<f64>,
}

impl<'c> Worst<'c> {
    fn new(comparison: &'c Comparison<'c>) -> Worst<'c> {
        let mut probabilities = Vec::with_capacity(comparison.asked());
        for block in &comparison.blocks {
            let degrees = comparison.degrees(block);
            probabilities.extend(block.channels.map(|c| probability(&c, degrees)));
        }
        let worst = (0..probabilities.len())
            .min_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]))
            .expect("an image has a block");
        Worst {
            block: &comparison.blocks[worst / 3],
            channel: worst % 3,
            probabilities,
        }
    }

    fn deviation(&self) -> f64 {
        block_deviation(&self.block.channels[self.channel])
    }

    fn judge(&self, level: f64, metrics: &mut Metrics) -> Option<String> {
        let rejected = holm(&self.probabilities, level);
        let place = [self.block.columns.start, self.block.rows.start];
        metrics.extend([
            ("blocks", self.probabilities.len() as f64),
            ("rejected_blocks", rejected as f64),
            ("worst_block_z", finite(self.deviation())),
            ("worst_block_column", place[0] as f64),
            ("worst_block_row", place[1] as f64),
        ]);
        let off = self.block.channels[self.channel].difference.value;
        (rejected > 0).then(|| {
            format!(
                "{rejected} of {} blocks and channels are off by more than noise; the worst begins \
                 at ({}, {}): its {} is too {} by {:.3e}, {}",
                self.probabilities.len(),
                place[0],
                place[1],
                colour(self.channel),
                side(off),
                off.abs() / self.block.pixels() as f64,
                standard_errors(self.deviation()),
            )
        })
    }
}

/// Of a block that is off as far as this one, where nothing is wrong: the larger by both answers
/// to what its variance is.
fn probability(channel: &Channel, degrees: f64) -> f64 {
    let beyond = channel.difference.beyond_rounding();
    let own = deviation(beyond, channel.variance.own());
    let guard = deviation(beyond, channel.variance.guard());
    two_sided_estimated(own, degrees).max(two_sided(guard))
}

/// In the larger of both standard errors.
fn block_deviation(channel: &Channel) -> f64 {
    deviation(
        channel.difference.beyond_rounding(),
        channel.variance.largest(),
    )
}

/// A deviation in words.
fn standard_errors(deviation: f64) -> String {
    match deviation.abs() {
        size if size < BOUNDLESS => format!("{size:.1} standard errors"),
        _ => "where there is no noise at all".to_owned(),
    }
}

fn finite(value: f64) -> f64 {
    value.clamp(-BOUNDLESS, BOUNDLESS)
}
