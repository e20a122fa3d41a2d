//! Faults outside the catalogue of mistakes: a name is right, or there is none.
//!
//! Whoever is told the name of a mistake goes looking for it, so that a wrong name is worse than
//! none. Most of these [faults](faults::faults) are none of the catalogue, or a size of one that the
//! catalogue does not have; the truth stands beside each, and what is said is [judged](verdict::judge)
//! by it.

mod faults;
mod images;
mod verdict;

use crate::common::suite::{case_of, explained, film_with, suite, uninterrupted, validated};
use crate::needs::tries;
use faults::{Edit, Fault, Kind, faults};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::time::{Duration, Instant};
use verdict::{Judgement, Said, judge, table};
use volref::compare::stochastic::judge_at;
use volref::conventions::{CATALOGUE, under};
use volref::film::Film;
use volref::geometry::Camera;
use volref::judging::{CaseResult, Judged, Verdict};
use volref::math;
use volref::naming::{ConventionSearch, Predictions, Search, diagnosis};
use volref::scene::{Model, Scattering, Scene};
use volref::sensitivity::number;
use volref::suite::Case;
use volref::variations::mistakes;

fn given(variable: &str) -> Option<u32> {
    std::env::var(variable).ok()?.parse().ok()
}

/// The image of `scene` with the image plane moved, in pixels to the right and down, by an exact
/// half, whole or one and a half in one axis: the image with more rows or columns of the same size,
/// without those at one end.
fn with_more_pixels(scene: &Scene, [right, down]: [f64; 2]) -> Film {
    let mut scene = scene.clone();
    let more = [right, down].map(|shift| (2.0 * shift.abs()) as usize);
    let panel = &mut scene.panels[0];
    let [width, height] = [panel.width, panel.height];
    [panel.width, panel.height] = [width + more[0], height + more[1]];
    let taller = (height + more[1]) as f64 / height as f64;
    edit_camera(&mut panel.model, |camera| {
        let half = taller * math::tan(0.5 * camera.vertical_fov());
        camera.with_vertical_fov(2.0 * math::atan2(half, 1.0))
    });
    let film = rendered(&scene, 16);
    let first = [
        if right < 0.0 { more[0] } else { 0 },
        if down < 0.0 { more[1] } else { 0 },
    ];
    let of = |i: usize| first[0] + i % width + film.width() * (first[1] + i / width);
    let indices = || (0..width * height).map(of);
    let pixels = indices().map(|i| film.radiance()[i]).collect();
    match film.noise() {
        None => Film::new(width, height, pixels),
        Some(noise) => {
            let variance = indices().map(|i| noise.variance()[i]).collect();
            Film::with_noise(width, height, pixels, variance, noise.samples())
        }
    }
}

/// A shift by any part of a pixel, by a camera that is turned: to 0.1 pixels in the corners.
fn with_camera_turned(scene: &Scene, [right, down]: [f64; 2]) -> Film {
    let mut scene = scene.clone();
    let panel = &mut scene.panels[0];
    let pixel = 2.0 / panel.height as f64;
    edit_camera(&mut panel.model, |camera| {
        let centre =
            *camera.forward - camera.half_right * (right * pixel) + camera.half_up * (down * pixel);
        let [eye, up] = [camera.eye, *camera.upright];
        Camera::new(eye, eye + centre, up, camera.vertical_fov()).unwrap()
    });
    rendered(&scene, 16)
}

fn edit_camera(model: &mut Model, edit: impl Fn(&Camera) -> Camera) {
    match model {
        Model::Classified(scene) => scene.camera = edit(&scene.camera),
        Model::Radiative(scene) => scene.camera = edit(&scene.camera),
        Model::Curve(_) => panic!("a plot has no camera"),
    }
}

/// With random numbers of its own.
fn rendered(scene: &Scene, samples: u32) -> Film {
    film_with(scene, samples, 0x6f75_7473_6964_6500)
}

