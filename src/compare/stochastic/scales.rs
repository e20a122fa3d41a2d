//! Squares of blocks at every scale: a bias that is too small for a block and too local for the image.

use super::comparison::Comparison;
use super::{colour, means, side};
use crate::compare::significance::{deviation, holm, two_sided, two_sided_estimated};

/// Sums over a square of blocks.
struct Square {
    /// First block.
    corner: [usize; 2],
    /// Blocks along an edge.
    edge: usize,
    channel: usize,
    pixels: f64,
    radiance: f64,
    difference: f64,
    variance: f64,
    probability: f64,
}

/// Whether any square of 2 × 2, 4 × 4 … blocks is off; both images state their noise.
pub(super) fn judge_scales(comparison: &Comparison<'_>, level: f64) -> Option<String> {
    if comparison.numbers().contains(&None) {
        return None;
    }
    let columns = comparison.columns();
    let rows = comparison.blocks.len() / columns;
    let mut squares = Vec::new();
    let mut edge = 2;
    while edge < columns.max(rows) {
        for row in (0..rows).step_by(edge) {
            for column in (0..columns).step_by(edge) {
                for channel in 0..3 {
                    squares.push(square(comparison, [column, row], edge, channel));
                }
            }
        }
        edge *= 2;
    }
    let probabilities: Vec<f64> = squares.iter().map(|square| square.probability).collect();
    let rejected = holm(&probabilities, level);
    let worst = squares
        .iter()
        .min_by(|a, b| a.probability.total_cmp(&b.probability))?;
    (rejected > 0).then(|| {
        let first = &comparison.blocks[worst.corner[1] * columns + worst.corner[0]];
        let pixels = worst.edge * super::BLOCK;
        format!(
            "a region of {pixels} × {pixels} pixels from column {} and row {} is too {} in {}: {}",
            first.columns.start,
            first.rows.start,
            side(worst.difference),
            colour(worst.channel),
            means(
                worst.radiance / worst.pixels,
                worst.difference / worst.pixels,
                deviation(worst.difference, worst.variance)
            ),
        )
    })
}

fn square(comparison: &Comparison<'_>, corner: [usize; 2], edge: usize, channel: usize) -> Square {
    let columns = comparison.columns();
    let rows = comparison.blocks.len() / columns;
    let (mut pixels, mut radiance, mut difference, mut rounding) = (0, 0.0, 0.0, 0.0);
    let (mut own, mut guard, mut degrees) = (0.0, 0.0, 0.0);
    for row in corner[1]..(corner[1] + edge).min(rows) {
        for column in corner[0]..(corner[0] + edge).min(columns) {
            let block = &comparison.blocks[row * columns + column];
            let of = &block.channels[channel];
            pixels += block.pixels();
            radiance += of.radiance;
            difference += of.difference.value;
            rounding += of.difference.rounding;
            own += of.variance.own();
            // By the ratio of noise that is larger, of single blocks or where the image is brightest.
            guard += of
                .variance
                .guard()
                .max(comparison.shape.guard_of_whole(of.stated, of.radiance));
            degrees += comparison.degrees(block);
        }
    }
    let beyond = (difference.abs() - rounding).max(0.0).copysign(difference);
    let by_own = two_sided_estimated(deviation(beyond, own), degrees);
    Square {
        corner,
        edge,
        channel,
        pixels: pixels as f64,
        radiance,
        difference,
        variance: own.max(guard),
        probability: by_own.max(two_sided(deviation(beyond, guard))),
    }
}
