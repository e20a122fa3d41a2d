//! What the stochastic gate promises, simulated: honest suites raise no alarms, and what it must
//! see it sees.
//!
//! The tables in `src/guide/comparing.md` are printed by the long versions of both:
//! `cargo test --release --test library gate:: -- --ignored --nocapture`.

use crate::common::simulated::{Sampling, Shape, faults, replicates, sampled, scene, silent};
use crate::common::suite::{film_with, scene_of, suite};
use rayon::prelude::*;
use std::path::Path;
use volref::compare::significance::at_least;
use volref::compare::stochastic::{FALSE_ALARM, judge_at};
use volref::film::Film;
use volref::suite::{Golden, Suite};

/// Pixels on a side: 64 blocks, of which the edges cut none and the scene's many.
const SIDE: usize = 64;

/// Cases of a suite, as many as the real one has.
const CASES: u64 = 30;

/// Samples per pixel of test images.
const SAMPLES: [u32; 5] = [4, 8, 16, 32, 64];

/// Levels of a whole suite: the promised one, and one at which there are alarms to count.
const LEVELS: [f64; 2] = [FALSE_ALARM, 0.01];

/// How a test image states its noise.
const KINDS: [&str; 3] = ["variance", "none", "replicates"];

/// Alarms of `suites` honest suites, by [`LEVELS`] and [`KINDS`], and what was said of them.
fn honest(suites: u64, samples_of_references: [u32; 2]) -> ([[u64; 3]; 2], Vec<String>) {
    let shapes = Shape::all();
    let cases: Vec<u64> = (0..suites * CASES).collect();
    let of_case = |case: &u64| alarms_of_case(*case, &shapes, samples_of_references);
    let found: Vec<_> = cases.par_iter().map(of_case).collect();
    let mut alarms = [[0; 3]; 2];
    for suite in found.chunks(CASES as usize) {
        for (level, of_level) in alarms.iter_mut().enumerate() {
            for (kind, count) in of_level.iter_mut().enumerate() {
                *count += u64::from(suite.iter().any(|case| case[level][kind].is_some()));
            }
        }
    }
    let said = found.into_iter().flatten().flatten().flatten();
    (alarms, said.collect())
}

/// What is said of an honest case, by level and kind. Cases are numbered through all suites.
fn alarms_of_case(
    number: u64,
    shapes: &[Shape],
    samples_of_references: [u32; 2],
) -> [[Option<String>; 3]; 2] {
    let (suite, case) = (number / CASES, (number % CASES) as usize);
    let shape = &shapes[case % shapes.len()];
    // In every third suite, another noise in another part of the image.
    let other = &shapes[(case + usize::from(suite.is_multiple_of(3))) % shapes.len()];
    let image = |seed: u64, samples: u32| {
        let sampling = Sampling {
            // Where there is more to see, what is not there must not be seen either.
            side: if suite % 10 == 5 { 3 * SIDE } else { SIDE },
            samples,
            seed: number * 16 + seed,
            shapes: [shape, other],
            coloured: suite.is_multiple_of(4),
            one_for_all: false,
        };
        sampled(sampling, scene)
    };
    let reference = image(0, samples_of_references[case % 2]);
    let samples = SAMPLES[case / shapes.len()];
    let test = image(1, samples);
    let several: Vec<Film> = (2..6)
        .map(|seed| image(seed, samples.div_ceil(4)))
        .collect();
    let tests = [test.clone(), silent(&test), replicates(&several)];
    LEVELS.map(|level| {
        [0, 1, 2].map(|kind| {
            let judgement = judge_at(&reference, &tests[kind], level / CASES as f64).unwrap();
            (!judgement.passed).then(|| {
                format!(
                    "suite {suite}, case {case} ({} and {}, {samples} samples, {}, level {level}): \
                     {}",
                    shape.name, other.name, KINDS[kind], judgement.reason
                )
            })
        })
    })
}

/// The number of alarms of `suites` suites at `level` is not above what chance explains, one in
/// a thousand.
fn assert_rare(suites: u64, alarms: [[u64; 3]; 2], said: &[String]) {
    for (level, alarms) in LEVELS.into_iter().zip(alarms) {
        for (kind, count) in KINDS.into_iter().zip(alarms) {
            assert!(
                at_least(count, suites, level) > 1e-3,
                "{count} alarms of {suites} suites at {level}, {kind}:\n{}",
                said.join("\n")
            );
        }
    }
}

#[test]
fn honest_suites_raise_no_alarm() {
    let suites = 10;
    let (alarms, said) = honest(suites, [256, 384]);
    assert_rare(suites, alarms, &said);
}

