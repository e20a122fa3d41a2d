//! Images of 8 bits: of right ones none is rejected, whatever the case, and faults beyond the rounding are.

use crate::common::simulated::edited;
use crate::common::suite::{case_of, film_with, silent, suite};
use crate::needs::tries;
use volref::compare::Picture;
use volref::compare::flip::SrgbImage;
use volref::film::{Bits, Encoding, Film, Origin, Quantisation};
use volref::judging::{CaseResult, Verdict, declared, validate};
use volref::scene::{Length, Panel, Scene};
use volref::suite::{Case, Golden, Output};

/// The roundings of 8 bits that renderers have, at the exposure of a case.
fn roundings(exposure: f64) -> [Quantisation; 2] {
    [Encoding::Linear, Encoding::Srgb].map(|encoding| Quantisation {
        encoding,
        exposure,
        origin: Origin::Declared,
        blended: false,
    })
}

fn judged(case: &Case, films: Vec<Film>, bits: Option<&str>) -> CaseResult {
    let mut pictures: Vec<Picture> = films.into_iter().map(Picture::Radiance).collect();
    let output = match pictures.len() {
        1 => Output::Picture(Box::new(pictures.remove(0))),
        _ => Output::Refined(pictures),
    };
    let bits = bits.map(|bits| bits.parse::<Bits>().unwrap());
    let output = declared(output, bits, case);
    validate(case, &suite().store(), output, None).result
}

fn golden(case: &Case) -> Film {
    Golden::read(&suite().store(), case).unwrap().film
}

/// The picture of a case with `samples` per pixel, and seeds of its own.
fn rendered(scene: &Scene, samples: u32) -> Film {
    film_with(scene, samples, scene.seed().unwrap_or(0) ^ 0x38_6269_7473)
}

/// The scene of a case without a step, with its step times `factor` and samples at `first` in each.
fn sampled_scene(scene: &Scene, factor: f64, first: f64) -> Scene {
    scene.with_volumes(|volume| {
        volume.sample();
        volume.conventions.first_sample = first;
        volume
            .set_step(Length::World(factor * volume.step))
            .unwrap();
    })
}

fn is_accepted(result: &CaseResult) -> bool {
    matches!(result.verdict, Verdict::Pass | Verdict::Inconclusive)
}

/// Without noise: the golden itself, declared and recognised.
#[test]
fn no_rounded_image_is_rejected() {
    let (mut rejected, mut passed, mut said) = (Vec::new(), 0, 0);
    let without_noise = suite()
        .cases()
        .iter()
        .filter(|case| case.sampling.is_none());
    for case in without_noise.step_by(tries(3, 1)) {
        let golden = golden(case);
        for rounding in roundings(case.exposure) {
            let film = silent(&rounding.rounded(&golden));
            let bits = format!("8-{}", rounding.encoding.name());
            for bits in [Some(&*bits), None] {
                // Rendering for the limit takes its time.
                if case.is_limit() && bits.is_some() {
                    continue;
                }
                let result = judged(case, vec![film.clone()], bits);
                // An image that is not recognised, for want of colours, is not allowed for.
                let is_known = !result.notes.is_empty();
                said += usize::from(is_known && bits.is_none());
                if is_known && !is_accepted(&result) {
                    rejected.push(format!("{} {bits:?}: {}", case.name, result.reason));
                }
                passed += usize::from(is_known && result.verdict == Verdict::Pass);
            }
        }
    }
    assert!(rejected.is_empty(), "{rejected:#?}");
    assert!(
        passed > tries(30, 100) && said > tries(8, 30),
        "{passed} passed, {said} recognised"
    );
}

/// Ladders of steps, by rules of first and of second order.
#[test]
fn no_rounded_ladder_is_rejected() {
    let mut rejected = Vec::new();
    let mut still = 0;
    let cases = suite().cases().iter().filter(|case| case.is_limit());
    // A rule of the second order, and one of the first, by turns.
    for (case, first) in cases
        .zip([0.5, 1.0].into_iter().cycle())
        .step_by(tries(3, 1))
    {
        let scene = case.load_scene().unwrap();
        let films =
            [1.0, 0.5, 0.25].map(|factor| rendered(&sampled_scene(&scene, factor, first), 1));
        let exact = judged(case, films.to_vec(), None);
        // A table of one step is not what every case converges from.
        if !is_accepted(&exact) {
            continue;
        }
        for rounding in roundings(case.exposure) {
            let films = films.each_ref().map(|film| silent(&rounding.rounded(film)));
            let result = judged(case, films.to_vec(), None);
            let has_order = result.metrics.contains_key("observed_order");
            still += usize::from(!has_order);
            if !is_accepted(&result) {
                rejected.push(format!(
                    "{} {first} {rounding}: {}",
                    case.name, result.reason
                ));
            }
        }
    }
    assert!(rejected.is_empty(), "{rejected:#?}");
    assert!(still > tries(1, 5), "{still}");
}

