//! Predictions: images of a scene with a change, of as few pixels or samples as tell.

use super::clock::SearchClock;
use super::hypothesis::Hypothesis;
use crate::compare::stochastic::BLOCK;
use crate::film::Film;
use crate::render::{Counters, Detail, Event, Plan, Sampling, Seed, plans, render_part};
use crate::scene::Scene;

/// Pixels of a look, and samples in each.
pub(super) type Look = (Detail, u32);

/// Seed of predictions, the first of a few: one that neither goldens nor renderings of users are likely to have.
const SEED: u64 = 0x7072_6564_6963_7400;

/// Samples in a block of each look, where pixels are means of samples: 1, 8 and 32 per pixel. The last has as many as
/// a test image of the suite, or more, so that its own noise is no longer the larger one.
const SAMPLES: [u32; 3] = [64, 512, 2048];

/// Samples in a pixel of a scene without random numbers that asks for some: of a plot.
const WITHOUT_NOISE: u32 = 4;

/// Approximate number of pixels of a lattice: of a mistake that shows in one pixel in a hundred,
/// twenty are seen.
const LATTICE: usize = 2048;

/// A lattice of about `wanted` pixels of an image of `pixels`; the whole image where it is small.
pub(in crate::naming) fn lattice_of(pixels: usize, wanted: usize) -> Detail {
    match (pixels / wanted).isqrt() {
        0 | 1 => Detail::Whole,
        every => Detail::Lattice(every),
    }
}

/// Predictor of the images that changes of a scene make.
pub(super) struct Predictor {
    /// Name of the case.
    name: String,
    pub scene: Scene,
    /// Looks at an image, from few pixels or samples to many.
    pub looks: Vec<Look>,
}

impl Predictor {
    /// Predictor for the `scene` of the case called `name`, whose pixels are means of samples or not.
    pub fn new(name: &str, scene: Scene, is_sampled: bool) -> Predictor {
        let pixels = scene.width() * scene.height();
        let mut looks: Vec<Look> = if is_sampled {
            let look = |samples: u32| match blocks(&scene) {
                Some(blocks) => (blocks, samples),
                None => (Detail::Whole, (samples / (BLOCK * BLOCK) as u32).max(2)),
            };
            SAMPLES.map(look).into()
        } else {
            [lattice_of(pixels, LATTICE), Detail::Whole]
                .map(|it| (it, WITHOUT_NOISE))
                .into()
        };
        looks.dedup();
        Predictor {
            name: name.to_owned(),
            scene,
            looks,
        }
    }

    /// The look with the fewest pixels, or samples.
    pub fn few(&self) -> Look {
        self.looks[0]
    }

    /// The look with the most pixels, or samples.
    pub fn most(&self) -> Look {
        self.looks[self.looks.len() - 1]
    }

    /// A look with the random numbers of a `seed` from 0 at `edited`, the scene with a change; nothing if that cannot be
    /// rendered, or if the search is to end.
    pub fn rendered(
        &self,
        edited: &Scene,
        (detail, samples): Look,
        seed: u64,
        clock: &SearchClock<'_>,
    ) -> Option<Film> {
        (!clock.is_over()).then_some(())?;
        let plans = plans(edited);
        // A block of a scene that the change has left without random numbers is no mean, but one ray.
        let detail = match detail {
            Detail::Blocks(_) if !plans.iter().all(Plan::is_sampled) => Detail::Whole,
            detail => detail,
        };
        let stopped = || clock.is_stopped();
        let sampling = Sampling {
            samples: Some(samples),
            seed: Seed::Given(SEED + seed),
        };
        let made = render_part(&plans, sampling, detail, &stopped, &|| ()).ok()?;
        // A ray that meets nothing takes a little as well.
        let rays = made.film.radiance().len() as u64 * u64::from(samples);
        let of_panel = |work: &Counters| Event::ALL.iter().map(|&event| work[event]).sum::<u64>();
        clock.spend(rays + made.work.iter().map(of_panel).sum::<u64>());
        Some(made.film)
    }

    /// The image that `hypothesis` would make, of the scene or of its `golden`; nothing where it has no occasion, or where
    /// the search is to end. Work is counted as if nothing were kept, so that the same search always gets as far.
    pub fn predict(
        &self,
        golden: &Film,
        hypothesis: &Hypothesis,
        look: Look,
        clock: &SearchClock<'_>,
    ) -> Option<Film> {
        let mut scene = None;
        for mistake in hypothesis.mistakes().filter(|it| !it.is_of_the_image()) {
            scene = Some(mistake.in_scene(scene.as_ref().unwrap_or(&self.scene))?);
        }
        let mut film = match scene {
            Some(scene) => self.kept_or_rendered(&scene, hypothesis, look, clock)?,
            None => golden.clone(),
        };
        for mistake in hypothesis.mistakes().filter(|it| it.is_of_the_image()) {
            film = mistake.in_image(&film)?;
        }
        Some(film)
    }

    fn kept_or_rendered(
        &self,
        scene: &Scene,
        hypothesis: &Hypothesis,
        look: Look,
        clock: &SearchClock<'_>,
    ) -> Option<Film> {
        let key = (self.name.clone(), *hypothesis, format!("{look:?}"));
        let before = clock.work();
        if let Some((film, work)) = clock.predictions().get(&key) {
            return clock.spend(work).then_some(film);
        }
        let film = self.rendered(scene, look, 0, clock)?;
        clock
            .predictions()
            .put(key, (film.clone(), clock.work() - before));
        Some(film)
    }
}

/// Blocks as pixels, for scenes that are path traced and whose panels, side by side, have the
/// borders of blocks; else `None`.
fn blocks(scene: &Scene) -> Option<Detail> {
    let (last, before) = scene.panels.split_last()?;
    let is_large = last.width.min(last.height) >= BLOCK;
    let is_aligned = before.iter().all(|panel| panel.width.is_multiple_of(BLOCK));
    let can = is_large && is_aligned && plans(scene).iter().all(Plan::is_sampled);
    can.then_some(Detail::Blocks(BLOCK))
}

/// The pixels of `film`, an image of `scene`, that are rendered with `detail`: the means over blocks are not among them.
pub(in crate::naming) fn pixels_of(film: &Film, scene: &Scene, detail: Detail) -> Film {
    let (mut columns, mut left) = (Vec::new(), 0);
    for panel in &scene.panels {
        columns.extend(detail.places(panel.width).map(|column| left + column));
        left += panel.width;
    }
    let rows = detail.places(film.height());
    let height = rows.len();
    let places = rows.flat_map(|row| {
        columns
            .iter()
            .map(move |column| column + row * film.width())
    });
    let pixels = places.map(|index| film.pixel(index)).collect();
    let pixels = Film::with_opacity(columns.len(), height, pixels);
    let pixels = match film.opacity() {
        Some(_) => pixels,
        None => pixels.without_opacity(),
    };
    match film.quantisation() {
        Some(quantisation) => pixels.quantised(quantisation),
        None => pixels,
    }
}
