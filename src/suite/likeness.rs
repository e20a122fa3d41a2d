//! Which mistake an image looks like.
//!
//! A failing image is held against what every mistake of the [catalogue](super::mistakes) would
//! have made of the case: mistakes of the image are made in the golden, those of the scene are
//! rendered, first with few samples, and what is left with more. A mistake explains an image if
//! the two differ by no more than noise, and the golden does not; among several, the one that is
//! nearest beyond doubt comes first. Where none does, two at a time are tried. Cases that passed
//! speak against mistakes that would have been seen in them.
//!
//! A case that a mistake already found explains is not searched again: one mistake that runs
//! through a whole suite is looked for once.

mod cells;
mod prediction;

use super::mistakes::{self, Mistake};
use super::{Case, Cause, Judged, Likeness};
use crate::compare::flip::SrgbImage;
use crate::compare::{Gate, Picture, judge};
use crate::film::Film;
use crate::math;
use crate::scene::Scene;
use cells::{Cells, Misfit};
use prediction::{FIRST_LOOK, SECOND_LOOK, in_cells, predicted};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

/// No more mistakes than this are named.
const MOST_NAMED: usize = 5;

/// Mistakes of a scene that get a second look, at most.
const MOST_SECOND_LOOKS: usize = 8;

/// Mistakes of a scene that are tried together with every other, where none explains an image.
const MOST_FIRSTS: usize = 8;

/// What a mistake may leave unexplained, where there is no noise: this share of the squared
/// difference.
const REMAINDER: f64 = 0.02;

/// Mistakes that cases which passed are asked about, at most.
const MOST_CROSS_EXAMINED: usize = 5;

/// Cases which passed that are asked, at most.
const MOST_WITNESSES: usize = 12;

/// Cases in which two mistakes at a time are looked for, at most: that takes a while.
const MOST_PAIR_SEARCHES: usize = 2;

/// Names the mistakes that the images in `judged` that failed look like: in `looks_like` of each
/// result, and for all together, most likely first. `progress` is told of every rendering.
pub fn likeness(cases: &[&Case], judged: &mut [Judged], progress: &dyn Fn()) -> Vec<Likeness> {
    likeness_with(cases, judged, &|case| case.load_scene().ok(), progress)
}

/// [`likeness`], where scenes come from elsewhere.
pub(super) fn likeness_with(
    cases: &[&Case],
    judged: &mut [Judged],
    scenes: &dyn Fn(&Case) -> Option<Scene>,
    progress: &dyn Fn(),
) -> Vec<Likeness> {
    let (mut suspects, mut witnesses) = (Vec::new(), Vec::new());
    for (index, judged) in judged.iter().enumerate() {
        let case = cases.iter().find(|case| case.name == judged.result.name);
        let Some(case) = case else { continue };
        match judged.result.cause {
            Cause::Mismatch => suspects.extend(Suspect::new(index, case, judged, scenes)),
            Cause::None | Cause::Undecided => witnesses.push((index, *case)),
            _ => {}
        }
    }
    let mut known: Vec<Hypothesis> = Vec::new();
    let mut fits: BTreeMap<Hypothesis, BTreeMap<usize, Misfit>> = BTreeMap::new();
    let mut pair_searches = 0;
    for at in 0..suspects.len() {
        let suspect = &suspects[at];
        let mut found: Vec<(Hypothesis, Misfit)> = known
            .iter()
            .filter_map(|hypothesis| Some((*hypothesis, suspect.test(hypothesis, progress)?)))
            .filter(|(_, misfit)| suspect.explained_by(misfit))
            .collect();
        if found.is_empty() {
            let (singles, looks) = suspect.search(progress);
            found = singles;
            if found.is_empty() && pair_searches < MOST_PAIR_SEARCHES {
                pair_searches += 1;
                found = suspect.search_pairs(&looks, progress);
            }
            // What explains this one may explain those before it as well, which were not asked.
            for (hypothesis, _) in &found {
                if known.contains(hypothesis) {
                    continue;
                }
                known.push(*hypothesis);
                for earlier in &suspects[..at] {
                    if let Some(misfit) = earlier.test(hypothesis, progress)
                        && earlier.explained_by(&misfit)
                    {
                        fits.entry(*hypothesis)
                            .or_default()
                            .insert(earlier.index, misfit);
                    }
                }
            }
        }
        for (hypothesis, misfit) in found {
            fits.entry(hypothesis)
                .or_default()
                .insert(suspect.index, misfit);
        }
    }
    let mut ranked: Vec<Explanation> = fits.into_iter().map(Explanation::new).collect();
    ranked.sort_by_cached_key(Explanation::rank);
    // What passed speaks against mistakes that would have been seen there.
    let most = ranked.first().map_or(0, |first| first.fits.len());
    let close = ranked.iter_mut().filter(|other| other.fits.len() == most);
    let mut close: Vec<_> = close.take(MOST_CROSS_EXAMINED).collect();
    if close.len() > 1 {
        for (index, case) in witnesses.into_iter().take(MOST_WITNESSES) {
            let Some(witness) = Suspect::new(index, case, &judged[index], scenes) else {
                continue;
            };
            for explanation in &mut close {
                progress();
                let misfit = witness.predict(&explanation.hypothesis, FIRST_LOOK);
                let misfit = misfit.and_then(|film| witness.misfit(&film));
                let speaks_against = misfit.is_some_and(|misfit| !misfit.is_noise());
                explanation.contradictions += usize::from(speaks_against);
            }
        }
    }
    ranked.sort_by_cached_key(Explanation::rank);
    for suspect in &suspects {
        judged[suspect.index].result.looks_like = ranked
            .iter()
            .filter(|explanation| explanation.fits.contains_key(&suspect.index))
            .map(|explanation| explanation.hypothesis.name())
            .take(MOST_NAMED)
            .collect();
    }
    ranked
        .iter()
        .take(MOST_NAMED)
        .map(|explanation| Likeness {
            mistake: explanation.hypothesis.name(),
            advice: explanation.hypothesis.advice(),
            explains: explanation.fits.len(),
            of: suspects.len(),
            cases: explanation
                .fits
                .keys()
                .map(|&index| judged[index].result.name.clone())
                .collect(),
        })
        .collect()
}

