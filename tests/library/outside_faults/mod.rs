//! Faults outside the catalogue of mistakes: a name is right, or there is none.
//!
//! Whoever is told the name of a mistake goes looking for it, so that a wrong name is worse than
//! none. Most of these [faults](faults::faults) are none of the catalogue, or a size of one that the
//! catalogue does not have; the truth stands beside each, and what is said is [judged](verdict::judge)
//! by it.

mod faults;
mod images;
mod tables;
mod verdict;

use faults::{Edit, Fault, Kind, faults};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::{Duration, Instant};
use verdict::{Judgement, Said, judge, table};
use volref::compare::Picture;
use volref::compare::stochastic::judge_at;
use volref::conventions::{CATALOGUE, under};
use volref::film::Film;
use volref::geometry::Camera;
use volref::judging::{CaseResult, Judged, Verdict, validate};
use volref::math;
use volref::naming::{ConventionSearch, Predictions, Search, likeness};
use volref::render::{Sampling, Seed, plans, render};
use volref::scene::{Model, Scattering, Scene};
use volref::sensitivity::{number, numbers};
use volref::suite::{Output, Suite};
use volref::variations::mistakes;

/// The image of `scene` with the image plane moved, in pixels to the right and down, by an exact
/// half, whole or one and a half in one axis: the image with more rows or columns of the same size,
/// without those at one end.
fn with_more_pixels(scene: &Scene, [right, down]: [f64; 2], samples: u32) -> Film {
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
    let film = rendered(&scene, samples);
    let first = [
        if right < 0.0 { more[0] } else { 0 },
        if down < 0.0 { more[1] } else { 0 },
    ];
    let of = |i: usize| first[0] + i % width + film.width() * (first[1] + i / width);
    let pixels = (0..width * height)
        .map(|i| film.radiance()[of(i)])
        .collect();
    match film.noise() {
        None => Film::new(width, height, pixels),
        Some(noise) => {
            let variance = (0..width * height)
                .map(|i| noise.variance()[of(i)])
                .collect();
            Film::with_noise(width, height, pixels, variance, noise.samples())
        }
    }
}

/// A shift by any part of a pixel, by a camera that is turned: to 0.1 pixels in the corners.
fn with_camera_turned(scene: &Scene, [right, down]: [f64; 2], samples: u32) -> Film {
    let mut scene = scene.clone();
    let panel = &mut scene.panels[0];
    let pixel = 2.0 / panel.height as f64;
    edit_camera(&mut panel.model, |camera| {
        let centre = *camera.forward() - camera.half_right() * (right * pixel)
            + camera.half_up() * (down * pixel);
        let [eye, up] = [camera.eye(), *camera.upright()];
        Camera::new(eye, eye + centre, up, camera.vertical_fov()).unwrap()
    });
    rendered(&scene, samples)
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
    let sampling = Sampling {
        samples: Some(samples),
        seed: Seed::Given(0x6f75_7473_6964_6500),
    };
    render(&plans(scene), sampling, &|| ()).unwrap().film
}