/// The scene with `fault`; `None` where a number or a mistake has no occasion.
fn faulty_scene(fault: &Fault, scene: &Scene) -> Option<Scene> {
    let mut scene = scene.clone();
    for edit in &fault.edits {
        match edit {
            Edit::Number(name, change) => {
                scene = number(&scene, name).unwrap().changed(&scene, *change)?;
            }
            Edit::Mistake(name) => {
                let mistake = mistakes::named(name).unwrap();
                if !mistake.is_of_the_image() {
                    scene = mistake.in_scene(&scene)?;
                }
            }
            Edit::Convention(words) => {
                let at = CATALOGUE.iter().position(|it| it.words == *words);
                scene = under(&scene, &[at.unwrap()]);
            }
            _ => {}
        }
        for panel in &mut scene.panels {
            match (edit, &mut panel.model) {
                (Edit::Classified(edit), Model::Classified(classified)) => edit(classified),
                (Edit::Radiative(edit), Model::Radiative(radiative)) => edit(radiative),
                _ => {}
            }
        }
    }
    Some(scene)
}

/// The image of `scene` with `fault`.
fn faulty(fault: &Fault, scene: &Scene, samples: u32) -> Option<Film> {
    let scene = faulty_scene(fault, scene)?;
    let plane = fault.edits.iter().find_map(|edit| match edit {
        Edit::ImagePlane(shift) => Some(*shift),
        _ => None,
    });
    let mut film = match plane {
        None => rendered(&scene, samples),
        Some(shift) if shift.iter().all(|x| (2.0 * x).fract() == 0.0) => {
            with_more_pixels(&scene, shift)
        }
        Some(shift) => with_camera_turned(&scene, shift),
    };
    for edit in &fault.edits {
        match edit {
            Edit::Film(edit) => film = edit(&film),
            Edit::Mistake(name) => {
                let mistake = mistakes::named(name).unwrap();
                if mistake.is_of_the_image() {
                    film = mistake.in_image(&film)?;
                }
            }
            _ => {}
        }
    }
    Some(film)
}

/// The verdict on the image with `fault`: as `validate` has it, conventions first, then names.
fn verdict(
    fault: &Fault,
    samples: u32,
    conventions: Option<f64>,
    search: &Search<'_>,
) -> Judgement {
    let case = case_of(fault.case);
    let scene = case.load_scene().unwrap();
    let film = faulty(fault, &scene, samples).expect("the case has occasion for it");
    if let Some(folder) = std::env::var_os("VOLREF_FAULTS_KEEP") {
        // For another version of the program.
        let folder = Path::new(&folder).join(fault.name.replace([' ', '/'], "_"));
        let path = folder.join(format!("{}.exr", case.name));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, film.to_exr().unwrap()).unwrap();
    }
    let mut judged = validated(case, film);
    if let Some(seconds) = conventions {
        let search = ConventionSearch::default();
        search.explain_mismatch(case, &suite().store(), &mut judged, seconds, false);
    }
    judge(fault, &scene, &explained(case, judged, search))
}

const EXTINCTION: &str =
    "extinction of the volume 10.0000 ± 0.0040 % too large: with this change the scene agrees";

/// Some of them (every run takes each second), with what is said of each: whether a name, whether a description, and part of a reason or of
/// what was measured. Pairs of mistakes, which take the most time, are not looked for.
const IN_EVERY_RUN: [(&str, Said, Option<Said>, &str); 7] = [
    ("samples clamped at 3", NO, None, ""),
    // Its interval is too narrow.
    ("field of view 39.8°", NO, None, "height of the image plane"),
    ("opacity + 10 %", NO, YES, EXTINCTION),
    (
        "diffuse 0.7, opacity + 10 %",
        NO,
        YES,
        "diffuse reflection 30.00 ± 0.10 % too small and extinction of the volume 10.000",
    ),
    ("clamped at 0.5", NO, None, ""),
    ("half a voxel along x", Said::Rightly, Some(NO), ""),
    // Black, or bright by 4π, leave as much as the image has.
    (
        "3 % of the brightness",
        NO,
        YES,
        "the image is the golden × 0.030",
    ),
];
const NO: Said = Said::Nothing;
const YES: Option<Said> = Some(Said::Rightly);

