//! The stochastic gate: means of random samples with known noise.
//!
//! Both images estimate the same radiance, so their difference is noise around zero, of a
//! variance that the images state. Tests, each with its share of the false alarms:
//!
//! - *The image*: is the mean of a channel too bright or too dark?
//! - *Blocks* of 8 × 8 pixels: is any of them, in any channel? A block has an eighth of the noise
//!   of a pixel and is nearer to normal. Holm's procedure corrects for the number of tests.
//! - *Squares of blocks, rows and columns* at every scale up to the image, where no block and no mean is off:
//!   see the file `scales.rs`.
//! - *Parameters of the scene*: does the difference look like what an error of one of them makes, where
//!   derivatives are known? See the file `scores.rs`.
//! - *Pixels*: do too many lie beyond five standard errors? By Chebyshev's inequality a pixel
//!   does with probability 1/25 at most, whatever the shape of its noise. This finds
//!   differences that cancel within blocks.
//! - *Pixels without noise*: where all samples of both images are equal, so must be the pixels,
//!   to a rounding. If all a samples of one are x and all b of the other y ≠ x, that had a
//!   probability of `p^a · (1 − p)^b` at most, which is largest at p = a/(a + b).
//! - *Black pixels*: a mean of samples that are not negative is 0 only if all are, which by Cantelli's
//!   inequality has a small probability where light is steady. This finds a NaN that was replaced by
//!   0, of 64 samples even a single one. It has one share together with the pixels without noise. A
//!   single pixel that is too bright is another matter: noise makes those.
//! - *Copies*: more than half of the pixels that have noise are the same bit for bit as in the reference.
//! - *The amount of noise*: the squares of the differences should sum to the variances, block by
//!   block (chi-square). Half as much is suspicious too: as if the images shared random numbers,
//!   or one had been smoothed. Too much is looked for from 64 samples a pixel on.
//! - *Neighbours*: are their differences correlated? See the file `neighbours.rs`.
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
//! Renderings that do not count their samples ([`Film::from_replicates`]) are in between: the own
//! variance is how they differ, with a degree of freedom less than renderings for each pixel, and the
//! ratio for the guard is estimated, for four renderings of 64 samples are not four samples.
//!
//! # A known answer
//!
//! The reference may be known, pixel by pixel ([`Film::known`]): then it has no noise, in any of the
//! tests. It has not seen what is rare either, and lends the test image no guard. That is taken from
//! the answer itself: noise is spread as that of light that arrives or does not, in proportion to the
//! radiance, and how large it is follows from all blocks, as of an image that does not count its samples.
//! A block that light missed by chance, and that therefore states no noise, has its share of what the
//! others state.
//!
//! The *number of samples* that an image states is not judged. Another estimator may well need
//! sixteen times fewer samples for the same noise, or more, and nothing in the image tells that from
//! a number that is wrong. One that is too large narrows the guard, at the cost of the image alone;
//! one that is too small widens it, so that the detectable bias grows, and with it the pass becomes
//! inconclusive. `validate --run` notes a number that is not the one it asked for.
//!
//! # Rounding
//!
//! A test image may have been summed in single precision, rounded to half precision or printed with six decimals, and
//! none of that is noise: pixels without noise are all rounded the same way. So every sum, over a block, a line, the
//! image or a score, first subtracts the largest error that rounding could cause (see `blocks.rs`).
//! Variances that half precision made 0 are no statement either: the guard is there.
//!
//! # Images of 8 bits
//!
//! A quantised test image is off by half a code at most where it is not cut off. That is
//! allowed for in the same way. (The excess over half a code in each *pixel* has
//! no mean of zero: skewed noise is mostly a little too dark and rarely much too bright, and rounding would
//! hide the former alone.) Pixels that the largest code may have cut off are left out: see the file
//! `cut_off.rs`. Neighbours are compared only where noise dithers the rounding, and no pixel is too black.
//! Independent noise cannot fall below that of the reference, rounded or not, so that too little of it is
//! looked for as ever.
//!
//! # What would decide
//!
//! A pass that could not have detected the required bias states how many samples could. It
//! evaluates the gate itself, with the variances that the test image would then have. If the noise
//! of the reference, or an unknown noise of the test image, is the limit, it states that instead.
//!
//! # Order of reasons
//!
//! A mean that is off, of the image or of blocks, before what follows from it. That neighbours are
//! off together is not said where the image is off on the whole.
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
mod comparison;
mod cut_off;
mod map;
mod neighbours;
mod pixels;
mod resolution;
mod scales;
mod scores;
mod unstated;
mod variance;

pub use blocks::{BLOCK, DARK};
pub(crate) use map::{block_error, block_map};
pub(crate) use unstated::is_off_by_noise;

