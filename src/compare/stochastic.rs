//! The stochastic gate: means of random samples, whose noise is known.
//!
//! Both images estimate the same radiance, so their difference is noise around zero, of a
//! variance that the images state. Five questions, each with its share of the false alarms:
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
//! - *The amount of noise*: the squares of the differences should sum to the variances, block by
//!   block (chi-square). Half as much is suspicious too: as if the images shared random numbers,
//!   or one had been smoothed. Not asked below 64 samples a pixel, only reported: single
//!   variances are then known too badly, and few differences have the shape of a normal one.
//!
//! # Whose variance
//!
//! From few samples a variance is not only imprecise: where light arrives rarely, a pixel that
//! missed it is too dark *and* says it has no noise. So a variance is the larger of what the
//! image states and what the samples of the other image would give, if that one has as many or
//! more: `variance × samples / own samples`. This makes the gate blinder to an image of less
//! noise per sample, never stricter.
//!
//! Where only one image states its noise, that of both is taken from the spread of the
//! differences within each block, and a block is judged by Student's t. A difference that varies
//! within a block then counts as noise, and the questions about pixels are not asked.
//!
//! # Limits
//!
//! Normality is assumed of the sums over a block, that is of 64 pixels times the samples of a
//! pixel. Noise that comes from events rarer than about one in that number is not normal: a
//! sample that meets light with probability p deviates by `1/√(n·p)` standard errors of a block
//! of n samples, which for p = 10⁻⁴ and four samples a pixel is 6.25, about the limit. Such scenes
//! need more samples, not a wider gate.

use super::significance::{
    at_least, chi_square_two_sided, critical, critical_estimated, deviation, holm, two_sided,
    two_sided_estimated,
};
use super::{Gate, Judgement, PictureError};
use crate::film::{Film, Noise};
use crate::math::{self, Moments, Sum};
use std::ops::Range;

/// Probability that any case of a suite is rejected although nothing is wrong with it.
pub const FALSE_ALARM: f64 = 1e-6;

/// Pixels on a side of a block. What is left over at the edges goes to the last blocks.
pub const BLOCK: usize = 8;

/// Radiance added to the mean of a block before a bias is taken relative to it: the absolute
/// part of the tolerance of the deterministic gate.
pub const DARK: f64 = 1e-3;

/// A pixel beyond this many standard errors is counted.
const FAR: f64 = 5.0;

/// There may be this much times the noise that is stated, or one part in this of it, however
/// unlikely: variances are themselves estimates, and their ratio to the squares is not quite
/// chi-square where channels share their noise or samples are far from normal.
const AMOUNT: f64 = 2.0;

/// Samples from which the amount of noise is judged: a variance is then known to √(2/64), less
/// than a fifth.
const ENOUGH: u32 = 64;

/// Questions asked, among which the false alarms are divided.
const QUESTIONS: f64 = 5.0;

/// What is printed of a deviation without bound: numbers of a judgement are finite.
const BOUNDLESS: f64 = 1e9;

/// Judges `test` by `reference`, one of `cases` comparisons that raise a false alarm with
/// probability [`FALSE_ALARM`] together. At least one must state its noise.
pub fn judge(reference: &Film, test: &Film, cases: usize) -> Result<Judgement, PictureError> {
    judge_at(reference, test, FALSE_ALARM / cases.max(1) as f64)
}

/// [`judge`], with the probability of a false alarm of this one comparison.
pub fn judge_at(reference: &Film, test: &Film, level: f64) -> Result<Judgement, PictureError> {
    if reference.noise().is_none() && test.noise().is_none() {
        return Err(PictureError::NeedsNoise);
    }
    if let Some(different) = super::incomparable_films(Gate::Stochastic, reference, test) {
        return Ok(different);
    }
    Ok(Comparison::new(reference, test).judgement(level / QUESTIONS))
}

