//! The likely mistake behind an image.
//!
//! A failing image is compared with the image that every mistake of the
//! [catalogue](crate::variations::mistakes) would give: mistakes of the image are applied to the golden, those
//! of the scene are rendered, first with few pixels or samples, the remaining ones with more. A
//! mistake explains an image if it leaves no more than a [small share](unexplained) of what the
//! image differs from the golden by; among several, the one that is significantly nearest comes
//! first. If none does, pairs of mistakes are tried. Cases that passed contradict mistakes that would
//! have shown in them.
//!
//! A case explained by a mistake found before is not searched again, so a mistake that affects a
//! whole suite is searched once. The search of a case has a [budget](Search), and its renderings
//! are [kept](Predictions) for the next run.

mod clock;
mod compared_case;
mod distances;
mod distinguished;
mod fit;
mod hunt;
mod hypothesis;
mod kept;
mod opacity;
mod prediction;
mod registration;
mod step;
mod volume_in_view;

use crate::compare::SHARED_POSITIONS;
use crate::compare::cells::Misfit;
pub use clock::{Search, SearchStep, Stage};
pub(super) use clock::{WORK_PER_SECOND, latest_end};
pub use fit::is_number_found;
pub use kept::{CACHE_VARIABLE, Predictions, cache_of_the_user};
pub(crate) use prediction::{lattice_of, pixels_at, pixels_of};

use crate::conventions::Profile;
use crate::judging::{Cause, Judged, Likeness};
use crate::scene::Scene;
use crate::suite::Case;
use clock::SearchClock;
use compared_case::ComparedCase;
use fit::Fitted;
use hunt::singles;
use hypothesis::Hypothesis;
use opacity::OfOpacity;
use std::cmp::Reverse;
use std::collections::BTreeMap;

/// Sentence for a difference in which nothing stands out.
pub const NOTHING_STANDS_OUT: &str = "no gain and no shift by a pixel or less accounts for a fifth of the squared difference, \
    and it is in no channel, box or part that is looked for";

/// Sentence for a difference of which noise would hide whether even the right mistake explains it.
const UNDECIDABLE: &str = "no single mistake that was tried is shown to be the cause; at this noise two together cannot be \
    told apart: more samples would tell";

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

