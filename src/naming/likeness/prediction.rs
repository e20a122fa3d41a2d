//! Predictions: images of a scene in which a mistake is made.

use super::clock::SearchClock;
use crate::compare::stochastic::BLOCK;
use crate::film::Film;
use crate::render::{
    Counters, Detail, Event, Plan, Sampling, Seed, plans, render_coarse, render_coarse_counted,
};
use crate::scene::{Panel, Scene};
use crate::suite::golden::input_hashes;

/// Seed of predictions, the first of a few: one that neither goldens nor renderings of users are likely to have.
const SEED: u64 = 0x7072_6564_6963_7400;

/// Samples in a block of a first look, by which most mistakes are ruled out: a quarter of a sample
/// per pixel.
pub(super) const FIRST_LOOK: u32 = 16;

/// Samples in a block of a second look, at what is left: four per pixel.
pub(super) const SECOND_LOOK: u32 = 256;

/// Samples in a block of a third look, at what noise leaves open: 32 per pixel, as many as a test
/// image of the suite has or more, so that the noise of the prediction is no longer the larger one.
pub(super) const THIRD_LOOK: u32 = 2048;

/// Approximate number of pixels of a lattice: of a mistake that shows in one pixel in a hundred,
/// twenty are seen.
const LATTICE: usize = 2048;

/// The lattice of a first look at an image of this size without noise; the whole image where it is
/// small.
pub(super) fn first_lattice(pixels: usize) -> Detail {
    lattice_of(pixels, LATTICE)
}

/// A lattice of about `wanted` pixels of an image of `pixels`; the whole image where it is small.
pub(crate) fn lattice_of(pixels: usize, wanted: usize) -> Detail {
    match (pixels / wanted).isqrt() {
        0 | 1 => Detail::Whole,
        every => Detail::Lattice(every),
    }
}

/// Blocks as pixels, for scenes that are path traced and whose panels, side by side, have the
/// borders of blocks; else `None`.
pub(super) fn blocks(scene: &Scene) -> Option<Detail> {
    let (last, before) = scene.panels.split_last()?;
    let is_large = last.width.min(last.height) >= BLOCK;
    let is_aligned = before.iter().all(|panel| panel.width.is_multiple_of(BLOCK));
    let can = is_large && is_aligned && plans(scene).iter().all(Plan::is_sampled);
    can.then_some(Detail::Blocks(BLOCK))
}

/// Columns and rows of pixels of `scene` that are rendered with `detail`.
fn size(scene: &Scene, detail: Detail) -> [usize; 2] {
    let columns = |panel: &Panel| detail.columns(panel.width).count();
    [
        scene.panels.iter().map(columns).sum(),
        detail.rows(scene.height()).count(),
    ]
}

/// Number of rays from the eye in one look at `scene`, if it is sampled.
pub(super) fn rays(scene: &Scene, (detail, samples): (Detail, u32)) -> u64 {
    let [columns, rows] = size(scene, detail);
    (columns * rows) as u64 * u64::from(samples)
}

/// Work of a ray from the eye in `scene`, in events, by one look.
pub(super) fn work_of_a_ray(scene: &Scene, look: (Detail, u32)) -> f64 {
    let sampling = Sampling {
        samples: Some(look.1),
        seed: Seed::Given(SEED),
    };
    let counted = render_coarse_counted(&plans(scene), sampling, look.0);
    let events = counted.map_or(0, |of_panels| {
        let of_panel = |work: &Counters| Event::ALL.iter().map(|&event| work[event]).sum::<u64>();
        of_panels.iter().map(of_panel).sum()
    });
    // A ray that meets nothing takes a little as well.
    1.0 + events as f64 / rays(scene, look) as f64
}

