//! The likely cause behind an image: a mistake, or a change of parameters.
//!
//! A search compares a failing image with the image that every mistake of the
//! [catalogue](crate::variations::mistakes) would give. It applies mistakes of the image to the golden, and renders
//! mistakes of the scene: first with few pixels or samples, the nearest ones with more. A mistake explains an image
//! if the image that it makes passes for it. Among several, the nearest comes first. If none does, the search tries the
//! usual pairs, then changes of parameters.
//!
//! What explains one case is tried first in the others, so a mistake that affects a whole suite is searched once. The
//! search of a case has a [budget](Search).

mod clock;
mod compared_case;
mod fit;
mod hypothesis;
mod predictions;
mod predictor;

pub(super) use clock::SearchClock;
pub use clock::{Search, SearchStep, Stage};
pub use predictions::Predictions;
pub(super) use predictor::{lattice_of, pixels_of};

use crate::conventions::Profile;
use crate::judging::{CaseResult, Judged, LikelyMistake, Verdict};
use crate::suite::Case;
use crate::variations::mistakes;
use compared_case::ComparedCase;
use fit::Fitted;
use hypothesis::Hypothesis;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Sentence for a difference of which noise hides the cause.
const UNDECIDABLE: &str =
    "the image is too noisy to compare causes: more samples would show the difference";

/// Sentence for right colours with an opacity that no mistake makes.
const OF_OPACITY_ALONE: &str = "the colours are right: the difference is in opacity alone, and no mistake of opacity that \
    is known makes it";

/// Words on a difference that nothing known explains.
pub(crate) const NOTHING_KNOWN: &str = "no cause found";

/// Largest number of mistakes named for an image. Each comes with two or three lines of advice:
/// five of them fill most of a terminal of 24 lines.
const MOST_NAMED: usize = 5;

/// Results of a search for mistakes.
#[derive(Clone, Debug, Default)]
pub struct Diagnosis {
    /// Likely mistakes, most likely first.
    pub likely: Vec<LikelyMistake>,
    /// Number of cases searched, completely or not.
    pub searched: usize,
    /// Searches that were ended before they were done.
    pub unfinished: Vec<SearchStep>,
    /// Results of cases that no mistake explains.
    pub unexplained: Vec<CaseResult>,
}

impl Diagnosis {
    /// What searches have left in `results`, each judged by itself.
    pub fn of_results(results: &[CaseResult]) -> Diagnosis {
        let failed = results.iter().filter(|it| it.verdict == Verdict::Fail);
        let searched = failed.filter(|it| it.search_ended == Some(true));
        let unexplained = searched.clone().filter(|it| it.looks_like.is_empty());
        Diagnosis {
            likely: likely(results.iter()),
            searched: searched.count(),
            unexplained: unexplained.cloned().collect(),
            ..Diagnosis::default()
        }
    }
}

/// The mistakes that `results` look like, first those that explain most cases.
fn likely<'r>(results: impl Iterator<Item = &'r CaseResult>) -> Vec<LikelyMistake> {
    let failed = results.filter(|it| it.verdict == Verdict::Fail);
    let searched: Vec<&CaseResult> = failed.filter(|it| it.search_ended.is_some()).collect();
    let mut likely: Vec<LikelyMistake> = Vec::new();
    for result in &searched {
        for name in &result.looks_like {
            let at = likely.iter().position(|known| known.mistake == *name);
            let at = at.unwrap_or_else(|| {
                let parts = name.split(" + ").filter_map(mistakes::named);
                let advice: Vec<&str> = parts.map(|mistake| mistake.advice).collect();
                likely.push(LikelyMistake {
                    mistake: name.clone(),
                    advice: advice.join("; and "),
                    explains: 0,
                    of: searched.len(),
                    cases: Vec::new(),
                });
                likely.len() - 1
            });
            likely[at].explains += 1;
            likely[at].cases.push(result.name.clone());
        }
    }
    likely.sort_by_key(|known| Reverse(known.explains));
    likely.truncate(MOST_NAMED);
    likely
}

