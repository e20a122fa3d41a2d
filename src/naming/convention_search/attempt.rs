//! The search for the conventions behind one image: best first.
//!
//! A set of conventions is expanded: each single change of it is rendered on few pixels, and the
//! [effects](Effects) of the changes, added up, propose sets that are further away. The rendered set with the least
//! residual is expanded next, until the whole image agrees.

use super::effects::Effects;
use super::images::Images;
use super::misfit::{CAP, LATTICE, MOST_OUTSIDE, Misfit};
use super::{Agreement, MOST_TOGETHER};
use crate::compare::deterministic::tolerance;
use crate::compare::unexplained::makes_what_shows;
use crate::compare::{Conditions, Picture, default_gate, judge};
use crate::conventions::{
    CATALOGUE, Convention, ConventionSet, FIRST_SAMPLE, Profile, STEP, under,
};
use crate::film::Film;
use crate::judging::nothing_drawn::background;
use crate::math::powu;
use crate::naming::likeness::{Stage, lattice_of, pixels_at, pixels_of};
use crate::render::Detail;
use crate::scene::{Classified, Compositing, Conventions, Panel, Scene};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Share of the remaining difference that a further convention must remove. A convention of the
/// renderer that removes less leaves an image that passes without it, or another one comes first.
const LEAST_GAIN: f64 = 0.1;

/// Largest number of sets that are expanded.
const MOST_EXPANDED: usize = 7;

/// Expansions after a set under which the image agrees but for rounding: a further convention may leave nothing.
const EXPANDED_AFTER_ROUNDING: usize = 2;

/// Largest number of sets of an expansion for which the whole image is rendered.
const MOST_WHOLE: usize = 3;

/// Share of the pixels that are outside of the tolerance under volref's conventions that may be so under
/// those that are claimed.
const LEFT_BY_ROUNDING: f64 = 0.1;

/// Expansions after which pairs of choices [`OF_STEPS`] are tried.
const EXPANDED_BEFORE_PAIRS: usize = 2;

/// Choices about the places of samples and about the opacity of a step. Samples that are at the right places by one
/// convention of two are at no right place, and which opacities are dropped depends on the step: neither may
/// leave less alone.
const OF_STEPS: [&str; 11] = [
    FIRST_SAMPLE,
    STEP,
    "step_length",
    "step_opacity",
    "fitted_steps",
    "last_step",
    "last_sample",
    "least_opacity",
    "box",
    "centring",
    "pixel",
];

/// The search in the images of one case.
pub struct Attempt<'a> {
    exposure: f64,
    scene: &'a Scene,
    images: &'a Images<'a>,
    /// The image with the step of the scene, and those with half of it, a quarter and so on.
    tests: &'a [Film],
    /// The pixels that sets are compared on, in the first of the images.
    lattice: Detail,
    /// The first of the images there.
    on_lattice: Film,
    /// The image in which nothing is drawn.
    nothing: Film,
}

/// A set of conventions, rendered on the lattice.
struct Candidate {
    misfit: Misfit,
    deviations: Vec<f64>,
    is_expanded: bool,
    /// The whole image was compared, too.
    is_compared: bool,
}

/// Everything rendered so far, by set.
type Candidates = BTreeMap<ConventionSet, Candidate>;

/// A change of a set of conventions.
#[derive(Clone, Copy)]
struct Change {
    choice: &'static str,
    /// The convention that answers the choice; volref's own if none does.
    to: Option<usize>,
}

impl Change {
    /// The change to the convention of this index.
    fn to(index: usize) -> Change {
        Change {
            choice: CATALOGUE[index].choice,
            to: Some(index),
        }
    }

    /// `set` with this change.
    fn of(self, set: &[usize]) -> ConventionSet {
        let others = set.iter().copied();
        let others = others.filter(|&index| CATALOGUE[index].choice != self.choice);
        let mut changed: ConventionSet = others.chain(self.to).collect();
        changed.sort_unstable();
        changed
    }
}

