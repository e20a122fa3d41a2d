//! How a result fails: what an entry of a file of known failures states of it.

use super::{CaseResult, Cause, Verdict};
use crate::compare::deterministic::HARD_CAP;
use crate::compare::perceptual::MOST_P99;

/// True of a result that is a fault of the renderer: its image differs or cannot be read, or the renderer failed. A
/// missing or undecided image is none: it has not been judged.
pub(super) fn is_failure(result: &CaseResult) -> bool {
    let differs = matches!(result.cause, Cause::Mismatch | Cause::Convention);
    let is_broken = result.verdict == Verdict::Error && result.cause == Cause::OtherRenderer;
    differs || is_broken
}

/// Names of the causes that were found, and true if they were searched to the end or found. A search that was left out
/// or ended early says nothing.
pub(super) fn found_causes(result: &CaseResult) -> (Vec<&str>, bool) {
    let found = result.looks_like.iter().chain(&result.conventions);
    let found: Vec<&str> = found.map(String::as_str).collect();
    let is_searched = !found.is_empty() || result.search_ended == Some(true);
    (found, is_searched)
}

/// The size of a difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Size {
    /// The bound to write for it.
    pub bound: f64,
    /// The size less the margin: above its bound, the difference has become worse.
    pub least: f64,
}

/// Standard errors by which the mean of an image may be off by chance: by more once in 1.7 million images.
const STANDARD_ERRORS: f64 = 5.0;

impl Size {
    /// The size by the metric of the gate; `None` where it was not measured.
    ///
    /// The margin is what the gate itself lets pass of this metric: an image that it takes for the same as the known
    /// one may be off from the golden by so much more (triangle inequality).
    pub fn of(result: &CaseResult) -> Option<Size> {
        let (metric, margin) = match result.gate.name() {
            "exact" => ("max_abs_error", 0.0),
            "deterministic" => ("worst_in_tolerances", HARD_CAP),
            // The pixel agrees within one width of its interval.
            "refinement" => ("worst_off_limit", 1.0),
            "perceptual" => ("flip_weighted_p99", MOST_P99),
            "stochastic" => return Size::of_mean(result),
            _ => return None,
        };
        let size = *result.metrics.get(metric)?;
        let bound = rounded_up(size);
        Some(Size {
            bound,
            least: size - margin,
        })
    }

    /// The size of the largest difference of the mean of a channel, which does not grow with the number of samples.
    /// Noise is in both images: the bound is above the one, and the other is taken as small as it may be.
    fn of_mean(result: &CaseResult) -> Option<Size> {
        let of_channel = |channel: &&str| {
            let metric = |kind: &str| result.metrics.get(&format!("mean_{kind}_{channel}"));
            let (difference, z) = (metric("difference")?.abs(), metric("z")?.abs());
            let error = if z > 0.0 { difference / z } else { 0.0 };
            Some((difference, STANDARD_ERRORS * error))
        };
        let channels = ["red", "green", "blue"];
        let sizes = channels.iter().filter_map(of_channel);
        let (size, margin) = sizes.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
        Some(Size {
            bound: rounded_up(size + margin),
            least: size - margin,
        })
    }
}

/// `size`, not negative, to three digits, never less.
fn rounded_up(size: f64) -> f64 {
    let text = format!("{size:.2e}");
    let near: f64 = text.parse().unwrap_or(size);
    match text.split_once('e') {
        Some((digits, power)) if near < size => {
            let digits: f64 = digits.parse().unwrap_or(10.0);
            let above = format!("{:.2}e{power}", digits + 0.01);
            above.parse().unwrap_or(size)
        }
        _ => near,
    }
}

/// How a case fails, as it is written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Failing {
    pub verdict: &'static str,
    /// The first cause that was found; `Some(None)` if none was, `None` if there was no search.
    pub cause: Option<Option<String>>,
    pub bound: Option<f64>,
}

impl Failing {
    pub fn of(result: &CaseResult) -> Failing {
        let (found, is_searched) = found_causes(result);
        let size = Size::of(result).filter(|_| result.verdict == Verdict::Fail);
        Failing {
            verdict: result.verdict.name(),
            cause: is_searched.then(|| found.first().map(|name| (*name).to_owned())),
            bound: size.map(|size| size.bound),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_up() {
        for (size, bound) in [
            (0.0, 0.0),
            (1.0, 1.0),
            (12.341, 12.4),
            (99.91, 100.0),
            (0.020_000_1, 0.0201),
            (3.0e-7, 3.0e-7),
        ] {
            assert_eq!(rounded_up(size), bound);
        }
    }
}