/// Most pixels of these miss a light that is half of all, and which they miss varies smoothly.
#[test]
fn what_a_large_image_misses_is_not_held_against_it() {
    let shapes = Shape::all();
    for (number, shape) in (0..).zip([&shapes[4], &shapes[3], &shapes[4], &shapes[5]]) {
        let image = |seed: u64, samples: u32| {
            let sampling = Sampling {
                side: 192,
                samples,
                seed: 100 * number + seed,
                shapes: [shape; 2],
                coloured: number == 2,
                one_for_all: false,
            };
            sampled(sampling, |x, y| scene(x / 3.0, y / 3.0))
        };
        let reference = image(0, 512);
        for (seed, samples) in [(1, 4), (2, 4), (3, 16)] {
            let test = image(seed, samples);
            for test in [&silent(&test), &test] {
                // A hundred such, and one in a thousand may fail.
                let judgement = judge_at(&reference, test, 1e-5).unwrap();
                let said = judgement.reason;
                assert!(
                    judgement.passed,
                    "{}, {samples} samples: {said}",
                    shape.name
                );
            }
        }
    }
}

#[test]
#[ignore = "minutes: the figures of the guide"]
fn a_thousand_honest_suites_raise_no_alarm() {
    let suites = 1000;
    let (alarms, said) = honest(suites, [512, 1024]);
    for (level, alarms) in LEVELS.into_iter().zip(alarms) {
        println!("level {level}: {alarms:?} of {suites} suites ({KINDS:?})");
    }
    println!("{}", said.join("\n"));
    assert_rare(suites, alarms, &said);
}

/// How often each fault is called out, by whether the test image states its variance and by its
/// samples per pixel; and one of the reasons.
struct Power {
    fault: &'static str,
    caught: Vec<[u32; 2]>,
    reason: String,
}

/// Samples of test images that faults are looked for in.
const FAULTY: [u32; 4] = [4, 16, 64, 256];

/// Samples of their reference.
const CONVERGED: u32 = 1024;

/// At the level of one case of thirty.
fn power(trials: u32, side: usize, shape: &Shape) -> Vec<Power> {
    let sampling = |seed: u32, samples| Sampling::of(shape, side, samples, seed.into());
    // The scene as large as the image.
    let scale = 64.0 / side as f64;
    let truth = move |x: f64, y: f64| scene(x * scale, y * scale);
    let mut table: Vec<Power> = Vec::new();
    for trial in 0..trials {
        let reference = sampled(sampling(2 * trial, CONVERGED), truth);
        for (column, samples) in FAULTY.into_iter().enumerate() {
            let of = sampling(2 * trial + 1, samples);
            let honest = sampled(of, truth);
            let mut rows = vec![
                ("nothing", honest.clone()),
                (
                    "half a pixel to the right",
                    sampled(of, |x, y| truth(x - 0.5, y)),
                ),
                ("half of the reference's own samples", {
                    sampled(sampling(2 * trial, CONVERGED / 2), truth)
                }),
                ("a copy of the reference", reference.clone()),
                ("one seed for all pixels", {
                    let one_for_all = true;
                    sampled(Sampling { one_for_all, ..of }, truth)
                }),
            ];
            rows.extend(
                faults()
                    .into_iter()
                    .map(|(name, fault)| (name, fault(&honest))),
            );
            for (row, (fault, test)) in rows.into_iter().enumerate() {
                if table.len() == row {
                    table.push(Power {
                        fault,
                        caught: vec![[0; 2]; FAULTY.len()],
                        reason: String::new(),
                    });
                }
                for (kind, test) in [&test, &silent(&test)].into_iter().enumerate() {
                    let judgement = judge_at(&reference, test, FALSE_ALARM / 30.0).unwrap();
                    if !judgement.passed {
                        table[row].caught[column][kind] += 1;
                        table[row].reason = judgement.reason;
                    }
                }
            }
        }
    }
    table
}

fn print(title: &str, trials: u32, table: &[Power]) {
    println!("\n{title}\n");
    let heads = FAULTY.map(|samples| format!(" {samples} spp |"));
    println!(
        "| fault |{}\n|---|{}",
        heads.concat(),
        "---|".repeat(FAULTY.len())
    );
    for row in table {
        let percent = |count: u32| 100 * count / trials;
        let cells = row.caught.iter();
        let cells = cells.map(|[with, none]| format!(" {} / {} |", percent(*with), percent(*none)));
        println!("| {} |{}", row.fault, cells.collect::<String>());
    }
    for row in table {
        println!("{}: {}", row.fault, row.reason);
    }
}

