//! Formulas for whole images: scenes that they refuse, and volref's renderings held to them.

use crate::common::suite::suite;
use std::path::PathBuf;
use volref::compare::Picture;
use volref::film::Film;
use volref::judging::{Verdict, validate};
use volref::known_answers::{CATALOGUE, Footprint, Formula};
use volref::math::Moments;
use volref::render::{Sampling, Seed, plans, render};
use volref::scene::Scene;
use volref::suite::{Answer, Case, Golden, Output};

fn cases() -> Vec<Case> {
    let cases = suite().cases().to_vec();
    cases.into_iter().filter(|c| c.truth.is_some()).collect()
}

fn footprint(case: &Case) -> Footprint {
    match case.sampling {
        Some(_) => Footprint::Square,
        None => Footprint::Centre,
    }
}

#[test]
fn every_formula_has_a_case() {
    let cases = cases();
    assert!(cases.len() >= 12);
    for formula in CATALOGUE {
        assert!(
            cases.iter().any(|case| case.truth == Some(formula)),
            "{}",
            formula.name
        );
    }
}

/// What a formula gives for the mean over a pixel and for its centre differs by less than the gates
/// tolerate: a renderer may do either where there is no noise.
#[test]
fn answers_are_smooth_within_a_pixel() {
    for case in cases().iter().filter(|case| case.sampling.is_none()) {
        let scene = case.load_scene().unwrap();
        let formula = case.truth.unwrap();
        let [centre, square] = [Footprint::Centre, Footprint::Square]
            .map(|footprint| formula.image(&scene, footprint).unwrap().film);
        let pairs = centre
            .radiance()
            .as_flattened()
            .iter()
            .zip(square.radiance().as_flattened());
        for (&a, &b) in pairs {
            assert!((a - b).abs() <= 5e-4 + 5e-3 * a, "{}: {a} {b}", case.name);
        }
    }
}

/// The formula of `name`, applied to its case with an edit of the scene.
fn refusal(case: &str, from: &str, to: &str) -> String {
    let cases = cases();
    let case = cases.iter().find(|c| c.name.ends_with(case)).unwrap();
    let text = std::fs::read_to_string(&case.scene).unwrap();
    assert!(text.contains(from), "{from}");
    let path: PathBuf = case.scene.clone();
    let scene = Scene::parse(&text.replace(from, to), &path).unwrap();
    let formula: &Formula = case.truth.unwrap();
    match formula.image(&scene, footprint(case)) {
        Ok(_) => format!("{}: {to:?} is accepted", case.name),
        Err(reason) => reason,
    }
}

