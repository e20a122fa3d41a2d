//! Looks at more and more samples raise no more false alarms than one look.

use crate::common::simulated::{Sampling, Shape, replicates, sampled, scene};
use crate::needs::tries;
use volref::compare::stochastic::{FALSE_ALARM, judge_at};
use volref::film::Film;
use volref::judging::share_of_look;

const SIDE: usize = 24;
const LOOKS: u32 = 6;

/// Noise shown to a renderer whose samples are doubled until it fails, or until a bias of 5 % would be
/// seen, six looks at most.
fn is_rejected(seed: u64, shape: &Shape, level: f64, states_noise: bool) -> bool {
    let sampling = |seed: u64, samples: u32| Sampling::of(shape, SIDE, samples, seed);
    let reference = sampled(sampling(2 * seed + 200_000, 512), scene);
    let mut films = vec![sampled(sampling(1000 * seed + 1, 8), scene)];
    for look in 1..=LOOKS {
        let test = match &films[..] {
            [one] => one.clone(),
            several if states_noise => Film::from_replicates(several).unwrap(),
            several => replicates(several),
        };
        let judgement = judge_at(&reference, &test, level * share_of_look(look)).unwrap();
        if !judgement.passed {
            return true;
        }
        if judgement.metrics["smallest_visible_bias"] < 0.05 {
            return false;
        }
        let seed = 1000 * seed + 10 * u64::from(look);
        if states_noise {
            films.push(sampled(sampling(seed, 8 << (look - 1)), scene));
        } else {
            // Sixteen new ones, of more samples each time.
            let fresh = (0..16).map(|i| sampled(sampling(seed + 100 * i + 1, 1 << look), scene));
            films = fresh.collect();
        }
    }
    false
}

/// At levels at which alarms are rare and at which they are not: no more suites are rejected than one
/// look is promised to reject, by four standard deviations of their number.
#[test]
fn adaptive_looks_keep_the_promise_of_one() {
    let shapes = Shape::all();
    let suites = tries(200, 1000) as u64;
    for (level, states_noise) in [(0.2, true), (0.02, true), (0.2, false)] {
        let alarms = (0..suites)
            .filter(|&suite| {
                let shape = &shapes[suite as usize % shapes.len()];
                is_rejected(suite, shape, level, states_noise)
            })
            .count();
        let expected = level * suites as f64;
        let most = expected + 4.0 * expected.sqrt();
        assert!(
            alarms as f64 <= most,
            "{alarms} alarms at {level}, {states_noise}"
        );
    }
}

/// A fault of the test image: its mean at column x, row y over what is right, and the variance that it
/// states over what it has.
struct Fault {
    name: &'static str,
    mean: fn(f64, usize, usize) -> f64,
    variance: fn(f64) -> f64,
}

const FAULTS: [Fault; 5] = [
    Fault {
        name: "whole image",
        mean: |size, _, _| 1.0 + size,
        variance: |_| 1.0,
    },
    Fault {
        name: "a block of 8 × 8",
        mean: |size, x, y| {
            if x / 8 == 2 && y / 8 == 2 {
                1.0 + size
            } else {
                1.0
            }
        },
        variance: |_| 1.0,
    },
    Fault {
        name: "a pixel",
        mean: |size, x, y| if [x, y] == [20, 18] { 1.0 + size } else { 1.0 },
        variance: |_| 1.0,
    },
    Fault {
        name: "variance stated too small",
        mean: |_, _, _| 1.0,
        variance: |size| 1.0 / (1.0 + size),
    },
    Fault {
        name: "variance stated too large",
        mean: |_, _, _| 1.0,
        variance: |size| 1.0 + size,
    },
];

const SIZES: [f64; 8] = [0.005, 0.01, 0.02, 0.05, 0.1, 0.5, 2.0, 9.0];

/// Samples per pixel of the first look, and of the last.
const FIRST: u32 = 64;
const LAST: u32 = 1 << 16;

/// Samples at which an image with a fault fails, when they are doubled from look to look.
fn samples_to_rejection(fault: &Fault, size: f64, seed: u64) -> Option<u32> {
    const SIDE: usize = 48;
    let shape = &Shape::all()[1];
    let reference = sampled(Sampling::of(shape, SIDE, LAST, 7), scene);
    let (mut samples, mut look) = (FIRST, 1);
    while samples <= LAST {
        let sampling = Sampling::of(shape, SIDE, samples, 1000 * seed + u64::from(look));
        let honest = sampled(sampling, scene);
        let variances = honest.noise().unwrap().variance();
        let edited = |index: usize| {
            let factor = (fault.mean)(size, index % SIDE, index / SIDE) as f32;
            let stated = (fault.variance)(size) as f32;
            let mean = honest.radiance()[index].map(|value| value * factor);
            (
                mean,
                variances[index].map(|value| value * factor * factor * stated),
            )
        };
        let (means, variances) = (0..SIDE * SIDE).map(edited).unzip();
        let test = Film::with_noise(SIDE, SIDE, means, variances, samples);
        let level = FALSE_ALARM / 1000.0 * share_of_look(look);
        if !judge_at(&reference, &test, level).unwrap().passed {
            return Some(samples);
        }
        samples *= 2;
        look += 1;
    }
    None
}

/// The table of the guide: noise is exponential, its standard deviation as large as the mean.
#[test]
#[ignore = "prints the table in src/guide/comparing.md, in minutes"]
fn samples_to_decision_by_fault_and_size() {
    const RUNS: u64 = 5;
    let sizes = SIZES.map(|size| format!("{} %", 100.0 * size));
    println!("| fault | {} |", sizes.join(" | "));
    println!("| --- |{}", " --- |".repeat(SIZES.len()));
    for fault in &FAULTS {
        let cells = SIZES.map(|size| {
            let mut needed: Vec<_> = (1..=RUNS)
                .map(|seed| samples_to_rejection(fault, size, seed).unwrap_or(u32::MAX))
                .collect();
            needed.sort_unstable();
            // The median.
            match needed[RUNS as usize / 2] {
                u32::MAX => "–".to_owned(),
                samples => samples.to_string(),
            }
        });
        println!("| {} | {} |", fault.name, cells.join(" | "));
    }
}