/// The image of `scene` with `fault`; `None` where a number or a mistake has no occasion.
fn faulty(fault: &Fault, scene: &Scene, samples: u32) -> Option<Film> {
    let mut scene = scene.clone();
    let mut plane = None;
    for edit in &fault.edits {
        match *edit {
            Edit::Classified(edit) => {
                for panel in &mut scene.panels {
                    if let Model::Classified(classified) = &mut panel.model {
                        edit(classified);
                    }
                }
            }
            Edit::Radiative(edit) => {
                for panel in &mut scene.panels {
                    if let Model::Radiative(radiative) = &mut panel.model {
                        edit(radiative);
                    }
                }
            }
            Edit::Number(name, change) => {
                scene = number(&scene, name).unwrap().changed(&scene, change)?;
            }
            Edit::Mistake(name) => {
                let mistake = mistakes::named(name).unwrap();
                if !mistake.is_of_the_image() {
                    scene = mistake.in_scene(&scene)?;
                }
            }
            Edit::Convention(words) => {
                let at = CATALOGUE.iter().position(|it| it.words == words).unwrap();
                scene = under(&scene, &[at]);
            }
            Edit::ImagePlane(shift) => plane = Some(shift),
            Edit::Film(_) => {}
        }
    }
    let mut film = match plane {
        None => rendered(&scene, samples),
        Some(shift) if shift.iter().all(|x| (2.0 * x).fract() == 0.0) => {
            with_more_pixels(&scene, shift, samples)
        }
        Some(shift) => with_camera_turned(&scene, shift, samples),
    };
    for edit in &fault.edits {
        match *edit {
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
    suite: &Suite,
    samples: u32,
    conventions: Option<f64>,
    search: &Search<'_>,
) -> Judgement {
    let case = suite.select(&[fault.case.to_owned()]).unwrap()[0];
    let scene = case.load_scene().unwrap();
    let film = faulty(fault, &scene, samples).expect("the case has occasion for it");
    if let Some(folder) = std::env::var_os("VOLREF_FAULTS_KEEP") {
        // For another version of the program.
        let folder = Path::new(&folder).join(fault.name.replace([' ', '/'], "_"));
        let path = folder.join(format!("{}.exr", case.name));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, film.to_exr().unwrap()).unwrap();
    }
    let output = Output::Picture(Box::new(Picture::Radiance(film)));
    let mut judged: Vec<Judged> = vec![validate(case, &suite.store(), output, None)];
    if let Some(seconds) = conventions {
        ConventionSearch::default().explain_mismatch(
            case,
            &suite.store(),
            &mut judged[0],
            seconds,
            false,
        );
    }
    likeness(&[case], &[], None, &mut judged, search);
    judge(fault, &scene, &judged[0].result)
}

/// Some of them, with what is said of each: part of a reason, or of what was measured. Pairs of
/// mistakes, which take the most time, are not looked for.
const IN_EVERY_RUN: [(&str, Said, Option<Said>, &str); 7] = [
    (
        "samples clamped at 3",
        Said::Nothing,
        Some(Said::Rightly),
        "no value is above 3, where",
    ),
    (
        "field of view 39.8°",
        Said::Nothing,
        // Its interval is too narrow.
        None,
        "(a field of view of 39.79 degrees)",
    ),
    (
        "opacity + 10 %",
        Said::Nothing,
        Some(Said::Rightly),
        "extinction of the volume 10.0000 ± 0.0040 % too large: with this change the scene agrees",
    ),
    (
        "diffuse 0.7, opacity + 10 %",
        Said::Nothing,
        Some(Said::Rightly),
        "diffuse reflection 30.00 ± 0.10 % too small and extinction of the volume 10.000",
    ),
    (
        "clamped at 0.5",
        Said::Nothing,
        Some(Said::Rightly),
        "no value is above 0.5",
    ),
    (
        "half a voxel along x",
        Said::Rightly,
        Some(Said::Nothing),
        "",
    ),
    // Black, or bright by 4π, leave as much as the image has.
    (
        "3 % of the brightness",
        Said::Nothing,
        Some(Said::Rightly),
        "the image is the golden × 0.030",
    ),
];

#[test]
fn a_name_is_right_or_there_is_none() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let predictions = Predictions::default();
    let faults = faults();
    for (name, named, described, words) in IN_EVERY_RUN {
        let search = Search {
            budget: None,
            predictions: &predictions,
            interrupted: &|| false,
            progress: &|_| (),
        };
        let fault = faults.iter().find(|fault| fault.name == name).unwrap();
        let judged = verdict(fault, &suite, 16, None, &search);
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
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    for fault in &faults {
        let truth = &fault.truth;
        for name in truth.names.iter().flat_map(|names| names.split(" + ")) {
            assert!(mistakes::named(name).is_some(), "{name} is no mistake");
        }
        let case = suite.select(&[fault.case.to_owned()]).unwrap()[0];
        let scene = case.load_scene().unwrap();
        for edit in &fault.edits {
            let is_possible = match *edit {
                Edit::Number(name, change) => number(&scene, name)
                    .unwrap_or_else(|error| panic!("{}: {error}", fault.case))
                    .changed(&scene, change)
                    .is_some(),
                Edit::Mistake(name) => {
                    let mistake = mistakes::named(name).unwrap_or_else(|| panic!("{name}"));
                    mistake.is_of_the_image() || mistake.in_scene(&scene).is_some()
                }
                Edit::Convention(words) => CATALOGUE.iter().any(|it| it.words == words),
                _ => true,
            };
            assert!(is_possible, "{}: {}", fault.case, fault.name);
        }
    }
}

/// A search that is cut off gets as far whether predictions have to be rendered or are kept.
#[test]
fn a_limit_of_a_search_counts_work_and_not_time() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let case = suite.select(&["smoke/cornell".to_owned()]).unwrap()[0];
    let mut scene = case.load_scene().unwrap();
    for panel in &mut scene.panels {
        if let Model::Radiative(radiative) = &mut panel.model {
            radiative.scattering = Scattering::Multiple(Some(2));
        }
    }
    let output = || Output::Picture(Box::new(Picture::Radiance(rendered(&scene, 4))));
    let found = || {
        let mut judged = [validate(case, &suite.store(), output(), None)];
        let predictions = Predictions::default();
        let search = uninterrupted(Duration::from_millis(300), &predictions);
        let found = likeness(&[case], &[], None, &mut judged, &search);
        let [judged] = judged;
        (found, judged.result.looks_like, judged.result.difference)
    };
    let first = found();
    let done = first.0.unfinished.first().map(|step| step.done);
    assert!(
        done.is_some_and(|done| done > 20),
        "{:?}",
        first.0.unfinished
    );
    assert_eq!(found(), first);
}