/// Largest number of cases that are searched for pairs of mistakes. A first look at the pairs takes
/// up to eight times as many renderings as one at single mistakes, 400 in place of 53, and what
/// explains one case is tried in all others: the second is for a folder whose first failing case is
/// special.
const MOST_PAIR_SEARCHES: usize = 2;

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
    /// Words on `case`, or on all, that nothing known explains.
    pub fn nothing_known(&self, case: Option<&str>) -> &'static str {
        let mut open = self.with_open_conventions.iter();
        if self.under_a_profile {
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
                failing.extend(failed.filter(|case| !case.is_another_exposure));
            }
            Cause::None | Cause::Undecided => passing.push((index, *case)),
            _ => {}
        }
    }
    let mut known: Vec<Hypothesis> = Vec::new();
    let mut fits: BTreeMap<Hypothesis, BTreeMap<usize, Misfit>> = BTreeMap::new();
    let mut unfinished = Vec::new();
    let mut open = Vec::new();
    let mut fitted: BTreeMap<usize, Fitted> = BTreeMap::new();
    for (at, failed) in failing.iter().enumerate() {
        let clock = SearchClock::start(search, &failed.name, singles());
        clock.report();
        let mut found: hunt::Explaining = known
            .iter()
            .filter_map(|it| Some((*it, failed.explanation(it, None, &clock)?)))
            .collect();
        if found.is_empty() {
            // First, for it takes little of the work that the search may use up.
            let in_pixels = failed.search_in_pixels(&clock);
            let (singles, looks) = failed.search(&clock);
            found = singles;
            let mut is_beyond_doubt = found.iter().any(|(_, misfit)| failed.explained_by(misfit));
            if found.is_empty() {
                found = in_pixels;
                is_beyond_doubt = !found.is_empty();
            }
            if !is_beyond_doubt && !failed.suspects.is_empty() {
                let fit = failed.fitted_numbers(&clock);
                // A number that agrees as well is as likely as a mistake that noise leaves possible.
                let is_nearer =
                    |misfit: &Misfit| fit.in_noise.is_none_or(|it| misfit.in_noise < it);
                found.retain(|(_, misfit)| is_nearer(misfit));
                fitted.insert(failed.index, fit);
            }
            explain(&failing[..at], &found, &clock, &mut known, &mut fits);
            let is_a_number = fitted.get(&failed.index).is_some_and(|fit| fit.agrees);
            let goes_on = failed.is_decidable() && failed.simple.is_none() && !is_a_number;
            if found.is_empty() && goes_on && !clock.is_late() {
                open.push((at, looks, clock));
            } else {
                unfinished.extend(clock.unfinished());
            }
        }
        for (hypothesis, misfit) in found {
            let of = fits.entry(hypothesis).or_default();
            of.insert(failed.index, misfit);
        }
    }
    // What no single mistake explains, also none that another case was explained by since.
    let mut pair_searches = 0;
    for (at, looks, mut clock) in open {
        let failed = &failing[at];
        let is_explained = fits.values().any(|cases| cases.contains_key(&failed.index));
        if is_explained {
            continue;
        }
        clock.resume();
        // One number that is off is likelier than two mistakes.
        let fit = fitted
            .entry(failed.index)
            .or_insert_with(|| failed.fitted_numbers(&clock));
        fit.or(failed.fitted_step(&clock));
        let mut is_explained = fit.is_explained || fit.agrees;
        if !is_explained && pair_searches < MOST_PAIR_SEARCHES && failed.can_tell_pairs() {
            pair_searches += 1;
            let found = failed.search_pairs(&looks, &mut clock);
            let others = failing[..at].iter().chain(&failing[at + 1..]);
            explain(others, &found, &clock, &mut known, &mut fits);
            is_explained |= !found.is_empty();
            for (hypothesis, misfit) in found {
                let of = fits.entry(hypothesis).or_default();
                of.insert(failed.index, misfit);
            }
        }
        if !is_explained {
            fit.or(failed.fitted_place(&clock));
        }
        unfinished.extend(clock.unfinished());
    }
    let mut ranked: Vec<Explanation> = fits.into_iter().map(Explanation::new).collect();
    ranked.sort_by_cached_key(Explanation::rank);
    // What passed speaks against mistakes that would have been seen there.
    let most = ranked.first().map_or(0, |first| first.fits.len());
    let close = ranked.iter_mut().filter(|other| other.fits.len() == most);
    let mut close: Vec<_> = close.take(MOST_CROSS_EXAMINED).collect();
    if close.len() > 1 {
        let questions = close.len() * passing.len().min(MOST_PASSING);
        let clock = SearchClock::start(search, "the cases that passed", questions);
        for (index, case) in passing.into_iter().take(MOST_PASSING) {
            if clock.is_over() {
                break;
            }
            let Some(passed) = ComparedCase::new(index, case, &judged[index], scenes) else {
                continue;
            };
            for explanation in &mut close {
                let speaks_against = passed.speaks_against(&explanation.hypothesis, &clock);
                explanation.contradictions += usize::from(speaks_against == Some(true));
                clock.decided();
            }
        }
    }
    ranked.sort_by_cached_key(Explanation::rank);
    for failed in &failing {
        judged[failed.index].result.looks_like = ranked
            .iter()
            .filter(|explanation| explanation.fits.contains_key(&failed.index))
            .map(|explanation| explanation.hypothesis.name())
            .take(MOST_NAMED)
            .collect();
    }
    let mut unexplained = Vec::new();
    for failed in &failing {
        let result = &mut judged[failed.index].result;
        if result.looks_like.is_empty() {
            let fit = fitted.remove(&failed.index).unwrap_or_default();
            result.difference = fit.sentence.into_iter().collect();
            if failed.has_noise() && !failed.is_decidable() && result.difference.is_empty() {
                result.difference.push(UNDECIDABLE.to_owned());
            }
            let measured = failed.measured_difference(fit.agrees);
            let is_measured = measured.is_some();
            result.difference.extend(measured.unwrap_or_default());
            let is_asked = result
                .difference
                .iter()
                .any(|said| said == SHARED_POSITIONS);
            if !is_asked && failed.may_share_positions(&result.changes) {
                result.difference.push(SHARED_POSITIONS.to_owned());
            }
            if result.difference.is_empty() && is_measured {
                result.difference.push(NOTHING_STANDS_OUT.to_owned());
            }
            // A simple map that explains all is in the verdict.
            if failed.simple.is_none() || !result.difference.is_empty() {
                unexplained.push((result.name.clone(), result.difference.clone()));
            }
        } else if let Some(fit) = fitted.remove(&failed.index)
            && fit.agrees
        {
            // Noise leaves both possible.
            result.difference = fit.sentence.into_iter().collect();
        }
    }
    let mut likely: Vec<Likeness> = ranked
        .iter()
        .take(MOST_NAMED)
        .map(|explanation| Likeness {
            mistake: explanation.hypothesis.name(),
            advice: explanation.hypothesis.advice(),
            explains: explanation.fits.len(),
            of: failing.len(),
            cases: explanation
                .fits
                .keys()
                .map(|&index| judged[index].result.name.clone())
                .collect(),
            beside_the_next: None,
        })
        .collect();
    let is_unjudged = |case: &&Case| {
        let of_case = |judged: &&Judged| judged.result.name == case.name;
        let judged = judged.iter().find(of_case);
        judged.is_none_or(|judged| judged.evidence.test.is_none())
    };
    let unjudged: Vec<&Case> = others.iter().filter(is_unjudged).collect();
    for (likely, pair) in likely.iter_mut().zip(ranked.windows(2)) {
        likely.beside_the_next = distinguished::in_words(&pair[0], &pair[1], &unjudged);
    }
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