use super::advice::Undecided;
use super::gate::{Description, Gate, MEAN_DIFFERENCES, metrics};
use super::incomparable;
use super::judgement::Judgement;
use super::picture::PictureError;
use super::precision::CUT_OFF;
use super::promise::Promise;
use super::sensitivity::{Sensitivity, with_error};
use super::significance::{deviation, holm, two_sided, two_sided_estimated};
use crate::film::{CHANNELS, Film};
use crate::math;
use amount::judge_amount;
use blocks::{Block, Channel};
use comparison::Comparison;
use cut_off::WithinCodes;
use neighbours::judge_neighbours;
use pixels::{PixelDifferences, judge_black};
use resolution::Limits;
use scales::judge_scales;
use scores::judge_numbers;

/// Probability that any correct case of a suite is rejected.
pub const FALSE_ALARM: f64 = 1e-6;

/// Shares into which the false alarms are divided: one for each question, and one for noise that
/// was underestimated.
const SHARES: f64 = 10.0;

/// Value printed for an infinite deviation: numbers of a judgement are finite.
const BOUNDLESS: f64 = 1e9;

pub(super) const DESCRIPTION: Description = Description {
    name: "stochastic",
    rule: "The pixels are means of random samples, so differences are measured in standard errors. \
        Noise alone nearly always stays below 3 standard errors; the limits are set so that a \
        correct renderer raises a false alarm once in a million suites.",
    metrics: &metrics! {
        "blocks" => "Number of tests: blocks of 8 × 8 pixels times three channels.";
        "rejected_blocks" => "Blocks and channels that differ beyond noise; 0 passes.";
        "worst_block_z" => "Test minus golden of the worst block, in standard errors: above 0 it is too bright.";
        "worst_block_column" => "First column of the worst block.";
        "worst_block_row" => "First row of the worst block.";
        MEAN_DIFFERENCES[0];
        MEAN_DIFFERENCES[1];
        MEAN_DIFFERENCES[2];
        "mean_z_red" => "Mean of red over the image, test minus golden, in standard errors.";
        "mean_z_green" => "Mean of green over the image, test minus golden, in standard errors.";
        "mean_z_blue" => "Mean of blue over the image, test minus golden, in standard errors.";
        "scores" => "Parameters of the scene that were tested: does an error in them look like the difference?";
        "largest_score" => "How much the difference looks like the change that an error of one of these parameters makes, in standard errors: above 0 as if it were larger.";
        "smallest_visible_bias" => "Detectable bias of the mean, as a share of the brightness of the image: a larger one is rejected.";
        "smallest_visible_block_bias" => "Detectable bias within single blocks (90th percentile), as a share of the brightness of the block: a larger one is rejected.";
        "times_the_samples_that_would_decide" => "How many times more samples per pixel would make the required bias detectable.";
        "samples_that_would_decide" => "Samples per pixel, summed over all renderings, at which it becomes detectable.";
        "far_pixels" => "Single pixels off by more than 5 standard errors, in the channel with most; many mean fireflies, or differences that cancel within blocks.";
        "contrary_pixels" => "Pixels and channels that differ although neither image has any noise there.";
        "black_pixels" => "Pixels that are exactly 0 although the golden is not; samples that are all 0 by chance make some, in images of few samples.";
        "amount_of_noise" => "Squared differences relative to the variance given in the images: 1 is expected, far below 1 means smoothing or shared random numbers, far above 1 a difference beyond noise.";
        "chi_square_probability" => "Probability of at least this much deviation from noise alone; near 0 means a real difference.";
        "copied_pixels" => "Noisy pixels that are bit-identical to the golden; independent renderings share none.";
        "correlation_across" => "Correlation of the differences of horizontally adjacent pixels: 0 is expected; above 0.05 whole regions are off, or the image was filtered or denoised, or its pixels share random numbers.";
        "correlation_down" => "The same for vertically adjacent pixels.";
    },
    default_for: Some("two linear images if at least one includes its variance"),
};

/// Judges `test` by `reference`, one of `cases` comparisons that raise a false alarm with
/// probability [`FALSE_ALARM`] together. At least one must state its noise.
pub fn judge(reference: &Film, test: &Film, cases: usize) -> Result<Judgement, PictureError> {
    judge_at(reference, test, FALSE_ALARM / cases.max(1) as f64)
}

/// [`judge`], with the probability of a false alarm of this one comparison.
pub fn judge_at(reference: &Film, test: &Film, level: f64) -> Result<Judgement, PictureError> {
    judge_with(reference, test, level, None, &[])
}

