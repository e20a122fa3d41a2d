//! The likely mistake behind an image.
//!
//! A failing image is compared with the image that every mistake of the
//! [catalogue](crate::variations::mistakes) would give: mistakes of the image are applied to the golden, those
//! of the scene are rendered, first with few pixels or samples, the remaining ones with more. A
//! mistake explains an image if it leaves no more than a [small share](unexplained) of what the
//! image differs from the golden by; among several, the one that is significantly nearest comes
//! first. If none does, the usual pairs of mistakes are tried. Cases that passed contradict mistakes that would
//! have shown in them.
//!
//! A case explained by a mistake found before is not searched again, so a mistake that affects a
//! whole suite is searched once. The search of a case has a [budget](Search), and a run keeps its renderings.

mod clock;
mod compared_case;
mod distinguished;
mod explanations;
mod fit;
mod hunt;
mod hypothesis;
mod kept;
mod kept_values;
mod noisy_pixels;
mod opacity;
mod prediction;
mod predictor;
mod step;
mod volume_in_view;

use crate::compare::cells::Misfit;
use crate::compare::{NumberChange, SHARED_POSITIONS};
pub use clock::{Search, SearchStep, Stage};
pub(super) use clock::{WORK_PER_SECOND, latest_end};
pub(crate) use fit::is_number_found;
pub use kept::Predictions;
pub(crate) use prediction::{lattice_of, pixels_at, pixels_of};

use crate::conventions::Profile;
use crate::judging::{CaseResult, Cause, Judged, KnownMistakes, Likeness};
use crate::scene::Scene;
use crate::suite::Case;
use crate::variations::mistakes;
use clock::SearchClock;
use compared_case::ComparedCase;
use explanations::{Explanation, Explanations, Found};
use fit::Fitted;
use hypothesis::Hypothesis;
use opacity::OfOpacity;

/// Sentence for a difference in which nothing stands out.
pub(crate) const NOTHING_STANDS_OUT: &str = "no gain and no shift by a pixel or less accounts for a fifth of the squared difference, \
    and it is in no channel, box or part that is looked for";

/// Sentence for a difference of which noise would hide whether even the right mistake explains it.
const UNDECIDABLE: &str = "no mistake that was tried is shown to be the cause: noise would hide what the right one leaves of \
    the difference";

/// Sentence for right colours with an opacity that no mistake makes.
const OF_OPACITY_ALONE: &str = "the colours are right: the difference is in opacity alone, and no mistake of opacity that \
    is known makes it";

/// Largest number of mistakes named for an image. Each comes with two or three lines of advice:
/// five of them fill most of a terminal of 24 lines.
const MOST_NAMED: usize = 5;

/// Largest number of mistakes that are tested against passing cases: those that would be named.
const MOST_CROSS_EXAMINED: usize = MOST_NAMED;

/// Largest number of passing cases in that test. Five mistakes in twelve cases are 60 first looks,
/// about as many as the 53 mistakes of a radiative scene take in one failing case.
const MOST_PASSING: usize = 12;

/// Results of a search for mistakes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Likenesses {
    /// Likely mistakes, most likely first.
    pub likely: Vec<Likeness>,
    /// Number of cases searched, completely or not.
    pub searched: usize,
    /// Searches that were ended before they were done.
    pub unfinished: Vec<SearchStep>,
    /// Cases that no mistake explains, with what was measured of their difference: sentences.
    pub unexplained: Vec<(String, Vec<String>)>,
    /// Names of cases whose search for conventions ended at the limit of its work.
    pub with_open_conventions: Vec<String>,
    /// True if the images were judged by a profile, so that no other conventions were looked for.
    pub under_a_profile: bool,
}

impl Likenesses {
    /// What searches have left in `results`, each judged by itself.
    pub fn of_results(results: &[CaseResult]) -> Likenesses {
        let advice = |name: &str| -> String {
            let parts = name.split(" + ").filter_map(mistakes::named);
            let parts: Vec<&str> = parts.map(|mistake| mistake.advice).collect();
            parts.join("; and ")
        };
        let searched = results.iter().filter(|it| it.search_ended == Some(true));
        let of = results
            .iter()
            .filter(|it| it.search_ended.is_some())
            .count();
        let mut likely: Vec<Likeness> = Vec::new();
        for result in results {
            for name in &result.looks_like {
                let known = likely.iter_mut().find(|known| known.mistake == *name);
                match known {
                    Some(known) => known.cases.push(result.name.clone()),
                    None => likely.push(Likeness {
                        mistake: name.clone(),
                        advice: advice(name),
                        explains: 0,
                        of,
                        cases: vec![result.name.clone()],
                        beside_the_next: None,
                    }),
                }
            }
        }
        likely
            .iter_mut()
            .for_each(|known| known.explains = known.cases.len());
        likely.sort_by_key(|known| std::cmp::Reverse(known.explains));
        likely.truncate(MOST_NAMED);
        let unexplained = searched.clone().filter(|it| it.looks_like.is_empty());
        Likenesses {
            likely,
            searched: searched.count(),
            unexplained: unexplained
                .map(|it| (it.name.clone(), it.difference.clone()))
                .collect(),
            ..Likenesses::default()
        }
    }