/// The image of `edited`, which is `scene` with a change known as `label` (the names of mistakes, or
/// of changed numbers), from the random numbers of a `seed` from 0, with `samples` in each pixel that is rendered, if it is sampled. Nothing where it
/// cannot be rendered, or where the search was stopped.
pub(super) fn predicted(
    scene: &Scene,
    edited: &Scene,
    (label, seed): (&str, u64),
    (detail, samples): (Detail, u32),
    clock: &SearchClock<'_>,
) -> Option<Film> {
    let plans_of_edited = plans(edited);
    // A block of a scene that the change has left without random numbers is no mean, but one ray.
    let detail = match detail {
        Detail::Blocks(_) if !plans_of_edited.iter().all(Plan::is_sampled) => Detail::Whole,
        detail => detail,
    };
    let key = [
        &scene.canonical_text(),
        &format!("{:?}", input_hashes(scene)),
        &profile_text(scene),
        label,
        &format!("{detail:?} {samples} {seed}"),
    ]
    .join("\n");
    if let Some(kept) = clock.predictions().get(&key) {
        return Some(kept);
    }
    let sampling = Sampling {
        samples: Some(samples),
        seed: Seed::Given(SEED + seed),
    };
    let film = render_coarse(&plans_of_edited, sampling, detail, &|| clock.is_stopped()).ok()?;
    clock.predictions().put(key, &film);
    Some(film)
}

/// Changes of a scene by a [profile](crate::conventions::Profile), which are not among its keys, as text.
fn profile_text(scene: &Scene) -> String {
    let of_panels = scene.panels.iter().filter_map(Panel::classified);
    let texts = of_panels.map(|volume| {
        format!(
            "{:?} {:?} {}",
            volume.conventions, volume.compositing, volume.step
        )
    });
    texts.collect()
}

/// The pixels of `film`, an image of panels of these widths, that are rendered with `detail`: the
/// means over blocks are not among them.
pub(crate) fn pixels_of(film: &Film, panels: &[usize], detail: Detail) -> Film {
    let indices = indices_of([film.width(), film.height()], panels, detail);
    pixels_at(film, &indices, detail.rows(film.height()).count())
}

/// The pixels of `film` of these indices, row by row, as so many `rows`.
pub(crate) fn pixels_at(film: &Film, indices: &[usize], rows: usize) -> Film {
    let columns = indices.len() / rows;
    let indices = indices.iter();
    let pixels = match film.opacity() {
        Some(_) => {
            let pixels = indices.map(|&index| film.pixel(index)).collect();
            Film::with_opacity(columns, rows, pixels)
        }
        None => {
            let pixels = indices.map(|&index| film.radiance()[index]).collect();
            Film::new(columns, rows, pixels)
        }
    };
    match film.quantisation() {
        Some(quantisation) => pixels.quantised(quantisation),
        None => pixels,
    }
}

/// Indices of those pixels in an image of this size.
pub(super) fn indices_of(
    [width, height]: [usize; 2],
    panels: &[usize],
    detail: Detail,
) -> Vec<usize> {
    let mut columns = Vec::new();
    let mut left = 0;
    for &of_panel in panels {
        columns.extend(detail.columns(of_panel).map(|column| left + column));
        left += of_panel;
    }
    let of_row = |row: usize| columns.iter().map(move |column| column + row * width);
    detail.rows(height).flat_map(of_row).collect()
}

#[cfg(test)]
mod tests {
    use super::super::clock::Search;
    use super::super::kept::Predictions;
    use super::*;
    use crate::compare::cells::Cells;
    use crate::conventions::Profile;
    use crate::render::{RenderError, render};
    use crate::scene::{Model, Scattering};
    use std::path::Path;

    /// A scene of the suite with fewer pixels.
    fn small(name: &str, [width, height]: [usize; 2]) -> Scene {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes");
        let mut scene = Scene::load(&root.join(name)).unwrap();
        for panel in &mut scene.panels {
            (panel.width, panel.height) = (width, height);
        }
        scene
    }

