//! A failed case, and the misfit of its image to the predicted image of a mistake.

use super::clock::SearchClock;
use super::hypothesis::{Explaining, Hypothesis};
use super::kept_values::KeptValues;
use super::noisy_pixels::NoisyPixels;
use super::prediction::{indices_of, pixels_of};
use super::predictor::{Look, Predictor, UNCHANGED};
use super::volume_in_view::VolumeInView;
use crate::compare::cells::{Cells, Misfit};
use crate::compare::stochastic::{BLOCK, judge_at};
use crate::compare::unexplained::{
    BOUND, MOST_IN_NOISE, SquaredDistance, UNEXPLAINED, UNEXPLAINED_IN_NOISE,
};
use crate::compare::{
    Conditions, Deterministic, Gate as _, NumberChange, Perceptual, Picture, Refinement, Seen,
    WITHIN_A_PIXEL, change_with_step, default_gate, judge, measured, place_of_rest,
};
use crate::film::{Film, Noise};
use crate::judging::Judged;
use crate::judging::measured::{SimpleMap, decoded, simple};
use crate::math;
use crate::render::Detail;
use crate::scene::Scene;
use crate::suite::Case;
use std::sync::OnceLock;

/// An 8-bit image is rounded, which leaves a share of a small difference unexplained: there the
/// perceptual gate may say that prediction and image are the same, if no more than this share is
/// left.
const OF_CODES: f64 = 0.5;

/// The same on a lattice. Its share is an estimate from 2000 pixels or more: one that is half the
/// pixels' has a standard error of a tenth even where one pixel in fifty differs.
const FAR_OFF_ON_LATTICE: f64 = 0.75;

/// Probability with which an image is said to disagree with a rendering with a changed number, though it
/// has that change.
const DISAGREES: f64 = 0.01;

/// Smallest mean squared difference, in variances and beyond the one that noise makes, of which a share is known:
/// in 200 cells noise moves the mean by a tenth, √(2/200).
const LEAST_EXCESS: f64 = 0.5;

/// Seed of the renderings that decide, none of those that were fitted.
const CLOSE_SEED: u64 = 7;

/// A failed case.
pub(super) struct ComparedCase {
    /// Index of the case among the results.
    pub index: usize,
    /// Name of the case.
    pub name: String,
    /// The simple map of values from the golden to the image, which the verdict states already.
    pub simple: Option<SimpleMap>,
    /// Work that the search for its conventions took, in events of kernels.
    pub spent: u64,
    /// What explains the image, where that search has found it.
    pub known: Explaining,
    /// Judged by noise, in coarse cells; else pixel by pixel.
    pub is_sampled: bool,
    pub golden: Film,
    /// Numbers of the scene that the verdict names; none where it names none.
    pub suspects: Vec<String>,
    /// The image with the step of the scene, with half of it and so on, if they are judged by their
    /// limit.
    refined: Vec<Film>,
    predictor: Predictor,
    exposure: f64,
    /// Values that the file of the image can hold.
    kept: KeptValues,
    /// The image as it was given, for the gates without noise.
    picture: Picture,
    golden_cells: Cells,
    test_cells: Cells,
    /// Misfit of the golden to the image: a mistake has to do better.
    from_golden: Misfit,
    /// The scene itself as a first and as a second look shows it.
    unchanged: [OnceLock<Option<Cells>>; 2],
    /// Without noise: golden and image as a first look sees them.
    glimpse: Option<Glimpse>,
}

/// The pixels of a lattice.
struct Glimpse {
    golden: Cells,
    test: Cells,
    test_film: Film,
    from_golden: Misfit,
}

/// The part of the largest score from which a number is suspected: far from the golden, where
/// derivatives do not hold, another may have a larger score than the one that is off.
const SUSPICIOUS: f64 = 0.5;