#[test]
fn a_name_is_right_or_there_is_none() {
    let predictions = Predictions::default();
    let search = uninterrupted(None, &predictions);
    let faults = faults();
    for (name, named, described, words) in IN_EVERY_RUN.into_iter().step_by(tries(5, 1)) {
        let fault = faults.iter().find(|fault| fault.name == name).unwrap();
        let judged = verdict(fault, 16, None, &search);
        assert!(judged.is_caught(), "{name}: {}", judged.text);
        assert_eq!(judged.named, named, "{name}: {}", judged.text);
        if let Some(described) = described {
            assert_eq!(judged.described, described, "{name}: {}", judged.text);
        }
        assert!(judged.text.contains(words), "{name}: {}", judged.text);
    }
}

#[test]
fn there_are_faults_enough_and_each_is_its_own() {
    let faults = faults();
    let names: BTreeSet<(&str, &str)> = faults.iter().map(|f| (f.case, &*f.name)).collect();
    assert_eq!(names.len(), faults.len());
    assert!(faults.len() >= 250, "{}", faults.len());
    let mut scenes = BTreeMap::new();
    for fault in &faults {
        for part in fault.truth.iter().flat_map(|part| part.split(" + ")) {
            let is_mistake = part.contains('-') && !part.contains(' ');
            assert!(
                !is_mistake || mistakes::named(part).is_some(),
                "{part} is no mistake"
            );
        }
        let case = case_of(fault.case);
        let scene = scenes.entry(fault.case);
        let scene = scene.or_insert_with(|| case.load_scene().unwrap());
        let is_possible = faulty_scene(fault, scene).is_some();
        assert!(is_possible, "{}: {}", fault.case, fault.name);
    }
}

/// A search that is cut off gets as far whether predictions have to be rendered or are kept.
#[test]
fn a_limit_of_a_search_counts_work_and_not_time() {
    let case = case_of("smoke/cornell");
    let mut scene = case.load_scene().unwrap();
    if let Model::Radiative(radiative) = &mut scene.panels[0].model {
        radiative.scattering = Scattering::Multiple(Some(2));
    }
    let found = || {
        let mut judged = [validated(case, rendered(&scene, 4))];
        let predictions = Predictions::default();
        let search = uninterrupted(Some(Duration::from_millis(300)), &predictions);
        let found = diagnosis(&[case], None, &mut judged, &search);
        let [judged] = judged;
        let (looks_like, difference) = (judged.result.looks_like, judged.result.difference);
        (found.unfinished, found.likely, looks_like, difference)
    };
    let first = found();
    let unfinished = &first.0;
    assert!(
        unfinished.first().is_some_and(|step| step.done > 20),
        "{unfinished:?}"
    );
    assert_eq!(found(), first);
}

/// One table for all faults, or for those of which the name, the case or the kind contains a word of
/// `VOLREF_FAULTS`; `scripts/verdicts.sh` runs it.
#[test]
#[ignore = "an hour: scripts/verdicts.sh runs it"]
fn names_of_faults_outside_the_catalogue() {
    let predictions = Predictions::default();
    let seconds = f64::from(given("VOLREF_EXPLAIN").unwrap_or(10));
    let search = uninterrupted(Some(Duration::from_secs_f64(seconds)), &predictions);
    let wanted = std::env::var("VOLREF_FAULTS").unwrap_or_default();
    let is_wanted = |fault: &Fault| {
        let texts = [&*fault.name, fault.case, &format!("{:?}", fault.kind)].join("\n");
        wanted.split(',').any(|word| texts.contains(word))
    };
    let wanted: Vec<Fault> = faults().into_iter().filter(is_wanted).collect();
    let judge = |fault: &Fault| {
        let samples = given("VOLREF_FAULT_SAMPLES").unwrap_or(fault.samples);
        let begun = Instant::now();
        let judgement = verdict(fault, samples, Some(seconds), &search);
        println!(
            "{:<26} {:<44} {samples:>2} {:>4.0} s  {}\n        {}",
            fault.case,
            fault.name,
            begun.elapsed().as_secs_f64(),
            judgement.in_words(),
            judgement.text
        );
        (fault.kind, judgement)
    };
    let judged: Vec<(Kind, Judgement)> = wanted.par_iter().with_max_len(1).map(judge).collect();
    println!("\n{}", table(&judged));
    let wrong = |it: &&(Kind, Judgement)| it.1.named == Said::Wrongly;
    let wrong = judged.iter().filter(wrong).count();
    let caught = judged.iter().filter(|it| it.1.is_caught()).count();
    assert!(
        50 * wrong <= caught,
        "{wrong} wrong names in {caught} rejected images"
    );
}

