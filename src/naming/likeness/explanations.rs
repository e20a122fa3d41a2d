//! Hypotheses that explain failing images: found in one case, tried in all others.

use super::clock::{Search, SearchClock, SearchStep};
use super::compared_case::ComparedCase;
use super::fit::Fitted;
use super::hunt::singles;
use super::hypothesis::{Explaining, Hypothesis};
use crate::compare::cells::Misfit;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Explanations of failing cases.
pub(super) struct Explanations<'c> {
    failing: &'c [ComparedCase],
    /// Hypotheses that were tried in every case searched so far.
    known: Vec<Hypothesis>,
    /// Misfit by hypothesis and index of the result.
    misfits: BTreeMap<Hypothesis, BTreeMap<usize, Misfit>>,
    /// Changes of numbers by index of the result.
    fitted: BTreeMap<usize, Fitted>,
    unfinished: Vec<SearchStep>,
}

/// Search of a case that no single mistake explains, interrupted.
struct OpenSearch<'s> {
    /// Place among the failing cases.
    at: usize,
    clock: SearchClock<'s>,
}

/// Results of the search: hypotheses, changes of numbers by index of the result, and searches that were ended.
pub(super) struct Found {
    pub explanations: Vec<Explanation>,
    pub fitted: BTreeMap<usize, Fitted>,
    pub unfinished: Vec<SearchStep>,
}

impl<'c> Explanations<'c> {
    /// Searches all `failing` cases for single mistakes, then those that none explains for changed parameters.
    pub fn search(failing: &'c [ComparedCase], search: &Search<'_>) -> Found {
        let mut explanations = Explanations {
            failing,
            known: Vec::new(),
            misfits: BTreeMap::new(),
            fitted: BTreeMap::new(),
            unfinished: Vec::new(),
        };
        let open: Vec<OpenSearch<'_>> = (0..failing.len())
            .filter_map(|at| explanations.search_singles(at, search))
            .collect();
        for open in open {
            explanations.fit(open);
        }
        let found = explanations.misfits.into_iter().map(Explanation::new);
        Found {
            explanations: found.collect(),
            fitted: explanations.fitted,
            unfinished: explanations.unfinished,
        }
    }

    /// Searches the failing case `at` for single mistakes; returns the search if it can go on.
    fn search_singles<'s>(&mut self, at: usize, search: &'s Search<'_>) -> Option<OpenSearch<'s>>
    where
        'c: 's,
    {
        let failed = &self.failing[at];
        let clock = SearchClock::start(search, &failed.name, singles(), failed.spent);
        clock.report();
        let known: Explaining = self
            .known
            .iter()
            .filter_map(|it| Some((*it, failed.explanation(it, None, &clock)?)))
            .collect();
        if !known.is_empty() {
            self.add(failed, known);
            return None;
        }
        if !failed.known.is_empty() {
            self.try_in(&self.failing[..at], &failed.known, &clock);
            self.add(failed, failed.known.iter().copied());
            return None;
        }
        // First, for it takes little of the work that the search may use up.
        let in_pixels = failed.search_in_pixels(&clock);
        let mut found = failed.search(&clock);
        let mut is_beyond_doubt = found.iter().any(|(_, misfit)| failed.explained_by(misfit));
        if !is_beyond_doubt && !in_pixels.is_empty() {
            (found, is_beyond_doubt) = (in_pixels, true);
        }
        let mut is_a_number = false;
        if !is_beyond_doubt && !failed.suspects.is_empty() {
            let fit = failed.fitted_numbers(&clock);
            // A number that agrees as well is as likely as a mistake that noise leaves possible.
            let is_nearer = |misfit: &Misfit| fit.in_noise.is_none_or(|it| misfit.in_noise < it);
            found.retain(|(_, misfit)| is_nearer(misfit));
            is_a_number = fit.agrees;
            self.fitted.insert(failed.index, fit);
        }
        // Cases after this one try what is known by then.
        self.try_in(&self.failing[..at], &found, &clock);
        let goes_on = failed.is_decidable() && failed.simple.is_none() && !is_a_number;
        if found.is_empty() && goes_on && !clock.is_late() {
            return Some(OpenSearch { at, clock });
        }
        self.unfinished.extend(clock.unfinished());
        self.add(failed, found);
        None
    }

    /// Goes on with a search for changed parameters, unless a mistake of another case has explained this one since.
    fn fit(&mut self, open: OpenSearch<'_>) {
        let OpenSearch { at, mut clock } = open;
        let failed = &self.failing[at];
        let mut explained = self.misfits.values();
        if explained.any(|cases| cases.contains_key(&failed.index)) {
            return;
        }
        clock.resume();
        let known = self.fitted.remove(&failed.index);
        let mut fit = known.unwrap_or_else(|| failed.fitted_numbers(&clock));
        fit.or(failed.fitted_step(&clock));
        self.fitted.insert(failed.index, fit);
        self.unfinished.extend(clock.unfinished());
    }

    /// Tries each new hypothesis of `found` in the `others`.
    fn try_in(
        &mut self,
        others: impl IntoIterator<Item = &'c ComparedCase> + Clone,
        found: &Explaining,
        clock: &SearchClock<'_>,
    ) {
        for (hypothesis, _) in found {
            if self.known.contains(hypothesis) {
                continue;
            }
            self.known.push(*hypothesis);
            for other in others.clone() {
                let misfit = other.explanation(hypothesis, None, clock);
                self.add(other, misfit.map(|misfit| (*hypothesis, misfit)));
            }
        }
    }

    /// Adds hypotheses that explain `case`.
    fn add(&mut self, case: &ComparedCase, found: impl IntoIterator<Item = (Hypothesis, Misfit)>) {
        for (hypothesis, misfit) in found {
            let of = self.misfits.entry(hypothesis).or_default();
            of.insert(case.index, misfit);
        }
    }
}

/// A hypothesis that explains at least one case.
pub(super) struct Explanation {
    pub hypothesis: Hypothesis,
    /// Misfit by index of the result.
    pub fits: BTreeMap<usize, Misfit>,
    /// Passing cases that would have failed.
    pub contradictions: usize,
}

impl Explanation {
    fn new((hypothesis, fits): (Hypothesis, BTreeMap<usize, Misfit>)) -> Explanation {
        Explanation {
            hypothesis,
            fits,
            contradictions: 0,
        }
    }

    /// Mean of `what` over the cases that it explains.
    pub fn mean(&self, what: impl Fn(&Misfit) -> f64) -> f64 {
        self.fits.values().map(what).sum::<f64>() / self.fits.len() as f64
    }

    /// Key of the order, likeliest first: few contradictions, many cases, one mistake rather than
    /// two, small distances, and then the order of the catalogue.
    pub fn rank(&self) -> (usize, Reverse<usize>, usize, u64, Hypothesis) {
        (
            self.contradictions,
            Reverse(self.fits.len()),
            self.hypothesis.mistakes().len(),
            // Positive numbers are ordered as their bits are.
            self.mean(Misfit::remoteness).to_bits(),
            self.hypothesis,
        )
    }
}
