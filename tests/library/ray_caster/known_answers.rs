//! Compositing and marching against numbers from outside.
//!
//! Not tested, because the ray caster takes its samples in the middle of steps and gives each
//! the exact opacity of its length: the marching sums with samples at the ends of steps
//! (`T_left_endpoint_exponential`, `T_right_endpoint_exponential`), with opacity linear in the
//! step (`T_midpoint_linearised_alpha`), and with a step's own transmittance taken at its
//! start, middle or end (`L_transmittance_at_step_*`).

use super::{U, scenes};
use glam::DVec3;
use serde_json::Value;
use volref::geometry::Span;
use volref::optics::Layer;
use volref::optics::{TransferFunction, over_length};
use volref::render::classified::steps::Steps;

fn entries(case: &str) -> Vec<Value> {
    let text = include_str!("../../../fixtures/known-answers/compositing.json");
    let file: Value = serde_json::from_str(text).unwrap();
    let entries = file["entries"].as_array().unwrap().iter().cloned();
    let entries: Vec<_> = entries
        .filter(|entry| entry["inputs"]["case"] == case)
        .collect();
    assert!(!entries.is_empty(), "no entry for {case:?}");
    entries
}

fn input(entry: &Value, name: &str) -> f64 {
    entry["inputs"][name].as_f64().unwrap()
}

fn expected(entry: &Value, name: &str) -> f64 {
    entry["expected"][name].as_f64().unwrap()
}

#[track_caller]
fn assert_within(entry: &Value, found: f64, expected: f64, bound: f64) {
    let id = &entry["id"];
    assert!(
        (found - expected).abs() <= bound,
        "{id}: {found:e} is not {expected:e}"
    );
}

#[test]
fn every_entry_has_a_test() {
    let text = include_str!("../../../fixtures/known-answers/compositing.json");
    let file: Value = serde_json::from_str(text).unwrap();
    let cases = [
        "N identical samples",
        "opacity correction",
        "front-to-back sequence",
        "ray march, linear density",
        "ray march, constant emission",
    ];
    let tested: usize = cases.iter().map(|case| entries(case).len()).sum();
    assert_eq!(file["entries"].as_array().unwrap().len(), tested);
}

#[test]
fn identical_samples() {
    for entry in entries("N identical samples") {
        let (alpha, count) = (input(&entry, "alpha"), input(&entry, "N"));
        let mut layers = Layer::EMPTY;
        for _ in 0..count as u64 {
            layers = layers.over(Layer::sample(DVec3::ZERO, alpha));
        }
        let opacity = expected(&entry, "opacity");
        // The sum rounds by u of at most the final opacity in every step; the two roundings of
        // each term add up to 2u of it, the expected number has one.
        let bound = (count + 3.0) * U * opacity;
        assert_within(&entry, layers.opacity, opacity, bound);
        // A rounding for 1 − α and one for its product, and u of the expected number.
        let transmittance = expected(&entry, "transmittance");
        let bound = (2.0 * count + 1.0) * U * transmittance;
        assert_within(&entry, layers.transparency, transmittance, bound);
        // In one go: 2u + u + 2u, and u of the expected number.
        assert_within(
            &entry,
            over_length(alpha, count),
            opacity,
            6.0 * U * opacity,
        );
    }
}

#[test]
fn opacity_correction() {
    for entry in entries("opacity correction") {
        let ratio = input(&entry, "ds") / input(&entry, "ds0");
        let found = over_length(input(&entry, "alpha0"), ratio);
        // As above, and u for the ratio.
        let alpha = expected(&entry, "alpha");
        assert_within(&entry, found, alpha, 7.0 * U * alpha);
        assert_within(
            &entry,
            1.0 - found,
            expected(&entry, "one_minus_alpha"),
            8.0 * U,
        );
    }
}

#[test]
fn sequences() {
    for entry in entries("front-to-back sequence") {
        let pairs = entry["inputs"]["alpha_color_not_premultiplied"]
            .as_array()
            .unwrap();
        let samples: Vec<(f64, f64)> = pairs
            .iter()
            .map(|pair| (pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap()))
            .collect();
        let layers = samples
            .iter()
            .map(|&(opacity, colour)| Layer::sample(DVec3::splat(colour * opacity), opacity));
        for layers in in_both_orders(layers) {
            // At most 5u a sample (see `order.rs`), u for each product with its opacity and u
            // of the expected number; colours are at most 2.
            let bound = (6 * samples.len() + 1) as f64 * U;
            let colour = expected(&entry, "color_premultiplied");
            assert_within(&entry, layers.colour.x, colour, 2.0 * bound);
            assert_within(&entry, layers.opacity, expected(&entry, "opacity"), bound);
        }
    }
}

/// These samples composited front to back, and back to front.
fn in_both_orders(samples: impl DoubleEndedIterator<Item = Layer> + Clone) -> [Layer; 2] {
    [
        samples.clone().fold(Layer::EMPTY, Layer::over),
        samples.rfold(Layer::EMPTY, |behind, sample| sample.over(behind)),
    ]
}

/// A ray through a slab of the entry's `length`, in its number of `steps`, with an extinction along z. With floor 0 and
/// a reference length of 1 the transfer function is `T = exp(−d²)` per length: a density is the root of an extinction.
fn march(entry: &Value, sigma: impl Fn(f64) -> f64) -> [Layer; 2] {
    let length = input(entry, "length");
    let transfer_function = TransferFunction {
        appearance: scenes::formula(0.0, "white"),
        reference_length: 1.0,
    };
    let steps = Steps::over(Span::new(0.0, length), length / input(entry, "steps"));
    let samples: Vec<Layer> = (0..steps.count())
        .map(|index| {
            let (t, length) = steps.sample(index);
            let density = sigma(t).sqrt();
            let opacity = transfer_function.opacity(density, length);
            let radiance = transfer_function.colour(density) * transfer_function.emission(density);
            Layer::sample(radiance * opacity, opacity)
        })
        .collect();
    in_both_orders(samples.into_iter())
}

#[test]
fn linear_density() {
    for entry in entries("ray march, linear density") {
        let (sigma0, a) = (input(&entry, "sigma0"), input(&entry, "a"));
        let sigma = |t: f64| sigma0 * (1.0 + a * t);
        for layers in march(&entry, sigma) {
            // Extinction along the way rounds 8 times up to σ, root and square 3 times more;
            // x·e^(−x) < 1 keeps that below 11u of opacity, and a sample has 6u and rounds 5u.
            let bound = (17.0 + 5.0 * input(&entry, "steps") + 1.0) * U;
            for name in ["T_exact", "T_midpoint_exponential"] {
                assert_within(&entry, layers.transparency, expected(&entry, name), bound);
            }
        }
    }
}

#[test]
fn constant_emission() {
    for entry in entries("ray march, constant emission") {
        let (emission, sigma) = (input(&entry, "j"), input(&entry, "sigma_t"));
        for layers in march(&entry, |_| sigma) {
            // A classified sample emits d² = σ per opacity; this one is to emit j/σ.
            let radiance = layers.colour.x * (emission / (sigma * sigma));
            let bound = (17.0 + 5.0 * input(&entry, "steps") + 1.0) * U;
            for name in ["L_exact", "L_per_step_analytic"] {
                assert_within(&entry, radiance, expected(&entry, name), bound);
            }
        }
    }
}
