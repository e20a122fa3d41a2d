//! The smallest bias that would have been seen, and what it takes to see a smaller one.

use super::super::significance::{critical, critical_estimated};
use super::blocks::{Block, Comparison};
use super::finite;
use std::fmt;

/// A pass that says too little: the bias of the mean of the image that a case promises to see
/// would not have been seen. What would decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Undecided {
    /// That many samples per pixel of the test image.
    Samples(u64),
    /// That many times the samples of the test image, which does not say how many it has.
    Times(u64),
    /// Nothing the test image could do: the noise of the reference alone hides any bias up to
    /// this, relative to the mean of the image.
    Reference(f64),
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Undecided::Samples(samples) => write!(
                f,
                "a test image of {samples} samples per pixel would decide"
            ),
            Undecided::Times(times) => write!(
                f,
                "a test image of {times} times the samples per pixel would decide"
            ),
            Undecided::Reference(bias) => write!(
                f,
                "no test image would decide: the noise of the reference alone hides a bias of \
                 {:.2} %",
                100.0 * bias
            ),
        }
    }
}

/// Deviations at which blocks are rejected, by how their variance is known, and at which the whole
/// image is.
pub(super) struct Limits<'c> {
    comparison: &'c Comparison<'c>,
    whole: f64,
    guard: f64,
    /// By the pixels of a block, of which there are four numbers at most.
    own: Vec<(usize, f64)>,
}

impl<'c> Limits<'c> {
    /// `level` is that of all blocks together, and that of the channels of the whole image.
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

    /// Variances of a sum over the block, reference and test image, each times the square of the
    /// deviation at which it is rejected. The bias must exceed the roots of both sums.
    fn terms(&self, block: &Block, channel: usize) -> [[f64; 2]; 2] {
        let known = self.own.iter().find(|&&(n, _)| n == block.pixels());
        let own = known.map_or(f64::INFINITY, |&(_, limit)| limit);
        let variance = block.channels[channel].variance;
        [
            variance.own.map(|v| own * own * v),
            variance.guard.map(|v| self.guard * self.guard * v),
        ]
    }

    /// What nine tenths of the blocks and channels do not exceed.
    fn of_nine_tenths(&self, each: impl Fn(&Block, usize) -> f64) -> f64 {
        let blocks = self.comparison.blocks.iter();
        let mut values: Vec<f64> = blocks
            .flat_map(|block| [0, 1, 2].map(|channel| each(block, channel)))
            .collect();
        let at = (values.len() * 9).div_ceil(10) - 1;
        *values.select_nth_unstable_by(at, f64::total_cmp).1
    }

    /// The bias that nine tenths of the blocks would show with probability one half at least,
    /// relative to the mean of the block plus [`DARK`](super::DARK), were the test image's noise
    /// `scale` times what it is.
    pub fn resolution(&self, scale: f64) -> f64 {
        let visible = |block: &Block, channel: usize| {
            let terms = self.terms(block, channel);
            let squared = terms.map(|[reference, test]| reference + scale * test);
            let rounding = block.channels[channel].difference.rounding;
            (squared[0].max(squared[1]).sqrt() + rounding) / block.floor(channel)
        };
        finite(self.of_nine_tenths(visible))
    }

    /// The bias of the mean of the image that each channel would show with probability one half at
    /// least, relative to that mean plus [`DARK`](super::DARK), were the variance of the test image `scale` times
    /// what it is.
    pub fn mean_resolution(&self, scale: f64) -> f64 {
        let visible = self.channels().map(|channel| {
            let variance = channel.reference + scale * channel.test;
            (self.whole * variance.sqrt() + channel.rounding) / channel.floor
        });
        finite(visible.into_iter().fold(0.0, f64::max))
    }

    /// What it takes to see a bias of `promise` of the mean, if the images do not show it.
    pub fn undecided(&self, promise: f64) -> Option<Undecided> {
        if self.mean_resolution(1.0) <= promise {
            return None;
        }
        // How much more of its samples each channel needs: the variance of the test image falls as
        // they grow, that of the reference and the rounding stay.
        let times = self.channels().map(|channel| {
            let room = (promise * channel.floor - channel.rounding).max(0.0) / self.whole;
            match room * room - channel.reference {
                left if left > 0.0 => channel.test / left,
                _ => f64::INFINITY,
            }
        });
        let times = times.into_iter().fold(0.0, f64::max);
        // More than any renderer takes: the reference is what is in the way.
        const MOST: f64 = 1e6;
        if times > MOST {
            return Some(Undecided::Reference(self.mean_resolution(0.0)));
        }
        let samples = self.comparison.samples()[1];
        Some(match samples {
            Some(samples) => Undecided::Samples((times * f64::from(samples)).ceil() as u64),
            None => Undecided::Times(times.ceil() as u64),
        })
    }

    /// The channels of the whole image.
    fn channels(&self) -> [Whole; 3] {
        let totals = self.comparison.totals();
        let blocks = &self.comparison.blocks;
        [0, 1, 2].map(|c| {
            let variance = self.comparison.variance_of_whole(&totals[c]);
            let reference = blocks
                .iter()
                .map(|block| block.channels[c].variance.own[0])
                .sum();
            Whole {
                reference,
                test: (variance - reference).max(0.0),
                rounding: totals[c].difference.rounding,
                floor: blocks.iter().map(|block| block.floor(c)).sum(),
            }
        })
    }
}

/// Sums over a channel of the image.
struct Whole {
    /// Variance of the reference.
    reference: f64,
    /// Variance of the test image.
    test: f64,
    rounding: f64,
    /// What a bias is relative to.
    floor: f64,
}