impl ComparedCase {
    /// The case of a failed image; `None` where the image cannot be compared, or the scene cannot
    /// be read.
    pub fn new(
        index: usize,
        case: &Case,
        judged: &Judged,
        scenes: &dyn Fn(&Case) -> Option<Scene>,
    ) -> Option<ComparedCase> {
        let golden = judged.evidence.golden.clone()?;
        let picture = judged.evidence.test.clone()?;
        let size = (golden.width(), golden.height());
        let is_sampled = case.sampling.is_some();
        let (test, kept) = match &picture {
            Picture::Radiance(film) => (film.clone(), KeptValues::by(film, is_sampled)),
            Picture::Codes(codes) => {
                let ceiling = math::exp2(-case.exposure);
                (decoded(codes, case.exposure), KeptValues::UpTo(ceiling))
            }
        };
        if !golden.is_comparable(&test) {
            return None;
        }
        let in_cells = |film: &Film| {
            if is_sampled {
                Cells::of_blocks(film)
            } else {
                Cells::of_pixels(film)
            }
        };
        let bounded = kept.film(&golden);
        let golden_cells = in_cells(&bounded);
        let mut test_cells = in_cells(&test);
        if is_sampled && test.noise().is_none() {
            test_cells.spread_noise_like(&golden_cells);
        }
        let predictor = Predictor::new(scenes(case)?, size.0 * size.1, is_sampled);
        let glimpse = (!is_sampled)
            .then(|| Glimpse::new(&bounded, &test, &predictor.widths, predictor.first.0));
        let known = judged.evidence.known_mistakes.0.iter();
        let known = known.map(|&(one, misfit)| (Hypothesis::One(one), misfit));
        Some(ComparedCase {
            index,
            name: case.name.clone(),
            simple: simple(case, &golden, &picture),
            spent: judged.evidence.work_of_search,
            known: known.collect(),
            is_sampled,
            suspects: suspects(judged),
            refined: if judged.result.gate.name() == Refinement.name() {
                judged.evidence.refined.clone()
            } else {
                Vec::new()
            },
            from_golden: golden_cells.misfit(&test_cells, &golden_cells),
            golden,
            predictor,
            exposure: case.exposure,
            kept,
            picture,
            golden_cells,
            test_cells,
            unchanged: Default::default(),
            glimpse,
        })
    }

    /// True if a mistake with this misfit explains the image: all but a small share of its
    /// difference from the golden, beyond doubt.
    pub fn explained_by(&self, misfit: &Misfit) -> bool {
        match self.picture {
            Picture::Radiance(_) => self.leaves(misfit, self.may_leave()),
            Picture::Codes(_) => misfit.is_noise(),
        }
    }

    /// Renders the scene itself for a first look. Pairs are looked at in parallel: there threads would wait for the one
    /// that renders it, and that one for them.
    pub fn render_unchanged(&self, clock: &SearchClock<'_>) {
        if self.is_sampled {
            self.unchanged(self.predictor.first, clock);
        }
    }

    /// The scene itself as a first or second `look` shows it, if the search is to go on.
    fn unchanged(&self, look: Look, clock: &SearchClock<'_>) -> Option<&Cells> {
        let unchanged = &self.unchanged[usize::from(look == self.predictor.second)];
        let rendered = || {
            let scene = &self.predictor.scene;
            let film = self
                .predictor
                .rendered(scene, (UNCHANGED, 0), look, clock)?;
            in_cells(&self.kept.film(&film), &self.golden_cells)
        };
        unchanged.get_or_init(rendered).as_ref()
    }

    /// Misfit of `film`, a `look` at a hypothesis, to a noisy image, with what the hypothesis gains, if a closer look may
    /// show that it explains the image.
    fn promise_in_noise(&self, film: &Film, look: Look, clock: &SearchClock<'_>) -> Option<Misfit> {
        let (test, golden) = (&self.test_cells, &self.golden_cells);
        let predicted = in_cells(&self.kept.film(film), golden)?;
        let misfit = predicted.misfit(test, golden);
        if !self.may_be_explained_by(&misfit) {
            return None;
        }
        let by_itself = predicted.amount_in(test, golden).map(|amount| amount.gain);
        let unchanged = self.unchanged(look, clock);
        let beside = unchanged.map(|it| predicted.gain_over(it, test, golden));
        Some(Misfit {
            gain: by_itself.unwrap_or(0.0).max(beside.unwrap_or(0.0)),
            ..misfit
        })
    }

