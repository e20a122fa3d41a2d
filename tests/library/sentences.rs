//! Sentences of a verdict on a difference: for each an image of which it must be said, and one of which it
//! must not.

use crate::common::simulated::{Sampling, Shape, edited, sampled, scene, silent};
use crate::common::suite::{case_of, film_with, searched, validated};
use volref::compare::stochastic::{judge_at, judge_with};
use volref::compare::{
    Conditions, Gate, Picture, Sensitivity, judge, measured as measured_difference,
};
use volref::film::Film;
use volref::math;
use volref::scene::{Model, Scene};
use volref::sensitivity::numbers_of_place;

/// A sentence, and what is said of two images.
struct Row {
    sentence: &'static str,
    of: String,
    /// None of this one.
    not_of: String,
}

fn row(sentence: &'static str, of: String, not_of: String) -> Row {
    Row {
        sentence,
        of,
        not_of,
    }
}

fn check(rows: Vec<Row>) {
    for Row {
        sentence,
        of,
        not_of,
    } in rows
    {
        assert!(of.contains(sentence), "{sentence:?} is not said: {of}");
        assert!(!not_of.contains(sentence), "{sentence:?} is said: {not_of}");
    }
}

const WIDTH: usize = 96;
const HEIGHT: usize = 80;

/// Hills of three colours, moved by so many pixels.
fn hills([right, down]: [f64; 2]) -> Film {
    let pixel = |i: usize| {
        let [x, y] = [(i % WIDTH) as f64 - right, (i / WIDTH) as f64 - down];
        let hill = |p: f64, q: f64| 0.6 + 0.4 * math::sin(p * x) * math::cos(q * y);
        [hill(0.21, 0.17), hill(0.13, 0.25), hill(0.3, 0.1)].map(|x| x as f32)
    };
    Film::new(WIDTH, HEIGHT, (0..WIDTH * HEIGHT).map(pixel).collect())
}

/// Flat tiles of 20 pixels, each unlike its neighbours.
fn tiles() -> Film {
    let pixel = |i: usize| {
        let [x, y] = [i % WIDTH / 20, i / WIDTH / 20];
        [0.3 + 0.1 * ((3 * x + 5 * y) % 4) as f32; 3]
    };
    Film::new(WIDTH, HEIGHT, (0..WIDTH * HEIGHT).map(pixel).collect())
}

/// True on either side of the border of two tiles.
fn is_edge(at: usize, length: usize) -> bool {
    at.is_multiple_of(20) && at > 0 || at % 20 == 19 && at + 1 < length
}

/// The hills with other values: by value, channel and place.
fn with(map: impl Fn(f32, usize, [usize; 2]) -> f32) -> Film {
    edited(&hills([0.0; 2]), |x, y, pixel| {
        [0, 1, 2].map(|c| map(pixel[c], c, [x, y]))
    })
}

fn measured(golden: &Film, test: &Film) -> String {
    measured_difference(golden, test).join("; ")
}

/// Of the hills.
fn said(test: &Film) -> String {
    measured(&hills([0.0; 2]), test)
}

#[test]
fn measurements_of_a_difference() {
    let brighter = with(|x, _, _| 1.1 * x);
    let corner =
        |factor: f32| with(move |x, _, [i, j]| if i < 32 && j >= 40 { factor * x } else { x });
    let of_tiles = |at_edges: bool| {
        let test = edited(&tiles(), |x, y, pixel| {
            let is = is_edge(x, WIDTH) || is_edge(y, HEIGHT);
            pixel.map(|value| if is == at_edges { value + 0.02 } else { value })
        });
        measured(&tiles(), &test)
    };
    check(vec![
        row(
            "of the squared relative difference is in green",
            said(&with(|x, c, _| if c == 1 { 1.1 * x } else { x })),
            said(&brighter),
        ),
        row(
            "the golden times 1.1000",
            said(&brighter),
            said(&with(|x, _, [i, _]| if i < 48 { 1.1 * x } else { 0.9 * x })),
        ),
        row("lies at edges", of_tiles(true), of_tiles(false)),
        row(
            "lies in columns 0 to 95 and row 79",
            said(&with(|x, _, [_, j]| if j == 79 { 0.0 } else { x })),
            said(&with(|x, _, [_, j]| if j >= 78 { 0.0 } else { x })),
        ),
        row(
            "nearly all of the squared relative difference lies in columns 0 to 31 and rows 40 to 79",
            said(&corner(0.5)),
            said(&with(
                |x, _, [i, j]| if i < 32 && j >= 40 { 0.5 * x } else { 0.9 * x },
            )),
        ),
    ]);
}