/// One table for all faults, or for those of which the name, the case or the kind contains a word of
/// `VOLREF_FAULTS`; `scripts/verdicts.sh` runs it.
#[test]
#[ignore = "an hour: scripts/verdicts.sh runs it"]
fn names_of_faults_outside_the_catalogue() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let predictions = Predictions::default();
    let seconds = f64::from(given("VOLREF_EXPLAIN").unwrap_or(10));
    let search = uninterrupted(Duration::from_secs_f64(seconds), &predictions);
    let wanted = std::env::var("VOLREF_FAULTS").unwrap_or_default();
    let is_wanted = |fault: &Fault| {
        let kind = Kind::ALL.iter().find(|(kind, _)| *kind == fault.kind);
        let texts = [
            &*fault.name,
            fault.case,
            kind.map_or("", |(_, words)| words),
        ];
        let mut words = wanted.split(',');
        wanted.is_empty() || words.any(|word| texts.iter().any(|text| text.contains(word)))
    };
    let wanted: Vec<Fault> = faults().into_iter().filter(is_wanted).collect();
    let judge = |fault: &Fault| {
        let samples = given("VOLREF_FAULT_SAMPLES").unwrap_or(fault.samples);
        let begun = Instant::now();
        let judgement = verdict(fault, &suite, samples, Some(seconds), &search);
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
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let predictions = Predictions::default();
    let search = uninterrupted(Duration::from_secs(10), &predictions);
    let wanted = std::env::var("VOLREF_FAULTS").unwrap_or_default();
    let seeds = u64::from(given("VOLREF_SEEDS").unwrap_or(4));
    let (mut named_in_all, mut failed_in_all) = (0, 0);
    println!(
        "| case | samples | mistakes | images that fail | named first | not |\n| --- | --- | --- | --- | --- | --- |"
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
            let trials: Vec<(&str, u64)> = tried
                .iter()
                .flat_map(|name| (1..=seeds).map(|seed| (*name, seed)))
                .collect();
            let trial = |&(name, seed): &(&'static str, u64)| {
                let result = result_of_mistake(&suite, case, name, (samples, seed), &search)?;
                let first = result.looks_like.first().cloned().unwrap_or_default();
                let is_first =
                    first == name || !first.is_empty() && same_image(&suite, case, &first, name);
                if !is_first {
                    let difference = result.difference.join("; ");
                    println!(
                        "{case} {samples:>2} {name} seed {seed}: {first:?}; {}\n        {difference}",
                        result.reason
                    );
                }
                Some((name, is_first))
            };
            let failed: Vec<(&str, bool)> = trials
                .par_iter()
                .with_max_len(1)
                .filter_map(trial)
                .collect();
            let of: BTreeSet<&str> = failed.iter().map(|(name, _)| *name).collect();
            let named = failed.iter().filter(|(_, is_first)| *is_first).count();
            println!(
                "| `{case}` | {samples} | {} | {} | {named} | {} |",
                of.len(),
                failed.len(),
                failed.len() - named
            );
            named_in_all += named;
            failed_in_all += failed.len();
        }
    }
    assert!(
        named_in_all as f64 >= NAMED_FIRST * failed_in_all as f64,
        "{named_in_all} of {failed_in_all}"
    );
}

