//! Noise that a test image does not state, beside a reference that has none.
//!
//! A right image without noise differs from such a reference by no more than the deterministic gate allows. An image that
//! differs by more is wrong, unless the difference is noise. Noise is in most pixels that have light, and neighbours are as
//! often on different sides of the median of their block as on the same. Single wrong pixels leave most pixels as they are.
//! Where an image is biased, displaced or filtered, neighbours are on the same side.

use super::super::deterministic::tolerance;
use super::blocks::{DARK, parts};
use crate::film::Film;
use std::collections::BTreeMap;

/// Share of the tolerance beyond which a pixel counts as off from the median difference of its block. Noise of which one
/// pixel in 5000 exceeds the tolerance, as the deterministic gate allows, has a standard deviation of a quarter of it
/// (3.7 standard deviations), and two thirds of its pixels are beyond this.
const OFF: f64 = 0.1;

/// Share of the neighbours beyond one half that may be on the same side. A mean of 2 × 2 pixels makes more:
/// asin(1/2)/π = 1/6. A median that varies within the block makes less: 2 · 0.2² = 0.08, if it leaves 70 % of the noise on
/// one side.
const MORE_ON_ONE_SIDE: f64 = 0.1;

/// Standard errors of that share that chance may add where few pixels have light: once in 30,000 images it is more.
const ERRORS: f64 = 4.0;

/// Means of the channels of a pixel: reference, and test minus reference.
fn grey(reference: &Film, test: &Film, index: usize) -> [f64; 2] {
    let mean = |film: &Film| {
        let channels = film.radiance()[index].map(f64::from);
        channels.iter().sum::<f64>() / 3.0
    };
    [mean(reference), mean(test) - mean(reference)]
}

/// True if `test` differs from `reference`, an image of the same size without noise, by noise.
pub(crate) fn is_off_by_noise(reference: &Film, test: &Film) -> bool {
    let (width, height) = (reference.width(), reference.height());
    let (mut filled, mut differing, mut same, mut pairs) = (0_usize, 0_usize, 0_usize, 0_usize);
    for rows in parts(height) {
        for columns in parts(width) {
            let indices = rows
                .clone()
                .flat_map(|y| columns.clone().map(move |x| y * width + x));
            let pixels: Vec<(usize, [f64; 2])> = indices
                .map(|index| (index, grey(reference, test, index)))
                .collect();
            if pixels
                .iter()
                .all(|(_, [right, off])| off.abs() <= tolerance(*right))
            {
                continue;
            }
            differing += 1;
            // Noise is in proportion to light.
            let lit = pixels.into_iter().filter(|(_, [right, _])| *right > DARK);
            let shares: BTreeMap<usize, [f64; 2]> = lit
                .map(|(index, [right, off])| (index, [off / right, tolerance(right) / right]))
                .collect();
            let mut sorted: Vec<f64> = shares.values().map(|[share, _]| *share).collect();
            sorted.sort_by(f64::total_cmp);
            let Some(&median) = sorted.get(sorted.len() / 2) else {
                continue;
            };
            let is_off = |[share, tolerance]: &&[f64; 2]| (share - median).abs() > OFF * tolerance;
            filled += usize::from(2 * shares.values().filter(is_off).count() > shares.len());
            let side = |index: usize| Some(shares.get(&index)?[0] > median);
            for &index in shares.keys() {
                // Nothing is beyond the end of a row, as the next block is another map.
                let beside = ((index + 1) % width != 0).then_some(index + 1);
                for other in [beside, Some(index + width)]
                    .into_iter()
                    .flatten()
                    .filter_map(side)
                {
                    pairs += 1;
                    same += usize::from(Some(other) == side(index));
                }
            }
        }
    }
    let pairs = pairs as f64;
    let chance = 0.5 * ERRORS / pairs.max(1.0).sqrt();
    2 * filled > differing && same as f64 <= (0.5 + MORE_ON_ONE_SIDE.max(chance)) * pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns, one too bright and one too dark: neighbours are on the same side down them, and on the other across. The
    /// end of a row is no neighbour of the next row's beginning, which is on the other side.
    #[test]
    fn the_ends_of_short_rows_are_no_neighbours() {
        let film = |value: &dyn Fn(usize) -> f32| {
            Film::new(2, 512, (0..1024).map(|index| [value(index); 3]).collect())
        };
        // The row makes the first of a block the median alone.
        let striped = film(&|index| match index % 2 {
            0 => 0.55 + 0.001 * (index / 2 % 8) as f32,
            _ => 0.45,
        });
        assert!(!is_off_by_noise(&film(&|_| 0.5), &striped));
    }
}