/// [`judge_at`] of an image that is to show the promised biases, where it is known how the reference changes with parameters
/// of its scene.
pub fn judge_with(
    reference: &Film,
    test: &Film,
    level: f64,
    promise: Option<Promise>,
    sensitivities: &[Sensitivity],
) -> Result<Judgement, PictureError> {
    if reference.noise().is_none() && test.noise().is_none() {
        return Err(PictureError::NeedsNoise);
    }
    if let Some(different) = incomparable::films(Gate::Stochastic, reference, test) {
        return Ok(different);
    }
    let share = level / SHARES;
    let Some(seen) = WithinCodes::of(reference, test, share) else {
        let comparison = Comparison::new(reference, test, share);
        return Ok(judgement(&comparison, share, promise, sensitivities));
    };
    let comparison = Comparison::new(&seen.reference, &seen.test, share);
    // Derivatives are those of all pixels of a block.
    let known = if seen.share_left_out > 0.0 {
        &[]
    } else {
        sensitivities
    };
    let mut judgement = judgement(&comparison, share, promise, known);
    let left_out = (CUT_OFF.0.to_owned(), seen.share_left_out);
    judgement.metrics.extend([left_out]);
    Ok(judgement)
}

type Metrics = Vec<(&'static str, f64)>;

/// Answers the questions, each at `level`.
fn judgement(
    comparison: &Comparison<'_>,
    level: f64,
    promise: Option<Promise>,
    sensitivities: &[Sensitivity],
) -> Judgement {
    let mut metrics = Metrics::new();
    let limits = Limits::new(comparison, level);
    let visible = limits.visible(comparison, |difference| difference.rounding);
    metrics.push(("smallest_visible_bias", visible[0]));
    metrics.push(("smallest_visible_block_bias", visible[1]));

    // The whole image comes first: much of the rest follows from it.
    let whole = judge_whole(comparison, level, &mut metrics);
    let is_off = whole.is_some();
    let mut faults = Vec::from_iter(whole);
    let worst = WorstBlock::new(comparison);
    faults.extend(worst.judge(level, &mut metrics));
    if faults.is_empty() {
        faults.extend(judge_scales(comparison, level));
    }
    let numbers = judge_numbers(comparison, sensitivities, level, &mut metrics);
    faults.extend(numbers.fault);
    let pixels = PixelDifferences::new(comparison);
    if let [Some(a), Some(b)] = comparison.numbers() {
        faults.extend(pixels.judge_far(level, &mut metrics));
        faults.extend(pixels.judge_contrary([a, b], level, &mut metrics));
        faults.extend(judge_black(comparison, level, &mut metrics));
    }
    let copied = pixels.judge_copied(level, &mut metrics);
    // A copy has too little noise, which goes without saying.
    let amount = judge_amount(comparison, level, &mut metrics).filter(|_| copied.is_none());
    faults.extend(copied);
    faults.extend(amount);
    let together = judge_neighbours(comparison, level, &mut metrics);
    // That neighbours are off together where whole regions are goes without saying, too.
    faults.extend(together.filter(|_| !is_off));

    let passed = faults.is_empty();
    let undecided = promise
        .filter(|_| passed)
        .and_then(|promise| limits.undecided(&promise));
    let noise = format!(
        "largest block deviation {:.1} standard errors; up to {:.1} is expected by chance among {} blocks × channels",
        finite(worst.deviation().abs()),
        limits.of_block(worst.block, worst.channel),
        comparison.asked(),
    );
    let reason = match undecided {
        Some((undecided, required)) => {
            format!("{}: {noise}", too_noisy(visible, &undecided, required))
        }
        _ if passed => {
            let [of_mean, of_blocks] = visible.map(percent);
            let of_number = numbers.detectable.first();
            let of_number = of_number.map_or(String::new(), |it| format!("{}, ", it.words));
            format!(
                "no difference beyond noise; detectable bias {of_number}{of_mean} for the image mean, {of_blocks} within \
                 single blocks (90th percentile); {noise}"
            )
        }
        _ => faults.join("; "),
    };
    let undecided = undecided.map(|(undecided, _)| undecided);
    if let Some(Undecided::Samples(advice)) = undecided {
        metrics.push(("times_the_samples_that_would_decide", advice.times));
        let samples = advice.samples();
        metrics.extend(samples.map(|samples| ("samples_that_would_decide", samples)));
    }
    Judgement {
        undecided,
        changes: numbers.changes,
        detectable: numbers.detectable,
        ..Judgement::new(Gate::Stochastic, passed, reason, &metrics)
    }
}

/// Sentence for two images that agree, and could have hidden a bias of the mean and of blocks that is larger than
/// `required`.
fn too_noisy(visible: [f64; 2], advice: &Undecided, required: [f64; 2]) -> String {
    let [mean, block] = [0, 1].map(|i| {
        let [seen, required] = [visible[i], required[i]].map(percent);
        format!("{seen}, required {required}")
    });
    let of_block = match required[1].is_finite() {
        true => format!("; of single blocks (90th percentile) {block}"),
        false => String::new(),
    };
    format!(
        "too noisy to decide: detectable bias of the mean {mean}{of_block}; {advice}; no difference beyond noise"
    )
}

fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

fn side(difference: f64) -> &'static str {
    if difference > 0.0 { "bright" } else { "dark" }
}