/// Filters hide in blocks and noise that neighbours share; a shift by a pixel and one of two mistakes with nearly the same
/// image take the noise's measure of what is left.
#[test]
fn mistakes_that_noise_hides_are_named() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let predictions = Predictions::default();
    let search = uninterrupted(Duration::from_secs(10), &predictions);
    let hidden = ["half-resolution", "one-pixel-left", "lights-counted-twice"];
    hidden.par_iter().for_each(|name| {
        let result = result_of_mistake(&suite, "smoke/cornell", name, (16, 1), &search).unwrap();
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
    suite: &Suite,
    case: &str,
    name: &'static str,
    (samples, seed): (u32, u64),
    search: &Search<'_>,
) -> Option<CaseResult> {
    let case = suite.select(&[case.to_owned()]).unwrap()[0];
    let film = with_mistake(&case.load_scene().unwrap(), name, samples, seed)?;
    let output = Output::Picture(Box::new(Picture::Radiance(film)));
    let mut judged = vec![validate(case, &suite.store(), output, None)];
    let has_failed = judged[0].result.verdict == Verdict::Fail;
    has_failed.then(|| likeness(&[case], &[], None, &mut judged, search));
    has_failed.then(|| judged.remove(0).result)
}

/// The image of `scene` with the mistake of that name; `None` where it has no occasion.
fn with_mistake(scene: &Scene, name: &str, samples: u32, seed: u64) -> Option<Film> {
    let mistake = mistakes::named(name)?;
    let sampling = Sampling {
        samples: Some(samples),
        seed: Seed::Given(seed),
    };
    let render_it = |scene: &Scene| Some(render(&plans(scene), sampling, &|| ()).ok()?.film);
    if mistake.is_of_the_image() {
        mistake.in_image(&render_it(scene)?)
    } else {
        render_it(&mistake.in_scene(scene)?)
    }
}

/// True if images with the two mistakes agree as far as many samples tell.
fn same_image(suite: &Suite, case: &str, one: &str, other: &str) -> bool {
    let scene = suite.select(&[case.to_owned()]).unwrap()[0]
        .load_scene()
        .unwrap();
    let images =
        [(one, 11), (other, 12)].map(|(name, seed)| with_mistake(&scene, name, CLOSELY, seed));
    let [Some(one), Some(other)] = images else {
        return false;
    };
    judge_at(&one, &other, ANOTHER_IMAGE).is_ok_and(|judgement| judgement.passed)
}

/// A search with this much work that nobody ends.
fn uninterrupted(work: Duration, predictions: &Predictions) -> Search<'_> {
    Search {
        budget: Some(work),
        predictions,
        interrupted: &|| false,
        progress: &|_| (),
    }
}

fn given(variable: &str) -> Option<u32> {
    std::env::var(variable).ok()?.parse().ok()
}

