//! Changes of numbers of the scene as a forest plot, a point and an interval for each, and the
//! difference that they make as pictures.

use crate::compare::{FitMap, NumberChange};
use crate::report::template::{blue_to_red, image_address};
use minijinja::{Value, context};

/// Rows, at most: the others have smaller scores.
const MOST_ROWS: usize = 12;

/// Half of the width of a plot, in pixels, and that of its drawing.
const HALF: f64 = 130.0;
const DRAWN: f64 = 122.0;

/// Standard errors of a 95 % interval.
const INTERVAL: f64 = 1.96;

/// The rows, those that fit best first.
pub(super) fn rows(changes: &[NumberChange]) -> Vec<Value> {
    let shown = || changes.iter().take(MOST_ROWS);
    let of = |change: &NumberChange| match change.change / change.error {
        ratio if ratio.is_finite() => ratio,
        _ => 0.0,
    };
    let farthest = shown()
        .map(|change| of(change).abs() + INTERVAL)
        .fold(1.0, f64::max);
    let at = |errors: f64| format!("{:.1}", HALF + DRAWN * errors / farthest);
    let row = |change: &NumberChange| {
        let errors = of(change);
        context! {
            words => change.words,
            best => change.fits_best,
            low => at(errors - INTERVAL),
            high => at(errors + INTERVAL),
            at => at(errors),
            score => format!("{:.1}", change.score).replace('-', "−"),
            label => format!("{errors:.1} standard errors"),
        }
    };
    shown().map(row).collect()
}

/// The full colour of a picture is this many standard errors, at least: noise stays pale.
const FULL: f64 = 6.0;

/// Width of a picture on the page.
const PICTURE: usize = 240;

/// The difference, the part that the best changes make, and what is left, in one scale.
pub(super) fn pictures(fit: &FitMap) -> Value {
    // Channels have their noise from the same paths: their mean says no less than all three.
    let means = |blocks: &[[f64; 3]]| -> Vec<f64> {
        let mean = |block: &[f64; 3]| block.iter().sum::<f64>() / 3.0;
        blocks.iter().map(mean).collect()
    };
    let (difference, fitted) = (means(&fit.difference), means(&fit.fitted));
    let left = difference.iter().zip(&fitted).map(|(d, f)| d - f);
    let left: Vec<f64> = left.collect();
    let mut sizes: Vec<f64> = difference.iter().map(|errors| errors.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    // One block in a hundred may be beyond.
    let full = sizes[(sizes.len() - 1) * 99 / 100].max(FULL);
    let rows = difference.len() / fit.columns;
    let picture = |errors: &[f64], words: &str| {
        let codes: Vec<[u8; 3]> = errors
            .iter()
            .map(|errors| blue_to_red((errors / full).clamp(-1.0, 1.0)))
            .collect();
        context! { address => image_address(&codes, fit.columns, rows), words }
    };
    context! {
        full => format!("{full:.0}"),
        width => PICTURE,
        height => PICTURE * rows / fit.columns,
        pictures => [
            picture(&difference, "the difference"),
            picture(&fitted, "what the changes in bold make"),
            picture(&left, "what they leave"),
        ],
    }
}
