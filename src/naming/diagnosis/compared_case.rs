//! A failed case: golden and image as a search sees them.

use super::clock::{SearchClock, Stage};
use super::hypothesis::{Explaining, Hypothesis};
use super::predictor::{Predictor, pixels_of};
use crate::compare::coarse::Coarse;
use crate::compare::deterministic::outliers;
use crate::compare::unexplained::{
    MOST_IN_NOISE, SquaredDistance, UNEXPLAINED, UNEXPLAINED_IN_NOISE, makes_what_shows,
};
use crate::compare::{Conditions, Gate, NumberChange, Picture, measured, passes};
use crate::conventions::Profile;
use crate::film::{Film, Quantisation};
use crate::judging::Judged;
use crate::judging::measured::gain;
use crate::judging::nothing_drawn::background;
use crate::math;
use crate::scene::Scene;
use crate::suite::Case;
use crate::variations::edited_film::mapped;
use crate::variations::mistakes::Mistake;

/// Largest share of the squared difference that a prediction may leave, beside passing for the image. Codes of 8 bits
/// round small differences, and a gate allows what is below its tolerance: passing alone explains nothing.
const OF_ROUNDING: f64 = 0.5;

/// On the lattice, predictions that leave more than this share are dropped. The share is an estimate from 2000 pixels or
/// more: a share of one half has a standard error of a tenth even if one pixel in fifty differs.
const FAR_OFF_ON_LATTICE: f64 = 0.75;

/// Hypotheses that get the next closer look.
const SURVIVORS: [usize; 2] = [16, 8];

/// Work of an edit and a comparison of one pixel, in [events](crate::render::Event).
const EVENTS_OF_AN_EDIT: usize = 8;

/// Share of the largest score from which a parameter is suspected. Far from the golden derivatives do not hold, and
/// another parameter may have a larger score than the one that is off.
const SUSPICIOUS: f64 = 0.5;

/// Seed of the renderings that decide; the fit uses other seeds.
const CLOSE_SEED: u64 = 7;

/// Values that the file of an image can hold.
#[derive(Clone, Copy)]
enum KeptValues {
    All,
    UpTo(f64),
    Codes(Quantisation),
}

/// Golden and image in the same pixels, with the weights and the whole of their difference.
pub(super) struct View {
    pub golden: Coarse,
    pub test: Coarse,
    pub weights: Vec<f64>,
    pub whole: SquaredDistance,
    /// Distance of the image from black: a dark image is not explained by any other dark one.
    from_black: SquaredDistance,
}

impl View {
    fn new(golden: Coarse, test: Coarse) -> View {
        let test = test.with_noise_spread_like(&golden);
        let weights = golden.weights(&test);
        View {
            whole: golden.distance(&test, &weights),
            from_black: golden.black().distance(&test, &weights),
            golden,
            test,
            weights,
        }
    }

    /// What `prediction` leaves of the difference.
    pub fn left(&self, prediction: &Coarse) -> SquaredDistance {
        prediction.distance(&self.test, &self.weights)
    }
}

/// A failed case: its golden and its image in the pixels and the values in which a search compares them.
pub(super) struct ComparedCase {
    /// Index of the case among the results.
    pub index: usize,
    /// Name of the case.
    pub name: String,
    /// The image is the golden times a factor, as far as the gate can tell, which the verdict states.
    pub is_gain: bool,
    /// The colours are right, and opacity is not.
    pub is_of_opacity: bool,
    /// Work that the search for its conventions took, in events of kernels.
    pub spent: u64,
    /// Pixels are means of samples: they are compared in blocks.
    pub is_sampled: bool,
    /// The image is judged by what its step may leave.
    has_step: bool,
    /// A prediction may be off by what single precision rounds: not where the golden would pass so, too.
    in_single_precision: bool,
    /// Parameters of the scene that the verdict names; none where it names none.
    pub suspects: Vec<String>,
    pub predictor: Predictor,
    golden: Film,
    test: Film,
    /// The image as it was given.
    picture: Picture,
    exposure: f64,
    kept: KeptValues,
    /// What the look with the fewest pixels sees.
    pub few: View,
    /// All pixels of an image that states its noise.
    pixels: Option<View>,
}