/// A change of 10 % of what absorbs alone is far outside the range of derivatives, and one of 5 % at its
/// edge: neither is taken for another number, or for two.
#[test]
fn numbers_far_off_are_told_in_noise() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let predictions = Predictions::default();
    let search = Search {
        budget: None,
        predictions: &predictions,
        interrupted: &|| false,
        progress: &|_| (),
    };
    let case = suite.select(&["fog/absorption".to_owned()]).unwrap()[0];
    let right = case.load_scene().unwrap();
    let numbers = numbers(&right);
    let density = numbers.iter().find(|it| it.name() == "density").unwrap();
    let judged = |change: f64| {
        let film = rendered(&density.changed(&right, change).unwrap(), 64);
        let output = Output::Picture(Box::new(Picture::Radiance(film)));
        validate(case, &suite.store(), output, None)
    };
    let little = judged(-0.05).result;
    let named = little.changes.iter().filter(|change| change.fits_best);
    let named: Vec<&str> = named.map(|change| change.name.as_str()).collect();
    assert_eq!(named, ["density"], "{}", little.reason);
    let change = &little.changes[0];
    assert!(
        (change.change + 0.05).abs() < 4.0 * change.error,
        "{change:?}"
    );

    let mut much = [judged(0.1)];
    let reason = &much[0].result.reason;
    assert!(reason.contains("is too large for derivatives"), "{reason}");
    likeness(&[case], &[], None, &mut much, &search);
    let said = &much[0].result.difference;
    assert!(
        said[0].starts_with("density ") && said[0].contains("scene agrees with the image"),
        "{said:?}"
    );
    let size = said[0].split(' ').find_map(|word| word.parse::<f64>().ok());
    assert!((size.unwrap() - 10.0).abs() < 0.5, "{said:?}");
    assert!(
        said.iter().all(|said| !said.contains("reflectance")),
        "{said:?}"
    );
}

/// Size and standard error of the number that is called `words`, where `sentence` states them.
fn interval(sentence: &str, words: &str) -> Option<[f64; 2]> {
    let rest = sentence.split(words).nth(1)?;
    let (size, error) = rest.split_once(" ± ")?;
    let number = |word: &str| word.trim_start_matches(['+', '−', ' ']).parse::<f64>().ok();
    // Another number has the interval where the size is none.
    let size = number(size.trim().trim_start_matches("off by "))?;
    Some([size, number(error.split(' ').next()?)?])
}

/// Changes far beyond the derivatives, in images with edges: an interval holds the truth, or there is
/// none, and the scene agrees with the image.
#[test]
#[ignore = "minutes: scripts/nightly.sh runs it"]
fn intervals_of_far_changes_hold_the_truth() {
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap();
    let predictions = Predictions::default();
    let mut stated = 0;
    for (case, name, change, unit) in [
        ("smoke/cornell", "camera.down", 2.0, 1.0),
        ("smoke/cornell", "camera.down", -1.3, 1.0),
        ("smoke/cornell", "camera.view", 0.02724, 100.0),
        ("fog/forward", "reflectance", -0.3, 100.0),
        ("fog/absorption", "density", 0.1, 100.0),
    ] {
        let search = Search {
            budget: None,
            predictions: &predictions,
            interrupted: &|| false,
            progress: &|_| (),
        };
        let case = suite.select(&[case.to_owned()]).unwrap()[0];
        let right = case.load_scene().unwrap();
        let numbers = numbers(&right);
        let number = numbers.iter().find(|it| it.name() == name).unwrap();
        let film = rendered(&number.changed(&right, change).unwrap(), 64);
        let output = Output::Picture(Box::new(Picture::Radiance(film)));
        let mut judged = [validate(case, &suite.store(), output, None)];
        likeness(&[case], &[], None, &mut judged, &search);
        let said = judged[0].result.difference.join("; ");
        println!("{name} {change}: {said}");
        assert!(said.contains("scene agrees with the image"), "{said}");
        if let Some([size, error]) = interval(&said, &number.words()) {
            stated += 1;
            let pull = (size - unit * change.abs()) / error;
            assert!(pull.abs() < 4.0, "{name} {change}: {said}");
        }
    }
    assert!(stated >= 2, "{stated} intervals");
}
