//! Sentences on failing images that nobody has a ready name for.

use crate::common::suite::{case_of as case, film_with, output_of};
use glam::DVec3;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use volref::compare::Picture;
use volref::film::Film;
use volref::judging::{CaseResult, Judged, Verdict, validate};
use volref::math::powu;
use volref::naming::{Predictions, Search, Stage, diagnosis};
use volref::scene::{Classified, Scene};
use volref::suite::{Case, Output};
use volref::variations::mistakes;
use volref::volume::{Grid, Interpolation, Lattice};

/// The result of `case` with `output`, which fails, and the number of predictions that were rendered;
/// `go_on` is asked before each step of the search.
fn searched(
    case: &Case,
    output: Output,
    go_on: impl Fn(Stage, usize) -> bool + Sync,
) -> (CaseResult, usize) {
    let suite = crate::common::suite::suite();
    let predictions = Predictions::default();
    let is_over = AtomicBool::new(!go_on(Stage::Singles, 0));
    let search = Search {
        budget: None,
        predictions: &predictions,
        interrupted: &|| is_over.load(Ordering::Relaxed),
        progress: &|step| {
            is_over.fetch_or(!go_on(step.stage, step.done), Ordering::Relaxed);
        },
    };
    let mut judged: Vec<Judged> = vec![validate(case, &suite.store(), output, None)];
    let reason = &judged[0].result.reason;
    assert_eq!(judged[0].result.verdict, Verdict::Fail, "{reason}");
    diagnosis(&[case], None, &mut judged, &search);
    (judged.remove(0).result, predictions.count())
}

fn result_of(
    case: &Case,
    output: Output,
    go_on: impl Fn(Stage, usize) -> bool + Sync,
) -> CaseResult {
    searched(case, output, go_on).0
}

/// The image of `scene`, by random numbers of its own where it is sampled.
fn image(scene: &Scene, samples: u32) -> Film {
    film_with(scene, samples, 0x776f_7264_7300)
}

/// Nearest nodes of a grid that lies half a voxel further along every axis, or back.
fn nearest_and_half_a_voxel(volume: &mut Classified, voxels: f64) {
    let old = *volume.grid.lattice();
    let first = old.first() + old.spacing() * DVec3::splat(voxels);
    let lattice = Lattice::new(old.nodes(), old.spacing(), first).unwrap();
    let lattice = lattice.with_centring(old.centring()).unwrap();
    volume.grid = Arc::new(Grid::new(lattice, volume.grid.values().to_vec()).unwrap());
    volume.interpolation = Interpolation::Nearest;
}

/// Found before the long search for pairs; nearest nodes alone, or half a voxel alone, are no pair.
#[test]
fn nearest_nodes_half_a_voxel_off_are_named() {
    let pair = |half| format!("nearest-for-trilinear + volume-half-voxel-{half}");
    for (name, images, voxels) in [
        ("sampled/trilinear-blocks", 1, 0.5),
        ("sampled/trilinear-blocks", 1, -0.5),
        ("limit/plume", 3, -0.5),
        ("figures/figure-3", 1, 0.5),
    ] {
        let case = case(name);
        let images = (0..images).map(|halvings| {
            let scene = case.load_scene().unwrap().with_volumes(|volume| {
                volume.step *= powu(0.5, halvings as u32);
                volume.sample();
                nearest_and_half_a_voxel(volume, voxels);
            });
            image(&scene, 1)
        });
        let images: Vec<Film> = images.collect();
        let output = match &images[..] {
            [only] => output_of(only.clone()),
            several => Output::Refined(several.iter().cloned().map(Picture::Radiance).collect()),
        };
        let found = result_of(case, output, |stage, _| stage == Stage::Singles);
        let half = if voxels > 0.0 { "off" } else { "back" };
        assert_eq!(found.looks_like, [pair(half)], "{name}: {}", found.reason);
    }
    let case = case("sampled/trilinear-blocks");
    let scene = case.load_scene().unwrap();
    for name in ["nearest-for-trilinear", "volume-half-voxel-off"] {
        let scene = mistakes::named(name).unwrap().in_scene(&scene).unwrap();
        let found = result_of(case, output_of(image(&scene, 1)), |stage, _| {
            stage == Stage::Singles
        });
        assert_eq!(found.looks_like, [name]);
    }
}

/// Mistakes are tried before a number that is far off is fitted, which took all the time; and what the
/// verdict says of it is no cause.
#[test]
fn a_number_far_off_is_no_cause_before_mistakes_are_tried() {
    let case = case("fog/isotropic");
    let scene = case.load_scene().unwrap();
    let single = mistakes::named("single-scattering").unwrap();
    let far = image(&single.in_scene(&scene).unwrap(), 8);
    let as_if = "is too large for derivatives to tell if a number is off";
    let (found, rendered) = searched(case, output_of(far.clone()), |_, tried| tried < 1);
    assert!(found.reason.contains(as_if), "{}", found.reason);
    // The first mistakes, of the image, take no rendering; a fit begins with one.
    assert_eq!(rendered, 0, "{:?}", found.difference);
    let (found, rendered) = searched(case, output_of(far.clone()), |stage, _| {
        stage == Stage::Singles
    });
    assert!(rendered > 0);
    assert_eq!(
        found.looks_like,
        ["single-scattering"],
        "{:?}",
        found.difference
    );
}