    /// Words on `case`, or on all, that nothing known explains.
    pub(crate) fn nothing_known(&self, case: Option<&str>) -> &'static str {
        let mut open = self.with_open_conventions.iter();
        let is_asked = |(name, _): &&(String, Vec<String>)| case.is_none_or(|case| case == name);
        let mut asked = self.unexplained.iter().filter(is_asked).peekable();
        let is_hidden = |(_, said): &(String, Vec<String>)| said.iter().any(|it| it == UNDECIDABLE);
        if asked.peek().is_some() && asked.all(is_hidden) {
            "noise leaves the cause open"
        } else if self.under_a_profile {
            "no known mistake explains it under this profile"
        } else if open.any(|open| case.is_none_or(|case| case == open)) {
            "no known mistake explains it, and not all conventions were tried"
        } else {
            "no known mistake or convention explains it"
        }
    }
}

/// Names the likely mistakes behind the failed images in `judged`: in `looks_like` of each result,
/// and for all together, most likely first. `others` are cases that may distinguish mistakes where
/// these cannot. Mistakes are made in scenes under the `profile` by which the images were judged.
pub fn likeness(
    cases: &[&Case],
    others: &[Case],
    profile: Option<&Profile>,
    judged: &mut [Judged],
    search: &Search<'_>,
) -> Likenesses {
    let scene_of = |case: &Case| {
        let scene = case.load_scene().ok()?;
        let under = profile.and_then(|profile| profile.applied_to(&scene).ok().flatten());
        Some(under.unwrap_or(scene))
    };
    Likenesses {
        under_a_profile: profile.is_some(),
        ..likeness_with(cases, others, judged, &scene_of, search)
    }
}

/// [`likeness`], where scenes come from elsewhere.
pub(crate) fn likeness_with(
    cases: &[&Case],
    others: &[Case],
    judged: &mut [Judged],
    scenes: &dyn Fn(&Case) -> Option<Scene>,
    search: &Search<'_>,
) -> Likenesses {
    let (mut failing, mut passing) = (Vec::new(), Vec::new());
    let mut of_opacity = OfOpacity::default();
    for (index, judged) in judged.iter().enumerate() {
        let case = cases.iter().find(|case| case.name == judged.result.name);
        let Some(case) = case else { continue };
        match judged.result.cause {
            Cause::Mismatch if judged.differs() && of_opacity.takes(index, judged) => {}
            Cause::Mismatch if judged.differs() => {
                let failed = ComparedCase::new(index, case, judged, scenes);
                failing.extend(failed);
            }
            Cause::None | Cause::Undecided => passing.push((index, *case)),
            _ => {}
        }
    }
    let Found {
        explanations: mut ranked,
        mut fitted,
        unfinished,
    } = Explanations::search(&failing, search);
    ranked.sort_by_cached_key(Explanation::rank);
    let passed =
        |(index, case): (usize, &Case)| ComparedCase::new(index, case, &judged[index], scenes);
    cross_examine(&mut ranked, passing, &passed, search);
    ranked.sort_by_cached_key(Explanation::rank);
    let mut unexplained = Vec::new();
    for failed in &failing {
        let explains = |it: &&Explanation| it.fits.contains_key(&failed.index);
        let names = ranked
            .iter()
            .filter(explains)
            .map(|it| it.hypothesis.name());
        let Judged { result, evidence } = &mut judged[failed.index];
        result.looks_like = names.take(MOST_NAMED).collect();
        let was_cut = unfinished.iter().any(|search| search.case == result.name);
        result.search_ended = Some(!was_cut && !evidence.conventions_are_open);
        let fit = fitted.remove(&failed.index).unwrap_or_default();
        if result.looks_like.is_empty() {
            result.difference = measured(failed, fit, &result.changes);
            // A simple map that explains all is in the verdict.
            if failed.simple.is_none() || !result.difference.is_empty() {
                unexplained.push((result.name.clone(), result.difference.clone()));
            }
        } else if fit.agrees {
            // Noise leaves both possible.
            result.difference = fit.sentence.into_iter().collect();
        }
    }
    let mut likely = named(&ranked, others, judged, failing.len());
    let open = judged.iter().filter(|it| it.evidence.conventions_are_open);
    let with_open_conventions = open.map(|it| it.result.name.clone()).collect();
    let searched = failing.len() + of_opacity.count();
    let (of_opacity, without_name) = of_opacity.name(judged);
    likely.extend(of_opacity);
    let said = |name| (name, vec![OF_OPACITY_ALONE.to_owned()]);
    unexplained.extend(without_name.into_iter().map(said));
    Likenesses {
        likely,
        searched,
        unfinished,
        unexplained,
        with_open_conventions,
        under_a_profile: false,
    }
}

