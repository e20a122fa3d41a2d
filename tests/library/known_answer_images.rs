//! Formulas for whole images: scenes that they refuse, and volref's renderings held to them.

use crate::common::suite::{case_of, film_with, golden_of, suite, validated};
use volref::film::Film;
use volref::judging::Verdict;
use volref::known_answers::{CATALOGUE, Footprint};
use volref::math::Moments;
use volref::suite::{Answer, Case};

fn cases() -> Vec<&'static Case> {
    let cases = suite().cases().iter();
    cases.filter(|case| case.truth.is_some()).collect()
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
            cases
                .iter()
                .any(|case| case.truth.unwrap().name == formula.name),
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

/// Many samples of each case against its formula: the mean within 0.1 % and four standard errors, and
/// squared deviations of blocks of 8 × 8 pixels that sum to their number. Prints both.
#[test]
#[ignore = "minutes: scripts/nightly.sh runs it"]
fn many_samples_agree_with_every_formula() {
    let mut printed = String::new();
    let mut wrong = Vec::new();
    for case in cases() {
        let scene = case.load_scene().unwrap();
        let known = case.truth.unwrap().image(&scene, footprint(case)).unwrap();
        let samples = case.sampling.map_or(1, |_| 8192);
        let film = film_with(&scene, samples, 0x6b6e_6f77_6e00_0000);
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
    let case = case_of("hard/s5-half-space-0.999");
    let Some(Answer::InTheMean(right)) = case.answer else {
        panic!("the answer of a sampled case");
    };
    let golden = golden_of(&case.name);
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
        validated(case, film).result
    };
    let passed = verdict(1.0);
    assert_eq!(passed.verdict, Verdict::Pass, "{}", passed.reason);
    let failed = verdict(1.02);
    assert_eq!(failed.verdict, Verdict::Fail, "{}", failed.reason);
}
