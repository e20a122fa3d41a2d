//! Changes of numbers of the scene as a forest plot, a point and an interval for each.

use crate::compare::NumberChange;
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