/// A hypothesis that explains at least one case.
struct Explanation {
    hypothesis: Hypothesis,
    /// By index of the result, how well.
    fits: BTreeMap<usize, Misfit>,
    /// Cases that passed and would not have.
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

    /// The smaller, the likelier: few contradictions, many cases, one mistake rather than two,
    /// small distances, and then the order of the catalogue.
    fn rank(&self) -> (usize, Reverse<usize>, usize, u64, Hypothesis) {
        let sum: f64 = self.fits.values().map(Misfit::at_most).sum();
        let mean = sum / self.fits.len() as f64;
        (
            self.contradictions,
            Reverse(self.fits.len()),
            self.hypothesis.mistakes().len(),
            // Positive numbers are ordered as their bits are.
            mean.to_bits(),
            self.hypothesis,
        )
    }
}

/// One mistake, or two, the first made before the second; by their places in the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Hypothesis {
    One(usize),
    Two(usize, usize),
}

impl Hypothesis {
    fn mistakes(&self) -> Vec<&'static Mistake> {
        let at = |index: usize| mistakes::catalogue().nth(index).expect("a place in it");
        match *self {
            Hypothesis::One(one) => vec![at(one)],
            Hypothesis::Two(first, second) => vec![at(first), at(second)],
        }
    }

    fn name(&self) -> String {
        let names: Vec<_> = self.mistakes().iter().map(|m| m.name).collect();
        names.join(" + ")
    }

    fn advice(&self) -> String {
        let advice: Vec<_> = self.mistakes().iter().map(|m| m.advice).collect();
        advice.join("; and ")
    }
}

/// A case whose image is wrong.
struct Suspect {
    /// Among the results.
    index: usize,
    scene: Scene,
    exposure: f64,
    golden: Film,
    /// Largest radiance that the file of the image can hold.
    ceiling: Option<f64>,
    /// The image as it was given, for the gates without noise.
    picture: Picture,
    /// Judged by noise, in coarse cells; else pixel by pixel.
    is_sampled: bool,
    golden_cells: Cells,
    test_cells: Cells,
    /// How far the image is from the golden: a mistake has to do better.
    from_golden: Misfit,
}

/// Renderings of a first look, by place in the catalogue.
type Looks = BTreeMap<usize, Film>;