/// Faults that no noise of this kind hides, each from so many samples on, with a stated variance
/// and without.
#[test]
fn faults_are_called_out() {
    let never = u32::MAX;
    let table = power(1, SIDE, &Shape::all()[1]);
    for (fault, with, without) in [
        ("nothing", never, never),
        ("a copy of the reference", 4, 4),
        ("half of the reference's own samples", 4, never),
        ("one seed for all pixels", 4, 4),
        // The standard error of the mean of all is 0.6 % at 64 samples; the limit is seven.
        ("+5 %", 64, 64),
        // A block of 64 samples a pixel is known to 1.6 %; without its variance, less surely.
        ("a block +50 %", 16, 64),
        ("0.2 % fireflies", 4, never),
        ("one pixel to the right", 16, 256),
        ("half a pixel to the right", 64, 64),
        ("mean of 3 × 3 pixels", 4, 4),
        ("tent of radius 1.5", 4, 4),
    ] {
        let row = table.iter().find(|row| row.fault == fault).expect(fault);
        for (kind, least) in [with, without].into_iter().enumerate() {
            for (samples, caught) in FAULTY.into_iter().zip(&row.caught) {
                let is_smooth = fault.contains("mean") || fault.contains("tent");
                if fault == "nothing" {
                    assert_eq!(caught[kind], 0, "{fault}, {samples}: {}", row.reason);
                } else if samples >= least && !(is_smooth && samples > 4) {
                    assert_eq!(
                        caught[kind], 1,
                        "{fault}, {samples} samples, {}",
                        KINDS[kind]
                    );
                }
            }
        }
    }
}

#[test]
#[ignore = "minutes: the figures of the guide"]
fn power_in_full() {
    for shape in &Shape::all()[1..5] {
        let (side, trials) = (192, 10);
        let title = format!("{} noise, {side} × {side} pixels", shape.name);
        print(&title, trials, &power(trials, side, shape));
    }
}

/// Cases of the suite and samples per pixel of renderings in which faults are looked for.
const OF_THE_SUITE: [(&str, u32); 10] = [
    ("smoke/cornell", 64),
    ("smoke/cornell", 1024),
    ("procedural/gain-0.5", 64),
    ("procedural/gain-0.5", 1024),
    ("fog/rate-0.1", 64),
    ("fog/rate-0.1", 1024),
    ("fog/spotlight", 64),
    ("fog/spotlight", 1024),
    ("fog/backward", 64),
    ("fog/backward", 1024),
];

/// The golden of a case of `suite`, and the level of one case of all.
fn golden(suite: &Suite, name: &str) -> (Film, f64) {
    let case = suite.case(name).unwrap();
    let film = Golden::read(&suite.store(), case).unwrap().film;
    (film, FALSE_ALARM / suite.cases().len() as f64)
}

/// The table of faults in renderings beside goldens: for each, whether the gate calls it out with the
/// variance stated and without; and with it stated, beside the goldens of another suite,
/// `$VOLREF_BEFORE`, and those of this one.
#[test]
#[ignore = "minutes: the figures of the guide"]
fn faults_beside_goldens() {
    let before = std::env::var_os("VOLREF_BEFORE");
    let before = before.map(|folder| Suite::open(Path::new(&folder)).unwrap());
    let mut rows: Vec<[String; 2]> = Vec::new();
    for (name, samples) in OF_THE_SUITE {
        let honest = film_with(&scene_of(name), samples, 1);
        let (now, level) = golden(suite(), name);
        let before = before.as_ref().map(|suite| golden(suite, name));
        let mut tests = vec![
            ("none", honest.clone()),
            ("a copy of the golden", now.clone()),
        ];
        let spoilt = faults().into_iter();
        tests.extend(spoilt.map(|(fault, spoil)| (fault, spoil(&honest))));
        let mark = |golden: &Film, test: &Film, level| {
            let passed = judge_at(golden, test, level).unwrap().passed;
            if passed { "-" } else { "x" }
        };
        let started = !rows.is_empty();
        for (row, (fault, test)) in tests.iter().enumerate() {
            if !started {
                rows.push([format!("| {fault} |"), format!("| {fault} |")]);
            }
            let stated = mark(&now, test, level);
            rows[row][0] += &format!(" {stated} {} |", mark(&now, &silent(test), level));
            if let Some((before, level)) = &before {
                rows[row][1] += &format!(" {} {stated} |", mark(before, test, *level));
            }
        }
        assert!(
            rows[0][0].ends_with("- - |"),
            "{name}: an honest image fails"
        );
    }
    println!("{OF_THE_SUITE:?}");
    for table in 0..=usize::from(before.is_some()) {
        for row in &rows {
            println!("{}", row[table]);
        }
    }
}
