//! Tests of squares of blocks, of rows and of columns at every scale, for a bias too small for one block and too
//! local for the mean of the image.
//!
//! A renderer loses what it works on at a time: tiles, which are squares of blocks, or lines. No block holds more
//! than an eighth of a line of pixels.

use super::blocks::{Block, Channel};
use super::comparison::Comparison;
use super::{block_deviation, means, probability, side};
use crate::compare::significance::holm;
use crate::film::CHANNELS;
use std::ops::Range;

/// A channel of a region.
struct Region {
    columns: Range<usize>,
    rows: Range<usize>,
    colour: usize,
    pixels: usize,
    sums: Channel,
    probability: f64,
}

/// Reason to reject, if any square of 2 × 2, 4 × 4 … blocks is off, or 1, 2, 4 … rows or columns next to each other;
/// both images state their noise.
pub(super) fn judge_scales(comparison: &Comparison<'_>, level: f64) -> Option<String> {
    if comparison.numbers().contains(&None) {
        return None;
    }
    let mut regions = squares(comparison);
    for lines in comparison.lines() {
        regions.extend(bands(comparison, &lines));
    }
    let probabilities: Vec<f64> = regions.iter().map(|region| region.probability).collect();
    let rejected = holm(&probabilities, level);
    let worst = regions
        .iter()
        .min_by(|a, b| a.probability.total_cmp(&b.probability))?;
    (rejected > 0).then(|| {
        format!(
            "a region of {} × {} pixels from column {} and row {} is too {} in {}: {}",
            worst.columns.len(),
            worst.rows.len(),
            worst.columns.start,
            worst.rows.start,
            side(worst.sums.difference.value),
            CHANNELS[worst.colour],
            means(
                worst.sums.radiance / worst.pixels as f64,
                worst.sums.difference.value / worst.pixels as f64,
                block_deviation(&worst.sums)
            ),
        )
    })
}

fn squares(comparison: &Comparison<'_>) -> Vec<Region> {
    let columns = comparison.columns();
    let rows = comparison.blocks.len() / columns;
    let mut squares = Vec::new();
    let mut edge = 2;
    while edge < columns.max(rows) {
        for row in (0..rows).step_by(edge) {
            for column in (0..columns).step_by(edge) {
                let blocks = (row..(row + edge).min(rows)).flat_map(|row| {
                    (column..(column + edge).min(columns))
                        .map(move |column| &comparison.blocks[row * columns + column])
                });
                squares.extend(Region::of(comparison, blocks));
            }
        }
        edge *= 2;
    }
    squares
}

/// Lines next to each other: 1, 2, 4 … but not all.
fn bands(comparison: &Comparison<'_>, lines: &[Block]) -> Vec<Region> {
    let mut bands = Vec::new();
    let mut width = 1;
    while width < lines.len() {
        for lines in lines.chunks(width) {
            bands.extend(Region::of(comparison, lines.iter()));
        }
        width *= 2;
    }
    bands
}

impl Region {
    /// The channels of a region of these blocks, which begin in its first corner and end in the last one.
    fn of<'b>(
        comparison: &Comparison<'_>,
        blocks: impl Iterator<Item = &'b Block> + Clone,
    ) -> [Region; 3] {
        [0, 1, 2].map(|colour| Region::new(comparison, colour, blocks.clone()))
    }

    fn new<'b>(
        comparison: &Comparison<'_>,
        colour: usize,
        blocks: impl Iterator<Item = &'b Block>,
    ) -> Region {
        let (mut sums, mut pixels, mut degrees) = (Channel::default(), 0, 0.0);
        let (mut columns, mut rows) = (0..0, 0..0);
        for block in blocks {
            if pixels == 0 {
                (columns.start, rows.start) = (block.columns.start, block.rows.start);
            }
            (columns.end, rows.end) = (block.columns.end, block.rows.end);
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
        Region {
            columns,
            rows,
            colour,
            pixels,
            probability: probability(&sums, degrees),
            sums,
        }
    }
}