/// Names the likely mistakes behind the failed images in `judged`: in `looks_like` of each result,
/// and for all together, most likely first. Mistakes are made in scenes under the `profile` by which the images were
/// judged.
pub fn diagnosis(
    cases: &[&Case],
    profile: Option<&Profile>,
    judged: &mut [Judged],
    search: &Search<'_>,
) -> Diagnosis {
    let mut failing = Vec::new();
    for (index, judged) in judged.iter().enumerate() {
        let case = cases.iter().find(|case| case.name == judged.result.name);
        let Some(case) = case else { continue };
        if judged.differs() {
            failing.extend(ComparedCase::new(index, case, judged, profile));
        }
    }
    let mut findings = Findings::default();
    for at in 0..failing.len() {
        findings.search(&failing, at, search);
    }
    let mut explanations: Vec<_> = findings.explanations.into_iter().collect();
    // Many cases first, then one mistake rather than two, small distances, and the order of the catalogue.
    explanations.sort_by_cached_key(|(hypothesis, left)| {
        let sum: f64 = left.values().map(|left| left.max(0.0)).sum();
        // Positive numbers are ordered as their bits are.
        let mean = (sum / left.len() as f64).to_bits();
        (Reverse(left.len()), hypothesis.mistakes().count(), mean)
    });
    let mut unexplained = Vec::new();
    for failed in &failing {
        let Judged { result, evidence } = &mut judged[failed.index];
        let explanations = explanations.iter();
        let explains = explanations.filter(|(_, left)| left.contains_key(&failed.index));
        let names = explains.map(|(hypothesis, _)| hypothesis.name());
        result.looks_like = names.take(MOST_NAMED).collect();
        let was_cut = findings
            .unfinished
            .iter()
            .any(|search| search.case == result.name);
        result.search_ended = Some(!was_cut && !evidence.conventions_are_open);
        let fit = findings.fitted.remove(&failed.index).unwrap_or_default();
        result.change_agrees = fit.agrees;
        if result.looks_like.is_empty() {
            result.difference = measured(failed, fit, findings.close.get(&failed.index));
            // A gain that explains all is in the verdict.
            if !failed.is_gain || !result.difference.is_empty() {
                unexplained.push(result.clone());
            }
        } else if fit.agrees {
            // Noise leaves both possible.
            result.difference = fit.sentence.into_iter().collect();
        }
    }
    Diagnosis {
        likely: likely(judged.iter().map(|it| &it.result)),
        searched: failing.len(),
        unfinished: findings.unfinished,
        unexplained,
    }
}

/// Findings on failing cases, by index of the result.
#[derive(Default)]
struct Findings {
    /// What each hypothesis leaves of the differences that it explains.
    explanations: BTreeMap<Hypothesis, BTreeMap<usize, f64>>,
    /// The nearest mistake that does not explain a case, in words.
    close: BTreeMap<usize, String>,
    fitted: BTreeMap<usize, Fitted>,
    unfinished: Vec<SearchStep>,
}

impl Findings {
    /// Searches the mistakes behind the failing case `at`, and fits parameters where there are none.
    fn search(&mut self, failing: &[ComparedCase], at: usize, search: &Search<'_>) {
        let failed = &failing[at];
        let clock = SearchClock::start(search, &failed.name, failed.spent);
        let known = self.explanations.keys().copied().collect();
        let mut found = failed.search_among(known, false, &clock);
        if found.explaining.is_empty() {
            found = failed.search(&clock);
        }
        let mut is_a_number = false;
        let mut sure = found.explaining.iter();
        let is_open = !sure.any(|(_, left)| failed.is_all_beyond_doubt(left));
        if is_open && !failed.suspects.is_empty() {
            let fit = failed.fitted(&clock);
            // A parameter that agrees as well is as likely as a mistake that noise leaves possible.
            found
                .explaining
                .retain(|(_, left)| !fit.agrees || left.value < fit.left);
            is_a_number = fit.agrees;
            self.fitted.insert(failed.index, fit);
        }
        let is_explained = !found.explaining.is_empty();
        for (hypothesis, left) in found.explaining {
            let is_new = !self.explanations.contains_key(&hypothesis);
            let of = self.explanations.entry(hypothesis).or_default();
            of.insert(failed.index, left.value);
            // Cases after this one try what is known by then.
            for other in failing[..at].iter().filter(|_| is_new) {
                let found = other.search_among(vec![hypothesis], false, &clock);
                let left = found.explaining.first();
                of.extend(left.map(|(_, left)| (other.index, left.value)));
            }
        }
        self.close
            .extend(found.close.map(|(_, words)| (failed.index, words)));
        let goes_on = failed.is_decidable() && !failed.is_gain && !failed.is_of_opacity;
        if !is_explained && goes_on && !is_a_number && !clock.is_late() {
            let fit = || failed.fitted(&clock);
            self.fitted.entry(failed.index).or_insert_with(fit);
        }
        self.unfinished.extend(clock.unfinished());
    }
}

/// True if one factor of the golden, or a single mistake of the catalogue, explains the image behind `judged`. Such a cause
/// is plainer than several conventions.
pub(super) fn is_plainly_explained(case: &Case, judged: &Judged, search: &Search<'_>) -> bool {
    let failed = ComparedCase::new(0, case, judged, None);
    failed.is_some_and(|failed| {
        let clock = SearchClock::start(search, &failed.name, failed.spent);
        failed.is_gain || !failed.search(&clock).explaining.is_empty()
    })
}

/// Sentences on the difference of a case that no mistake explains.
fn measured(failed: &ComparedCase, fit: Fitted, close: Option<&String>) -> Vec<String> {
    if fit.agrees {
        return fit.sentence.into_iter().collect();
    }
    let mut said: Vec<String> = close.cloned().or(fit.sentence).into_iter().collect();
    if failed.is_of_opacity {
        said.push(OF_OPACITY_ALONE.to_owned());
    } else if said.is_empty() && !failed.is_decidable() {
        said.push(UNDECIDABLE.to_owned());
    }
    said.extend(failed.measured_difference());
    said
}