    /// Misfit of `film` to the image: a prediction of the whole image or in blocks.
    pub fn misfit(&self, film: &Film) -> Option<Misfit> {
        let film = self.kept.film(film);
        let (cells, golden) = (&self.test_cells, &self.golden_cells);
        if self.is_sampled {
            return Some(in_cells(&film, golden)?.misfit(cells, golden));
        }
        let predicted = Cells::of_pixels(&film).without_noise();
        if !predicted.has_size_of(golden) {
            return None;
        }
        let misfit = predicted.misfit(cells, golden);
        let Picture::Codes(_) = self.picture else {
            return Some(misfit);
        };
        let is_within = |share: f64| misfit.distance().value <= share * self.whole_distance();
        let conditions = Conditions {
            exposure: self.exposure,
            ..Conditions::default()
        };
        // FLIP takes its time, and need not be asked about what is far off.
        let is_noise = is_within(UNEXPLAINED)
            || is_within(OF_CODES)
                && judge(
                    &Perceptual,
                    &Picture::Radiance(film),
                    &self.picture,
                    &conditions,
                )
                .is_ok_and(|judgement| judgement.passed);
        Some(Misfit {
            in_noise: if is_noise { 1.0 } else { f64::INFINITY },
            ..misfit
        })
    }

    /// True if golden and image are means of samples.
    pub fn is_sampled(&self) -> bool {
        self.is_sampled
    }

    /// Golden and image pixel by pixel, where the image states its noise.
    pub fn noisy_pixels(&self) -> Option<NoisyPixels> {
        let test = self
            .picture
            .radiance()
            .filter(|film| self.is_sampled && film.noise().is_some())?;
        Some(NoisyPixels::of(&self.golden, test, self.kept))
    }

    /// The share of the squared difference that a hypothesis may leave unexplained.
    pub fn may_leave(&self) -> f64 {
        if self.is_sampled {
            UNEXPLAINED_IN_NOISE
        } else {
            UNEXPLAINED
        }
    }

    /// True if the image or its golden is noisy.
    pub fn has_noise(&self) -> bool {
        let films = [Some(&self.golden), self.picture.radiance()];
        films
            .into_iter()
            .flatten()
            .any(|film| film.noise().is_some())
    }

    /// True if noise is low enough to decide if a hypothesis, even the right one, explains the
    /// image.
    pub fn is_decidable(&self) -> bool {
        let whole = self.from_golden.distance();
        let of_the_right_one = SquaredDistance {
            value: 0.0,
            error: self.from_golden.least_error,
        };
        let is_known = whole.at_least() > 0.0;
        is_known && of_the_right_one.is_explained(&whole, self.may_leave())
            || matches!(self.picture, Picture::Codes(_))
    }

    /// True if the image is the golden times a factor, as far as the gate can tell: then it shows
    /// no curve of values.
    pub fn is_gain(&self) -> bool {
        self.simple == Some(SimpleMap::Gain)
    }

    /// Measurements of the difference, which a change of numbers may explain, as sentences; nothing where none can be made,
    /// or the verdict says how the image follows from the golden.
    pub fn measured_difference(&self, is_explained: bool) -> Option<Vec<String>> {
        let test = self.picture.radiance().filter(|_| self.simple.is_none())?;
        let seen = self.seen();
        let mut said = measured(&self.kept.film(&self.golden), test, &seen, is_explained)?;
        said.extend(change_with_step(&self.golden, &self.refined, &seen));
        Some(said)
    }

    fn seen(&self) -> Seen {
        let volume = VolumeInView::of(&self.predictor.scene);
        Seen {
            border: volume.as_ref().and_then(VolumeInView::border),
            voxels: volume.as_ref().and_then(VolumeInView::voxels),
        }
    }

    /// Place of what `prediction`, as [`in_fit`](Self::in_fit) sees the image, leaves of the difference.
    pub fn place_of_rest(&self, prediction: &Cells) -> Option<String> {
        let [golden, test] = self.in_fit();
        let squares = prediction.squares_left(test, golden);
        let (width, height) = (self.golden.width(), self.golden.height());
        let mut of_pixels = vec![0.0; width * height];
        if self.is_sampled {
            let edge = if golden.columns == width { 1 } else { BLOCK };
            for (i, of_pixel) in of_pixels.iter_mut().enumerate() {
                let [x, y] = [i % width / edge, i / width / edge];
                if x < golden.columns && y < golden.rows {
                    *of_pixel = squares[x + golden.columns * y];
                }
            }
        } else {
            let pixels = indices_of(
                [width, height],
                &self.predictor.widths,
                self.predictor.first.0,
            );
            for (i, square) in pixels.into_iter().zip(squares) {
                of_pixels[i] = square;
            }
        }
        place_of_rest(&self.golden, &self.seen(), &of_pixels)
    }