    #[test]
    fn a_lattice_has_the_bits_of_the_whole_image() {
        // Two panels, a plot, and one whose pixels have random numbers.
        for name in [
            "figures/figure-5.toml",
            "figures/figure-2.toml",
            "smoke/cornell.toml",
        ] {
            let scene = small(name, [60, 44]);
            let (plans, sampling) = (plans(&scene), Sampling::of_samples(16));
            let whole = render(&plans, sampling, &|| ()).unwrap().film;
            let panels: Vec<usize> = scene.panels.iter().map(|panel| panel.width).collect();
            for every in [1, 2, 7] {
                let detail = Detail::Lattice(every);
                let lattice = render_coarse(&plans, sampling, detail, &|| false).unwrap();
                let expected = pixels_of(&whole, &panels, detail);
                assert_eq!(lattice.radiance(), expected.radiance(), "{name} {every}");
                assert_eq!(lattice.opacity(), expected.opacity(), "{name} {every}");
            }
            // A plot takes no time.
            if name != "figures/figure-2.toml" {
                let stopped = render_coarse(&plans, sampling, Detail::Lattice(2), &|| true);
                assert_eq!(stopped.err(), Some(RenderError::Stopped));
            }
        }
    }

    /// A search without a limit.
    fn unlimited(predictions: &Predictions) -> Search<'_> {
        Search {
            budget: None,
            predictions,
            interrupted: &|| false,
            progress: &|_| (),
        }
    }

    /// A prediction under a profile is not taken for one without.
    #[test]
    fn predictions_are_kept_by_conventions() {
        let scene = small("figures/figure-3.toml", [20, 20]);
        let profile = Profile::named("vtk").unwrap();
        let under = profile.applied_to(&scene).unwrap().unwrap();
        let predictions = Predictions::default();
        let search = unlimited(&predictions);
        let clock = SearchClock::start(&search, "", 1, 0);
        let of = |scene: &Scene| predicted(scene, scene, ("same", 0), (Detail::Whole, 1), &clock);
        let [first, second, again] = [&scene, &under, &scene].map(|scene| of(scene).unwrap());
        assert_ne!(first.radiance(), second.radiance());
        assert_eq!(first.radiance(), again.radiance());
    }

    /// One ray through a block of a scene without random numbers would be no mean of its pixels.
    #[test]
    fn a_change_that_leaves_no_random_numbers_is_seen_whole() {
        let scene = small("smoke/cornell.toml", [19, 21]);
        let mut edited = scene.clone();
        let Model::Radiative(radiative) = &mut edited.panels[0].model else {
            panic!("a radiative scene");
        };
        radiative.scattering = Scattering::None;
        let predictions = Predictions::default();
        let search = unlimited(&predictions);
        let clock = SearchClock::start(&search, "", 1, 0);
        let look = (blocks(&scene).unwrap(), 16);
        let film = |edited| predicted(&scene, edited, ("a change", 0), look, &clock).unwrap();
        assert_eq!(film(&edited).width(), 19);
        assert_eq!(film(&scene).width(), 2);
    }

    /// Blocks leave out what is left over at the edges, and are the means of their pixels.
    #[test]
    fn a_block_is_the_mean_of_its_pixels() {
        let scene = small("smoke/cornell.toml", [19, 21]);
        assert!(matches!(scene.panels[0].model, Model::Radiative(_)));
        let (plans, detail) = (plans(&scene), blocks(&scene).unwrap());
        let of = Sampling::of_samples;
        let whole = render(&plans, of(64), &|| ()).unwrap().film;
        let coarse = render_coarse(&plans, of(64 * 64), detail, &|| false).unwrap();
        assert_eq!((coarse.width(), coarse.height()), (2, 2));
        let [whole, coarse] = [Cells::of_blocks(&whole), Cells::of_pixels(&coarse)];
        // Twelve squares: their mean is 1 within five times √(2/12).
        let misfit = coarse.misfit(&whole, &whole);
        assert!(misfit.in_noise < 3.1, "{misfit:?}");
    }

    #[test]
    fn a_lattice_has_two_thousand_pixels_or_more() {
        assert_eq!(first_lattice(12 * 10), Detail::Whole);
        assert_eq!(first_lattice(4 * 2048 - 1), Detail::Whole);
        assert_eq!(first_lattice(256 * 192), Detail::Lattice(4));
        for [width, height] in [[256, 192], [400, 500], [100_000, 2], [8192, 1]] {
            let detail = first_lattice(width * height);
            let count = detail.columns(width).count() * detail.rows(height).count();
            assert!(count >= 1024, "{width} × {height}: {count}");
        }
    }
}
