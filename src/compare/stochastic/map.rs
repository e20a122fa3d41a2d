//! Maps over the blocks of an image: standard errors and deviations.

use super::blocks::{Rounding, blocks, parts};
use super::comparison::Comparison;
use super::cut_off::WithinCodes;
use super::resolution::of_nine_tenths;
use super::{block_deviation, finite};
use crate::compare::BlockMap;
use crate::film::Film;

/// The standard error of the mean of a block, relative to that mean plus [`DARK`](super::DARK), that nine
/// tenths of the blocks and channels do not exceed, as in the metric of the gate; `None` for an
/// image without noise.
pub(crate) fn block_error(film: &Film) -> Option<f64> {
    film.noise()?;
    let blocks = blocks([film; 2], Rounding::of(film));
    Some(of_nine_tenths(&blocks, |block, c| {
        block.channels[c].stated[0].sqrt() / block.floor(c)
    }))
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
