//! Mistakes that explain failing cases: their order, likeliest first.

use super::MOST_NAMED;
use super::clock::{Search, SearchClock};
use super::compared_case::ComparedCase;
use super::hypothesis::Hypothesis;
use crate::compare::unexplained::SquaredDistance;
use crate::suite::Case;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Largest number of passing cases that may speak against a mistake. Five mistakes in twelve cases are about as many
/// looks as a radiative scene takes in one failing case.
const MOST_PASSING: usize = 12;

/// A hypothesis that explains at least one case.
pub(super) struct Explanation {
    pub hypothesis: Hypothesis,
    /// What it leaves of the difference, by index of the result.
    pub left: BTreeMap<usize, SquaredDistance>,
    /// Passing cases that would have failed.
    contradictions: usize,
}

impl Explanation {
    pub fn new(hypothesis: Hypothesis) -> Explanation {
        Explanation {
            hypothesis,
            left: BTreeMap::new(),
            contradictions: 0,
        }
    }

    /// Key of the order, likeliest first: few contradictions, many cases, one mistake rather than
    /// two, small distances, and then the order of the catalogue.
    pub fn rank(&self) -> (usize, Reverse<usize>, usize, u64, Hypothesis) {
        let left = self.left.values().map(|left| left.value.max(0.0));
        let mean = left.sum::<f64>() / self.left.len() as f64;
        (
            self.contradictions,
            Reverse(self.left.len()),
            self.hypothesis.mistakes().count(),
            // Positive numbers are ordered as their bits are.
            mean.to_bits(),
            self.hypothesis,
        )
    }
}

/// Counts, for the likeliest of `ranked` that explain equally many cases, the `passing` cases in which they would have
/// been seen.
pub(super) fn contradict<'c>(
    ranked: &mut [Explanation],
    passing: Vec<(usize, &'c Case)>,
    passed: &dyn Fn((usize, &'c Case)) -> Option<ComparedCase>,
    search: &Search<'_>,
) {
    let most = ranked.first().map_or(0, |first| first.left.len());
    let close = ranked.iter_mut().filter(|other| other.left.len() == most);
    let mut close: Vec<_> = close.take(MOST_NAMED).collect();
    if close.len() < 2 {
        return;
    }
    let clock = SearchClock::start(search, "the cases that passed", 0);
    let cases = passing.into_iter().take(MOST_PASSING);
    for passed in cases.filter_map(|case| if clock.is_over() { None } else { passed(case) }) {
        for explanation in &mut close {
            let agrees = passed.agrees_with(&explanation.hypothesis, &clock);
            explanation.contradictions += usize::from(agrees == Some(false));
        }
    }
}
