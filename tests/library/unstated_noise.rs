//! Monte Carlo images that state no noise, of scenes that volref integrates without any: their noise is estimated, and
//! no fault passes for noise.

use crate::common::simulated::{Bits, edited};
use crate::common::suite::{case_of, golden_of, validated};
use volref::film::Film;
use volref::judging::{CaseResult, Verdict};
use volref::math;

const NAMES: [&str; 4] = [
    "known-answers/airlight",
    "known-answers/lit-ball",
    "reported/one-event",
    "hard/s9-spotlight-edge",
];

/// The result of `edit` of the golden of each case.
fn results(edit: impl Fn(&Film) -> Film) -> [(&'static str, CaseResult); 4] {
    NAMES.map(|name| {
        let judged = validated(case_of(name), edit(&golden_of(name)));
        (name, judged.result)
    })
}

/// `golden`, each pixel times `value` of its column and row.
fn times(golden: &Film, value: impl Fn([usize; 2]) -> f64) -> Film {
    edited(golden, |x, y, pixel| {
        pixel.map(|channel| channel * value([x, y]) as f32)
    })
}

/// `golden` as the mean of `samples`, of which each is the right one times a number of an exponential distribution:
/// light that arrives along free paths.
fn sampled(golden: &Film, samples: u32, factor: f64) -> Film {
    let mut bits = Bits(7);
    let means = golden.radiance().iter().map(|pixel| {
        let uniform = || ((bits.word() >> 32) as f64 + 0.5) / f64::from(u32::MAX);
        let sum: f64 = std::iter::repeat_with(uniform)
            .take(samples as usize)
            .map(|u| -math::ln(u))
            .sum();
        pixel.map(|channel| channel * (factor * sum / f64::from(samples)) as f32)
    });
    Film::new(golden.width(), golden.height(), means.collect())
}

#[test]
fn noise_that_is_not_stated_is_estimated() {
    for samples in [16, 2048] {
        for (name, result) in results(|golden| sampled(golden, samples, 1.0)) {
            let is_right = matches!(result.verdict, Verdict::Pass | Verdict::Inconclusive);
            assert!(is_right, "{name}, {samples}: {}", result.reason);
            assert_eq!(result.gate.name(), "stochastic", "{name}");
            assert!(
                samples < 2048 || result.verdict == Verdict::Pass,
                "{name}: {}",
                result.reason
            );
        }
    }
    for (name, result) in results(|golden| sampled(golden, 2048, 1.03)) {
        assert_eq!(result.verdict, Verdict::Fail, "{name}: {}", result.reason);
    }
    // What noise hides is no pass.
    for (name, result) in results(|golden| sampled(golden, 4, 1.03)) {
        assert_ne!(result.verdict, Verdict::Pass, "{name}: {}", result.reason);
    }
}

/// Faults without noise are judged pixel by pixel, as ever.
#[test]
fn no_fault_passes_for_noise() {
    type Fault = (&'static str, fn(&Film) -> Film);
    let faults: [Fault; 6] = [
        ("brighter", |golden| times(golden, |_| 1.03)),
        ("a slope", |golden| {
            let width = golden.width() as f64;
            times(golden, move |[x, _]| 0.9 + 0.2 * x as f64 / width)
        }),
        ("ripples", |golden| {
            times(golden, |[x, y]| {
                1.0 + 0.1 * math::sin((x + 2 * y) as f64 / 3.0)
            })
        }),
        ("single pixels", |golden| {
            times(
                golden,
                |[x, y]| if (5 * x + 3 * y) % 31 == 0 { 1.5 } else { 1.0 },
            )
        }),
        ("lines", |golden| {
            times(golden, |[x, _]| if x % 8 == 3 { 0.5 } else { 1.0 })
        }),
        ("a pixel to the right", |golden| {
            let width = golden.width();
            let shifted = (0..golden.radiance().len())
                .map(|index| golden.radiance()[index - (index % width).min(1)]);
            Film::new(width, golden.height(), shifted.collect())
        }),
    ];
    for (what, fault) in faults {
        for (name, result) in results(fault) {
            assert_eq!(
                result.verdict,
                Verdict::Fail,
                "{what}, {name}: {}",
                result.reason
            );
            assert_eq!(result.gate.name(), "deterministic", "{what}, {name}");
        }
    }
}