/// PNG images of cases without a step are radiance at the exposure of the case, alone and as a ladder; at another
/// exposure they are told so.
#[test]
fn png_images_have_a_limit() {
    let case = case_of("limit/plume");
    let scene = case.load_scene().unwrap();
    let films = [1.0, 0.5, 0.25].map(|factor| rendered(&sampled_scene(&scene, factor, 0.5), 1));
    let png = |film: &Film, exposure: f64| {
        let codes = film.srgb_codes(exposure);
        Picture::Codes(SrgbImage::new(film.width(), film.height(), codes).unwrap())
    };
    let judged = |pictures: Vec<Picture>| {
        let output = match &pictures[..] {
            [one] => Output::Picture(Box::new(one.clone())),
            _ => Output::Refined(pictures),
        };
        validate(case, &suite().store(), output, None).result
    };
    let ladder = |exposure: f64| {
        films
            .iter()
            .map(|film| png(film, exposure))
            .collect::<Vec<_>>()
    };
    for pictures in [ladder(case.exposure), vec![png(&films[2], case.exposure)]] {
        let result = judged(pictures);
        assert_eq!(result.verdict, Verdict::Pass, "{}", result.reason);
        assert_eq!(result.gate.name(), "refinement");
        assert!(
            result.notes[0].starts_with("8 bits, sRGB"),
            "{:?}",
            result.notes
        );
    }
    for pictures in [
        ladder(case.exposure - 1.0),
        vec![png(&films[2], case.exposure - 1.0)],
    ] {
        let result = judged(pictures);
        assert_eq!(result.verdict, Verdict::Fail, "{}", result.reason);
        assert!(
            result.reason.contains("another exposure (-1.0"),
            "{}",
            result.reason
        );
    }
}

/// Beyond the rounding, faults are seen: another gain, a displaced image, shading left out.
#[test]
fn faults_beyond_the_rounding_are_rejected() {
    let mut missed = Vec::new();
    let names = [
        "figures/figure-1",
        "figures/figure-3",
        "figures/figure-4",
        "known-answers/lit-ball",
        "limit/plume",
    ];
    for name in names {
        let case = case_of(name);
        let scene = case.load_scene().unwrap();
        let golden = golden(case);
        let right = if case.sampling.is_some() {
            rendered(&scene, 4)
        } else {
            golden.clone()
        };
        let unshaded = scene.with_volumes(|volume| volume.phong = None);
        let mut volumes = scene.panels.iter().filter_map(Panel::classified);
        let is_shaded = volumes.any(|volume| volume.phong.is_some());
        let darker = edited(&right, |_, _, pixel| pixel.map(|value| 0.9 * value));
        let mut faults = vec![("gain", darker), ("shift", shifted(&right))];
        if is_shaded {
            faults.push(("unshaded", rendered(&unshaded, 1)));
        }
        for (fault, film) in faults {
            for rounding in roundings(case.exposure) {
                let test = silent(&rounding.rounded(&film));
                let bits = format!("8-{}", rounding.encoding.name());
                let result = judged(case, vec![test], Some(&bits));
                if result.verdict != Verdict::Fail {
                    missed.push(format!("{name} {fault} {rounding}: {}", result.reason));
                }
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Moved by a pixel.
fn shifted(film: &Film) -> Film {
    let width = film.width();
    let from = |index: usize| index - usize::from(!index.is_multiple_of(width));
    let pixels = (0..film.radiance().len()).map(|index| film.radiance()[from(index)]);
    Film::new(width, film.height(), pixels.collect())
}

/// A renderer that casts 255 x to a byte, or writes codes as numbers, is told so, and no other.
#[test]
fn codes_that_are_cut_or_not_divided_are_told() {
    let case = case_of("figures/figure-4");
    let golden = golden(case);
    let told = |code: &dyn Fn(f32) -> f32| {
        let film = edited(&golden, |_, _, pixel| pixel.map(code));
        let result = judged(case, vec![film], None);
        assert_eq!(result.verdict, Verdict::Fail, "{}", result.reason);
        result.reason
    };
    let is_told = |reason: &str, expected: [bool; 3]| {
        let sentences = [
            "every value is a whole number from 0 to 255",
            "the codes are rounded down",
            "the image agrees",
        ];
        let said = sentences.map(|sentence| reason.contains(sentence));
        assert_eq!(said, expected, "{reason}");
    };
    let yes = true;
    is_told(&told(&|x| (255.0 * x).floor() / 255.0), [false, yes, yes]);
    is_told(&told(&|x| (255.0 * x).round()), [yes, false, yes]);
    is_told(&told(&|x| (255.0 * x).floor()), [yes, false, false]);
    // Half as bright, they are codes, and wrong.
    is_told(&told(&|x| (127.0 * x).round()), [yes, false, false]);
    // As dark as cut codes are at most, but rounded to the nearest.
    let darker = |x: f32| (255.0 * x - 1.0).max(0.0).round() / 255.0;
    is_told(&told(&darker), [false; 3]);
    // A few whole numbers may be radiance.
    is_told(&told(&|x| (3.0 * x).round()), [false; 3]);
}
