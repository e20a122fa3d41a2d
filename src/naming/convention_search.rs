//! The conventions behind an image that differs from the golden of a classified volume.
//!
//! An image that agrees with the golden under other [conventions](crate::scene::Conventions) is not
//! wrong. Conventions are added one by one, on few pixels: each time the one of the
//! [catalogue](CATALOGUE) that brings the right image nearest to the test image. Once the whole
//! image, rendered under all of them, agrees, conventions that are not needed are removed again.
//! Only a set that passes the gate is reported.

use super::likeness::{lattice_of, pixels_of};
use crate::compare::deterministic::in_tolerances;
use crate::compare::{Conditions, Picture, default_gate, judge};
use crate::conventions::{
    CATALOGUE, Convention, ConventionSet, FIRST_SAMPLE, Profile, STEP, under,
};
use crate::film::Film;
use crate::judging::{CaseResult, Cause, Judged, Verdict};
use crate::math::Sum;
use crate::render::{Detail, Sampling, plans, render_coarse};
use crate::scene::{Classified, Compositing, Panel, Scene};
use crate::suite::Case;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Agreement of an image with the right one under other conventions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Agreement {
    /// It passes the gate.
    Full,
    /// All but this share of the pixels are within the tolerance, and none is far off.
    ButFor(f64),
}

impl Agreement {
    /// Share of the pixels that disagree.
    fn rest(self) -> f64 {
        match self {
            Agreement::Full => 0.0,
            Agreement::ButFor(share) => share,
        }
    }
}

/// The conventions behind an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    /// The conventions.
    pub set: ConventionSet,
    /// Agreement under them.
    pub agreement: Agreement,
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

    /// Replaces a mismatch by the verdict of these conventions: a pass where they are `accepted`.
    fn explain(&self, result: &mut CaseResult, accepted: bool) {
        result.conventions = self.in_words();
        result.verdict = Verdict::Convention;
        result.cause = if accepted {
            Cause::None
        } else {
            Cause::Convention
        };
        let rest = match self.agreement {
            Agreement::Full => String::new(),
            Agreement::ButFor(share) => format!(" but for {:.3} % of the pixels", 100.0 * share),
        };
        let outside = result.metrics.get("outlier_share");
        let size = outside.map_or(String::new(), |share| {
            format!(" in {:.3} % of the pixels", 100.0 * share)
        });
        result.reason = format!(
            "differs by convention{size}: it {}. The right image under {} agrees with it{rest}",
            result.conventions.join("; "),
            if result.conventions.len() == 1 {
                "this convention"
            } else {
                "these conventions"
            }
        );
        result.profile = self.profile.clone();
    }
}

/// Largest number of conventions in a set. VTK, as it comes, has eight of the catalogue.
const MOST_TOGETHER: usize = 9;

/// Share of the remaining difference that a further convention must remove. A convention of the
/// renderer that removes less leaves an image that passes without it, or another one comes first.
const LEAST_GAIN: f64 = 0.03;

/// First conventions to begin with, from that which leaves least on: two together may look more like a
/// third than like either.
const STARTS: usize = 4;

/// A difference counts by at most this many tolerances: a few pixels at an edge, far off, do not
/// decide for the whole image.
const CAP: f64 = 20.0;

/// Largest share of the pixels of the lattice outside of the tolerance at which the whole image is
/// rendered for the verdict. The gate allows 0.02 %; a lattice of few pixels may have met more of
/// them.
const MOST_OUTSIDE: f64 = 0.005;

/// Share of the pixels that may be outside of the tolerance under the conventions of a renderer, and
/// still be called rounding: five times what the gate allows. Renderers for graphics cards
/// compute in single precision, and highlights of an exponent of 32 magnify a normal that is off by a
/// thousandth to more than the tolerance of 1 %: VTK, as it comes, has 18 to 38 such pixels of 65,536.
const MOST_ROUNDED: f64 = 1e-3;

