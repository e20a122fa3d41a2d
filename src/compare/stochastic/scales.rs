//! Tests of squares of blocks at every scale, for a bias too small for one block and too local for
//! the mean of the image.

use super::blocks::{Block, Channel};
use super::comparison::Comparison;
use super::{means, probability, side};
use crate::compare::significance::{deviation, holm};
use crate::film::CHANNELS;

/// A channel of a square of blocks.
struct Square {
    /// First block.
    corner: [usize; 2],
    /// Blocks along an edge.
    edge: usize,
    colour: usize,
    pixels: usize,
    sums: Channel,
    probability: f64,
}

/// Reason to reject, if any square of 2 × 2, 4 × 4 … blocks is off; both images state their noise.
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
                for colour in 0..3 {
                    let blocks = (row..(row + edge).min(rows)).flat_map(|row| {
                        (column..(column + edge).min(columns))
                            .map(move |column| &comparison.blocks[row * columns + column])
                    });
                    squares.push(Square::new(comparison, [column, row], edge, colour, blocks));
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
            side(worst.sums.difference.value),
            CHANNELS[worst.colour],
            means(
                worst.sums.radiance / worst.pixels as f64,
                worst.sums.difference.value / worst.pixels as f64,
                deviation(worst.sums.difference.value, worst.sums.variance.largest())
            ),
        )
    })
}

impl Square {
    fn new<'b>(
        comparison: &Comparison<'_>,
        corner: [usize; 2],
        edge: usize,
        colour: usize,
        blocks: impl Iterator<Item = &'b Block>,
    ) -> Square {
        let (mut sums, mut pixels, mut degrees) = (Channel::default(), 0, 0.0);
        for block in blocks {
            let of = &block.channels[colour];
            pixels += block.pixels();
            degrees += comparison.degrees(block);
            sums.radiance += of.radiance;
            sums.difference.add(of.difference);
            sums.variance.own[0] += of.variance.own();
            // By the ratio of noise that is larger, of single blocks or where the image is brightest.
            let of_whole = comparison.shape.guard_of_whole(of.stated, of.radiance);
            sums.variance.guard[0] += of.variance.guard().max(of_whole);
        }
        Square {
            corner,
            edge,
            colour,
            pixels,
            probability: probability(&sums, degrees),
            sums,
        }
    }
}