/// A mean of the test image beside that of the reference, the difference with its standard error, and how unlikely
/// that is.
fn means(reference: f64, difference: f64, deviation: f64) -> String {
    let percent = 100.0 * difference / reference.abs();
    let sign = if difference < 0.0 { "−" } else { "+" };
    let relative = if reference == 0.0 {
        String::new()
    } else if deviation.abs() < BOUNDLESS && deviation != 0.0 {
        let [size, error] = with_error(percent.abs(), (percent / deviation).abs());
        format!(" ({sign}{size} ± {error} %)")
    } else {
        format!(" ({sign}{:.1} %)", percent.abs())
    };
    format!(
        "{} where the reference has {}{relative}, {}",
        radiance(reference + difference),
        radiance(reference),
        standard_errors(deviation)
    )
}

/// Radiance in four digits.
fn radiance(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e4).contains(&size) => {
            let before = math::log10(size).floor() as i32;
            format!("{value:.*}", (3 - before).max(0) as usize)
        }
        _ => format!("{value:.3e}"),
    }
}

fn judge_whole(comparison: &Comparison<'_>, level: f64, metrics: &mut Metrics) -> Option<String> {
    let totals = comparison.totals();
    let pixels: usize = comparison.blocks.iter().map(Block::pixels).sum();
    let mean = |c: usize| totals[c].difference.value / pixels as f64;
    let deviations = totals.map(|total| comparison.deviation(&total));
    let names = ["mean_z_red", "mean_z_green", "mean_z_blue"];
    for (c, z) in names.into_iter().enumerate() {
        metrics.push((MEAN_DIFFERENCES[c].0, mean(c)));
        metrics.push((z, finite(deviations[c])));
    }
    let probabilities = deviations.map(two_sided);
    let c = (0..3)
        .min_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]))
        .expect("three channels");
    let rejected = holm(&probabilities, level);
    let what = match rejected {
        3 if (0..3).all(|other| side(mean(other)) == side(mean(c))) => "the image",
        _ => CHANNELS[c],
    };
    let blocks = comparison.blocks.iter();
    let reference: f64 = blocks.map(|block| block.channels[c].radiance).sum();
    (rejected > 0).then(|| {
        format!(
            "{what} is too {} overall: the mean of {} is {}",
            side(mean(c)),
            CHANNELS[c],
            means(reference / pixels as f64, mean(c), deviations[c]),
        )
    })
}

/// The most unlikely of the blocks and channels.
struct WorstBlock<'c> {
    block: &'c Block,
    channel: usize,
    /// Probabilities of all blocks and channels.
    probabilities: Vec<f64>,
}

impl<'c> WorstBlock<'c> {
    fn new(comparison: &'c Comparison<'c>) -> WorstBlock<'c> {
        let mut probabilities = Vec::with_capacity(comparison.asked());
        for block in &comparison.blocks {
            let degrees = comparison.degrees(block);
            probabilities.extend(block.channels.map(|c| probability(&c, degrees)));
        }
        let worst = (0..probabilities.len())
            .min_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]))
            .expect("an image has a block");
        WorstBlock {
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
        let corner = [self.block.columns.start, self.block.rows.start];
        metrics.extend([
            ("blocks", self.probabilities.len() as f64),
            ("rejected_blocks", rejected as f64),
            ("worst_block_z", finite(self.deviation())),
            ("worst_block_column", corner[0] as f64),
            ("worst_block_row", corner[1] as f64),
        ]);
        let channel = &self.block.channels[self.channel];
        let (off, pixels) = (channel.difference.value, self.block.pixels() as f64);
        (rejected > 0).then(|| {
            format!(
                "{rejected} of {} blocks and channels differ beyond noise; the worst, {} × {} pixels \
                 from column {} and row {}, is too {} in {}: {}",
                self.probabilities.len(),
                self.block.columns.len(),
                self.block.rows.len(),
                corner[0],
                corner[1],
                side(off),
                CHANNELS[self.channel],
                means(channel.radiance / pixels, off / pixels, self.deviation()),
            )
        })
    }
}

/// Probability that a correct block deviates as far as this one: the larger by both estimates of
/// its variance.
fn probability(channel: &Channel, degrees: f64) -> f64 {
    let beyond = channel.difference.beyond_rounding();
    let own = deviation(beyond, channel.variance.own());
    let guard = deviation(beyond, channel.variance.guard());
    two_sided_estimated(own, degrees).max(two_sided(guard))
}

/// Deviation of a block in the larger of both standard errors.
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
        _ => "without any noise".to_owned(),
    }
}

fn finite(value: f64) -> f64 {
    value.clamp(-BOUNDLESS, BOUNDLESS)
}