impl<'a> Attempt<'a> {
    /// The search in `tests`, at least one, images of `scene` at `exposure` stops, by `images` of that scene.
    pub fn new(
        scene: &'a Scene,
        exposure: f64,
        tests: &'a [Film],
        images: &'a Images<'a>,
    ) -> Attempt<'a> {
        let widths: Vec<usize> = scene.panels.iter().map(|panel| panel.width).collect();
        let lattice = lattice_of(scene.width() * scene.height(), LATTICE);
        Attempt {
            exposure,
            scene,
            images,
            tests,
            lattice,
            on_lattice: pixels_of(&tests[0], &widths, lattice),
            nothing: background(scene).expect("conventions are about volumes"),
        }
    }

    /// True if the work reached its limit.
    pub fn is_work_done(&self) -> bool {
        self.images.is_work_done()
    }

    /// Agreement of all test images with those under the conventions of `set`, if there is any.
    pub fn agreement(&self, set: &[usize]) -> Option<Agreement> {
        let mut least = Agreement::Full;
        for (halvings, test) in self.tests.iter().enumerate() {
            let agreement = self.agreement_at(set, halvings, test)?;
            if agreement > least {
                least = agreement;
            }
        }
        Some(least)
    }

    fn agreement_at(&self, set: &[usize], halvings: usize, test: &Film) -> Option<Agreement> {
        let right = self.images.under(set, halvings, Detail::Whole)?;
        if !makes_what_shows(&right, test, &self.nothing) {
            return None;
        }
        if self.passes(&right, test, false) {
            return Some(Agreement::Full);
        }
        let misfit = Misfit::of(&right, test);
        let is_rounding = misfit.worst <= CAP && self.passes(&right, test, true);
        is_rounding.then_some(Agreement::ButFor(misfit.outside))
    }

    /// The conventions under which the images agree, none of them without need.
    pub fn search(&self) -> Option<(ConventionSet, Agreement)> {
        let found = self.completed(self.backward_elimination(self.best_first()?)?);
        self.is_explained(&found.0, found.1).then_some(found)
    }

    /// The set with one more convention, if only that one is missing for the images to pass: one that shows in fewer
    /// pixels than the lattice sees.
    fn completed(
        &self,
        (set, agreement): (ConventionSet, Agreement),
    ) -> (ConventionSet, Agreement) {
        let larger = || {
            let right = self.images.under(&set, 0, Detail::Whole)?;
            let outside = Misfit::pixels_outside(&right, &self.tests[0]);
            if outside.is_empty() {
                return None; // it is one with shorter steps that does not pass
            }
            let rest = pixels_at(&self.tests[0], &outside, 1);
            let lacks = |index: &usize| {
                let is_same = |&other: &usize| CATALOGUE[other].choice == CATALOGUE[*index].choice;
                !set.iter().any(is_same)
            };
            let mut candidates = (0..CATALOGUE.len())
                .filter(lacks)
                .map(|index| Change::to(index).of(&set));
            candidates.find(|set| {
                let is_near = self
                    .images
                    .at(set, &outside)
                    .is_some_and(|right| Misfit::pixels_outside(&right, &rest).is_empty());
                is_near && self.agreement(set) == Some(Agreement::Full)
            })
        };
        let is_open = matches!(agreement, Agreement::ButFor(share) if share > 0.0);
        match (is_open && set.len() < MOST_TOGETHER)
            .then(larger)
            .flatten()
        {
            Some(larger) => (larger, Agreement::Full),
            None => (set, agreement),
        }
    }

    /// True if the images under the conventions of `set` differ from those under volref's own by more than the
    /// gate allows, and pass under the `agreement` or leave no more of the pixels outside of the tolerance than
    /// [`LEFT_BY_ROUNDING`]; and if a step of the set [shows](Self::shows_step).
    pub fn is_explained(&self, set: &[usize], agreement: Agreement) -> bool {
        if !self.shows_step(set) {
            return false;
        }
        let (mut differs, mut before, mut left) = (false, 0.0_f64, 0.0_f64);
        for (halvings, test) in self.tests.iter().enumerate() {
            let images = [&[], set].map(|set| self.images.under(set, halvings, Detail::Whole));
            let [Some(own), Some(under)] = images else {
                return false;
            };
            before = before.max(Misfit::of(&own, test).outside);
            left = left.max(Misfit::of(&under, test).outside);
            differs |= !self.passes(&own, &under, false);
        }
        differs && (agreement == Agreement::Full || left <= LEFT_BY_ROUNDING * before)
    }

    /// True of a set without a step, and of one whose image differs by more than the gate allows from that with the
    /// scene's step: one that cannot be told from the scene's is not claimed.
    fn shows_step(&self, set: &[usize]) -> bool {
        let others = set.iter().filter(|&&index| CATALOGUE[index].choice != STEP);
        let others: ConventionSet = others.copied().collect();
        if others.len() == set.len() {
            return true;
        }
        let image = |set: &[usize]| self.images.under(set, 0, Detail::Whole);
        let images = image(&others).zip(image(set));
        images.is_some_and(|(without, with)| !self.passes(&without, &with, false))
    }

    /// True if `test` passes, `in_single_precision` but for what that rounds.
    fn passes(&self, right: &Film, test: &Film, in_single_precision: bool) -> bool {
        let conditions = Conditions {
            exposure: self.exposure,
            in_single_precision,
            ..Conditions::default()
        };
        let pictures = [right, test].map(|film| Picture::Radiance(film.clone()));
        let (gate, _) = default_gate(&pictures[0], &pictures[1]);
        judge(gate, &pictures[0], &pictures[1], &conditions).is_ok_and(|judged| judged.passed)
    }

    /// The first set, of those with the least misfit, under which the whole images agree.
    fn best_first(&self) -> Option<(ConventionSet, Agreement)> {
        let mut candidates = Candidates::new();
        self.render(self.starts(), &mut candidates)?;
        // First none, though others leave less: mistakes and conventions that add up are seen from there.
        self.expand(&[], &mut candidates)?;
        let mut rounded = None;
        let mut after_rounding = 0;
        for expanded in 1..=MOST_EXPANDED {
            if expanded == EXPANDED_BEFORE_PAIRS {
                let pairs = self.with_pairs_of_steps(&candidates);
                if self.render(pairs, &mut candidates).is_none() {
                    break;
                }
            }
            match self.agreeing(&mut candidates) {
                Some(found) if found.1 == Agreement::Full => return Some(found),
                other => rounded = other.or(rounded),
            }
            after_rounding += usize::from(rounded.is_some());
            if after_rounding > EXPANDED_AFTER_ROUNDING || expanded == MOST_EXPANDED {
                break;
            }
            let Some(set) = next(&candidates) else { break };
            if self.expand(&set, &mut candidates).is_none() {
                break;
            }
        }
        rounded
    }

    /// Sets to begin with: none, and those of the bundled profiles.
    fn starts(&self) -> Vec<ConventionSet> {
        let profiles = Profile::shipped().filter_map(|name| {
            let profile = Profile::named(name).ok()?;
            profile_set(&profile, self.scene)
        });
        std::iter::once(ConventionSet::new())
            .chain(profiles)
            .collect()
    }

    /// The expanded set that [leads](lead), with each pair of conventions [`OF_STEPS`].
    fn with_pairs_of_steps(&self, candidates: &Candidates) -> Vec<ConventionSet> {
        let expanded = candidates.iter().filter(|(_, it)| it.is_expanded);
        let best = expanded.min_by(|a, b| lead(a).total_cmp(&lead(b)));
        let best = best.map_or(&[][..], |(set, _)| set);
        let own = stated(self.scene);
        let is_of_steps = |&index: &usize| {
            let choice = CATALOGUE[index].choice;
            let has_step = || stated(&under(self.scene, &[index])) != own;
            OF_STEPS.contains(&choice) && (choice != STEP || has_step())
        };
        let of_steps: Vec<usize> = (0..CATALOGUE.len()).filter(is_of_steps).collect();
        let mut sets = Vec::new();
        for (at, &first) in of_steps.iter().enumerate() {
            let with_first = Change::to(first).of(best);
            for &second in &of_steps[at + 1..] {
                if CATALOGUE[first].choice != CATALOGUE[second].choice {
                    sets.push(Change::to(second).of(&with_first));
                }
            }
        }
        sets
    }

    /// Renders those of `sets` on the lattice that were not. `None` if the work has reached its limit.
    fn render(&self, sets: Vec<ConventionSet>, candidates: &mut Candidates) -> Option<()> {
        if self.is_work_done() {
            return None;
        }
        let new: BTreeSet<ConventionSet> = sets
            .into_iter()
            .filter(|set| !candidates.contains_key(set))
            .collect();
        let rendered: Option<Vec<_>> = new
            .into_par_iter()
            .map(|set| {
                let image = self.images.under(&set, 0, self.lattice)?;
                let candidate = Candidate {
                    misfit: Misfit::of(&image, &self.on_lattice),
                    deviations: deviations(&image, &self.on_lattice),
                    is_expanded: false,
                    is_compared: false,
                };
                Some((set, candidate))
            })
            .collect();
        candidates.extend(rendered?);
        Some(())
    }

    /// Renders all single changes of `set`, and the sets that their effects propose.
    fn expand(&self, set: &[usize], candidates: &mut Candidates) -> Option<()> {
        let before = candidates.values().filter(|it| it.is_expanded).count();
        self.images
            .report(Stage::Conventions, before, MOST_EXPANDED);
        candidates.get_mut(set)?.is_expanded = true;
        let others = (0..CATALOGUE.len()).filter(|index| !set.contains(index));
        let to_own = set.iter().map(|&index| Change {
            to: None,
            ..Change::to(index)
        });
        // A change may be about a thing that the scene does not have.
        let before = stated(&under(self.scene, set));
        let changes = others.map(Change::to).chain(to_own);
        let changes = changes.map(|change| (change, change.of(set)));
        let changes = changes.filter(|(_, to)| stated(&under(self.scene, to)) != before);
        let changes: Vec<(Change, ConventionSet)> = changes.collect();
        let singles = changes.iter().map(|(_, to)| to.clone()).collect();
        self.render(singles, candidates)?;
        let effects = Effects::new(
            &candidates[set].deviations,
            changes
                .iter()
                .map(|(change, to)| (change.choice, &candidates[to].deviations[..])),
        );
        let proposed = effects.proposals(MOST_TOGETHER, LEAST_GAIN).into_iter();
        let proposed = proposed.map(|together| {
            let set = set.to_vec();
            together
                .into_iter()
                .fold(set, |set, change| changes[change].0.of(&set))
        });
        let proposed = proposed.filter(|set| set.len() <= MOST_TOGETHER).collect();
        self.render(proposed, candidates)
    }

    /// The first of the sets that leave least under which the whole images agree.
    fn agreeing(&self, candidates: &mut Candidates) -> Option<(ConventionSet, Agreement)> {
        let mut near: Vec<_> = candidates
            .iter_mut()
            .filter(|(_, it)| !it.is_compared && it.misfit.outside <= MOST_OUTSIDE)
            .collect();
        near.sort_by(by_misfit);
        let mut best: Option<(ConventionSet, Agreement)> = None;
        for (set, candidate) in near.into_iter().take(MOST_WHOLE) {
            candidate.is_compared = true;
            match self.agreement(set) {
                Some(Agreement::Full) => return Some((set.clone(), Agreement::Full)),
                Some(agreement) if best.as_ref().is_none_or(|it| agreement < it.1) => {
                    best = Some((set.clone(), agreement));
                }
                _ => {}
            }
        }
        best
    }

    /// Agreement of the whole images, where that on the lattice does not exclude it.
    pub fn agreement_if_near(&self, set: &[usize]) -> Option<Agreement> {
        let image = self.images.under(set, 0, self.lattice)?;
        let is_near = Misfit::of(&image, &self.on_lattice).outside <= MOST_OUTSIDE;
        is_near.then(|| self.agreement(set))?
    }

    /// Backward elimination: the set without conventions that the image does not need; `None` if a
    /// single one is left that cannot explain the image alone.
    fn backward_elimination(
        &self,
        (mut set, mut agreement): (ConventionSet, Agreement),
    ) -> Option<(ConventionSet, Agreement)> {
        let mut index = 0;
        while index < set.len() {
            let mut shorter = set.clone();
            shorter.remove(index);
            let is_step = CATALOGUE[set[index]].choice == STEP;
            match self.agreement_if_near(&shorter) {
                Some(other) if other <= agreement || is_step && !self.shows_step(&set) => {
                    (set, agreement) = (shorter, other);
                }
                _ => index += 1,
            }
        }
        let stands = |index: &usize| CATALOGUE[*index].stands_alone;
        let is_claimed = set.len() > 1 || set.iter().all(stands);
        (is_claimed && !set.is_empty()).then_some((set, agreement))
    }

    /// Conventions that can replace one of `set` with the same agreement or more. Where nothing is
    /// at the border, for example, the image does not depend on a first sample there.
    pub fn alternatives(&self, set: &[usize], agreement: Agreement) -> Vec<usize> {
        let others = CATALOGUE
            .iter()
            .enumerate()
            .filter_map(|(other, convention)| {
                let is_same = |&&index: &&usize| CATALOGUE[index].choice == convention.choice;
                let place = set.iter().position(|index| is_same(&index))?;
                let mut changed = set.to_vec();
                changed[place] = other;
                let agrees = set[place] != other
                    && convention.stands_alone
                    && self
                        .agreement_if_near(&changed)
                        .is_some_and(|found| found <= agreement);
                agrees.then_some(other)
            });
        others.collect()
    }
}