/// Smallest share of the failed images with one mistake of the catalogue of which the first name is that mistake.
const NAMED_FIRST: f64 = 0.95;

/// Level at which the image of a name is said to be another than that of the mistake which was made.
const ANOTHER_IMAGE: f64 = 1e-3;

/// Samples per pixel of that comparison.
const CLOSELY: u32 = 1024;

/// Each mistake of the catalogue that fails in these cases, with four seeds and two numbers of samples: its name
/// comes first, or that of a mistake with the same image. `VOLREF_FAULTS` picks mistakes and cases by words of
/// their names, `VOLREF_SEEDS` takes fewer or more seeds.
#[test]
#[ignore = "hours: scripts/nightly.sh runs it"]
fn mistakes_of_the_catalogue_are_named_first() {
    let predictions = Predictions::default();
    let search = uninterrupted(Some(Duration::from_secs(10)), &predictions);
    let wanted = std::env::var("VOLREF_FAULTS").unwrap_or_default();
    let seeds = u64::from(given("VOLREF_SEEDS").unwrap_or(4));
    let (mut named_in_all, mut failed_in_all) = (0, 0);
    println!(
        "| case | samples | mistakes | images that fail | named first |\n|{}",
        " --- |".repeat(5)
    );
    for case in ["smoke/cornell", "fog/rate-0.1", "fog/spotlight"] {
        let is_wanted = |name: &str| {
            wanted
                .split(',')
                .any(|word| case.contains(word) || name.contains(word))
        };
        let tried: Vec<&str> = mistakes::catalogue()
            .filter(|mistake| !mistake.is_of_opacity() && is_wanted(mistake.name))
            .map(|mistake| mistake.name)
            .collect();
        for samples in [16, 64] {
            let trials = tried
                .iter()
                .flat_map(|name| (1..=seeds).map(|seed| (*name, seed)));
            let trials: Vec<(&str, u64)> = trials.collect();
            let trial = |&(name, seed): &(&'static str, u64)| {
                let result = result_of_mistake(case, name, (samples, seed), &search)?;
                let first = result.looks_like.first().cloned().unwrap_or_default();
                let is_first = first == name || !first.is_empty() && same_image(case, &first, name);
                if !is_first {
                    let said = [&[result.reason], &result.difference[..]]
                        .concat()
                        .join("\n        ");
                    println!("{case} {samples:>2} {name} seed {seed}: {first:?}; {said}");
                }
                Some((name, is_first))
            };
            let failed = trials.par_iter().with_max_len(1).filter_map(trial);
            let failed: Vec<(&str, bool)> = failed.collect();
            let of: BTreeSet<&str> = failed.iter().map(|(name, _)| *name).collect();
            let named = failed.iter().filter(|(_, is_first)| *is_first).count();
            println!(
                "| `{case}` | {samples} | {} | {} | {named} |",
                of.len(),
                failed.len()
            );
            named_in_all += named;
            failed_in_all += failed.len();
        }
    }
    let is_enough = named_in_all as f64 >= NAMED_FIRST * failed_in_all as f64;
    assert!(is_enough, "{named_in_all} of {failed_in_all}");
}