/// The standard error of the mean of a block, relative to that mean plus [`DARK`], that nine
/// tenths of the blocks and channels do not exceed, as with [`Judgement::resolution`]; nothing of an image without noise.
pub fn block_error(film: &Film) -> Option<f64> {
    let noise = film.noise()?;
    let mut errors = Vec::new();
    for rows in parts(film.height()) {
        for columns in parts(film.width()) {
            for channel in 0..3 {
                let (mut radiance, mut variance, mut count) = (0.0, 0.0, 0.0);
                for row in rows.clone() {
                    for index in columns.clone().map(|column| row * film.width() + column) {
                        radiance += f64::from(film.radiance()[index][channel]);
                        variance += f64::from(noise.variance()[index][channel]);
                        count += 1.0;
                    }
                }
                errors.push(variance.sqrt() / (radiance.abs() + DARK * count));
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    Some(errors[(errors.len() * 9).div_ceil(10) - 1])
}

/// How far blocks of 8 × 8 pixels deviate, for a map.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockMap {
    /// Blocks in a row.
    pub columns: usize,
    /// Rows of blocks.
    pub rows: usize,
    /// Test minus reference in standard errors, by channel; row by row from the top. What is left
    /// over at the right and lower edges belongs to the last blocks. At most 1e9 either way.
    pub deviations: Vec<[f64; 3]>,
}

/// The deviations of the blocks of `test` from `reference`, images of one size; nothing where
/// neither states its noise.
pub fn block_map(reference: &Film, test: &Film) -> Option<BlockMap> {
    if reference.noise().is_none() && test.noise().is_none() {
        return None;
    }
    let blocks = Comparison::new(reference, test).blocks;
    let deviations = blocks.chunks_exact(3);
    Some(BlockMap {
        columns: parts(reference.width()).count(),
        rows: parts(reference.height()).count(),
        deviations: deviations
            .map(|channels| [0, 1, 2].map(|c| finite(channels[c].sum.deviation())))
            .collect(),
    })
}

/// A difference of means, test minus reference.
#[derive(Clone, Copy, Debug, Default)]
struct Difference {
    value: f64,
    /// How much of it the rounding of both means to 32 bits can explain.
    rounding: f64,
    variance: f64,
}

impl Difference {
    /// What rounding does not explain, in standard errors.
    fn deviation(&self) -> f64 {
        let beyond = (self.value.abs() - self.rounding).max(0.0);
        deviation(beyond.copysign(self.value), self.variance)
    }

    fn add(&mut self, other: Difference) {
        self.value += other.value;
        self.rounding += other.rounding;
        self.variance += other.variance;
    }
}

/// One channel of one block.
struct Block {
    place: [usize; 2],
    channel: usize,
    pixels: usize,
    /// Sum of the reference over the block.
    radiance: f64,
    /// Sum of the differences over the block.
    sum: Difference,
}

impl Block {
    /// Degrees of freedom of a variance taken from the spread within the block.
    fn degrees(&self) -> f64 {
        (self.pixels.max(2) - 1) as f64
    }
}

/// What single pixels of one channel come to.
#[derive(Clone, Copy, Default)]
struct Pixels {
    values: u64,
    /// Beyond [`FAR`].
    far: u64,
    /// Different although neither image has noise there.
    contrary: u64,
    /// Sum of the squared differences over the variance, block by block, times the pixels.
    squares: Sum,
    /// How many pixels that is a sum of: those in blocks that have noise.
    squared: u64,
}

struct Comparison {
    blocks: Vec<Block>,
    /// By channel; nothing where only one image states its noise.
    pixels: Option<[Pixels; 3]>,
    /// Samples per pixel of both images, where both state their noise.
    samples: Option<[u32; 2]>,
    identical: bool,
}

/// `length` pixels in parts of at least [`BLOCK`], or one part of all.
fn parts(length: usize) -> impl Iterator<Item = Range<usize>> + Clone {
    let count = (length / BLOCK).max(1);
    (0..count).map(move |i| {
        let end = if i + 1 == count {
            length
        } else {
            (i + 1) * BLOCK
        };
        i * BLOCK..end
    })
}

impl Comparison {
    fn new(reference: &Film, test: &Film) -> Comparison {
        let noises = reference.noise().zip(test.noise());
        let mut comparison = Comparison {
            blocks: Vec::new(),
            pixels: noises.map(|_| Default::default()),
            samples: noises.map(|(a, b)| [a.samples(), b.samples()]),
            identical: reference.radiance() == test.radiance(),
        };
        let width = reference.width();
        for rows in parts(reference.height()) {
            for columns in parts(width) {
                for channel in 0..3 {
                    let columns = columns.clone();
                    let indices = rows.clone().flat_map(move |row| {
                        columns.clone().map(move |column| row * width + column)
                    });
                    comparison.add_block(reference, test, channel, indices.collect());
                }
            }
        }
        comparison
    }

    fn add_block(&mut self, reference: &Film, test: &Film, channel: usize, indices: Vec<usize>) {
        let value = |film: &Film, index: usize| f64::from(film.radiance()[index][channel]);
        let mut sum = Difference::default();
        let mut radiance = 0.0;
        let mut spread = Moments::default();
        let mut squares = 0.0;
        let mut shared = 0.0;
        for &index in &indices {
            let (a, b) = (value(reference, index), value(test, index));
            let [stated, by_more_samples] = match (reference.noise(), test.noise()) {
                (Some(a), Some(b)) => variances(a, b, index, channel),
                _ => [0.0; 2],
            };
            let pixel = Difference {
                value: b - a,
                // Each mean was rounded by at most half an epsilon of itself.
                rounding: f64::from(f32::EPSILON) * a.abs().max(b.abs()),
                variance: stated,
            };
            if let Some(pixels) = &mut self.pixels {
                pixels[channel].add(pixel, stated.max(by_more_samples));
            }
            let beyond = (pixel.value.abs() - pixel.rounding).max(0.0);
            squares += beyond * beyond;
            shared += by_more_samples;
            radiance += a;
            spread.add(pixel.value);
            sum.add(pixel);
        }
        match &mut self.pixels {
            Some(pixels) => {
                if sum.variance > 0.0 {
                    let count = indices.len();
                    pixels[channel]
                        .squares
                        .add(squares / sum.variance * count as f64);
                    pixels[channel].squared += count as u64;
                }
                sum.variance = sum.variance.max(shared);
            }
            // One pixel alone has no spread: nothing can be said of it.
            None => {
                let variance = spread.variance().unwrap_or(f64::INFINITY);
                sum.variance = variance * indices.len() as f64;
            }
        }
        let width = reference.width();
        self.blocks.push(Block {
            place: [indices[0] % width, indices[0] / width],
            channel,
            pixels: indices.len(),
            radiance,
            sum,
        });
    }

    /// The channels of the whole image.
    fn totals(&self) -> [Difference; 3] {
        let mut totals = [Difference::default(); 3];
        for block in &self.blocks {
            totals[block.channel].add(block.sum);
        }
        totals
    }

    /// Answers the questions, each at `level`.
    fn judgement(&self, level: f64) -> Judgement {
        let probability = |block: &Block| match self.pixels {
            Some(_) => two_sided(block.sum.deviation()),
            None => two_sided_estimated(block.sum.deviation(), block.degrees()),
        };
        let probabilities: Vec<f64> = self.blocks.iter().map(probability).collect();
        let rejected = holm(&probabilities, level);
        let worst = (0..self.blocks.len())
            .min_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]))
            .expect("an image has a block");
        let worst = &self.blocks[worst];
        let totals = self.totals();
        let of_totals = totals.map(|total| two_sided(total.deviation()));
        let count: usize = self.blocks.iter().map(|block| block.pixels).sum::<usize>() / 3;

        let mut metrics = vec![
            ("blocks", self.blocks.len() as f64),
            ("rejected_blocks", rejected as f64),
            ("worst_block_z", finite(worst.sum.deviation())),
            ("worst_block_column", worst.place[0] as f64),
            ("worst_block_row", worst.place[1] as f64),
        ];
        for (channel, names) in [
            ("mean_difference_red", "mean_z_red"),
            ("mean_difference_green", "mean_z_green"),
            ("mean_difference_blue", "mean_z_blue"),
        ]
        .into_iter()
        .enumerate()
        {
            metrics.push((names.0, totals[channel].value / count as f64));
            metrics.push((names.1, finite(totals[channel].deviation())));
        }
        let resolution = self.resolution(level);
        metrics.push(("smallest_visible_bias", resolution));

        let colour = |channel: usize| ["red", "green", "blue"][channel];
        let side = |difference: f64| if difference > 0.0 { "bright" } else { "dark" };
        let mut faults = Vec::new();
        if holm(&of_totals, level) > 0 {
            let c = (0..3)
                .min_by(|&a, &b| of_totals[a].total_cmp(&of_totals[b]))
                .expect("three channels");
            faults.push(format!(
                "{} is too {} on the whole: its mean is off by {:.3e}, {:.1} standard errors",
                colour(c),
                side(totals[c].value),
                totals[c].value / count as f64,
                finite(totals[c].deviation().abs()),
            ));
        }
        if rejected > 0 {
            faults.push(format!(
                "{rejected} of {} blocks and channels are off by more than noise; the worst begins \
                 at ({}, {}): its {} is too {} by {:.3e}, {:.1} standard errors",
                self.blocks.len(),
                worst.place[0],
                worst.place[1],
                colour(worst.channel),
                side(worst.sum.value),
                worst.sum.value.abs() / worst.pixels as f64,
                finite(worst.sum.deviation().abs()),
            ));
        }
        if let Some(pixels) = &self.pixels {
            faults.extend(judge_far(pixels, level, &mut metrics));
            faults.extend(self.judge_contrary(pixels, level, &mut metrics));
            faults.extend(self.judge_amount(pixels, level, &mut metrics));
        }
        let passed = faults.is_empty();
        let reason = if passed {
            format!(
                "the differences are noise; the worst of {} blocks and channels is off by {:.1} \
                 standard errors; a bias of {:.2} % of a block would have been seen",
                self.blocks.len(),
                finite(worst.sum.deviation().abs()),
                100.0 * resolution
            )
        } else {
            faults.join("; ")
        };
        Judgement {
            resolution: Some(resolution),
            ..Judgement::new(Gate::Stochastic, passed, reason, &metrics)
        }
    }

    /// The bias that nine tenths of the blocks would show with probability one half at least,
    /// relative to the mean of the block plus [`DARK`].
    fn resolution(&self, level: f64) -> f64 {
        let level = level / self.blocks.len() as f64;
        let visible = |block: &Block| {
            let limit = match self.pixels {
                Some(_) => critical(level),
                None => critical_estimated(level, block.degrees()),
            };
            let floor = block.radiance.abs() + DARK * block.pixels as f64;
            (limit * block.sum.variance.sqrt() + block.sum.rounding) / floor
        };
        let mut visible: Vec<f64> = self.blocks.iter().map(visible).collect();
        visible.sort_by(f64::total_cmp);
        finite(visible[(visible.len() * 9).div_ceil(10) - 1])
    }

    fn judge_contrary(
        &self,
        pixels: &[Pixels; 3],
        level: f64,
        metrics: &mut Metrics,
    ) -> Option<String> {
        let [a, b] = self.samples?.map(f64::from);
        let contrary: u64 = pixels.iter().map(|p| p.contrary).sum();
        metrics.push(("contrary_pixels", contrary as f64));
        let asked: u64 = pixels.iter().map(|p| p.values).sum();
        let each = math::exp(a * math::ln(a / (a + b)) + b * math::ln(b / (a + b)));
        (contrary > 0 && each * asked as f64 <= level).then(|| {
            format!("{contrary} pixels and channels differ where neither image has any noise")
        })
    }

    fn judge_amount(
        &self,
        pixels: &[Pixels; 3],
        level: f64,
        metrics: &mut Metrics,
    ) -> Option<String> {
        let count: u64 = pixels.iter().map(|p| p.squared).sum();
        if count == 0 {
            return None;
        }
        let squares: Sum = pixels.iter().map(|p| p.squares.value()).collect();
        let amount = finite(squares.value() / count as f64);
        // The channels of a pixel may share their noise: as if there were a third of them.
        let independent = count as f64 / 3.0;
        let probability = chi_square_two_sided(amount * independent, independent);
        metrics.push(("amount_of_noise", amount));
        metrics.push(("chi_square_probability", probability));
        let is_enough = self.samples?.into_iter().all(|samples| samples >= ENOUGH);
        let is_odd = !(1.0 / AMOUNT..=AMOUNT).contains(&amount) && probability <= level;
        if !is_enough || self.identical || !is_odd {
            return None;
        }
        let why = match amount < 1.0 {
            true => "have they random numbers in common, or is one smoothed?",
            false => "pixels differ beyond it",
        };
        Some(format!(
            "the differences are {amount:.2} times the noise that the images state; {why}"
        ))
    }
}

