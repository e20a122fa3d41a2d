//! Monte Carlo images that state no noise, of scenes that volref integrates without any: their noise is estimated, and
//! no fault passes for noise.

use volref::compare::Picture;
use volref::film::Film;
use volref::judging::{CaseResult, Verdict, validate};
use volref::math;
use volref::suite::{Case, Output, Suite};

const NAMES: [&str; 4] = [
    "known-answers/airlight",
    "known-answers/lit-ball",
    "reported/one-event",
    "hard/s9-spotlight-edge",
];

/// The result of `edit` of the golden of each case.
fn results(edit: impl Fn(&Film) -> Film) -> Vec<(String, CaseResult)> {
    let suite = Suite::bundled().unwrap();
    let result = |name: &str| {
        let cases = suite.select(&[name.to_owned()]).unwrap();
        let case: &Case = cases[0];
        let golden = std::fs::read(suite.golden_folder().join(format!("{name}.exr"))).unwrap();
        let golden = Film::from_exr(&golden).unwrap();
        let picture = Picture::Radiance(edit(&golden));
        let judged = validate(
            case,
            &suite.store(),
            Output::Picture(Box::new(picture)),
            None,
        );
        (name.to_owned(), judged.result)
    };
    NAMES.map(result).into()
}

/// `golden`, each pixel times `value` of its column and row.
fn times(golden: &Film, mut value: impl FnMut([usize; 2]) -> f64) -> Film {
    let width = golden.width();
    let pixels = golden.radiance().iter().enumerate();
    let pixels = pixels.map(|(index, pixel)| {
        let factor = value([index % width, index / width]) as f32;
        pixel.map(|channel| channel * factor)
    });
    Film::new(width, golden.height(), pixels.collect())
}

/// `golden` as the mean of `samples`, of which each is the right one times a number of an exponential distribution:
/// light that arrives along free paths.
fn sampled(golden: &Film, samples: u32, factor: f64) -> Film {
    let mut state = 7_u64;
    let mut uniform = || {
        // Knuth's generator of 64 bits, of which the upper half is good enough.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 32) as f64 + 0.5) / f64::from(u32::MAX)
    };
    times(golden, |_| {
        let sum: f64 = (0..samples).map(|_| -math::ln(uniform())).sum();
        factor * sum / f64::from(samples)
    })
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