/// Approximate number of pixels of the lattice on which sets are compared.
const LATTICE: usize = 1024;

/// The search for the conventions behind images, with the sets that were found so far: what
/// explains one image is tried first in the next.
#[derive(Debug, Default)]
pub struct ConventionSearch {
    known: Mutex<Vec<ConventionSet>>,
}

impl ConventionSearch {
    /// Replaces a mismatch that other conventions explain by that verdict: a pass if they are
    /// `accepted`. Takes at most half of `seconds`.
    pub fn explain_mismatch(&self, case: &Case, judged: &mut Judged, seconds: f64, accepted: bool) {
        if !judged.differs() {
            return;
        }
        let (Some(test), Ok(scene)) = (&judged.evidence.test, case.load_scene()) else {
            return;
        };
        let end = Instant::now().checked_add(Duration::from_secs_f64(0.5 * seconds));
        if let Some(explained) = self.explain(case, &scene, test, end) {
            explained.explain(&mut judged.result, accepted);
        }
    }

    /// The fewest conventions, of those tried, under which `test` passes as an image of `case`;
    /// `None` if there are none, or if the time is over.
    pub fn explain(
        &self,
        case: &Case,
        scene: &Scene,
        test: &Picture,
        end: Option<Instant>,
    ) -> Option<Explained> {
        if test.size() != (scene.width(), scene.height()) || is_of_one_colour(test) {
            return None;
        }
        // An integral has no samples, and no conventions about them.
        let is_sampled = |volume: &Classified| !volume.is_continuous();
        let mut volumes = scene.panels.iter().map(Panel::classified);
        if !volumes.all(|volume| volume.is_some_and(is_sampled)) {
            return None;
        }
        let attempt = Attempt {
            case,
            scene,
            test,
            end,
        };
        let known = self.known.lock().expect("no panic holds it").clone();
        let from_before = known.into_iter().find_map(|set| {
            let agreement = attempt.agreement(&set)?;
            Some((set, agreement))
        });
        let is_new = from_before.is_none();
        let found = from_before.or_else(|| attempt.of_a_profile());
        let (set, agreement) = found.or_else(|| attempt.search())?;
        if is_new {
            let mut known = self.known.lock().expect("no panic holds it");
            known.push(set.clone());
        }
        let alternatives = attempt.alternatives(&set, agreement);
        Some(Explained {
            profile: profile(scene, &set, &alternatives),
            alternatives,
            set,
            agreement,
        })
    }
}

/// True for an image such as black, which no convention makes of a volume.
fn is_of_one_colour(picture: &Picture) -> bool {
    picture
        .radiance()
        .is_some_and(|film| film.radiance().windows(2).all(|pair| pair[0] == pair[1]))
}

/// The search in one image.
struct Attempt<'a> {
    case: &'a Case,
    scene: &'a Scene,
    test: &'a Picture,
    end: Option<Instant>,
}

