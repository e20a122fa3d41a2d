//! The conventions behind an image that differs from the golden of a classified volume.
//!
//! An image that agrees with the golden under other [conventions](crate::scene::Conventions) is not
//! wrong. Sets of conventions are [searched](attempt) on few pixels, best first; once the whole image,
//! rendered under a set, agrees, conventions that are not needed are removed again. Only a set that
//! passes the gate is reported.

pub(super) mod attempt;
mod effects;
pub(super) mod images;

use super::diagnosis::{self, Predictions, Search, SearchClock, SearchStep};
use super::shipped_profile::{self, NamedProfile};
use crate::conventions::{CATALOGUE, ConventionSet, STEP, under};
use crate::film::Film;
use crate::judging::{CaseResult, Cause, Judged, OF_PROFILE, Verdict};
use crate::scene::{Compositing, Mode, Panel, Scene};
use crate::suite::{Case, Store};
use attempt::Attempt;
use images::Images;
use std::sync::Mutex;
use std::time::Duration;

/// Share of the work for a case that its conventions may take: mistakes have what is left, half or more.
const OF_CONVENTIONS: f64 = 0.5;

/// The conventions behind an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    /// The conventions.
    pub set: ConventionSet,
    /// The share of the pixels but for which it agrees, none of which is far off; 0 where it passes the gate.
    pub but_for: f64,
    /// Others, in place of one of the set, under which the image agrees as well.
    pub alternatives: Vec<usize>,
    /// The profile that states them; `None` for a step, which a profile does not state.
    pub profile: Option<String>,
}

impl Explained {
    /// The conventions in words, each with those that may stand in its place.
    pub fn in_words(&self) -> Vec<String> {
        let words = |&index: &usize| {
            let one = &CATALOGUE[index];
            let others = self.alternatives.iter().map(|&other| &CATALOGUE[other]);
            let others = others.filter(|other| other.choice == one.choice);
            others.fold(one.words.to_owned(), |words, other| {
                format!("{words} (or {})", other.words)
            })
        };
        self.set.iter().map(words).collect()
    }

    /// True of one convention; a step is none, but a parameter that the scene states.
    fn is_plain(&self) -> bool {
        matches!(self.set[..], [one] if CATALOGUE[one].choice != STEP)
    }

    /// Replaces a mismatch by the verdict of these conventions: no fault where they are `accepted`.
    fn explain(&self, result: &mut CaseResult, accepted: bool) {
        result.conventions = self.in_words();
        let rest = match self.but_for {
            0.0 => String::new(),
            share => format!(" but for {:.3} % of the pixels", 100.0 * share),
        };
        result.profile = self.profile.clone();
        set_verdict(result, accepted, &rest);
    }
}

/// Replaces a mismatch by the verdict of the conventions of `profile`, which volref brings as `name`.
fn explain_by_profile((name, profile): &NamedProfile, result: &mut CaseResult, accepted: bool) {
    let words = format!("{OF_PROFILE} {name}, {}", profile.name);
    result.conventions = vec![words];
    result.profile = Some(profile.text.clone());
    set_verdict(result, accepted, "");
}

/// The verdict of the conventions that `result` holds, under which the image agrees but for `rest`.
fn set_verdict(result: &mut CaseResult, accepted: bool, rest: &str) {
    result.verdict = Verdict::Convention;
    result.search_ended = Some(true);
    result.cause = if accepted {
        Cause::None
    } else {
        Cause::Convention
    };
    let conventions = result.conventions.join("; ");
    result.reason = format!(
        "differs by convention: it {conventions}. volref's image under these conventions agrees with it{rest}"
    );
}

/// The search for the conventions behind images, with the sets that were found so far: what
/// explains one image is tried first in the next.
pub struct ConventionSearch<'s> {
    known: Mutex<Vec<ConventionSet>>,
    interrupted: &'s (dyn Fn() -> bool + Sync),
    progress: &'s (dyn Fn(&SearchStep) + Sync),
}

impl Default for ConventionSearch<'_> {
    fn default() -> Self {
        ConventionSearch::watched(&|| false, &|_| ())
    }
}