impl Suspect {
    fn new(
        index: usize,
        case: &Case,
        judged: &Judged,
        scenes: &dyn Fn(&Case) -> Option<Scene>,
    ) -> Option<Suspect> {
        let golden = judged.evidence.golden.clone()?;
        let picture = judged.evidence.test.clone()?;
        let size = (golden.width(), golden.height());
        let (test, ceiling) = match &picture {
            Picture::Radiance(film) => (film.clone(), None),
            Picture::Codes(codes) => {
                let ceiling = math::exp2(-case.exposure);
                (radiance(codes, case.exposure), Some(ceiling))
            }
        };
        let is_number = |film: &Film| film.radiance().as_flattened().iter().all(|x| x.is_finite());
        if picture.size() != size || !is_number(&test) {
            return None;
        }
        let is_sampled = case.sampling.is_some();
        let in_cells = |film: &Film| match is_sampled {
            true => Cells::of_blocks(film),
            false => Cells::of_pixels(film),
        };
        let golden_cells = in_cells(&clamped(&golden, ceiling));
        let mut test_cells = in_cells(&test);
        if is_sampled && test.noise().is_none() {
            test_cells.spread_noise_like(&golden_cells);
        }
        Some(Suspect {
            index,
            scene: scenes(case)?,
            exposure: case.exposure,
            from_golden: golden_cells.misfit(&test_cells, &golden_cells),
            golden,
            ceiling,
            picture,
            is_sampled,
            golden_cells,
            test_cells,
        })
    }

    /// Whether a mistake with this misfit explains the image: better than the golden does, beyond
    /// doubt, and within noise.
    fn explained_by(&self, misfit: &Misfit) -> bool {
        misfit.is_noise() && misfit.at_most() < self.from_golden.at_least().max(0.0)
    }

    /// How far the image is from `film`, a prediction.
    fn misfit(&self, film: &Film) -> Option<Misfit> {
        let film = clamped(film, self.ceiling);
        if self.is_sampled {
            let cells = in_cells(&film, &self.golden_cells)?;
            return Some(cells.misfit(&self.test_cells, &self.golden_cells));
        }
        // Without noise the gate itself says whether the images are the same.
        let cells = Cells::of_pixels(&film).without_noise();
        if (cells.columns, cells.rows) != (self.golden_cells.columns, self.golden_cells.rows) {
            return None;
        }
        let gate = match self.picture {
            Picture::Radiance(_) => Gate::Deterministic,
            Picture::Codes(_) => Gate::Perceptual,
        };
        let misfit = cells.misfit(&self.test_cells, &self.golden_cells);
        // Whoever makes a mistake makes it in a way of their own: it need not be ours to the digit.
        let is_within = |share: f64| misfit.distance <= share * self.from_golden.distance;
        // The gate takes its time, FLIP above all, and need not be asked about what is far off.
        let is_noise = is_within(REMAINDER)
            || is_within(0.5)
                && judge(gate, &Picture::Radiance(film), &self.picture, self.exposure)
                    .is_ok_and(|judgement| judgement.passed);
        Some(Misfit {
            in_noise: if is_noise { 1.0 } else { f64::INFINITY },
            ..misfit
        })
    }

    /// The image that `hypothesis` would make, or nothing where it has no occasion.
    fn predict(&self, hypothesis: &Hypothesis, samples: u32) -> Option<Film> {
        let mistakes = hypothesis.mistakes();
        let mut scene = None;
        for mistake in mistakes.iter().filter(|m| !m.is_of_the_image()) {
            scene = Some(mistake.in_scene(scene.as_ref().unwrap_or(&self.scene))?);
        }
        let of_the_image: Vec<_> = mistakes.iter().filter(|m| m.is_of_the_image()).collect();
        let mut film = match scene {
            // Pixels are as they are only where no mistake moves them about.
            Some(scene) => predicted(scene, of_the_image.is_empty(), samples)?,
            None => self.golden.clone(),
        };
        for mistake in of_the_image {
            film = mistake.in_image(&film)?;
        }
        Some(film)
    }

    /// How far the image is from what `hypothesis` would make, closely looked at.
    fn test(&self, hypothesis: &Hypothesis, progress: &dyn Fn()) -> Option<Misfit> {
        progress();
        self.misfit(&self.predict(hypothesis, SECOND_LOOK)?)
    }

    /// The single mistakes that explain the image, nearest first, and what was rendered on the
    /// way.
    fn search(&self, progress: &dyn Fn()) -> (Vec<(Hypothesis, Misfit)>, Looks) {
        let mut looks = Looks::new();
        let mut found = Vec::new();
        let mut promising = Vec::new();
        for (place, mistake) in mistakes::catalogue().enumerate() {
            let hypothesis = Hypothesis::One(place);
            if mistake.is_of_the_image() {
                if let Some(film) = mistake.in_image(&self.golden)
                    && let Some(misfit) = self.misfit(&film)
                    && self.explained_by(&misfit)
                {
                    found.push((hypothesis, misfit));
                }
                continue;
            }
            progress();
            let Some(film) = self.predict(&hypothesis, FIRST_LOOK) else {
                continue;
            };
            if let Some(misfit) = self.misfit(&film)
                && self.explained_by(&misfit)
            {
                promising.push((hypothesis, misfit));
            }
            looks.insert(place, film);
        }
        found.extend(self.look_closer(promising, progress));
        found.sort_by(|(_, a), (_, b)| a.at_most().total_cmp(&b.at_most()));
        (found, looks)
    }

