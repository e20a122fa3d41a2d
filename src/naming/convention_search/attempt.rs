//! The search for the conventions behind one image: best first.
//!
//! A set of conventions is expanded: each single change of it is rendered on few pixels, and the
//! [effects](Effects) of the changes, added up, propose sets that are further away. The rendered set with the least
//! residual is expanded next, until the whole image agrees.

use super::effects::Effects;
use super::images::Images;
use crate::compare::deterministic::{in_tolerances, tolerance};
use crate::compare::unexplained::makes_what_shows;
use crate::compare::{Conditions, Picture, passes};
use crate::conventions::{CATALOGUE, Convention, ConventionSet, Profile, STEP, under};
use crate::film::Film;
use crate::judging::nothing_drawn::background;
use crate::math::{Sum, powu};
use crate::naming::diagnosis::{Stage, lattice_of, pixels_of};
use crate::render::Detail;
use crate::scene::{Classified, Compositing, Conventions, Panel, Scene};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of conventions in a set. VTK, as it comes, has eight of the catalogue.
const MOST_TOGETHER: usize = 9;

/// A difference counts by at most this many tolerances: a few pixels at an edge, far off, do not
/// decide for the whole image.
const CAP: f64 = 20.0;

/// Largest share of the pixels of the lattice that may be outside of the tolerance, if the whole image is rendered for the
/// verdict. The gate allows 0.02 % of all pixels; a lattice of few pixels may meet more of them.
pub const MOST_OUTSIDE: f64 = 0.005;

/// Approximate number of pixels of the lattice on which sets are compared.
pub const LATTICE: usize = 576;

/// Share of the remaining difference that a further convention must remove. If one of the renderer's conventions removes
/// less, the image passes without it, or another convention comes first.
const LEAST_GAIN: f64 = 0.1;

/// Largest number of sets that are expanded.
const MOST_EXPANDED: usize = 7;

/// Expansions after a set under which the image agrees but for rounding: a further convention may leave nothing.
const EXPANDED_AFTER_ROUNDING: usize = 2;

/// Largest number of sets of an expansion for which the whole image is rendered.
const MOST_WHOLE: usize = 3;

/// Largest share of the pixels outside of the tolerance under volref's conventions that may stay outside under the claimed
/// ones.
const LEFT_BY_ROUNDING: f64 = 0.1;

/// Residual of an image beside the right one under other conventions, in tolerances of the deterministic gate, by the
/// worst channel of each pixel.
pub struct Residual {
    /// Mean over the pixels of its square.
    mean_square: f64,
    /// Share of the pixels that are off by more than one tolerance.
    pub outside: f64,
    /// The worst pixel.
    worst: f64,
}

impl Residual {
    pub fn of(right: &Film, test: &Film) -> Residual {
        let test = &*test.nearest_to(right);
        let (mut sum, mut outside, mut largest) = (Sum::default(), 0, 0.0_f64);
        for (right, test) in right.radiance().iter().zip(test.radiance()) {
            let worst = in_tolerances(*right, *test);
            sum.add(worst.min(CAP) * worst.min(CAP));
            outside += usize::from(worst > 1.0);
            largest = largest.max(worst);
        }
        let pixels = right.radiance().len() as f64;
        Residual {
            mean_square: sum.value() / pixels,
            outside: outside as f64 / pixels,
            worst: largest,
        }
    }
}

/// The search in the images of one case.
pub struct Attempt<'a> {
    exposure: f64,
    images: &'a Images<'a>,
    test: &'a Film,
    /// The pixels that sets are compared on.
    lattice: Detail,
    /// The image there.
    on_lattice: Film,
    /// The image in which nothing is drawn.
    nothing: Film,
}