impl Attempt<'_> {
    fn is_over(&self) -> bool {
        self.end.is_some_and(|end| Instant::now() >= end)
    }

    /// The image under the conventions of `set`.
    fn image(&self, set: &[usize], detail: Detail) -> Option<Film> {
        let scene = under(self.scene, set);
        let sampling = Sampling::default();
        render_coarse(&plans(&scene), sampling, detail, &|| self.is_over()).ok()
    }

    /// Agreement of the test image with the image under the conventions of `set`, if there is any.
    fn agreement(&self, set: &[usize]) -> Option<Agreement> {
        let image = self.image(set, Detail::Whole)?;
        let conditions = Conditions {
            exposure: self.case.exposure,
            ..Conditions::default()
        };
        let right = Picture::Radiance(image);
        let (gate, _) = default_gate(&right, self.test);
        let judgement = judge(gate, &right, self.test, &conditions).ok()?;
        if judgement.passed {
            return Some(Agreement::Full);
        }
        let misfit = Misfit::of(right.radiance()?, self.test.radiance()?);
        let is_rounding = misfit.outside <= MOST_ROUNDED && misfit.worst <= CAP;
        is_rounding.then_some(Agreement::ButFor(misfit.outside))
    }

    /// The set of a bundled profile that fits the image: a search by one at a time may miss them
    /// where the nearest node is taken, and each step of it changes single pixels by much.
    fn of_a_profile(&self) -> Option<(ConventionSet, Agreement)> {
        Profile::shipped().find_map(|name| {
            let set = profile_set(&Profile::named(name).ok()?, self.scene)?;
            if set.is_empty() {
                return None; // volref's own
            }
            let agreement = self.agreement(&set)?;
            self.backward_elimination((set, agreement))
        })
    }

    fn search(&self) -> Option<(ConventionSet, Agreement)> {
        let test = self.test.radiance()?;
        let widths: Vec<usize> = self.scene.panels.iter().map(|panel| panel.width).collect();
        let detail = lattice_of(test.width() * test.height(), LATTICE);
        let seen = pixels_of(test, &widths, detail);
        let misfit = |set: &[usize]| Some(Misfit::of(&self.image(set, detail)?, &seen));
        let nothing = misfit(&[])?;
        let mut starts = further(&[], &nothing, misfit)?;
        for set in samples_and_steps() {
            let misfit = misfit(&set)?;
            if misfit.mean_square < (1.0 - LEAST_GAIN) * nothing.mean_square {
                starts.push((set, misfit));
            }
        }
        by_what_is_left(&mut starts);
        let mut starts = starts.into_iter().take(STARTS);
        let found = starts.find_map(|start| self.forward_selection(start, misfit))?;
        self.backward_elimination(found)
    }

    /// Forward selection: the set that begins with `start` and takes in the convention that leaves
    /// least, until the whole image agrees.
    fn forward_selection(
        &self,
        (mut set, mut left): (ConventionSet, Misfit),
        misfit: impl Fn(&[usize]) -> Option<Misfit>,
    ) -> Option<(ConventionSet, Agreement)> {
        let mut found = None;
        loop {
            if left.outside <= MOST_OUTSIDE
                && let Some(agreement) = self.agreement(&set)
            {
                found = Some((set.clone(), agreement));
                if agreement == Agreement::Full {
                    return found;
                }
            }
            if set.len() == MOST_TOGETHER {
                return found;
            }
            match further(&set, &left, &misfit)?.into_iter().next() {
                Some(longer) => (set, left) = longer,
                None => return found,
            }
        }
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
            match self.agreement(&shorter) {
                Some(other) if other.rest() <= agreement.rest() => {
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
    fn alternatives(&self, set: &[usize], agreement: Agreement) -> Vec<usize> {
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
                        .agreement(&changed)
                        .is_some_and(|found| found.rest() <= agreement.rest());
                agrees.then_some(other)
            });
        others.collect()
    }
}

/// The conventions of the catalogue that `profile` holds beside those of `scene`.
fn profile_set(profile: &Profile, scene: &Scene) -> Option<ConventionSet> {
    let applied = profile.applied_to(scene).ok()??;
    let volume = |scene: &Scene| scene.panels.iter().find_map(Panel::classified).cloned();
    let (before, after) = (volume(scene)?, volume(&applied)?);
    let changes = |volume: &Classified, convention: &Convention| {
        let mut changed = volume.clone();
        convention.apply(&mut changed);
        let stated = |volume: &Classified| (volume.conventions, volume.compositing, volume.step);
        stated(&changed) != stated(volume)
    };
    let held = CATALOGUE
        .iter()
        .enumerate()
        .filter(|(_, convention)| changes(&before, convention) && !changes(&after, convention));
    Some(held.map(|(index, _)| index).collect())
}