/// All that conventions are about in the volumes of a scene.
fn stated(scene: &Scene) -> Vec<(Conventions, Compositing, f64)> {
    let volumes = scene.panels.iter().filter_map(Panel::classified);
    volumes.map(stated_by).collect()
}

fn stated_by(volume: &Classified) -> (Conventions, Compositing, f64) {
    (volume.conventions, volume.compositing, volume.step)
}

/// The set to expand next: the best of those in which every convention counts, as far as is known. Sets that
/// differ by one that does not would be as good, one after the other; so would those that give other answers to
/// the same choices as one that was expanded, each of which counts half.
fn next(candidates: &Candidates) -> Option<ConventionSet> {
    let counts = |set: &ConventionSet, misfit: &Misfit| {
        let shorter = (0..set.len()).map(|index| {
            let mut shorter = set.clone();
            shorter.remove(index);
            shorter
        });
        let limit = |it: &Candidate| (1.0 - LEAST_GAIN) * it.misfit.mean_square;
        shorter.chain([ConventionSet::new()]).all(|shorter| {
            let known = candidates.get(&shorter);
            known.is_none_or(|it| misfit.mean_square < limit(it))
        })
    };
    let choices = |set: &[usize]| -> BTreeSet<&str> {
        set.iter().map(|&index| CATALOGUE[index].choice).collect()
    };
    let expanded = candidates.iter().filter(|(_, it)| it.is_expanded);
    let expanded: Vec<_> = expanded.map(|(set, _)| choices(set)).collect();
    let rank = |it: &(&ConventionSet, &Candidate)| {
        let choices = choices(it.0);
        let before = expanded.iter().filter(|other| **other == choices).count();
        lead(it) * powu(2.0, before as u32)
    };
    let open = candidates
        .iter()
        .filter(|(set, it)| !it.is_expanded && counts(set, &it.misfit));
    let best = open.min_by(|a, b| rank(a).total_cmp(&rank(b)));
    best.map(|(set, _)| set.clone())
}

