//! The smallest detectable bias, and the samples needed for a smaller one.

use super::blocks::{Block, Difference};
use super::comparison::Comparison;
use super::finite;
use crate::compare::advice::{Advice, Undecided};
use crate::compare::promise::Promise;
use crate::compare::significance::{critical, critical_estimated};
use std::f64::consts::SQRT_2;

/// Largest factor on the samples: beyond it, it is the noise of the reference that prevents a
/// decision.
const MOST_TIMES: f64 = 1e6;

/// Standard errors by which the noise may be larger than it seems, when samples are advised. The advice rests on one
/// estimate, and the image that follows it on another: together they have √2 standard errors. One in seven hundred
/// exceeds three times that.
const SAFETY: f64 = 3.0 * SQRT_2;

/// Largest safety factor on the advice, for very rough estimates of the noise.
const MOST_SAFETY: f64 = 2.0;

/// Deviations at which blocks are rejected, by how their variance is known, and at which the whole
/// image is.
pub(super) struct Limits<'c> {
    comparison: &'c Comparison<'c>,
    whole: f64,
    guard: f64,
    /// Deviation by the number of pixels of a block, of which there are at most four.
    own: Vec<(usize, f64)>,
}

impl<'c> Limits<'c> {
    /// Limits at `level`, for all blocks together, and again for the channels of the whole image.
    pub fn new(comparison: &'c Comparison<'c>, level: f64) -> Limits<'c> {
        let whole = critical(level / 3.0);
        let level = level / comparison.asked() as f64;
        let mut own: Vec<(usize, f64)> = Vec::new();
        for block in &comparison.blocks {
            let pixels = block.pixels();
            if own.iter().all(|&(known, _)| known != pixels) {
                let limit = critical_estimated(level, comparison.degrees(block));
                own.push((pixels, limit));
            }
        }
        Limits {
            comparison,
            whole,
            guard: critical(level),
            own,
        }
    }

    /// Variance of the difference of a sum over the block, by both estimates, times the square of
    /// the deviation at which it is rejected. The bias must exceed the roots of both.
    fn terms(&self, block: &Block, channel: usize) -> [f64; 2] {
        let known = self.own.iter().find(|&&(n, _)| n == block.pixels());
        let own = known.map_or(f64::INFINITY, |&(_, limit)| limit);
        let variance = block.channels[channel].variance;
        [
            own * own * variance.own(),
            self.guard * self.guard * variance.guard(),
        ]
    }

    /// The biases that `comparison`, with these or other variances, would show with probability one half at least: of the
    /// mean of the image, in its worst channel, and of nine tenths of the blocks. They are relative to the mean plus
    /// [`DARK`](super::DARK). `hidden` is the part of a difference that hides a bias beside noise.
    pub fn visible(&self, comparison: &Comparison<'_>, hidden: fn(&Difference) -> f64) -> [f64; 2] {
        let totals = comparison.totals();
        let of_mean = [0, 1, 2].map(|c| {
            let variance = comparison.variance_of_whole(&totals[c]);
            let floor: f64 = comparison.blocks.iter().map(|block| block.floor(c)).sum();
            (self.whole * variance.sqrt() + hidden(&totals[c].difference)) / floor
        });
        let of_block = |block: &Block, channel: usize| {
            let [own, guard] = self.terms(block, channel);
            let hidden = hidden(&block.channels[channel].difference);
            (own.max(guard).sqrt() + hidden) / block.floor(channel)
        };
        let of_mean = of_mean.into_iter().fold(0.0, f64::max);
        [of_mean, of_nine_tenths(&comparison.blocks, of_block)].map(finite)
    }

    /// The standard errors, by the larger of both estimates, up to which a channel of a block may
    /// be off among so many.
    pub fn of_block(&self, block: &Block, channel: usize) -> f64 {
        let [own, guard] = self.terms(block, channel);
        let variance = block.channels[channel].variance.largest();
        if variance > 0.0 {
            (own.max(guard) / variance).sqrt()
        } else {
            self.guard
        }
    }

    /// The samples that it takes to keep `promise`, if the images do not, asked as this gate judges; and the biases of
    /// the mean and of blocks that the promise asks for.
    pub fn undecided(&self, promise: &Promise) -> Option<(Undecided, [f64; 2])> {
        // The precision of an image is declared: no samples make up for it, and none are asked for.
        let but_codes = |it: &Difference| it.rounding - it.half_codes;
        let seen = |comparison: &Comparison<'_>| self.visible(comparison, but_codes);
        let hidden = seen(&self.comparison.with_samples(MOST_TIMES));
        let required = promise.required(hidden);
        let keeps = |[mean, block]: [f64; 2]| mean <= required[0] && block <= required[1];
        if keeps(seen(self.comparison)) {
            return None;
        }
        if !keeps(hidden) {
            return Some((Undecided::Reference(hidden[0]), required));
        }
        let (mut few, mut enough) = (1.0, MOST_TIMES);
        // To a thousandth, of an estimate that is known to a tenth at best.
        while enough > 1.001 * few {
            let middle = f64::sqrt(few * enough);
            if keeps(seen(&self.comparison.with_samples(middle))) {
                enough = middle
            } else {
                few = middle
            }
        }
        let safety = (1.0 + SAFETY * self.comparison.shape.error).min(MOST_SAFETY);
        let [_, test] = self.comparison.films;
        let advice = Advice {
            times: enough * safety,
            has: test.samples(),
        };
        Some((Undecided::Samples(advice), required))
    }
}

/// The number that nine tenths of the blocks and channels do not exceed.
pub(super) fn of_nine_tenths(blocks: &[Block], each: impl Fn(&Block, usize) -> f64) -> f64 {
    let each = &each;
    let values = blocks
        .iter()
        .flat_map(|block| [0, 1, 2].map(|channel| each(block, channel)));
    let mut values: Vec<f64> = values.collect();
    let at = (values.len() * 9).div_ceil(10) - 1;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
