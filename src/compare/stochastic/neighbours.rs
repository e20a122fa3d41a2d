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
#[derive(Clone, Copy, Default)]
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

    /// Probability of a correlation as large where there is none, at most.
    fn probability(&self) -> f64 {
        if self.products <= 0.0 {
            return 1.0;
        }
        math::exp(-0.5 * self.products * self.products / self.squared_products)
    }
}

/// The pixels a, b, c, d along a line of a block: neighbours, and neighbours half a block on.
const QUADS: [[usize; 4]; 2] = [[0, 1, 4, 5], [2, 3, 6, 7]];

/// Differences of a block in parts of their standard error on average, row by row.
fn scaled(comparison: &Comparison<'_>, block: &Block) -> Vec<[f64; 3]> {
    let [reference, test] = comparison.films.map(|film| film.radiance());
    let scales = block.channels.map(|channel| {
        let variance = channel.variance.largest() / block.pixels() as f64;
        if variance > 0.0 && variance.is_finite() {
            1.0 / variance.sqrt()
        } else {
            0.0
        }
    });
    let indices = block.indices(comparison.films[0].width());
    let scaled = indices.map(|i| {
        [0, 1, 2].map(|c| (f64::from(test[i][c]) - f64::from(reference[i][c])) * scales[c])
    });
    scaled.collect()
}

pub(super) fn judge_neighbours(
    comparison: &Comparison<'_>,
    level: f64,
    metrics: &mut Metrics,
) -> Option<String> {
    let mut axes = [Axis::default(); 2];
    for block in &comparison.blocks {
        let (width, height) = (block.columns.len(), block.rows.len());
        let pixels = scaled(comparison, block);
        let steps = [(1, width, width, height), (width, 1, height, width)];
        for (axis, (along, across, length, lines)) in axes.iter_mut().zip(steps) {
            if length < BLOCK {
                continue;
            }
            for line in 0..lines {
                for quad in QUADS {
                    let [a, b, c, d] = quad.map(|i| pixels[line * across + i * along]);
                    let mut product = 0.0;
                    for channel in 0..3 {
                        let (one, next) = (a[channel] - c[channel], b[channel] - d[channel]);
                        product += one * next;
                        axis.squares += 0.5 * (one * one + next * next);
                    }
                    axis.products += product;
                    axis.squared_products += product * product;
                }
            }
        }
    }
    let [across, down] = axes.map(|axis| axis.correlation());
    metrics.push(("correlation_across", across));
    metrics.push(("correlation_down", down));
    let probabilities = axes.map(|axis| match axis.correlation() > CORRELATED {
        true => axis.probability(),
        false => 1.0,
    });
    (holm(&probabilities, level) > 0).then(|| {
        format!(
            "neighbouring pixels are off together (correlation {across:.2} across, {down:.2} down): \
             too smooth for pixels sampled independently; is the image denoised, smoothed or \
             filtered over more than a pixel, do pixels share random numbers, or is a whole region \
             off?"
        )
    })
}