    /// True if `prediction` agrees with the image, as [`in_fit`](Self::in_fit) sees it, by the rule of the
    /// gate: cells are judged as pixels.
    pub fn agrees(&self, prediction: &Cells) -> bool {
        let film = prediction.film();
        match &self.glimpse {
            Some(glimpse) => agree(film, Picture::Radiance(glimpse.test_film.clone())),
            None => judge_at(&film, &self.test_cells.film(), DISAGREES)
                .is_ok_and(|judgement| judgement.passed),
        }
    }

    /// True if `prediction` [agrees](Self::agrees), and the `whole` image of it where only a lattice of that is seen:
    /// a difference in a single row may lie between its lines.
    pub fn agrees_in_all(&self, prediction: &Cells, whole: impl FnOnce() -> Option<Film>) -> bool {
        let is_seen = self.is_sampled || self.sees_all_at_once();
        let agrees_as_a_whole = |film: Film| {
            let film = self.kept.film(&film).without_opacity();
            agree(film, self.picture.clone())
        };
        self.agrees(prediction)
            && (is_seen
                || matches!(self.picture, Picture::Codes(_))
                || whole().is_some_and(agrees_as_a_whole))
    }

    /// All pixels of `edited`, a change known as `label`, without noise.
    pub fn whole_of_scene(
        &self,
        edited: &Scene,
        label: &str,
        clock: &SearchClock<'_>,
    ) -> Option<Film> {
        let look = self.predictor.second;
        self.predictor.rendered(edited, (label, 0), look, clock)
    }

    /// Mean squared difference of `prediction` from the image, as [`in_fit`](Self::in_fit) sees it, in variances.
    pub fn in_noise(&self, prediction: &Cells) -> f64 {
        let [golden, test] = self.in_fit();
        prediction.misfit(test, golden).in_noise
    }

    /// True if the scene, rendered with the one mistake of `hypothesis` as `film`, agrees with the image by the rule
    /// of the gate, by which the golden would not, were it as noisy, and leaves at most [`MOST_IN_NOISE`] of the
    /// difference: of the squares, or of what they are in variances, where rare bright paths make the squares. Some
    /// of thousands of pairs agree by chance.
    fn agrees_with(&self, hypothesis: &Hypothesis, film: &Film, misfit: &Misfit) -> bool {
        let is_single = matches!(hypothesis, Hypothesis::One(_));
        let prediction = in_cells(&self.kept.film(film), &self.golden_cells);
        prediction.filter(|_| is_single).is_some_and(|prediction| {
            let noisy = self.golden_cells.with_noise_of(&prediction);
            let excess = self.in_noise(&noisy) - 1.0;
            let is_nearer = self.leaves(misfit, MOST_IN_NOISE)
                || excess > LEAST_EXCESS && misfit.in_noise - 1.0 <= MOST_IN_NOISE * excess
                || self.leaves_where_it_shows(&prediction)
                || self.has_amount_of(&prediction);
            is_nearer && !self.agrees(&noisy) && self.agrees(&prediction)
        })
    }

    /// True if at most [`MOST_IN_NOISE`] is left of the difference in the blocks that `prediction` changes: of one
    /// that lies in few, the noise of all the others hides how much is left.
    fn leaves_where_it_shows(&self, prediction: &Cells) -> bool {
        let shows = prediction.differs_from(&self.golden_cells);
        let [prediction, test, golden] =
            [prediction, &self.test_cells, &self.golden_cells].map(|cells| cells.only(&shows));
        let whole = golden.misfit(&test, &golden);
        shows.contains(&true)
            && prediction
                .misfit(&test, &golden)
                .explains(&whole, MOST_IN_NOISE)
    }

    /// True if the image has what `prediction` changes, and as much of it, so that at most [`MOST_IN_NOISE`] of its
    /// square is left, beyond doubt: of what is small in every block, noise hides how much is left but of the sum.
    fn has_amount_of(&self, prediction: &Cells) -> bool {
        let amount = prediction.amount_in(&self.test_cells, &self.golden_cells);
        amount.is_some_and(|it| (it.value - 1.0).abs() + BOUND * it.error <= MOST_IN_NOISE.sqrt())
    }

    /// The image of `edited`, a change known as `label`, with so many samples that noise hides little;
    /// in the cells of a [fit](Self::in_fit).
    pub fn predicted_closely(
        &self,
        edited: &Scene,
        label: &str,
        clock: &SearchClock<'_>,
    ) -> Option<Cells> {
        let film =
            self.predictor
                .rendered(edited, (label, CLOSE_SEED), self.predictor.third(), clock)?;
        in_cells(&self.kept.film(&film), &self.golden_cells)
    }