type Metrics = Vec<(&'static str, f64)>;

fn judge_far(pixels: &[Pixels; 3], level: f64, metrics: &mut Metrics) -> Option<String> {
    // Chebyshev, for any distribution of that variance.
    let each = 1.0 / (FAR * FAR);
    let probabilities = pixels.map(|p| at_least(p.far, p.values, each));
    let most = pixels.iter().max_by_key(|p| p.far).expect("three channels");
    metrics.push(("far_pixels", most.far as f64));
    (holm(&probabilities, level) > 0).then(|| {
        format!(
            "{} of {} pixels are off by more than {FAR} standard errors; whatever the shape of the \
             noise, one in {} may be",
            most.far,
            most.values,
            FAR * FAR
        )
    })
}

impl Pixels {
    /// One more difference with the variance that is stated, to be taken for `guarded`.
    fn add(&mut self, pixel: Difference, guarded: f64) {
        let guarded = Difference {
            variance: guarded,
            ..pixel
        };
        self.values += 1;
        let deviation = guarded.deviation().abs();
        self.far += u64::from(deviation > FAR);
        self.contrary += u64::from(deviation == f64::INFINITY);
    }
}

/// Variance of the difference at a pixel: as both images state, and by the samples of whichever
/// has more of them.
fn variances(a: &Noise, b: &Noise, index: usize, channel: usize) -> [f64; 2] {
    let of = |noise: &Noise| f64::from(noise.variance()[index][channel]);
    let (n_a, n_b) = (f64::from(a.samples()), f64::from(b.samples()));
    let (stated_a, stated_b) = (of(a), of(b));
    let shared = match a.samples().cmp(&b.samples()) {
        std::cmp::Ordering::Greater => stated_a * (1.0 + n_a / n_b),
        std::cmp::Ordering::Less => stated_b * (1.0 + n_b / n_a),
        std::cmp::Ordering::Equal => stated_a + stated_b,
    };
    [stated_a + stated_b, shared]
}

fn finite(value: f64) -> f64 {
    value.clamp(-BOUNDLESS, BOUNDLESS)
}
