//! Test for correlated differences of neighbouring pixels.
//!
//! Pixels of the reference are independent of each other, so pixels of the test image must be, too.
//! They are not if an image was denoised, smoothed, or filtered over more than a pixel, if all
//! pixels use the same random numbers, or if a whole region is off.
//!
//! Noise of light that arrives rarely is skewed: most pixels are a little too dark, few much too
//! bright, and neighbours agree in sign though they have nothing in common. So pixels are first
//! subtracted from others of the same block, half a block away: with `a b` and `c d` next to each
//! other, the products (a − c)·(b − d) are symmetric around zero where a could as well be c, or b
//! be d. No pixel is used twice, so the products are independent, and for the sum of independent
//! symmetric numbers over the root of the sum of their squares, P(T ≥ t) ≤ exp(−t²/2): of any
//! distribution, however few they are.
//!
//! Where brightness varies within a block, a could not as well be c: what a light that was missed
//! leaves out varies with it, and only the few products that hold the light make up for that. The mean of a product is
//! zero all the same, as long as none is made smaller for being large: blocks are weighed by the noise of the finer
//! image, and never by their own differences. Edges weigh most, which finds what is misplaced. The bound is then that
//! of a normal number, from many products of mean zero, no longer one of any distribution.
//!
//! Source: Efron 1969, JASA 64, 1278–1302, after Hoeffding 1963, JASA 58, 13–30.

use super::super::significance::holm;
use super::Metrics;
use super::blocks::{BLOCK, Block, Channel};
use super::comparison::Comparison;
use crate::math;

/// Largest correlation of neighbours that is accepted, however unlikely: with it, the variance of
/// the sum of a block is less than 1 + 4 · 0.05 times what it should be, its standard error a tenth
/// off.
const CORRELATED: f64 = 0.05;

/// Correlation along one axis.
#[derive(Clone, Copy, Debug, Default)]
struct NeighbourAxis {
    products: f64,
    squared_products: f64,
    /// Half the sum of the squares of the factors.
    squares: f64,
}

impl NeighbourAxis {
    fn correlation(&self) -> f64 {
        if self.squares > 0.0 {
            self.products / self.squares
        } else {
            0.0
        }
    }

    /// Probability, at most, of a correlation as large; 1 of one that is left alone.
    fn probability(&self) -> f64 {
        if self.correlation() <= CORRELATED {
            return 1.0;
        }
        math::exp(-0.5 * self.products * self.products / self.squared_products)
    }

    /// Adds one product, of the channels together: they may share their noise.
    fn add(&mut self, [a, b, c, d]: [[f64; 3]; 4]) {
        let mut product = 0.0;
        for channel in 0..3 {
            let (one, next) = (a[channel] - c[channel], b[channel] - d[channel]);
            product += one * next;
            self.squares += 0.5 * (one * one + next * next);
        }
        self.products += product;
        self.squared_products += product * product;
    }
}

/// The pixels a, b, c, d along a line of a block: neighbours, and neighbours half a block on.
const QUADS: [[usize; 4]; 2] = [[0, 1, 4, 5], [2, 3, 6, 7]];

/// Factors on the differences of each block and channel, so that blocks can be added: one over the standard error of a
/// pixel of the finer image, or of the guard where the reference is known. The standard error is at least that of the
/// median block: dark blocks, to which a little light from others is much, do not outweigh bright ones.
fn scales(comparison: &Comparison<'_>) -> Vec<[f64; 3]> {
    let noise = |channel: &Channel| match comparison.shape.is_known {
        true => channel.variance.guard(),
        false => channel.stated[comparison.shape.fine],
    };
    let blocks = comparison.blocks.iter();
    let noises = blocks
        .clone()
        .flat_map(|block| block.channels.iter().map(noise));
    let typical = median(noises.filter(|noise| *noise > 0.0).collect());
    let scale = |block: &Block, c: usize| {
        let channel = &block.channels[c];
        let sum = noise(channel).max(typical);
        if sum > 0.0 && !is_banded(block, channel) {
            (block.pixels() as f64 / sum).sqrt()
        } else {
            0.0
        }
    };
    blocks
        .map(|block| [0, 1, 2].map(|c| scale(block, c)))
        .collect()
}

/// True if rounding may share its sign among neighbours: what makes bands of a slope. Noise whose
/// standard deviation is half a code of 8 bits, or half a step of a half float, or more dithers it: of the mean of a
/// rounded value it leaves exp(−2π²/4)/π codes, 0.2 % (Vanderkooy & Lipshitz 1984, J. Audio Eng. Soc. 32, 106–113). The rounding
/// itself adds a twelfth of the square of a code to the variance, a third of that of half a code.
fn is_banded(block: &Block, channel: &Channel) -> bool {
    let half_code = channel.difference.rounding / block.pixels() as f64;
    let variance = channel.spread / block.pixels() as f64;
    variance < 4.0 / 3.0 * half_code * half_code
}

/// Median; 0 for no values.
fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Correlation across and down.
fn axes(comparison: &Comparison<'_>) -> [NeighbourAxis; 2] {
    let [reference, test] = comparison.films.map(|film| film.radiance());
    let mut axes = [NeighbourAxis::default(); 2];
    for (block, scales) in comparison.blocks.iter().zip(scales(comparison)) {
        let (width, height) = (block.columns.len(), block.rows.len());
        let difference = |i: usize| {
            let channel = |c: usize| f64::from(test[i][c]) - f64::from(reference[i][c]);
            [0, 1, 2].map(|c| channel(c) * scales[c])
        };
        let indices = block.indices(comparison.films[0].width());
        let pixels: Vec<[f64; 3]> = indices.map(difference).collect();
        let steps = [(1, width, width, height), (width, 1, height, width)];
        for (axis, (along, across, length, lines)) in axes.iter_mut().zip(steps) {
            if length < BLOCK {
                continue;
            }
            for line in 0..lines {
                for quad in QUADS {
                    axis.add(quad.map(|i| pixels[line * across + i * along]));
                }
            }
        }
    }
    axes
}

/// Reason for a correlation: a filter leaves no pixel its own noise, and in a region that is off neighbours agree, too.
pub(super) fn judge_neighbours(
    comparison: &Comparison<'_>,
    level: f64,
    metrics: &mut Metrics,
) -> Option<String> {
    let axes = axes(comparison);
    let [across, down] = axes.map(|axis| axis.correlation());
    metrics.push(("correlation_across", across));
    metrics.push(("correlation_down", down));
    (holm(&axes.map(|axis| axis.probability()), level) > 0).then(|| {
        format!(
            "differences of neighbouring pixels are correlated ({across:.2} across, {down:.2} down; independent samples: \
             0): too smooth for noise; possible causes: denoising, smoothing, a filter wider than a pixel, random numbers \
             shared by pixels, or regions that are too bright, too dark or displaced"
        )
    })
}