#[test]
fn scenes_of_another_kind_are_refused() {
    let medium = "[[radiative.medium]]\n";
    let said = [
        refusal("furnace-box", "sigma_s = 4", "sigma_s = 4\nsigma_a = 1e-9"),
        refusal("furnace-glowing", "[2, 1, 0.5]", "[2, 1, 0.6]"),
        refusal("half-space", "-60, -60, -60", "-60, -5, -60"),
        refusal("half-space", "sigma_t = 1", "sigma_t = 1\ng = 0.1"),
        refusal("half-space", "vertical_fov = 80", "vertical_fov = 100"),
        refusal(
            "slab-reflection",
            "[0, 0, 100], edge_v",
            "[0, 0, 90], edge_v",
        ),
        refusal("white-sky-through-fog", "[-60, 0, -60]", "[-20, 0, -60]"),
        refusal("airlight", "radius = 150", "radius = 100"),
        refusal("lit-ball", "scattering = \"single\"\n", ""),
        refusal("emitting-ball", "emission = ", "sigma_s = 0.1\nemission = "),
        refusal(
            "emitting-slab",
            medium,
            "[[radiative.light]]\npoint = { position = [0, 9, 0], intensity = 1 }\n\n[[radiative.medium]]\n",
        ),
        refusal(
            "absorbing-grid",
            "sigma_a",
            "interpolation = \"nearest\"\nsigma_a",
        ),
        refusal(
            "absorbing-grid",
            "known-answers/multilinear.nrrd",
            "hard/hill.nrrd",
        ),
        refusal(
            "overlapping-media",
            "sphere = { centre = [2, 0, 0], radius = 6 }",
            "mesh = { file = \"../../meshes/ball.obj\" }",
        ),
    ];
    insta::assert_snapshot!(said.join("\n"), @r#"
    the truth "furnace" does not fit the scene: a medium does not emit its absorption times the environment's radiance
    the truth "furnace" does not fit the scene: a medium does not emit its absorption times the environment's radiance
    the truth "half-space" does not fit the scene: the layer is too thin to stand for a half-space
    the truth "half-space" does not fit the scene: the formula is for isotropic scattering
    the truth "half-space" does not fit the scene: pixel [0, 0]: the ray does not go into the layer
    the truth "slab" does not fit the scene: its surface does not cut the layer all across
    the truth "slab" does not fit the scene: pixel [0, 0]: the ray enters within 30 mean free paths of a side of the layer
    the truth "airlight" does not fit the scene: the medium ends within 25 mean free paths of the eye: leave its boundary out, or make it a large `sphere`
    the truth "lit-body" does not fit the scene: the formula is for `scattering = "single"`
    the truth "emission-absorption" does not fit the scene: a medium scatters, and the formula is for absorption
    the truth "emission-absorption" does not fit the scene: it has a light, and the formula has none
    the truth "absorbing-grid" does not fit the scene: its grid is not trilinear between nodes on the faces of its box
    the truth "absorbing-grid" does not fit the scene: node [0, 1, 0] of its grid holds 0.03125, and between its corners lies 0
    the truth "emission-absorption" does not fit the scene: a medium has a shape that is neither `sphere` nor `box`
    "#);
}

/// Many samples of each case against its formula: the mean within 0.1 % and four standard errors, and
/// squared deviations of blocks of 8 × 8 pixels that sum to their number. Prints both.
#[test]
#[ignore = "minutes: scripts/nightly.sh runs it"]
fn many_samples_agree_with_every_formula() {
    let mut printed = String::new();
    let mut wrong = Vec::new();
    for case in cases() {
        let scene = case.load_scene().unwrap();
        let known = case.truth.unwrap().image(&scene, footprint(&case)).unwrap();
        let sampling = Sampling {
            samples: Some(case.sampling.map_or(1, |_| 8192)),
            seed: Seed::Given(0x6b6e_6f77_6e00_0000),
        };
        let film = render(&plans(&scene), sampling, &|| ()).unwrap().film;
        let (width, height) = (film.width(), film.height());
        for channel in 0..3 {
            let mean = |film: &volref::film::Film| {
                let values = film
                    .radiance()
                    .iter()
                    .map(|pixel| f64::from(pixel[channel]));
                values.collect::<Moments>().mean()
            };
            let (found, right) = (mean(&film), mean(&known.film));
            let relative = found / right - 1.0;
            let Some(noise) = film.noise() else {
                printed.push_str(&format!("{} {channel}: {relative:+.1e}\n", case.name));
                if relative.abs() > 1e-7 {
                    wrong.push(case.name.clone());
                }
                continue;
            };
            let (mut squares, mut count, mut variance) = (0.0, 0.0, 0.0);
            for block in 0..(width / 8) * (height / 8) {
                let corner = [block % (width / 8) * 8, block / (width / 8) * 8];
                let (mut difference, mut of_block) = (0.0, 0.0);
                for i in 0..64 {
                    let index = corner[0] + i % 8 + width * (corner[1] + i / 8);
                    difference += f64::from(film.radiance()[index][channel])
                        - f64::from(known.film.radiance()[index][channel]);
                    of_block += f64::from(noise.variance()[index][channel]);
                }
                variance += of_block;
                if of_block > 1e-12 * right * right {
                    squares += difference * difference / of_block;
                    count += 1.0;
                }
            }
            let error = variance.sqrt() / (width * height) as f64 / right;
            let z = if error > 1e-9 { relative / error } else { 0.0 };
            printed.push_str(&format!(
                "{} {channel}: {relative:+.1e}, {z:+.2} standard errors; chi-square {squares:.1} of {count}\n",
                case.name
            ));
            // Four standard deviations of a chi-square of that many degrees of freedom.
            let is_noise = squares <= count + 4.0 * (2.0_f64 * count).sqrt();
            if relative.abs() > 1e-3 || z.abs() > 4.0 || !is_noise {
                wrong.push(case.name.clone());
            }
        }
    }
    println!("{printed}");
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Where the radiance of every pixel is known, the noise of the golden hides no bias: images of other
/// renderers are compared with what is known.
#[test]
fn noise_of_a_golden_hides_nothing_where_the_answer_is_known() {
    let suite = suite();
    let mut cases = suite.cases().iter();
    let case = cases
        .find(|case| case.name == "hard/s5-half-space-0.999")
        .unwrap();
    let Some(Answer::InTheMean(right)) = case.answer else {
        panic!("the answer of a sampled case");
    };
    let golden = Golden::read(&suite.store(), case).unwrap().film;
    let (width, height) = (golden.width(), golden.height());
    // Mean of all pixels with a standard error of 0.001.
    let deviation = 1e-3 * ((width * height) as f64).sqrt();
    let verdict = |factor: f64| {
        let pixels = (0..width * height).map(|pixel| {
            // A pattern without a mean over four pixels.
            let noise = [1.0, -1.0, -1.0, 1.0][pixel % 4] * deviation;
            (right * factor + noise).as_vec3().to_array()
        });
        let variance = [(deviation * deviation) as f32; 3];
        let variance = vec![variance; width * height];
        let film = Film::with_noise(width, height, pixels.collect(), variance, 4096);
        let output = Output::Picture(Box::new(Picture::Radiance(film)));
        validate(case, &suite.store(), output, None).result
    };
    let passed = verdict(1.0);
    assert_eq!(passed.verdict, Verdict::Pass, "{}", passed.reason);
    let failed = verdict(1.02);
    assert_eq!(failed.verdict, Verdict::Fail, "{}", failed.reason);
}