    /// True if the shift that the verdict names may come of positions that all renderings of a mean
    /// share within a pixel.
    pub fn may_share_positions(&self, changes: &[NumberChange]) -> bool {
        let test = self.picture.radiance().and_then(Film::noise);
        let is_small_shift = |change: &NumberChange| {
            let is_shift = ["camera.right", "camera.down"].contains(&&*change.name);
            change.fits_best && is_shift && change.change.abs() <= WITHIN_A_PIXEL
        };
        test.is_some_and(Noise::is_of_renderings) && changes.iter().any(is_small_shift)
    }

    /// The scene of the case.
    pub fn scene(&self) -> &Scene {
        &self.predictor.scene
    }

    /// Pixels of the `edited` scene, a change known as `label`, in one look: a lattice where there
    /// is no noise, else blocks.
    pub fn predicted_with(
        &self,
        edited: &Scene,
        label: &str,
        clock: &SearchClock<'_>,
    ) -> Option<Cells> {
        self.predicted_by_seed(edited, label, 0, clock)
    }

    fn predicted_by_seed(
        &self,
        edited: &Scene,
        label: &str,
        seed: u64,
        clock: &SearchClock<'_>,
    ) -> Option<Cells> {
        let look = if self.is_sampled {
            self.predictor.second
        } else {
            self.predictor.first
        };
        let film = self
            .predictor
            .rendered(edited, (label, seed), look, clock)?;
        let film = self.kept.film(&film);
        if self.is_sampled {
            return in_cells(&film, &self.golden_cells);
        }
        Some(Cells::of_pixels(&film).without_noise())
    }

    /// Golden, image and the misfit of the golden, as [`predicted_with`](Self::predicted_with) sees
    /// them.
    fn as_predicted(&self) -> (&Cells, &Cells, &Misfit) {
        match &self.glimpse {
            Some(glimpse) => (&glimpse.golden, &glimpse.test, &glimpse.from_golden),
            None => (&self.golden_cells, &self.test_cells, &self.from_golden),
        }
    }

    /// Golden and image, as a [fit](crate::naming::likeness::fit) sees them.
    pub fn in_fit(&self) -> [&Cells; 2] {
        let (golden, test, _) = self.as_predicted();
        [golden, test]
    }

    /// Renderings of `edited` for a fit, one for each seed: two where there is noise.
    pub fn predicted_for_fit(
        &self,
        edited: &Scene,
        label: &str,
        clock: &SearchClock<'_>,
    ) -> Option<Vec<Cells>> {
        let seeds = if self.is_sampled { 2 } else { 1 };
        let of_seed = |seed: u64| {
            let cells = self.predicted_by_seed(edited, label, seed, clock)?;
            cells.has_size_of(self.in_fit()[0]).then_some(cells)
        };
        (0..seeds).map(of_seed).collect()
    }

    /// The share of the squared difference that `prediction` leaves.
    pub fn share_left(&self, prediction: &Cells) -> Option<f64> {
        let (golden, test, whole) = self.as_predicted();
        let fits = prediction.has_size_of(golden);
        fits.then(|| prediction.misfit(test, golden))?
            .share_of(whole)
    }

    /// True if `prediction` leaves no more than `share`, beyond doubt.
    pub fn is_explained_but_for(&self, prediction: &Cells, share: f64) -> Option<bool> {
        let (golden, test, whole) = self.as_predicted();
        let fits = prediction.has_size_of(golden);
        fits.then(|| prediction.misfit(test, golden).explains(whole, share))
    }

    /// The squared distance between golden and image.
    fn whole_distance(&self) -> f64 {
        self.from_golden.distance().value
    }

    /// Misfit of `look`, as [`ComparedCase::look`] returns it, to the image, if a closer look may
    /// find that they agree.
    pub fn promise(&self, look: &Film, clock: &SearchClock<'_>) -> Option<Misfit> {
        if self.is_sampled {
            return self.promise_in_noise(look, self.predictor.first, clock);
        }
        if self.sees_all_at_once() {
            return self.misfit(look).filter(|misfit| self.explained_by(misfit));
        }
        let misfit = self.distance(look)?;
        let whole = self.glimpse.as_ref()?.from_golden.distance().value;
        (misfit.distance().value <= FAR_OFF_ON_LATTICE * whole).then_some(misfit)
    }

