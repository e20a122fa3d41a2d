//! The smallest bias that would have been seen, and what it takes to see a smaller one.

use super::super::significance::{critical, critical_estimated};
use super::blocks::{Block, Comparison};
use super::finite;
use std::fmt;

/// A pass that says too little: the bias a case promises to see would not have been seen. What
/// would decide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Undecided {
    /// That many samples per pixel of the test image.
    Samples(u64),
    /// That many times the samples of the test image, which does not say how many it has.
    Times(u64),
    /// Nothing the test image could do: the noise of the reference alone hides any bias up to
    /// this, relative to a block.
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

/// Deviations at which blocks are rejected, by how their variance is known.
pub(super) struct Limits<'c> {
    comparison: &'c Comparison<'c>,
    guard: f64,
    /// By the pixels of a block, of which there are four numbers at most.
    own: Vec<(usize, f64)>,
}

impl<'c> Limits<'c> {
    /// `level` is that of all blocks together.
    pub fn new(comparison: &'c Comparison<'c>, level: f64) -> Limits<'c> {
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

    /// What it takes to see a bias of `promise`, if the images do not show it.
    pub fn undecided(&self, promise: f64) -> Option<Undecided> {
        if self.resolution(1.0) <= promise {
            return None;
        }
        // How much more of its samples each block needs: the variance of the test image falls as
        // they grow, that of the reference and the rounding stay.
        let times = |block: &Block, channel: usize| {
            let rounding = block.channels[channel].difference.rounding;
            let room = (promise * block.floor(channel) - rounding).max(0.0);
            let of_term = |[reference, test]: [f64; 2]| match room * room - reference {
                left if left > 0.0 => test / left,
                _ => f64::INFINITY,
            };
            let [own, guard] = self.terms(block, channel).map(of_term);
            own.max(guard)
        };
        let times = self.of_nine_tenths(times);
        // More than any renderer takes: the reference is what is in the way.
        const MOST: f64 = 1e6;
        if times > MOST {
            return Some(Undecided::Reference(self.resolution(0.0)));
        }
        let samples = self.comparison.samples()[1];
        Some(match samples {
            Some(samples) => Undecided::Samples((times * f64::from(samples)).ceil() as u64),
            None => Undecided::Times(times.ceil() as u64),
        })
    }
}