/// True if one factor of the golden, or a single mistake of the catalogue, explains the image behind `judged` as a gate has
/// it: that is plainer than several conventions. What this search finds and takes is handed on to the [later](likeness) one.
pub(super) fn is_plainly_explained(case: &Case, judged: &mut Judged, search: &Search<'_>) -> bool {
    let scenes = |case: &Case| case.load_scene().ok();
    let Some(failed) = ComparedCase::new(0, case, judged, &scenes) else {
        return false;
    };
    if failed.is_gain() {
        return true;
    }
    let clock = SearchClock::start(search, &failed.name, hunt::singles(), failed.spent);
    let found = failed.search(&clock);
    let mut hypotheses = found.iter().map(|(hypothesis, _)| hypothesis);
    let is_plain = hypotheses.any(|it| it.one().is_some() && failed.passes_with(it, &clock));
    let evidence = &mut judged.evidence;
    evidence.work_of_search = clock.work();
    if is_plain {
        let place = |(hypothesis, misfit): (Hypothesis, Misfit)| Some((hypothesis.one()?, misfit));
        evidence.known_mistakes = KnownMistakes(found.into_iter().filter_map(place).collect());
        evidence.conventions_are_open = clock.unfinished().is_some();
    }
    is_plain
}

/// Counts, for the likeliest of `ranked` that explain equally many cases, the `passing` cases in which they would have
/// been seen.
fn cross_examine<'c>(
    ranked: &mut [Explanation],
    passing: Vec<(usize, &'c Case)>,
    passed: &dyn Fn((usize, &'c Case)) -> Option<ComparedCase>,
    search: &Search<'_>,
) {
    let most = ranked.first().map_or(0, |first| first.fits.len());
    let close = ranked.iter_mut().filter(|other| other.fits.len() == most);
    let mut close: Vec<_> = close.take(MOST_CROSS_EXAMINED).collect();
    if close.len() < 2 {
        return;
    }
    let questions = close.len() * passing.len().min(MOST_PASSING);
    let clock = SearchClock::start(search, "the cases that passed", questions, 0);
    for case in passing.into_iter().take(MOST_PASSING) {
        if clock.is_over() {
            break;
        }
        let Some(passed) = passed(case) else { continue };
        for explanation in &mut close {
            let speaks_against = passed.speaks_against(&explanation.hypothesis, &clock);
            explanation.contradictions += usize::from(speaks_against == Some(true));
            clock.decided();
        }
    }
}

/// Sentences on the difference of a case that no mistake explains; `changes` are those that are stated already.
fn measured(failed: &ComparedCase, fit: Fitted, changes: &[NumberChange]) -> Vec<String> {
    let mut difference = Vec::from_iter(fit.sentence);
    if failed.has_noise() && !failed.is_decidable() && difference.is_empty() {
        difference.push(UNDECIDABLE.to_owned());
    }
    let measured = failed.measured_difference(fit.agrees);
    let is_measured = measured.is_some();
    difference.extend(measured.unwrap_or_default());
    let is_asked = difference.iter().any(|said| said == SHARED_POSITIONS);
    if !is_asked && failed.may_share_positions(changes) {
        difference.push(SHARED_POSITIONS.to_owned());
    }
    if difference.is_empty() && is_measured {
        difference.push(NOTHING_STANDS_OUT.to_owned());
    }
    difference
}

/// The likeliest of `ranked` in words, with the reason why each comes before the next; `failing` is the number of
/// failing cases, and `others` are cases that may distinguish two.
fn named(
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
    let beside = |at: usize| distinguished::in_words(&ranked[at], ranked.get(at + 1)?, &unjudged);
    let likeness = |(at, explanation): (usize, &Explanation)| Likeness {
        mistake: explanation.hypothesis.name(),
        advice: explanation.hypothesis.advice(),
        explains: explanation.fits.len(),
        of: failing,
        cases: explanation
            .fits
            .keys()
            .map(|&index| judged[index].result.name.clone())
            .collect(),
        beside_the_next: beside(at),
    };
    ranked
        .iter()
        .enumerate()
        .take(MOST_NAMED)
        .map(likeness)
        .collect()
}
