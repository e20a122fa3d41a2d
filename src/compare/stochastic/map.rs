//! Maps over the blocks of an image: standard errors and deviations.

use super::blocks::{DARK, parts};
use super::comparison::Comparison;
use super::cut_off::WithinCodes;
use super::{block_deviation, finite};
use crate::compare::BlockMap;
use crate::film::Film;

/// The standard error of the mean of a block, relative to that mean plus [`DARK`], that nine
/// tenths of the blocks and channels do not exceed, as in the metric of the gate; `None` for an
/// image without noise.
pub(crate) fn block_error(film: &Film) -> Option<f64> {
    let noise = film.noise()?;
    let mut errors = Vec::new();
    for rows in parts(film.height()) {
        for columns in parts(film.width()) {
            for channel in 0..3 {
                let (mut radiance, mut variance, mut count) = (0.0, 0.0, 0.0);
                for row in rows.clone() {
                    for index in columns.clone().map(|column| row * film.width() + column) {
                        radiance += f64::from(film.radiance()[index][channel]);
                        variance += f64::from(noise.variance()[index][channel]);
                        count += 1.0;
                    }
                }
                errors.push(variance.sqrt() / (radiance.abs() + DARK * count));
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    Some(errors[(errors.len() * 9).div_ceil(10) - 1])
}

/// The deviations of the blocks of `test` from `reference`, images of the same size; `None` if
/// neither states its noise.
pub(crate) fn block_map(reference: &Film, test: &Film) -> Option<BlockMap> {
    if reference.noise().is_none() && test.noise().is_none() {
        return None;
    }
    let seen = WithinCodes::of(reference, test, super::FALSE_ALARM);
    let [left, right] = match &seen {
        Some(seen) => [&seen.reference, &seen.test],
        None => [reference, test],
    };
    let blocks = Comparison::new(left, right, super::FALSE_ALARM).blocks;
    Some(BlockMap {
        columns: parts(reference.width()).count(),
        rows: parts(reference.height()).count(),
        deviations: blocks
            .iter()
            .map(|block| block.channels.map(|c| finite(block_deviation(&c))))
            .collect(),
    })
}