    /// Misfit of `look` to the image; [`Misfit::in_noise`] means nothing where there is none.
    pub fn distance(&self, look: &Film) -> Option<Misfit> {
        let look = self.kept.film(look);
        match &self.glimpse {
            Some(glimpse) => {
                let cells = Cells::of_pixels(&look).without_noise();
                let fits = cells.has_size_of(&glimpse.golden);
                fits.then(|| cells.misfit(&glimpse.test, &glimpse.golden))
            }
            None => {
                let cells = in_cells(&look, &self.golden_cells)?;
                Some(cells.misfit(&self.test_cells, &self.golden_cells))
            }
        }
    }

    /// True if the first look sees all of the image, so that there is no closer one.
    pub fn sees_all_at_once(&self) -> bool {
        !self.is_sampled && self.predictor.first.0 == Detail::Whole
    }

    /// The first look at a scene with `hypothesis`; `None` where it has no occasion,
    /// cannot be rendered, or the time is over.
    pub fn look(&self, hypothesis: &Hypothesis, clock: &SearchClock<'_>) -> Option<Film> {
        self.predictor
            .predict(&self.golden, hypothesis, self.predictor.first, clock)
    }

    /// The whole image that `hypothesis` would make.
    pub fn whole(&self, hypothesis: &Hypothesis, clock: &SearchClock<'_>) -> Option<Film> {
        self.predictor.predict(
            &self.golden,
            hypothesis,
            (Detail::Whole, self.predictor.second.1),
            clock,
        )
    }

    /// True if the whole image of `hypothesis` passes for this one, as an image under conventions has to.
    pub fn passes_with(&self, hypothesis: &Hypothesis, clock: &SearchClock<'_>) -> bool {
        let Some(film) = self.whole(hypothesis, clock) else {
            return false;
        };
        let film = Picture::Radiance(self.kept.film(&film));
        let conditions = Conditions {
            exposure: self.exposure,
            ..Conditions::default()
        };
        let (gate, _) = default_gate(&film, &self.picture);
        judge(gate, &film, &self.picture, &conditions).is_ok_and(|judgement| judgement.passed)
    }

    /// Misfit of `hypothesis` in one look.
    fn looked_at(
        &self,
        hypothesis: &Hypothesis,
        look: Look,
        clock: &SearchClock<'_>,
    ) -> Option<Misfit> {
        self.misfit(
            &self
                .predictor
                .predict(&self.golden, hypothesis, look, clock)?,
        )
    }

    /// Misfit of `hypothesis` on a second look at a noisy image, if a third one may show that it explains the image.
    pub fn second_look(&self, hypothesis: &Hypothesis, clock: &SearchClock<'_>) -> Option<Misfit> {
        // What leaves more than noise does not agree, and what leaves much does not explain.
        let most = self.may_leave() * self.whole_distance();
        let is_near = |misfit: &Misfit| misfit.is_noise() || misfit.distance().value <= most;
        let film =
            self.predictor
                .predict(&self.golden, hypothesis, self.predictor.second, clock)?;
        self.promise_in_noise(&film, self.predictor.second, clock)
            .filter(is_near)
    }

    fn may_be_explained_by(&self, misfit: &Misfit) -> bool {
        misfit.may_explain(&self.from_golden, self.may_leave())
    }

    /// True if a hypothesis with this misfit leaves no more than `share`, beyond doubt.
    pub fn leaves(&self, misfit: &Misfit, share: f64) -> bool {
        misfit.explains(&self.from_golden, share)
    }

    /// Misfit of `hypothesis`, with that of a `second` look if there was one, if it explains the image: beyond doubt,
    /// or as far as noise tells. Looked at a third time where noise leaves it open.
    pub fn explanation(
        &self,
        hypothesis: &Hypothesis,
        second: Option<Misfit>,
        clock: &SearchClock<'_>,
    ) -> Option<Misfit> {
        let second = second.or_else(|| self.looked_at(hypothesis, self.predictor.second, clock))?;
        if self.explained_by(&second) {
            return Some(second);
        }
        if !(self.is_sampled && self.may_be_explained_by(&second)) {
            return None;
        }
        let film =
            self.predictor
                .predict(&self.golden, hypothesis, self.predictor.third(), clock)?;
        let third = self.misfit(&film)?;
        self.is_explanation(hypothesis, &film, &third)
            .then_some(third)
    }