impl<'s> ConventionSearch<'s> {
    /// A search that ends once it is `interrupted`, and reports its `progress`.
    pub fn watched(
        interrupted: &'s (dyn Fn() -> bool + Sync),
        progress: &'s (dyn Fn(&SearchStep) + Sync),
    ) -> ConventionSearch<'s> {
        ConventionSearch {
            known: Mutex::default(),
            interrupted,
            progress,
        }
    }

    /// Replaces a mismatch that other conventions explain by that verdict: a pass if they are
    /// `accepted`. The search takes at most half as much work as two cores do in `seconds`, and a note says so of one
    /// that needs more: on any machine the same. A later [search for mistakes](super::diagnosis) has the rest.
    ///
    /// For an image of 8 bits, the shipped [profiles](crate::conventions::Profile::shipped) are tried first, as they are: the search
    /// does not vary the roundings that they state.
    pub fn explain_mismatch(
        &self,
        case: &Case,
        store: &Store,
        judged: &mut Judged,
        seconds: f64,
        accepted: bool,
    ) {
        if !judged.differs() || seconds == 0.0 {
            return;
        }
        let Ok(scene) = case.load_scene() else {
            return;
        };
        let test = judged.evidence.image();
        let Some(test) = test.filter(|test| may_be_by_convention(&scene, test)) else {
            return;
        };
        let predictions = Predictions::default();
        let search = self.within(Some(OF_CONVENTIONS * seconds), &predictions);
        let clock = SearchClock::start(&search, &case.name, 0);
        let images = Images::of(&scene, &clock);
        let profile = shipped_profile::passing(case, store, judged, &images);
        let found = match &profile {
            Some(_) => None,
            None => self.explain_by(case, &test, &images),
        };
        let is_open = profile.is_none() && found.is_none() && clock.is_over();
        judged.evidence.work_of_search = clock.work();
        judged.evidence.conventions_are_open = is_open;
        if let Some(profile) = profile {
            explain_by_profile(&profile, &mut judged.result, accepted);
        }
        // A plainer cause has all of the work for the case.
        let search = self.within(Some(seconds), &predictions);
        if let Some(explained) = &found
            && (explained.is_plain() || !diagnosis::is_plainly_explained(case, judged, &search))
        {
            explained.explain(&mut judged.result, accepted);
        }
        if is_open && !(self.interrupted)() {
            let note = format!(
                "the search for conventions reached its limit, half of {seconds} s of work: give it more with --explain"
            );
            judged.result.notes.push(note);
        }
    }

    /// The options of a search with as much work as two cores do in these `seconds`.
    fn within<'p>(&'p self, seconds: Option<f64>, predictions: &'p Predictions) -> Search<'p> {
        Search {
            budget: seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
            predictions,
            interrupted: self.interrupted,
            progress: self.progress,
        }
    }

    /// The fewest conventions, of those tried, under which `image` passes as one of `case`. `None` if there are none, or none were found
    /// with as much work as two cores do in these `seconds`.
    pub fn explain(
        &self,
        case: &Case,
        scene: &Scene,
        image: &Film,
        seconds: Option<f64>,
    ) -> Option<Explained> {
        if !may_be_by_convention(scene, image) {
            return None;
        }
        let predictions = Predictions::default();
        let search = self.within(seconds, &predictions);
        let clock = SearchClock::start(&search, &case.name, 0);
        self.explain_by(case, image, &Images::of(scene, &clock))
    }

    /// [`explain`](Self::explain) of `test` by `images` of the scene.
    fn explain_by(&self, case: &Case, test: &Film, images: &Images<'_>) -> Option<Explained> {
        let attempt = Attempt::new(case.exposure, test, images);
        let known = self.known.lock().expect("no panic holds it").clone();
        let from_before = known.into_iter().find_map(|set| {
            let but_for = attempt.agreement_if_near(&set)?;
            attempt
                .is_explained(&set, but_for)
                .then_some((set, but_for))
        });
        let is_new = from_before.is_none();
        let (set, but_for) = from_before.or_else(|| attempt.search())?;
        if is_new {
            let mut known = self.known.lock().expect("no panic holds it");
            known.push(set.clone());
        }
        let alternatives = attempt.alternatives(&set, but_for);
        Some(Explained {
            profile: profile_text(images.scene, &set),
            alternatives,
            set,
            but_for,
        })
    }
}

/// True of an image of single classified volumes in the size of `scene`, of more than one colour.
fn may_be_by_convention(scene: &Scene, image: &Film) -> bool {
    let is_classified = |panel: &Panel| {
        let volume = panel.classified();
        volume.is_some_and(|volume| volume.mode == Mode::Composited && !volume.has_objects())
    };
    // No convention makes an image of one colour, such as black, of a volume.
    let has_colours = image.radiance().windows(2).any(|pair| pair[0] != pair[1]);
    let is_of_size = [image.width(), image.height()] == [scene.width(), scene.height()];
    is_of_size && has_colours && scene.panels.iter().all(is_classified)
}

/// The profile, as TOML, of the conventions of `set` in `scene`; `None` with another step.
fn profile_text(scene: &Scene, set: &[usize]) -> Option<String> {
    if set.iter().any(|&index| CATALOGUE[index].choice == STEP) {
        return None;
    }
    let scene = under(scene, set);
    let volume = scene.panels.iter().find_map(Panel::classified)?;
    let mut lines = vec!["name = \"mine\"".to_owned()];
    if let Compositing::EarlyTermination(threshold) = volume.compositing {
        lines.push(format!("early_termination = {threshold:?}"));
    }
    let conventions = volume.conventions.lines();
    if !conventions.is_empty() {
        lines.push("[conventions]".to_owned());
        lines.extend(conventions);
    }
    Some(lines.join("\n") + "\n")
}