impl ComparedCase {
    /// The case of a failed image, whose scene follows `profile`; `None` where the image cannot be compared, or the scene
    /// cannot be read.
    pub fn new(
        index: usize,
        case: &Case,
        judged: &Judged,
        profile: Option<&Profile>,
    ) -> Option<ComparedCase> {
        let golden = judged.evidence.golden.clone()?;
        let picture = judged.evidence.test.clone()?;
        let is_sampled = case.sampling.is_some();
        let (test, kept) = match &picture {
            Picture::Radiance(film) => {
                let kept = match film.quantisation() {
                    None => KeptValues::All,
                    // Means of few samples are not predicted to a code.
                    Some(codes) if is_sampled => KeptValues::UpTo(codes.largest()),
                    Some(codes) => KeptValues::Codes(codes),
                };
                (film.clone(), kept)
            }
            Picture::Codes(_) => {
                let ceiling = math::exp2(-case.exposure);
                (picture.film(case.exposure), KeptValues::UpTo(ceiling))
            }
        };
        if !golden.is_comparable(&test) {
            return None;
        }
        let scene = case.load_scene().ok()?;
        let under = profile.and_then(|profile| profile.applied_to(&scene).ok().flatten());
        let predictor = Predictor::new(&case.name, under.unwrap_or(scene), is_sampled);
        let films = [&kept.film(&golden), &test];
        let of_pixels = || films.map(Coarse::of_pixels);
        let [few_golden, few_test] = if is_sampled {
            films.map(Coarse::of_blocks)
        } else {
            let lattice = predictor.few().0;
            films.map(|film| Coarse::of_pixels(&pixels_of(film, &predictor.scene, lattice)))
        };
        let states_noise = is_sampled && test.noise().is_some();
        let gate = judged.result.gate;
        let mut case = ComparedCase {
            index,
            name: case.name.clone(),
            is_gain: picture.radiance().is_some() && gain(case, &golden, &picture).is_some(),
            is_of_opacity: gate == Gate::Deterministic && has_right_colours(&golden, &picture),
            spent: judged.evidence.work_of_search,
            is_sampled,
            has_step: gate == Gate::Refinement,
            in_single_precision: true,
            suspects: suspects(judged),
            few: View::new(few_golden, few_test),
            pixels: states_noise.then(|| {
                let [golden, test] = of_pixels();
                View::new(golden, test)
            }),
            golden,
            test,
            picture,
            predictor,
            exposure: case.exposure,
            kept,
        };
        case.in_single_precision = !case.passes(&case.golden, &case.few.whole);
        Some(case)
    }

    /// The scene of the case.
    pub fn scene(&self) -> &Scene {
        &self.predictor.scene
    }

    /// True if noise is low enough to tell the image from the golden where they are compared.
    pub fn is_decidable(&self) -> bool {
        !self.is_sampled || !self.few.golden.agrees(&self.few.test)
    }

    /// Places of the difference as sentences; none where the verdict says how the image
    /// follows from the golden.
    pub fn measured_difference(&self) -> Vec<String> {
        let test = self.picture.radiance();
        let Some(test) = test.filter(|_| !self.is_gain && !self.is_of_opacity) else {
            return Vec::new();
        };
        measured(&self.kept.film(&self.golden), test)
    }

    /// `film`, a prediction of the whole image or in a look, in the pixels of `view`.
    fn seen(&self, film: &Film, view: &View) -> Option<Coarse> {
        let film = self.kept.film(film);
        let coarse = [Coarse::of_pixels, Coarse::of_blocks].map(|coarse| coarse(&film));
        let on_lattice = || {
            let is_whole = film.width() == self.golden.width() && !self.is_sampled;
            let lattice = self.predictor.few().0;
            is_whole.then(|| Coarse::of_pixels(&pixels_of(&film, self.scene(), lattice)))
        };
        let mut all = coarse
            .into_iter()
            .chain(std::iter::once_with(on_lattice).flatten());
        let found = all.find(|it| it.has_size_of(&view.golden))?;
        Some(if self.is_sampled {
            found
        } else {
            found.without_noise()
        })
    }

    /// True if a hypothesis that leaves this of the difference explains all of it beyond doubt: noise leaves no other cause
    /// possible.
    pub fn is_all_beyond_doubt(&self, left: &SquaredDistance) -> bool {
        let whole = &self.few.whole;
        !self.is_sampled
            || whole.at_least() > 0.0 && left.at_most() <= UNEXPLAINED_IN_NOISE * whole.value
    }

    /// The scene with a change, rendered with few pixels.
    pub fn few_of(&self, edited: &Scene, clock: &SearchClock<'_>) -> Option<Coarse> {
        let samples = self.predictor.looks[self.predictor.looks.len() / 2].1;
        let look = (self.predictor.few().0, samples);
        let film = self.predictor.rendered(edited, look, 0, clock)?;
        self.seen(&film, &self.few)
    }