    /// True if `hypothesis`, of which the image is `film` and that has this misfit, explains the image: beyond doubt, or
    /// as far as noise tells.
    pub fn is_explanation(&self, hypothesis: &Hypothesis, film: &Film, misfit: &Misfit) -> bool {
        let may_agree = || self.is_sampled && self.may_be_explained_by(misfit);
        self.explained_by(misfit) || may_agree() && self.agrees_with(hypothesis, film, misfit)
    }

    /// Misfit of `hypothesis` to the image, closely looked at: once more where noise leaves open
    /// whether it explains the image.
    pub fn test(&self, hypothesis: &Hypothesis, clock: &SearchClock<'_>) -> Option<Misfit> {
        let second = self.looked_at(hypothesis, self.predictor.second, clock)?;
        let is_open = self.may_be_explained_by(&second) && !self.explained_by(&second);
        let third = (self.is_sampled && is_open)
            .then(|| self.looked_at(hypothesis, self.predictor.third(), clock))
            .flatten();
        third.or(Some(second))
    }

    /// True if this image, which passed, would have failed with the mistakes of `hypothesis`.
    pub fn speaks_against(&self, hypothesis: &Hypothesis, clock: &SearchClock<'_>) -> Option<bool> {
        let is_glimpsed = matches!(self.predictor.first.0, Detail::Lattice(_))
            && matches!(self.picture, Picture::Radiance(_))
            && !hypothesis.mistakes().iter().any(|m| m.is_of_the_image());
        if is_glimpsed && let Some(glimpse) = &self.glimpse {
            let film =
                self.predictor
                    .predict(&self.golden, hypothesis, self.predictor.first, clock)?;
            let test = Picture::Radiance(glimpse.test_film.clone());
            let judgement = judge(
                &Deterministic,
                &Picture::Radiance(film),
                &test,
                &Conditions::default(),
            );
            return Some(judgement.is_ok_and(|judgement| !judgement.passed));
        }
        let look = if self.is_sampled {
            self.predictor.first
        } else {
            self.predictor.second
        };
        let film = self
            .predictor
            .predict(&self.golden, hypothesis, look, clock)?;
        if self.is_sampled || matches!(self.picture, Picture::Codes(_)) {
            return Some(!self.misfit(&film)?.is_noise());
        }
        let film = Picture::Radiance(self.kept.film(&film));
        let judgement = judge(&Deterministic, &film, &self.picture, &Conditions::default());
        Some(judgement.is_ok_and(|judgement| !judgement.passed))
    }
}

impl Glimpse {
    fn new(golden: &Film, test: &Film, panels: &[usize], detail: Detail) -> Glimpse {
        let [golden, test_film] = [golden, test].map(|film| pixels_of(film, panels, detail));
        let [golden, test] = [&golden, &test_film].map(Cells::of_pixels);
        Glimpse {
            from_golden: golden.misfit(&test, &golden),
            golden,
            test,
            test_film,
        }
    }
}

/// True if `picture` agrees with `film`, which is rendered after a fit: a ray at an edge may go either way.
fn agree(film: Film, picture: Picture) -> bool {
    let conditions = Conditions {
        in_single_precision: true,
        ..Conditions::default()
    };
    let judgement = judge(
        &Deterministic,
        &Picture::Radiance(film),
        &picture,
        &conditions,
    );
    judgement.is_ok_and(|judgement| judgement.passed)
}

/// Names of the numbers that the difference looks like, or, of one that is too large for derivatives,
/// those with the largest scores.
fn suspects(judged: &Judged) -> Vec<String> {
    let changes = &judged.result.changes;
    let scores = changes.iter().map(|change| change.score.abs());
    let largest = scores.fold(0.0, f64::max);
    let is_suspect = |change: &&NumberChange| {
        change.fits_best || change.alike || change.score.abs() > SUSPICIOUS * largest
    };
    let named = changes.iter().filter(is_suspect);
    named.map(|change| change.name.clone()).collect()
}

/// `film`, predicted in blocks or not, in the cells of an image of the size of `like`.
fn in_cells(film: &Film, like: &Cells) -> Option<Cells> {
    [Cells::of_pixels, Cells::of_blocks]
        .into_iter()
        .map(|cells| cells(film))
        .find(|cells| cells.has_size_of(like))
}