/// Tries each new hypothesis `found` in one case also in the `others`.
fn explain<'c>(
    others: impl IntoIterator<Item = &'c ComparedCase> + Clone,
    found: &hunt::Explaining,
    clock: &SearchClock<'_>,
    known: &mut Vec<Hypothesis>,
    fits: &mut BTreeMap<Hypothesis, BTreeMap<usize, Misfit>>,
) {
    for (hypothesis, _) in found {
        if known.contains(hypothesis) {
            continue;
        }
        known.push(*hypothesis);
        for other in others.clone() {
            if let Some(misfit) = other.explanation(hypothesis, None, clock) {
                let of = fits.entry(*hypothesis).or_default();
                of.insert(other.index, misfit);
            }
        }
    }
}

/// A hypothesis that explains at least one case.
struct Explanation {
    hypothesis: Hypothesis,
    /// Misfit by index of the result.
    fits: BTreeMap<usize, Misfit>,
    /// Passing cases that would have failed.
    contradictions: usize,
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
    fn mean(&self, what: impl Fn(&Misfit) -> f64) -> f64 {
        self.fits.values().map(what).sum::<f64>() / self.fits.len() as f64
    }

    /// Key of the order, likeliest first: few contradictions, many cases, one mistake rather than
    /// two, small distances, and then the order of the catalogue.
    fn rank(&self) -> (usize, Reverse<usize>, usize, u64, Hypothesis) {
        (
            self.contradictions,
            Reverse(self.fits.len()),
            self.hypothesis.mistakes().len(),
            // Positive numbers are ordered as their bits are.
            self.mean(|misfit| misfit.distance().at_most()).to_bits(),
            self.hypothesis,
        )
    }
}