    /// True if the scene with a change, rendered as closely as a search does with other random numbers than before,
    /// passes for the image.
    pub fn passes_with(&self, edited: &Scene, clock: &SearchClock<'_>) -> Option<bool> {
        let look = self.predictor.most();
        let film = self.predictor.rendered(edited, look, CLOSE_SEED, clock)?;
        if self.is_sampled {
            return Some(self.seen(&film, &self.few)?.agrees(&self.few.test));
        }
        let left = self.few.left(&self.seen(&film, &self.few)?);
        Some(self.passes(&film, &left))
    }

    /// True if `film`, which leaves this, passes for the image by the gate of the case. An image with steps is judged by the
    /// difference that is left: nobody knows what steps change in a prediction.
    fn passes(&self, film: &Film, left: &SquaredDistance) -> bool {
        if self.has_step {
            return left.value <= UNEXPLAINED * self.few.whole.value;
        }
        let film = self.kept.film(film);
        let film = Picture::Radiance(match self.is_of_opacity {
            true => film,
            false => film.without_opacity(),
        });
        let conditions = Conditions {
            exposure: self.exposure,
            in_single_precision: self.in_single_precision,
            opacity: self.is_of_opacity,
            ..Conditions::default()
        };
        passes(&film, &self.picture, &conditions)
    }

    /// What the prediction `film` leaves of the difference, if it explains the image. `mixes_pixels` is true of a mistake
    /// in the image that mixes pixels with their neighbours.
    fn explained_by(&self, film: &Film, mixes_pixels: bool) -> Option<SquaredDistance> {
        if self.is_of_opacity {
            return self
                .passes(film, &SquaredDistance::default())
                .then(SquaredDistance::default);
        }
        if self.is_sampled {
            let in_blocks = self.seen(film, &self.few)?;
            let left = self.few.left(&in_blocks);
            if left.at_least() > UNEXPLAINED_IN_NOISE * self.few.from_black.at_most() {
                return None;
            }
            let View { golden, test, .. } = &self.few;
            let amount = in_blocks.amount_in(test, golden);
            let has = |share: f64| amount.is_some_and(|amount| amount.leaves(share));
            let is_sure = self.is_all_beyond_doubt(&left) && has(UNEXPLAINED_IN_NOISE);
            if is_sure || has(MOST_IN_NOISE) && in_blocks.is_told(test, golden) {
                return Some(left);
            }
            // What moves light within a block shows in no block, and what mixes pixels changes their noise: there is
            // no gate for that.
            let pixels = self.pixels.as_ref().filter(|_| mixes_pixels)?;
            let predicted = self.seen(film, pixels)?;
            let amount = predicted.amount_in(&pixels.test, &pixels.golden)?;
            let left = pixels.left(&predicted);
            let is_near =
                pixels.whole.at_least() > 0.0 && left.is_explained(&pixels.whole, MOST_IN_NOISE);
            return (is_near && amount.leaves(MOST_IN_NOISE)).then_some(left);
        }
        let left = self.few.left(&self.seen(film, &self.few)?);
        let nothing = background(self.scene());
        let is_shown = film.radiance() == self.test.radiance()
            || nothing.is_none_or(|it| makes_what_shows(film, &self.test, &it));
        let is_nearer = left.value <= OF_ROUNDING * self.few.whole.value;
        (is_nearer && is_shown && self.passes(film, &left)).then_some(left)
    }

    /// The mistakes that explain the image, nearest first; the usual pairs, where none does by itself.
    pub fn search(&self, clock: &SearchClock<'_>) -> Found {
        let is_suspected = |mistake: &Mistake| mistake.is_of_opacity() == self.is_of_opacity;
        let singles = Hypothesis::singles(is_suspected);
        clock.report(Stage::Singles, 0, singles.len());
        let found = self.search_among(singles, true, clock);
        if !found.explaining.is_empty() || self.is_of_opacity {
            return found;
        }
        let of_pairs = self.search_among(Hypothesis::pairs(), false, clock);
        Found {
            explaining: of_pairs.explaining,
            close: found.close.or(of_pairs.close),
        }
    }

