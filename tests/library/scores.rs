//! Score tests of the stochastic gate: sizes without bias, alarms no more often than promised.

use crate::common::simulated::{Bits, Sampling, Shape, sampled, scene};
use volref::compare::stochastic::{BLOCK, judge_with};
use volref::compare::{Judgement, Sensitivity};
use volref::film::Film;

const SIDE: usize = 48;

/// How the simulated scene changes where it becomes denser: the more the brighter it is, and with a
/// sign of its own in the right half.
fn change(x: f64, y: f64) -> [f64; 3] {
    let light = scene(x, y);
    let factor = if x < 24.0 { -0.8 } else { 0.3 };
    light.map(|value| factor * value)
}

/// Of which half of the image becomes brighter, and of an image moved to the right.
fn others(which: usize, x: f64, y: f64) -> [f64; 3] {
    match which {
        0 if y < 24.0 => scene(x, y),
        0 => [0.0; 3],
        _ => {
            let [a, b] = [scene(x - 1.0, y), scene(x + 1.0, y)];
            [0, 1, 2].map(|c| 0.5 * (a[c] - b[c]))
        }
    }
}

/// Means over blocks of a derivative, with noise of `relative` standard deviations of its size.
fn sensitivity(
    name: &str,
    relative: f64,
    seed: u64,
    of: impl Fn(f64, f64) -> [f64; 3],
) -> Sensitivity {
    let columns = SIDE / BLOCK;
    let mut bits = Bits(seed);
    let (mut means, mut variances) = (Vec::new(), Vec::new());
    for at in 0..columns * columns {
        let mut mean = [0.0; 3];
        for pixel in 0..BLOCK * BLOCK {
            let x = at % columns * BLOCK + pixel % BLOCK;
            let y = at / columns * BLOCK + pixel / BLOCK;
            let of_pixel = of(x as f64, y as f64);
            for c in 0..3 {
                mean[c] += of_pixel[c] / (BLOCK * BLOCK) as f64;
            }
        }
        let error = mean.map(|mean| relative * mean.abs());
        // Twelve uniform numbers make one that is nearly normal.
        let normal = (0..12)
            .map(|_| bits.word() as f64 / u64::MAX as f64)
            .sum::<f64>()
            - 6.0;
        means.push([0, 1, 2].map(|c| (mean[c] + error[c] * normal) as f32));
        variances.push(error.map(|error| (error * error) as f32));
    }
    Sensitivity {
        name: name.to_owned(),
        words: name.to_owned(),
        unit: None,
        step: f64::INFINITY,
        can_be: [true; 2],
        derivative: Film::with_noise(columns, columns, means, variances, 16),
    }
}

fn sensitivities(seed: u64) -> Vec<Sensitivity> {
    vec![
        sensitivity("density", 0.3, 3 * seed + 1, change),
        sensitivity("lamp", 0.3, 3 * seed + 2, |x, y| others(0, x, y)),
        sensitivity("shift", 0.3, 3 * seed + 3, |x, y| others(1, x, y)),
    ]
}

fn pair(seed: u64, shape: &Shape, samples: u32, truth: impl Fn(f64, f64) -> [f64; 3]) -> [Film; 2] {
    let sampling = |seed: u64, samples: u32| Sampling::of(shape, SIDE, samples, seed);
    let reference = sampled(sampling(2 * seed + 100_000, 256), scene);
    [reference, sampled(sampling(2 * seed + 1, samples), truth)]
}

fn judged(pair: &[Film; 2], sensitivities: &[Sensitivity], level: f64) -> Judgement {
    let [reference, test] = pair;
    judge_with(reference, test, level, None, sensitivities).unwrap()
}

/// Suites of honest images, at levels at which alarms are rare and at which they are not: no more of
/// them than promised, by four standard deviations of their number. Levels are those of the whole
/// gate; the scores have a tenth of each.
#[test]
fn scores_raise_no_more_alarms_than_promised() {
    let shapes = Shape::all();
    let suites = 1000;
    for level in [0.5, 0.05] {
        let mut alarms = 0;
        for suite in 0..suites {
            let shape = &shapes[suite as usize % shapes.len()];
            let pair = pair(suite, shape, 32, scene);
            let judgement = judged(&pair, &sensitivities(suite), level);
            alarms += u32::from(
                judgement.reason.contains("with the same effect")
                    || judgement.reason.contains("for derivatives"),
            );
        }
        let expected = 0.1 * level * suites as f64;
        let most = expected + 4.0 * expected.sqrt();
        assert!(f64::from(alarms) <= most, "{alarms} alarms at {level}");
    }
}

/// Sizes that are found, less the true one, over the errors that are stated: mean 0, spread 1. The
/// channels of these images share their noise, as the errors take them to.
#[test]
fn sizes_have_no_bias() {
    let shapes = Shape::all();
    let runs = 200;
    for (size, shape) in [(0.2, 0), (-0.1, 1), (0.3, 1)] {
        let mut pulls = Vec::new();
        for run in 0..runs {
            let truth = |x: f64, y: f64| {
                let (light, change) = (scene(x, y), change(x, y));
                [0, 1, 2].map(|c| light[c] + size * change[c])
            };
            let pair = pair(run, &shapes[shape], 64, truth);
            let judgement = judged(&pair, &sensitivities(run), 1e-6);
            assert!(!judgement.passed);
            let found = judgement.changes.first().expect("a change").clone();
            assert_eq!(found.name, "density", "{}", judgement.reason);
            pulls.push((found.change - size) / found.error);
        }
        let mean = pulls.iter().sum::<f64>() / runs as f64;
        let square = pulls.iter().map(|pull| pull * pull).sum::<f64>() / runs as f64;
        // Four standard errors of the mean and of the mean square of 200 normal numbers.
        assert!(
            mean.abs() <= 4.0 / (runs as f64).sqrt(),
            "{size}: mean pull {mean}"
        );
        assert!(
            (square - 1.0).abs() <= 4.0 * (2.0 / runs as f64).sqrt(),
            "{size}: {square}"
        );
    }
}

/// What the other tests of the gate cannot see, because it is spread over the whole image and its
/// mean cancels.
#[test]
fn a_faint_change_is_seen_and_named() {
    let shapes = Shape::all();
    let pair = pair(3, &shapes[1], 64, |x, y| {
        let (light, change) = (scene(x, y), change(x, y));
        [0, 1, 2].map(|c| light[c] + 0.05 * change[c])
    });
    let without = judged(&pair, &[], 1e-6);
    assert!(without.passed, "{}", without.reason);
    let judgement = judged(&pair, &sensitivities(3), 1e-6);
    assert!(
        !judgement.passed && judgement.reason.contains("with the same effect: density"),
        "{}",
        judgement.reason
    );
    assert!(
        judgement.reason.contains("too large"),
        "{}",
        judgement.reason
    );
}