fn by_tolerance(golden: &Film, test: &Film) -> String {
    let [golden, test] = [golden, test].map(|film| Picture::Radiance(film.clone()));
    let judgement = judge(Gate::Deterministic, &golden, &test, &Conditions::default());
    judgement.unwrap().reason
}

#[test]
fn reasons_without_noise() {
    let biased = |far: f32| {
        let test = with(move |x, _, at| if at == [9, 9] { far * x } else { 1.005 * x });
        by_tolerance(&hills([0.0; 2]), &test)
    };
    check(vec![row(
        "the pixels are close, but",
        biased(1.0),
        by_tolerance(&hills([0.0; 2]), &hills([0.0; 2])),
    )]);
}

const SIDE: usize = 64;

/// Of simulated images: the second with 64 samples.
fn in_noise(edit: impl Fn(&Film, &Film) -> Film) -> String {
    let shape = &Shape::all()[0];
    let golden = sampled(Sampling::of(shape, SIDE, 256, 1), lit);
    let test = sampled(Sampling::of(shape, SIDE, 64, 2), lit);
    judge_at(&golden, &edit(&golden, &test), 1e-6)
        .unwrap()
        .reason
}

fn lit(x: f64, y: f64) -> [f64; 3] {
    scene(x, y).map(|value| value + 0.3)
}

fn scaled(test: &Film, factor: impl Fn(usize, usize) -> f32) -> Film {
    edited(test, |x, y, pixel| pixel.map(|value| value * factor(x, y)))
}

#[test]
fn reasons_in_noise() {
    let honest = || in_noise(|_, test| test.clone());
    let block = || {
        in_noise(|_, test| {
            scaled(
                test,
                |x, y| if x / 8 == 3 && y / 8 == 3 { 1.3 } else { 1.0 },
            )
        })
    };
    let black = |is: fn(usize, usize) -> bool| {
        in_noise(|_, test| scaled(test, |x, y| if is(x, y) { 0.0 } else { 1.0 }))
    };
    let copied = |rows: usize| {
        in_noise(|golden, test| {
            edited(test, |x, y, pixel| {
                if y < rows {
                    golden.radiance()[x + SIDE * y]
                } else {
                    pixel
                }
            })
        })
    };
    check(vec![
        row(
            "the image is too bright overall",
            in_noise(|_, test| scaled(test, |_, _| 1.05)),
            honest(),
        ),
        row("blocks and channels differ beyond noise", block(), honest()),
        row(
            "a NaN replaced by 0",
            black(|x, y| [x, y] == [20, 20] || [x, y] == [40, 50]),
            // A corner that is open.
            black(|x, y| x < 8 && y < 8),
        ),
        row("pixels are black", black(|x, y| x < 8 && y < 8), honest()),
        row("it is the same image", copied(SIDE), copied(50)),
        row("part of it is copied", copied(50), honest()),
        row(
            "pixels are off by more than 5 standard errors",
            in_noise(|_, test| {
                scaled(
                    test,
                    |x, y| if (x + y).is_multiple_of(2) { 1.5 } else { 0.5 },
                )
            }),
            honest(),
        ),
    ]);
}

/// How the simulated scene changes with a number.
fn change(x: f64, y: f64) -> [f64; 3] {
    lit(x, y).map(|value| value * if x < 24.0 { -0.8 } else { 0.3 })
}

fn sensitivity(name: &str, step: f64, of: impl Fn(f64, f64) -> [f64; 3]) -> Sensitivity {
    let blocks = SIDE / 8;
    let mean = |at: usize| {
        let mut mean = [0.0; 3];
        for pixel in 0..64 {
            let [x, y] = [at % blocks * 8 + pixel % 8, at / blocks * 8 + pixel / 8];
            let of_pixel = of(x as f64, y as f64);
            for c in 0..3 {
                mean[c] += of_pixel[c] / 64.0;
            }
        }
        mean.map(|x| x as f32)
    };
    let means = (0..blocks * blocks).map(mean).collect();
    Sensitivity {
        name: name.to_owned(),
        words: name.to_owned(),
        unit: None,
        step,
        can_be: [true; 2],
        derivative: Film::with_noise(blocks, blocks, means, vec![[0.0; 3]; blocks * blocks], 16),
    }
}

/// Reason for an image that differs by `size` times the change.
fn by_numbers(size: f64, step: f64) -> String {
    let shape = &Shape::all()[0];
    let golden = sampled(Sampling::of(shape, SIDE, 1024, 1), lit);
    let test = sampled(Sampling::of(shape, SIDE, 256, 2), |x, y| {
        let (light, change) = (lit(x, y), change(x, y));
        [0, 1, 2].map(|c| light[c] + size * change[c])
    });
    let all = [sensitivity("density", step, change)];
    judge_with(&golden, &test, 1e-6, None, &all).unwrap().reason
}