/// Misfit of a set, doubled for each of its conventions: many that leave a little less than few may be none of
/// them right, and from few that are right the others are found one by one.
fn lead((set, candidate): &(&ConventionSet, &Candidate)) -> f64 {
    candidate.misfit.mean_square * powu(2.0, set.len() as u32)
}

/// The order in which candidates are tried: by what they leave, a convention more for a share of
/// [`LEAST_GAIN`].
fn by_misfit(
    a: &(&ConventionSet, &mut Candidate),
    b: &(&ConventionSet, &mut Candidate),
) -> Ordering {
    let cost = |(set, candidate): &(&ConventionSet, &mut Candidate)| {
        candidate.misfit.mean_square * powu(1.0 / (1.0 - LEAST_GAIN), set.len() as u32)
    };
    cost(a).total_cmp(&cost(b))
}

/// The conventions of the catalogue that `profile` holds beside those of `scene`.
fn profile_set(profile: &Profile, scene: &Scene) -> Option<ConventionSet> {
    let applied = profile.applied_to(scene).ok()??;
    let volume = |scene: &Scene| scene.panels.iter().find_map(Panel::classified).cloned();
    let (before, after) = (volume(scene)?, volume(&applied)?);
    let changes = |volume: &Classified, convention: &Convention| {
        let mut changed = volume.clone();
        convention.apply(&mut changed);
        stated_by(&changed) != stated_by(volume)
    };
    let held = CATALOGUE
        .iter()
        .enumerate()
        .filter(|(_, convention)| changes(&before, convention) && !changes(&after, convention));
    Some(held.map(|(index, _)| index).collect())
}

/// Differences of the values of two images, in tolerances of the test image, so that those of several images
/// can be subtracted from each other; at most [`CAP`].
fn deviations(right: &Film, test: &Film) -> Vec<f64> {
    let test = test.nearest_to(right);
    let values = right.radiance().as_flattened().iter();
    let values = values.zip(test.radiance().as_flattened());
    let deviation = |(&right, &test): (&f32, &f32)| {
        let (right, test) = (f64::from(right), f64::from(test));
        ((right - test) / tolerance(test)).clamp(-CAP, CAP)
    };
    values.map(deviation).collect()
}