/// A set of conventions, rendered on the lattice.
struct Candidate {
    residual: Residual,
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
    /// The search in `test` at `exposure` stops, by `images` of the scene.
    pub fn new(exposure: f64, test: &'a Film, images: &'a Images<'a>) -> Attempt<'a> {
        let scene = images.scene;
        let lattice = lattice_of(scene.width() * scene.height(), LATTICE);
        Attempt {
            exposure,
            images,
            test,
            lattice,
            on_lattice: pixels_of(test, scene, lattice),
            nothing: background(scene).expect("conventions are about volumes"),
        }
    }

    /// The share of the pixels but for which the image agrees with that under the conventions of `set`, if it does: 0
    /// where it passes, and else what single precision may round.
    pub fn agreement(&self, set: &[usize]) -> Option<f64> {
        let right = self.images.under(set, Detail::Whole)?;
        if !makes_what_shows(&right, self.test, &self.nothing) {
            return None;
        }
        if self.passes(&right, self.test, false) {
            return Some(0.0);
        }
        let residual = Residual::of(&right, self.test);
        let is_rounding = residual.worst <= CAP && self.passes(&right, self.test, true);
        is_rounding.then_some(residual.outside.max(f64::MIN_POSITIVE))
    }

    /// The conventions under which the images agree, none of them without need, and that share of the pixels.
    pub fn search(&self) -> Option<(ConventionSet, f64)> {
        let found = self.backward_elimination(self.best_first()?)?;
        self.is_explained(&found.0, found.1).then_some(found)
    }

    /// True if the image under the conventions of `set` explains the test image. It differs from the image under
    /// volref's own conventions by more than the gate allows, and a step of the set [shows](Self::shows_step). It passes,
    /// or leaves at most the share [`LEFT_BY_ROUNDING`] of the pixels that were outside of the tolerance.
    pub fn is_explained(&self, set: &[usize], but_for: f64) -> bool {
        if !self.shows_step(set) {
            return false;
        }
        let images = [&[], set].map(|set| self.images.under(set, Detail::Whole));
        let [Some(own), Some(under)] = images else {
            return false;
        };
        let [before, left] = [&own, &under].map(|right| Residual::of(right, self.test).outside);
        !self.passes(&own, &under, false) && (but_for == 0.0 || left <= LEFT_BY_ROUNDING * before)
    }

    /// True of a set without a step. With one, its image must differ by more than the gate allows from the image with the
    /// scene's step: nobody claims a step that looks like the scene's.
    fn shows_step(&self, set: &[usize]) -> bool {
        let others = set.iter().filter(|&&index| CATALOGUE[index].choice != STEP);
        let others: ConventionSet = others.copied().collect();
        if others.len() == set.len() {
            return true;
        }
        let image = |set: &[usize]| self.images.under(set, Detail::Whole);
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
        passes(&pictures[0], &pictures[1], &conditions)
    }

    /// The first set, of those with the least residual, under which the whole images agree.
    fn best_first(&self) -> Option<(ConventionSet, f64)> {
        let mut candidates = Candidates::new();
        self.render(self.starts(), &mut candidates)?;
        let (mut rounded, mut after_rounding) = (None, 0);
        // First none, though others leave less: mistakes and conventions that add up are seen from there.
        let mut next = ConventionSet::new();
        for expanded in 0..MOST_EXPANDED {
            let clock = self.images.clock;
            clock.report(Stage::Conventions, expanded, MOST_EXPANDED);
            if self.expand(&next, &mut candidates).is_none() {
                break;
            }
            match self.agreeing(&mut candidates) {
                Some(found) if found.1 == 0.0 => return Some(found),
                // One that leaves a rest may lack a convention.
                other => rounded = other.or(rounded),
            }
            after_rounding += usize::from(rounded.is_some());
            if after_rounding > EXPANDED_AFTER_ROUNDING {
                break;
            }
            match best(&candidates) {
                Some(set) => next = set,
                None => break,
            }
        }
        rounded
    }

    /// Sets to begin with: none, and those of the bundled profiles.
    fn starts(&self) -> Vec<ConventionSet> {
        let profiles = Profile::shipped().filter_map(|name| {
            let profile = Profile::named(name).ok()?;
            profile_set(&profile, self.images.scene)
        });
        std::iter::once(ConventionSet::new())
            .chain(profiles)
            .collect()
    }

    /// Renders those of `sets` on the lattice that were not. `None` if the work has reached its limit.
    fn render(&self, sets: Vec<ConventionSet>, candidates: &mut Candidates) -> Option<()> {
        if self.images.clock.is_over() {
            return None;
        }
        let new: BTreeSet<ConventionSet> = sets
            .into_iter()
            .filter(|set| !candidates.contains_key(set))
            .collect();
        let rendered: Option<Vec<_>> = new
            .into_par_iter()
            .map(|set| {
                let image = self.images.under(&set, self.lattice)?;
                let candidate = Candidate {
                    residual: Residual::of(&image, &self.on_lattice),
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
        candidates.get_mut(set)?.is_expanded = true;
        let others = (0..CATALOGUE.len()).filter(|index| !set.contains(index));
        let to_own = set.iter().map(|&index| Change {
            to: None,
            ..Change::to(index)
        });
        // A change may be about a thing that the scene does not have.
        let before = stated(&under(self.images.scene, set));
        let changes = others.map(Change::to).chain(to_own);
        let changes = changes.map(|change| (change, change.of(set)));
        let changes = changes.filter(|(_, to)| stated(&under(self.images.scene, to)) != before);
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

    /// The first of the sets that leave least, a convention more for a share of [`LEAST_GAIN`], under which the whole
    /// images agree.
    fn agreeing(&self, candidates: &mut Candidates) -> Option<(ConventionSet, f64)> {
        let near = candidates.iter_mut();
        let near = near.filter(|(_, it)| !it.is_compared && it.residual.outside <= MOST_OUTSIDE);
        let mut near: Vec<_> = near.collect();
        let cost = |set: &ConventionSet, it: &Candidate| {
            it.residual.mean_square * powu(1.0 / (1.0 - LEAST_GAIN), set.len() as u32)
        };
        near.sort_by(|a, b| cost(a.0, a.1).total_cmp(&cost(b.0, b.1)));
        let mut best: Option<(ConventionSet, f64)> = None;
        for (set, candidate) in near.into_iter().take(MOST_WHOLE) {
            candidate.is_compared = true;
            let agreement = self.agreement(set);
            let least = best.as_ref().map_or(f64::INFINITY, |it| it.1);
            if let Some(but_for) = agreement.filter(|it| *it < least) {
                best = Some((set.clone(), but_for));
                if but_for == 0.0 {
                    break;
                }
            }
        }
        best
    }

    /// Agreement of the whole images, where that on the lattice does not exclude it.
    pub fn agreement_if_near(&self, set: &[usize]) -> Option<f64> {
        let image = self.images.under(set, self.lattice)?;
        let is_near = Residual::of(&image, &self.on_lattice).outside <= MOST_OUTSIDE;
        is_near.then(|| self.agreement(set))?
    }

    /// Backward elimination: the set without conventions that the image does not need; `None` if a
    /// single one is left that cannot explain the image alone.
    fn backward_elimination(
        &self,
        (mut set, mut agreement): (ConventionSet, f64),
    ) -> Option<(ConventionSet, f64)> {
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
    pub fn alternatives(&self, set: &[usize], agreement: f64) -> Vec<usize> {
        let agrees = |other: &usize| {
            let convention = &CATALOGUE[*other];
            let is_same = |&index: &usize| CATALOGUE[index].choice == convention.choice;
            let Some(place) = set.iter().position(is_same) else {
                return false;
            };
            let mut changed = set.to_vec();
            changed[place] = *other;
            let found = || self.agreement_if_near(&changed);
            set[place] != *other
                && convention.stands_alone
                && found().is_some_and(|found| found <= agreement)
        };
        (0..CATALOGUE.len()).filter(agrees).collect()
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

/// The set to expand next: the one with the least residual, doubled for each of its conventions, of those in which every
/// convention counts, as far as is known. Many that leave a little less than few may be none of them right, and from few
/// that are right the others are found one by one.
fn best(candidates: &Candidates) -> Option<ConventionSet> {
    let counts = |set: &ConventionSet, residual: &Residual| {
        let shorter = (0..set.len()).map(|index| {
            let mut shorter = set.clone();
            shorter.remove(index);
            shorter
        });
        let limit = |it: &Candidate| (1.0 - LEAST_GAIN) * it.residual.mean_square;
        shorter.chain([ConventionSet::new()]).all(|shorter| {
            let known = candidates.get(&shorter);
            known.is_none_or(|it| residual.mean_square < limit(it))
        })
    };
    let open = candidates
        .iter()
        .filter(|(set, it)| !it.is_expanded && counts(set, &it.residual));
    let lead = |(set, it): &(&ConventionSet, &Candidate)| {
        it.residual.mean_square * powu(2.0, set.len() as u32)
    };
    let best = open.min_by(|a, b| lead(a).total_cmp(&lead(b)));
    best.map(|(set, _)| set.clone())
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