    /// The `hypotheses` that explain the image, nearest first. Each is looked at with few pixels or samples, the
    /// nearest ones with more.
    pub fn search_among(
        &self,
        hypotheses: Vec<Hypothesis>,
        is_reported: bool,
        clock: &SearchClock<'_>,
    ) -> Found {
        let of = hypotheses.len();
        let mut open: Vec<(Hypothesis, f64)> = hypotheses.into_iter().map(|it| (it, 0.0)).collect();
        let mut found = Found::default();
        let looks = &self.predictor.looks;
        for (level, &look) in looks.iter().enumerate() {
            let mut promising = Vec::new();
            for (tried, (hypothesis, _)) in open.into_iter().enumerate() {
                let is_of_the_image = hypothesis.is_of_the_image();
                if is_of_the_image {
                    let pixels = self.golden.width() * self.golden.height();
                    clock.spend((EVENTS_OF_AN_EDIT * pixels) as u64);
                }
                if level == 0 && clock.is_late() {
                    break;
                }
                let film = self
                    .predictor
                    .predict(&self.golden, &hypothesis, look, clock);
                if let Some(film) = film {
                    if is_of_the_image || level + 1 == looks.len() {
                        found.add(self, hypothesis, &film);
                    } else if let Some(remoteness) = self.remoteness(&film) {
                        promising.push((hypothesis, remoteness));
                    }
                }
                if level == 0 && is_reported && !clock.is_late() {
                    clock.report(Stage::Singles, tried + 1, of);
                }
            }
            promising.sort_by(|a, b| a.1.total_cmp(&b.1));
            promising.truncate(SURVIVORS[level.min(SURVIVORS.len() - 1)]);
            open = promising;
        }
        found
            .explaining
            .sort_by(|(_, a), (_, b)| a.value.total_cmp(&b.value));
        found
    }

    /// The number by which hypotheses are sorted for a closer look, the least first: the difference that is left, or in
    /// noise the gain with a minus sign. Nothing if the prediction `film` is far off.
    fn remoteness(&self, film: &Film) -> Option<f64> {
        let few = &self.few;
        let seen = self.seen(film, few)?;
        if self.is_sampled {
            let amount = seen.amount_in(&few.test, &few.golden);
            return Some(-amount.map_or(0.0, |amount| amount.gain));
        }
        let left = few.left(&seen).value;
        (left <= FAR_OFF_ON_LATTICE * few.whole.value).then_some(left)
    }

    /// A sentence on how near `film`, which does not pass for the image, comes to it, with the difference that is left;
    /// nothing if it is not near.
    fn close_in_words(&self, hypothesis: &Hypothesis, film: &Film) -> Option<(f64, String)> {
        if self.is_sampled || self.is_of_opacity || film.width() != self.golden.width() {
            return None;
        }
        let left = self.few.left(&self.seen(film, &self.few)?).value;
        (left <= UNEXPLAINED * self.few.whole.value).then_some(())?;
        let off = outliers(film, &self.test.nearest_to(film));
        let words = format!(
            "close to {}: {} of {} pixels still differ, by up to {:.1} tolerances",
            hypothesis.name(),
            off.outside,
            off.count,
            off.worst.1
        );
        Some((left, words))
    }
}

/// What a search finds.
#[derive(Default)]
pub(super) struct Found {
    pub explaining: Explaining,
    /// The nearest hypothesis that does not explain the image, with the distance that it leaves.
    pub close: Option<(f64, String)>,
}

impl Found {
    fn add(&mut self, case: &ComparedCase, hypothesis: Hypothesis, film: &Film) {
        let mixes_pixels = hypothesis.is_of_the_image()
            && !hypothesis.mistakes().all(|it| it.is_of_single_pixels());
        match case.explained_by(film, mixes_pixels) {
            Some(left) => self.explaining.push((hypothesis, left)),
            None => {
                let close = case.close_in_words(&hypothesis, film);
                let both = [self.close.take(), close].into_iter().flatten();
                self.close = both.min_by(|a, b| a.0.total_cmp(&b.0));
            }
        }
    }
}

impl KeptValues {
    /// `film` as such a file keeps it.
    fn film(self, film: &Film) -> Film {
        match self {
            KeptValues::All => film.clone(),
            KeptValues::UpTo(ceiling) => mapped(film, |value, _| (value.min(ceiling), 1.0)),
            KeptValues::Codes(quantisation) => quantisation.rounded(film),
        }
    }
}

/// True if the colours of two images without noise agree, and opacity may not.
fn has_right_colours(golden: &Film, picture: &Picture) -> bool {
    let test = picture.radiance().filter(|test| test.noise().is_none());
    if golden.opacity().is_none() || golden.noise().is_some() || test.is_none() {
        return false;
    }
    let colours = Picture::Radiance(golden.clone().without_opacity());
    passes(&colours, picture, &Conditions::default())
}

/// Names of the parameters that the difference looks like, or, of one that is too large for derivatives,
/// those with the largest scores.
fn suspects(judged: &Judged) -> Vec<String> {
    let changes = &judged.result.changes;
    let scores = changes.iter().map(|change| change.score.abs());
    let largest = scores.fold(0.0, f64::max);
    let is_suspect =
        |change: &&NumberChange| change.fits_best || change.score.abs() > SUSPICIOUS * largest;
    let named = changes.iter().filter(is_suspect);
    named.map(|change| change.name.clone()).collect()
}