    /// The pairs of mistakes that explain the image, nearest first.
    fn search_pairs(&self, looks: &Looks, progress: &dyn Fn()) -> Vec<(Hypothesis, Misfit)> {
        let images: Vec<(usize, &Mistake)> = mistakes::catalogue()
            .enumerate()
            .filter(|(_, mistake)| mistake.is_of_the_image())
            .collect();
        // What each mistake makes of the case, and then a mistake of the image on top of it.
        let in_golden = |&(place, mistake): &(usize, &Mistake)| {
            let film = mistake.in_image(&self.golden)?;
            Some((place, film))
        };
        let mut firsts: Vec<(usize, Film)> = images.iter().filter_map(in_golden).collect();
        firsts.extend(looks.iter().map(|(&place, film)| (place, film.clone())));
        let pairs: Vec<(Hypothesis, Misfit)> = firsts
            .par_iter()
            .flat_map_iter(|(first, film)| {
                let seconds = images.iter().filter(move |(second, _)| second != first);
                seconds.filter_map(move |(second, then)| {
                    let misfit = self.misfit(&then.in_image(film)?)?;
                    Some((Hypothesis::Two(*first, *second), misfit))
                })
            })
            .filter(|(_, misfit)| self.explained_by(misfit))
            .collect();
        let mut promising = pairs;
        let mut nearest: Vec<(f64, usize)> = looks
            .iter()
            .filter_map(|(&place, film)| Some((self.misfit(film)?.distance, place)))
            .collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut tried = BTreeSet::new();
        for &(_, first) in nearest.iter().take(MOST_FIRSTS) {
            for &second in looks.keys().filter(|second| **second != first) {
                // Which is made first matters little.
                let hypothesis = Hypothesis::Two(first.min(second), first.max(second));
                if !tried.insert(hypothesis) {
                    continue;
                }
                progress();
                let film = self.predict(&hypothesis, FIRST_LOOK);
                let misfit = film.and_then(|film| self.misfit(&film));
                if let Some(misfit) = misfit.filter(|misfit| self.explained_by(misfit)) {
                    promising.push((hypothesis, misfit));
                }
            }
        }
        self.look_closer(promising, progress)
    }

    /// Those of the nearest hypotheses that explain the image on a second look, nearest first.
    fn look_closer(
        &self,
        mut promising: Vec<(Hypothesis, Misfit)>,
        progress: &dyn Fn(),
    ) -> Vec<(Hypothesis, Misfit)> {
        promising.sort_by(|(_, a), (_, b)| a.distance.total_cmp(&b.distance));
        promising.truncate(MOST_SECOND_LOOKS);
        // Without random numbers the first look saw it all.
        if self.is_sampled {
            promising.retain_mut(
                |(hypothesis, misfit)| match self.test(hypothesis, progress) {
                    Some(closer) if self.explained_by(&closer) => {
                        *misfit = closer;
                        true
                    }
                    _ => false,
                },
            );
        }
        promising.sort_by(|(_, a), (_, b)| a.at_most().total_cmp(&b.at_most()));
        promising
    }
}

/// `film` as a file keeps it that holds nothing above `ceiling`.
fn clamped(film: &Film, ceiling: Option<f64>) -> Film {
    let Some(ceiling) = ceiling else {
        return film.clone();
    };
    let below = |pixel: &[f32; 3]| pixel.map(|value| value.min(ceiling as f32));
    let radiance = film.radiance().iter().map(below).collect();
    let (width, height) = (film.width(), film.height());
    match film.noise() {
        Some(noise) => {
            let variance = noise.variance().to_vec();
            Film::with_noise(width, height, radiance, variance, noise.samples())
        }
        None => Film::new(width, height, radiance),
    }
}

/// The radiance that 8-bit codes stand for, at `exposure` stops.
fn radiance(codes: &SrgbImage, exposure: f64) -> Film {
    let scale = math::exp2(-exposure);
    let decode = |code: u8| (scale * math::srgb_to_linear(f64::from(code) / 255.0)) as f32;
    let pixels = codes.pixels().iter().map(|pixel| pixel.map(decode));
    Film::new(codes.width(), codes.height(), pixels.collect())
}