/// Filters hide in blocks and noise that neighbours share; a shift by a pixel and one of two mistakes with nearly the same
/// image take the noise's measure of what is left.
#[test]
#[ignore = "a minute: scripts/nightly.sh"]
fn mistakes_that_noise_hides_are_named() {
    let predictions = Predictions::default();
    let search = uninterrupted(Some(Duration::from_secs(10)), &predictions);
    let hidden = ["half-resolution", "one-pixel-left", "lights-counted-twice"];
    hidden.par_iter().for_each(|name| {
        let result = result_of_mistake("smoke/cornell", name, (16, 1), &search).unwrap();
        let first = result.looks_like.first().map(String::as_str);
        assert_eq!(
            first,
            Some(*name),
            "{:?}; {}",
            result.looks_like,
            result.reason
        );
    });
}

/// The verdict on an image with a mistake, if it fails.
fn result_of_mistake(
    case: &str,
    name: &'static str,
    (samples, seed): (u32, u64),
    search: &Search<'_>,
) -> Option<CaseResult> {
    let case = case_of(case);
    let film = with_mistake(&case.load_scene().unwrap(), name, samples, seed)?;
    let judged = validated(case, film);
    (judged.result.verdict == Verdict::Fail).then(|| explained(case, judged, search))
}

/// The image of `scene` with the mistake of that name; `None` where it has no occasion.
fn with_mistake(scene: &Scene, name: &str, samples: u32, seed: u64) -> Option<Film> {
    let mistake = mistakes::named(name)?;
    if mistake.is_of_the_image() {
        mistake.in_image(&film_with(scene, samples, seed))
    } else {
        Some(film_with(&mistake.in_scene(scene)?, samples, seed))
    }
}

/// True if images with the two mistakes agree as far as many samples tell.
fn same_image(case: &str, one: &str, other: &str) -> bool {
    let scene = case_of(case).load_scene().unwrap();
    let images =
        [(one, 11), (other, 12)].map(|(name, seed)| with_mistake(&scene, name, CLOSELY, seed));
    let [Some(one), Some(other)] = images else {
        return false;
    };
    judge_at(&one, &other, ANOTHER_IMAGE).is_ok_and(|judgement| judgement.passed)
}

/// The verdict on 64 samples of a case with that number changed.
fn judged_with_number(case: &Case, name: &str, change: f64) -> Judged {
    let right = case.load_scene().unwrap();
    let changed = number(&right, name).unwrap().changed(&right, change);
    validated(case, rendered(&changed.unwrap(), 64))
}

/// A change of 10 % of what absorbs alone is far outside the range of derivatives, and one of 5 % at its
/// edge: neither is taken for another number, or for two.
#[test]
fn numbers_far_off_are_told_in_noise() {
    let case = case_of("fog/absorption");
    let little = judged_with_number(case, "density", -0.05).result;
    let named = little.changes.iter().filter(|change| change.fits_best);
    let named: Vec<&str> = named.map(|change| change.name.as_str()).collect();
    assert_eq!(named, ["density"], "{}", little.reason);
    let change = &little.changes[0];
    let off = (change.change + 0.05).abs();
    assert!(off < 4.0 * change.error, "{change:?}");

    let much = judged_with_number(case, "density", 0.1).result;
    let reason = &much.reason;
    assert!(reason.contains("is too large for derivatives"), "{reason}");
}

/// Changes far beyond the derivatives, in images with edges: the scene agrees with the image.
#[test]
#[ignore = "minutes: scripts/nightly.sh runs it"]
fn far_changes_agree() {
    let predictions = Predictions::default();
    let search = uninterrupted(None, &predictions);
    for (case, name, change) in [
        ("smoke/cornell", "camera.down", 2.0),
        ("smoke/cornell", "camera.down", -1.3),
        ("smoke/cornell", "camera.view", 0.02724),
        ("fog/forward", "reflectance", -0.3),
        ("fog/absorption", "density", 0.1),
    ] {
        let case = case_of(case);
        let judged = judged_with_number(case, name, change);
        let said = explained(case, judged, &search).difference.join("; ");
        println!("{name} {change}: {said}");
        assert!(
            name == "reflectance" || !said.contains("reflectance"),
            "{said}"
        );
        assert!(said.contains("scene agrees with the image"), "{said}");
    }
}
