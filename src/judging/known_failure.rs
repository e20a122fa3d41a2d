//! How a result fails: what an entry of a file of known failures states of it.

use super::{CaseResult, Cause, Verdict};
use crate::compare::Gate;
use crate::compare::deterministic::{FAR_SHARE, HARD_CAP, OUTLIERS};
use crate::compare::perceptual::{MOST_MEAN, MOST_P99};
use crate::conventions::{CATALOGUE, Profile};
use crate::variations::mistakes;
use toml_edit::Value;

/// True of a result that is a fault of the renderer: its image differs or cannot be read, or the renderer failed. A
/// missing or undecided image is none: it has not been judged.
pub(super) fn is_failure(result: &CaseResult) -> bool {
    let differs = matches!(result.cause, Cause::Mismatch | Cause::Convention);
    let is_broken = result.verdict == Verdict::Error && result.cause == Cause::OtherRenderer;
    differs || is_broken
}

/// Begin of the words that name a profile as the cause.
pub(crate) const OF_PROFILE: &str = "has the conventions of the profile";

/// Names of the causes that were found, and true if they were searched to the end or found. A search that was left out
/// or ended early says nothing.
pub(super) fn found_causes(result: &CaseResult) -> (Vec<&str>, bool) {
    // Without the conventions that may stand in their place.
    let first = |words: &'_ String| words.split(" (or ").next().map_or(0, str::len);
    let found = result.looks_like.iter().chain(&result.conventions);
    let found: Vec<&str> = found.map(|words| &words[..first(words)]).collect();
    let is_searched = !found.is_empty() || result.search_ended == Some(true);
    (found, is_searched)
}

/// All names that `cause` may have: of mistakes and of conventions.
pub(super) fn causes() -> impl Iterator<Item = &'static str> {
    let mistakes = mistakes::catalogue().map(|mistake| mistake.name);
    mistakes.chain(CATALOGUE.iter().map(|convention| convention.words))
}

/// True if a search may find the `cause`.
pub(super) fn is_cause(cause: &str) -> bool {
    let profile = cause.strip_prefix(OF_PROFILE).unwrap_or_default();
    let is_named = |name| profile.trim_start().split(',').next() == Some(name);
    causes().any(|known| known == cause) || Profile::shipped().any(is_named)
}

/// A size of a difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Size {
    /// The bound to write for it.
    pub bound: f64,
    /// The size less the margin: above its bound, the difference has become worse.
    pub least: f64,
}

/// Keys that bound the sizes of a difference: that of the worst pixel, and how much of the image differs.
pub(super) const BOUNDS: [&str; 2] = ["bound", "share"];

/// Standard errors by which the mean of an image may be off by chance: by more once in 1.7 million images.
const STANDARD_ERRORS: f64 = 5.0;

impl Size {
    /// The sizes under the keys [`BOUNDS`], by metrics of the gate; `None` where they were not measured. What was
    /// measured of an image that conventions explain is left under these.
    ///
    /// The margin is what the gate itself lets pass: an image that it takes for the same as the known one may be off
    /// from the golden by so much more (triangle inequality). It moves a pixel by at most one tolerance, but for a
    /// share [`OUTLIERS`]: a pixel that is off by two was off by one, and was counted.
    pub fn of(result: &CaseResult) -> [Option<Size>; 2] {
        let size = |metric: &str, least: &str, margin: f64| {
            let [size, least] = [metric, least].map(|name| result.metrics.get(name));
            Some(Size {
                bound: rounded_up(*size?),
                least: least? - margin,
            })
        };
        let (worst, share, margin) = match result.gate {
            _ if result.verdict != Verdict::Fail => return [None; 2],
            Gate::Stochastic => return [Size::of_mean(result), None],
            Gate::Perceptual => {
                let p99 = size("flip_weighted_p99", "flip_weighted_p99", MOST_P99);
                return [p99, size("flip_mean", "flip_mean", MOST_MEAN)];
            }
            Gate::Deterministic => ("worst_in_tolerances", "outlier_share", HARD_CAP),
            // The pixel agrees within one width of its interval.
            _ => ("worst_off_limit", "share_off_limit", 1.0),
        };
        let share = size(share, FAR_SHARE.0, OUTLIERS);
        [size(worst, worst, margin), share]
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

/// Keys to write into an entry, with their values; `None` removes one.
pub(super) type Keys = Vec<(&'static str, Option<Value>)>;

/// How `result` fails, as it is written: the verdict, the first cause that was found, none if there was no search, and
/// the sizes.
pub(super) fn failing(result: &CaseResult) -> Keys {
    let (found, is_searched) = found_causes(result);
    let mut keys: Keys = vec![("verdict", Some(result.verdict.name().into()))];
    if is_searched {
        keys.push(("cause", found.first().map(|name| Value::from(*name))));
    }
    let bounds = Size::of(result).map(|size| Some(Value::from(size?.bound)));
    keys.extend(BOUNDS.into_iter().zip(bounds));
    keys
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
