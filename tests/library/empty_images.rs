//! Images in which nothing, or all but nothing, was drawn, and explanations of faint ones.

use crate::common::simulated::edited;
use crate::common::suite::{case_of as case, film_of as film, suite};
use volref::compare::Picture;
use volref::film::{Bits, Film};
use volref::judging::{Judged, Verdict, validate};
use volref::naming::{ConventionSearch, Predictions, Search, diagnosis};
use volref::suite::{Case, Output};

const WORK: f64 = 10.0;

fn output(picture: Picture) -> Output {
    Output::Picture(Box::new(picture))
}

/// The verdict on `picture` after all searches.
fn searched(case: &Case, picture: Picture) -> Judged {
    let store = suite().store();
    let mut judged = validate(case, &store, output(picture), None);
    ConventionSearch::default().explain_mismatch(case, &store, &mut judged, WORK, true);
    let search = Search {
        budget: None,
        predictions: &Predictions::default(),
        interrupted: &|| false,
        progress: &|step| panic!("a search of {}", step.case),
    };
    let mut all = [judged];
    if all[0].result.reason.contains("nothing was drawn") {
        let likely = diagnosis(&[case], None, &mut all, &search);
        assert_eq!(likely.searched, 0);
    }
    let [judged] = all;
    judged
}

fn is_told_empty(case: &Case, picture: Picture) {
    let result = searched(case, picture).result;
    let sentence = "nothing was drawn: every pixel is the background, within its tolerance";
    assert_eq!(
        result.verdict,
        Verdict::Fail,
        "{}: {}",
        case.name,
        result.reason
    );
    assert_eq!(result.reason, sentence, "{}", case.name);
    assert!(result.conventions.is_empty() && result.looks_like.is_empty());
    assert!(result.changes.is_empty() && result.difference.is_empty());
}

/// In every class of cases, in front of black and of a colour, as radiance and as codes.
#[test]
fn an_image_of_all_but_nothing_is_told_so_alone() {
    for (name, background) in [
        ("reported/slope", [0.0; 3]),
        ("limit/plume", [0.0; 3]),
        ("smoke/cornell", [0.0; 3]),
        ("sampled/column", [0.4, 0.6, 0.8]),
    ] {
        let case = case(name);
        let scene = case.load_scene().unwrap();
        let count = scene.width() * scene.height();
        let empty = Film::new(scene.width(), scene.height(), vec![background; count]);
        let at = |x: usize, y: usize| x + scene.width() * y;
        let one_pixel = edited(&empty, |x, y, pixel| match at(x, y) {
            245 => pixel.map(|value| value + 0.0002),
            _ => pixel,
        });
        // Of 0.4 half precision does not tell it.
        if background == [0.0; 3] {
            is_told_empty(case, Picture::Radiance(one_pixel));
        } else {
            let result = searched(case, Picture::Radiance(one_pixel)).result;
            assert!(
                result.reason.starts_with("nothing was drawn"),
                "{}",
                result.reason
            );
        }
        let noise = edited(&empty, |x, y, pixel| {
            pixel.map(|value| value + 0.0005 * ((at(x, y) * 7919) % 101) as f32 / 100.0)
        });
        if background == [0.0; 3] {
            is_told_empty(case, Picture::Radiance(noise));
        }
    }
    // Light far below the tolerance, whose shape is right.
    let case = case("reported/slope");
    let right = film(&case.load_scene().unwrap());
    let faint = edited(&right, |_, _, pixel| pixel.map(|value| 0.0004 * value));
    is_told_empty(case, Picture::Radiance(faint));
    // A single code of an image of 8 bits.
    for bits in ["8-srgb", "8-linear"] {
        let bits: Bits = bits.parse().unwrap();
        let quantisation = bits.of_png(case.exposure);
        let codes: Vec<[u8; 3]> = (0..right.radiance().len())
            .map(|index| [u8::from(index == 245); 3])
            .collect();
        let film = quantisation.decoded(right.width(), right.height(), &codes);
        is_told_empty(case, Picture::Radiance(film));
    }
}

/// An image of its own opacity shows something, and black colours are no convention.
#[test]
fn opacity_is_something_drawn() {
    let case = case("reported/slope");
    let right = film(&case.load_scene().unwrap());
    let pixels = (0..right.radiance().len()).map(|index| {
        let [_, _, _, opacity] = right.pixel(index);
        [0.0, 0.0, 0.0, opacity]
    });
    let black = Film::with_opacity(right.width(), right.height(), pixels.collect());
    let result = searched(case, Picture::Radiance(black)).result;
    assert_eq!(result.verdict, Verdict::Fail, "{}", result.reason);
    assert!(
        !result.reason.contains("nothing was drawn"),
        "{}",
        result.reason
    );
}
