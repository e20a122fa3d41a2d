//! Neighbouring pixels: do their differences have anything in common?
//!
//! Pixels of the reference are independent of each other, so pixels of the test image must be.
//! They are not where an image was denoised, smoothed, or filtered over more than a pixel, where
//! all pixels use the same random numbers, or where a whole region is off.
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
//! leaves out varies with it, and only the few products that hold the light make up for that. The
//! mean of a product is zero all the same, as long as none is made smaller for being large. So
//! blocks are weighed by the noise that the finer image states for them, and never by what the
//! differences themselves are.
//!
//! Source: Efron 1969, JASA 64, 1278–1302, after Hoeffding 1963, JASA 58, 13–30.

use super::super::significance::holm;
use super::Metrics;
use super::blocks::{BLOCK, Block, Comparison};
use crate::math;

/// Correlation of neighbours that is left alone, however unlikely: with it, the variance of the
/// sum of a block is less than 1 + 4 · 0.05 times what it should be, its standard error a tenth
/// off.
const CORRELATED: f64 = 0.05;

/// Correlation along one axis.
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    products: f64,
    squared_products: f64,
    /// Half the sum of the squares of the factors.
    squares: f64,
}

impl Axis {
    fn correlation(&self) -> f64 {
        if self.squares > 0.0 {
            self.products / self.squares
        } else {
            0.0
        }
    }

    /// Probability of a correlation as large where there is none, at most; 1 of one that is left
    /// alone.
    fn probability(&self) -> f64 {
        if self.correlation() <= CORRELATED {
            return 1.0;
        }
        math::exp(-0.5 * self.products * self.products / self.squared_products)
    }

    /// One more product, of the channels together: they may share their noise.
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

/// What differences of each block and channel are multiplied by, so that blocks can be added: one
/// over the standard error of a pixel of the finer image, or of the median block where that is
/// larger. Dark blocks, in which light of others is much to them, do not outweigh those.
fn scales(comparison: &Comparison<'_>) -> Vec<[f64; 3]> {
    let fine = comparison.shape.fine;
    let of_block = |block: &Block| {
        let pixels = block.pixels() as f64;
        block.channels.map(|channel| channel.stated[fine] / pixels)
    };
    let variances: Vec<[f64; 3]> = comparison.blocks.iter().map(of_block).collect();
    let mut noisy: Vec<f64> = variances.concat();
    noisy.retain(|&variance| variance > 0.0);
    if noisy.is_empty() {
        return vec![[0.0; 3]; variances.len()];
    }
    let middle = noisy.len() / 2;
    let median = *noisy.select_nth_unstable_by(middle, f64::total_cmp).1;
    let scale = |variance: f64| 1.0 / variance.max(median).sqrt();
    variances.into_iter().map(|v| v.map(scale)).collect()
}

/// Correlation across and down.
fn axes(comparison: &Comparison<'_>) -> [Axis; 2] {
    let [reference, test] = comparison.films.map(|film| film.radiance());
    let mut axes = [Axis::default(); 2];
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
            "neighbouring pixels are off together (correlation {across:.2} across, {down:.2} down): \
             too smooth for pixels sampled independently; is the image denoised, smoothed or \
             filtered over more than a pixel, do pixels share random numbers, or is a whole region \
             off?"
        )
    })
}
