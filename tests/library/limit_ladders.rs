//! Images with smaller and smaller steps in the family `limit`: rules of first order pass, conventions
//! are found and judged, and images that do not converge are told what they do.

use crate::common::simulated::edited;
use crate::common::suite::{case_of, film_of as rendered, silent, suite, validated};
use volref::compare::Picture;
use volref::conventions::Profile;
use volref::film::Film;
use volref::judging::{Judged, Verdict, validate};
use volref::naming::ConventionSearch;
use volref::scene::{Conventions, LastStep, Scene};
use volref::suite::{Case, Output};

/// Images of `scene` under conventions, with its step, half of it and a quarter.
fn ladder(scene: &Scene, edit: impl Fn(&mut Conventions)) -> Vec<Film> {
    let image = |share: f64| {
        let scene = scene.with_volumes(|volume| {
            volume.sample();
            volume.step *= share;
            edit(&mut volume.conventions);
        });
        rendered(&scene)
    };
    [1.0, 0.5, 0.25].map(image).to_vec()
}

/// The verdict on `images` of `case`, and what conventions explain if nothing else did.
fn judged(case: &Case, images: &[Film], profile: Option<&Profile>) -> Judged {
    let pictures = images.iter().cloned().map(Picture::Radiance).collect();
    let mut judged = validate(case, &suite().store(), Output::Refined(pictures), profile);
    if profile.is_none() {
        ConventionSearch::default().explain_mismatch(
            case,
            &suite().store(),
            &mut judged,
            1e4,
            false,
        );
    }
    judged
}

/// A single image with the step of its scene is right, with samples in the middle or at the ends of steps: what is thinner
/// than a step lies between samples or on one.
#[test]
fn a_single_image_at_the_step_of_its_scene_is_no_failure() {
    let verdict = |name: &str, first_sample: f64, factor: f32| {
        let case = case_of(&format!("limit/{name}"));
        let scene = case.load_scene().unwrap();
        let image = rendered(&scene.with_volumes(|volume| {
            volume.sample();
            volume.conventions.first_sample = first_sample;
        }));
        let image = edited(&image, |_, _, pixel| pixel.map(|value| factor * value));
        validated(case, silent(&image)).result.verdict
    };
    for (name, first_sample) in [
        ("opaque-shell", 0.5),
        ("sharp-peak", 0.5),
        ("sharp-peak", 1.0),
    ] {
        assert_ne!(
            verdict(name, first_sample, 1.0),
            Verdict::Fail,
            "{name}, {first_sample}"
        );
    }
    // But one that is a fifth too bright is.
    assert_eq!(verdict("opaque-shell", 0.5, 1.2), Verdict::Fail);
}

/// The part of a last step that lies beyond the back face is a sawtooth in the step: three images do not
/// bound it in every pixel.
#[test]
fn whole_last_steps_pass() {
    let names = [
        "full-to-the-border",
        "cell-centred",
        "eye-inside",
        "one-voxel-thick",
        "thin-haze",
    ];
    for name in names {
        let case = case_of(&format!("limit/{name}"));
        let scene = case.load_scene().unwrap();
        for first_sample in [0.0, 0.5] {
            let images = ladder(&scene, |it| {
                (it.first_sample, it.last_step) = (first_sample, LastStep::Whole);
            });
            let result = judged(case, &images, None).result;
            // Where the step of the scene is too long for such a rule, nothing is decided.
            let passes = [Verdict::Pass, Verdict::Inconclusive].contains(&result.verdict);
            assert!(passes, "{} {first_sample}: {}", case.name, result.reason);
        }
    }
}

/// Samples that are dropped because they are faint: the more there are, the more is lost. The convention is found, and under its profile they pass.
#[test]
fn faint_samples_that_are_dropped() {
    let case = case_of("limit/thin-haze");
    let scene = case.load_scene().unwrap();
    let images = ladder(&scene, |it| it.least_opacity = 0.001);
    let plain = validate(
        case,
        &suite().store(),
        Output::Refined(images.iter().cloned().map(Picture::Radiance).collect()),
        None,
    );
    assert_eq!(plain.result.verdict, Verdict::Fail);
    let words = "faint samples dropped";
    assert!(
        plain.result.reason.contains(words),
        "{}",
        plain.result.reason
    );
    // A limit by extrapolation, which nobody sees, is no evidence.
    assert_eq!(
        plain.evidence.test,
        Some(Picture::Radiance(images[2].clone()))
    );

    let found = judged(case, &images, None).result;
    assert_eq!(found.verdict, Verdict::Convention, "{}", found.reason);
    let words = "drops samples of an opacity below 0.001 over a step";
    assert!(
        found.conventions[0].contains(words),
        "{:?}",
        found.conventions
    );
    let profile = Profile::parse(&found.profile.unwrap(), "mine.toml").unwrap();
    let under = judged(case, &images, Some(&profile)).result;
    assert_eq!(under.verdict, Verdict::Pass, "{}", under.reason);
}