#[test]
fn reasons_by_numbers() {
    let little = || by_numbers(0.1, 0.5);
    let far = || by_numbers(0.3, 0.05);
    check(vec![
        row(
            "as if this were so, or like a mistake with the same effect: density",
            little(),
            far(),
        ),
        row("too large for derivatives to tell", far(), little()),
        // Nothing is as if less than no density.
        row("density", little(), by_numbers(-1.3, f64::INFINITY)),
    ]);
}

/// What is said of the numbers of a scene, of an image of `case` with an edit of its scene and one of
/// its pixels by column and row.
fn of_scene(case: &str, edit: impl Fn(&mut Scene), map: impl Fn(usize, usize) -> f32) -> String {
    let film = rendered(case, edit);
    searched(case_of(case), scaled(&film, map))
        .difference
        .join("; ")
}

/// An image of `case` with an edit of its scene.
fn rendered(case: &str, edit: impl Fn(&mut Scene)) -> Film {
    let mut scene = case_of(case).load_scene().unwrap();
    edit(&mut scene);
    film_with(&scene, 64, 0x7365_6e74)
}

/// An image that shows the background alone is told so, and nothing is measured of it.
#[test]
fn nothing_is_measured_of_what_is_not_drawn() {
    for (case, grey) in [("scenes/opacity-over-grey", 0.1), ("smoke/cornell", 0.0)] {
        let right = rendered(case, |_| ());
        let nothing = silent(&edited(&right, |_, _, _| [grey; 3]));
        let result = searched(case_of(case), nothing.clone());
        let sentence = "nothing was drawn: every pixel is the background";
        assert!(result.reason.starts_with(sentence), "{}", result.reason);
        assert!(result.changes.is_empty() && result.difference.is_empty());
        // One pixel is something.
        let one_pixel = edited(&nothing, |x, y, pixel| {
            pixel.map(|value| if [x, y] == [9, 9] { 2.0 } else { value })
        });
        let reason = validated(case_of(case), one_pixel).result.reason;
        assert!(!reason.contains("nothing was drawn"), "{reason}");
    }
}

/// A turn of the volume is a parameter of the scene.
#[test]
fn axes_of_turns() {
    let turned = rendered("reported/head", |scene| {
        let turn = numbers_of_place(scene).into_iter();
        let mut turn = turn.filter(|number| number.name() == "turn.z");
        *scene = turn.next().unwrap().changed(scene, 2.0).unwrap();
    });
    let said = searched(case_of("reported/head"), turned)
        .difference
        .join("; ");
    assert!(
        said.starts_with("turn of the volume about z off by +1.99977"),
        "{said}"
    );
}

#[test]
fn numbers_of_a_scene() {
    let make_denser = |scene: &mut Scene| {
        if let Model::Classified(volume) = &mut scene.panels[0].model {
            volume.transfer_function.reference_length /= 1.1;
        }
    };
    let end_early = |scene: &mut Scene| {
        if let Model::Classified(volume) = &mut scene.panels[0].model {
            volume.end_rays_at(0.3);
        }
    };
    let case = "sampled/trilinear-blocks";
    let [denser, ended] = [
        of_scene(case, make_denser, |_, _| 1.0),
        of_scene(case, end_early, |_, _| 1.0),
    ];
    // Denser, and besides brighter below.
    let besides = of_scene(case, make_denser, |_, y| if y < 40 { 1.0 } else { 1.025 });
    check(vec![
        row(
            "extinction of the volume 10.0000 ± 0.0040 % too large",
            denser.clone(),
            ended.clone(),
        ),
        row(
            "with this change the scene agrees with the image",
            denser.clone(),
            [ended, besides.clone()].join("; "),
        ),
        row("as if ", besides.clone(), denser.clone()),
        row(", which leaves ", besides, denser),
    ]);
}

/// Parameters are fitted on every fourth row, which these are not; that the scene agrees is said of all.
#[test]
fn a_scene_does_not_agree_but_for_three_rows() {
    let but_for_rows = |_, y| {
        if [124, 128, 132].contains(&y) {
            0.0
        } else {
            1.5
        }
    };
    let said = of_scene("figures/figure-4", |_| {}, but_for_rows);
    assert!(said.contains("the golden times 1.4"), "{said}");
    assert!(!said.contains("agrees"), "{said}");
}