/// The profile, as TOML, of the conventions of `set` in `scene`, each with the `alternatives` that the
/// image does not tell from it as a comment; `None` with another step.
fn profile(scene: &Scene, set: &[usize], alternatives: &[usize]) -> Option<String> {
    let is_step = |&index: &usize| CATALOGUE[index].choice == STEP;
    if set.iter().any(is_step) {
        return None;
    }
    let mut lines = profile_lines(scene, set)?;
    for &other in alternatives {
        let is_other = |&index: &usize| CATALOGUE[index].choice != CATALOGUE[other].choice;
        let mut changed: ConventionSet = set.iter().copied().filter(is_other).collect();
        changed.push(other);
        for line in profile_lines(scene, &changed)? {
            if lines.iter().any(|stated| stated.starts_with(&line)) {
                continue;
            }
            let key = |line: &str| line.split(' ').next().unwrap_or_default().to_owned();
            match lines.iter_mut().find(|stated| key(stated) == key(&line)) {
                Some(stated) if stated.contains('#') => stated.push_str(&format!(", or {line}")),
                Some(stated) => stated.push_str(&format!("   # or, just as well, {line}")),
                None => lines.push(format!("# or, just as well, {line}")),
            }
        }
    }
    Some(lines.join("\n") + "\n")
}

fn profile_lines(scene: &Scene, set: &[usize]) -> Option<Vec<String>> {
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
    Some(lines)
}

/// Sets of `set` and one further convention, with their misfit, where that is much less than the
/// misfit `left` before; smallest first. `None` if a `misfit` is out of time.
fn further(
    set: &[usize],
    left: &Misfit,
    misfit: impl Fn(&[usize]) -> Option<Misfit>,
) -> Option<Vec<(ConventionSet, Misfit)>> {
    let limit = (1.0 - LEAST_GAIN) * left.mean_square;
    let mut longer_sets = Vec::new();
    for (index, convention) in CATALOGUE.iter().enumerate() {
        let is_made = |&chosen: &usize| CATALOGUE[chosen].choice == convention.choice;
        if set.iter().any(is_made) {
            continue;
        }
        let mut longer = set.to_vec();
        longer.push(index);
        longer.sort_unstable();
        let misfit = misfit(&longer)?;
        if misfit.mean_square < limit {
            longer_sets.push((longer, misfit));
        }
    }
    by_what_is_left(&mut longer_sets);
    Some(longer_sets)
}

fn by_what_is_left(sets: &mut [(ConventionSet, Misfit)]) {
    sets.sort_by(|(_, a), (_, b)| a.mean_square.total_cmp(&b.mean_square));
}

/// Pairs of a first sample and a step. The place of a sample is counted in steps: neither may leave
/// less alone.
fn samples_and_steps() -> impl Iterator<Item = ConventionSet> {
    let of = |choice| {
        let found = CATALOGUE.iter().enumerate();
        found
            .filter(move |(_, convention)| convention.choice == choice)
            .map(|(index, _)| index)
    };
    of(FIRST_SAMPLE).flat_map(move |first| of(STEP).map(move |step| vec![first, step]))
}

/// Difference of two images in tolerances of the deterministic gate, by the worst channel of each
/// pixel.
struct Misfit {
    /// Mean over the pixels of its square.
    mean_square: f64,
    /// Share of the pixels that are off by more than one tolerance.
    outside: f64,
    /// Difference of the worst pixel.
    worst: f64,
}

impl Misfit {
    fn of(right: &Film, test: &Film) -> Misfit {
        let test = &*test.nearest_to(right);
        let (mut sum, mut outside, mut largest) = (Sum::default(), 0, 0.0_f64);
        for (right, test) in right.radiance().iter().zip(test.radiance()) {
            let worst = in_tolerances(*right, *test);
            sum.add(worst.min(CAP) * worst.min(CAP));
            outside += usize::from(worst > 1.0);
            largest = largest.max(worst);
        }
        let pixels = right.radiance().len() as f64;
        Misfit {
            mean_square: sum.value() / pixels,
            outside: outside as f64 / pixels,
            worst: largest,
        }
    }
}
