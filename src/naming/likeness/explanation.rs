//! Mistakes that explain failing cases: their order, likeliest first.

use super::MOST_NAMED;
use super::clock::{Search, SearchClock};
use super::compared_case::ComparedCase;
use super::hypothesis::Hypothesis;
use crate::compare::unexplained::SquaredDistance;
use crate::judging::{Judged, Likeness};
use crate::suite::Case;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Largest number of passing cases that may speak against a mistake. Five mistakes in twelve cases are about as many
/// looks as a radiative scene takes in one failing case.
const MOST_PASSING: usize = 12;

/// Largest number of scenes loaded for a hint. Loading one takes up to a quarter of a second
/// (figure 5): two seconds in all.
const MOST_SCENES: usize = 8;

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

    /// Mean of `what` over the cases that it explains.
    fn mean(&self, what: impl Fn(&SquaredDistance) -> f64) -> f64 {
        self.left.values().map(what).sum::<f64>() / self.left.len() as f64
    }

    /// Key of the order, likeliest first: few contradictions, many cases, one mistake rather than
    /// two, small distances, and then the order of the catalogue.
    pub fn rank(&self) -> (usize, Reverse<usize>, usize, u64, Hypothesis) {
        (
            self.contradictions,
            Reverse(self.left.len()),
            self.hypothesis.mistakes().count(),
            // Positive numbers are ordered as their bits are.
            self.mean(|left| left.value.max(0.0)).to_bits(),
            self.hypothesis,
        )
    }

    /// True if both explain the same cases, and neither leaves less beyond doubt.
    fn is_alike(&self, other: &Explanation) -> bool {
        let least = |it: &Explanation| it.mean(SquaredDistance::at_least);
        let most = |it: &Explanation| it.mean(SquaredDistance::at_most);
        self.left.keys().eq(other.left.keys())
            && self.contradictions == other.contradictions
            && self.hypothesis.mistakes().count() == other.hypothesis.mistakes().count()
            && most(self) >= least(other)
            && most(other) >= least(self)
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

/// The likeliest of `ranked` in words, with those that cannot be told apart; `failing` is the number of
/// failing cases, and `others` are cases that may distinguish two.
pub(super) fn named(
    ranked: &[Explanation],
    others: &[Case],
    judged: &[Judged],
    failing: usize,
) -> Vec<Likeness> {
    let is_unjudged = |case: &&Case| {
        let mut of_case = judged.iter().filter(|it| it.result.name == case.name);
        of_case.next().is_none_or(|it| it.evidence.test.is_none())
    };
    let unjudged: Vec<&Case> = others.iter().filter(is_unjudged).collect();
    let beside_the_next = |at: usize| {
        let (first, second) = (&ranked[at], ranked.get(at + 1)?);
        first.is_alike(second).then(|| {
            let hint = match telling(&first.hypothesis, &second.hypothesis, &unjudged) {
                Some(case) => format!("an image of {case} would tell them apart"),
                None => "images of other cases may tell them apart".to_owned(),
            };
            let other = second.hypothesis.name();
            format!("cannot be told apart from {other} in these cases; {hint}")
        })
    };
    let likeness = |(at, explanation): (usize, &Explanation)| Likeness {
        mistake: explanation.hypothesis.name(),
        advice: explanation.hypothesis.advice(),
        explains: explanation.left.len(),
        of: failing,
        cases: explanation
            .left
            .keys()
            .map(|&index| judged[index].result.name.clone())
            .collect(),
        beside_the_next: beside_the_next(at),
    };
    let ranked = ranked.iter().enumerate().take(MOST_NAMED);
    ranked.map(likeness).collect()
}

/// A case among `cases` that promises to catch one of the mistakes, and has no occasion for the
/// other.
fn telling<'c>(first: &Hypothesis, second: &Hypothesis, cases: &[&'c Case]) -> Option<&'c str> {
    let promises = |case: &Case, of: &Hypothesis| case.mistakes.contains(&of.name());
    let one_sided =
        cases
            .iter()
            .filter_map(|case| match [first, second].map(|it| promises(case, it)) {
                [true, false] => Some((case, second)),
                [false, true] => Some((case, first)),
                _ => None,
            });
    let mut scenes = one_sided
        .filter(|(_, other)| !other.is_of_the_image())
        .take(MOST_SCENES);
    let found = scenes.find(|(case, other)| {
        let scene = case.load_scene().ok();
        scene.is_some_and(|scene| other.mistakes().any(|it| it.in_scene(&scene).is_none()))
    });
    found.map(|(case, _)| case.name.as_str())
}
