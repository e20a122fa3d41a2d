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

/// In what differences are measured, so that blocks can be added. Exchanging pixels of a block
/// moves neither.
#[derive(Clone, Copy)]
enum Unit {
    /// Their root mean square over the block: all blocks weigh alike, which finds smoothing.
    Spread,
    /// The standard error of a pixel of the block on average, or their root mean square where that
    /// is larger: blocks that hold more than noise weigh more, which finds what is misplaced.
    Noise,
}

/// Differences of a block, row by row.
fn scaled(comparison: &Comparison<'_>, block: &Block, unit: Unit) -> Vec<[f64; 3]> {
    let [reference, test] = comparison.films.map(|film| film.radiance());
    let scales = block.channels.map(|channel| {
        let squares = match unit {
            Unit::Spread => channel.squares,
            Unit::Noise => channel.variance.largest().max(channel.squares),
        };
        if channel.squares > 0.0 && squares.is_finite() {
            (block.pixels() as f64 / squares).sqrt()
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

/// Correlation across and down.
fn axes(comparison: &Comparison<'_>, unit: Unit) -> [Axis; 2] {
    let mut axes = [Axis::default(); 2];
    for block in &comparison.blocks {
        let (width, height) = (block.columns.len(), block.rows.len());
        let pixels = scaled(comparison, block, unit);
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
    let [spread, noise] = [Unit::Spread, Unit::Noise].map(|unit| axes(comparison, unit));
    let [across, down] = spread.map(|axis| axis.correlation());
    metrics.push(("correlation_across", across));
    metrics.push(("correlation_down", down));
    let probabilities = [spread, noise].concat();
    let probabilities: Vec<f64> = probabilities.iter().map(Axis::probability).collect();
    (holm(&probabilities, level) > 0).then(|| {
        let larger = |axis: usize| spread[axis].correlation().max(noise[axis].correlation());
        format!(
            "neighbouring pixels are off together (correlation {:.2} across, {:.2} down): too \
             smooth for pixels sampled independently; is the image denoised, smoothed or filtered \
             over more than a pixel, do pixels share random numbers, or is a whole region off?",
            larger(0),
            larger(1)
        )
    })
}
