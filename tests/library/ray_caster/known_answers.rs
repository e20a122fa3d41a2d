//! Compositing and marching against numbers from outside.
//!
//! Not tested, because the ray caster takes its samples in the middle of steps and gives each
//! the exact opacity of its length: the marching sums with samples at the ends of steps
//! (`T_left_endpoint_exponential`, `T_right_endpoint_exponential`), with opacity linear in the
//! step (`T_midpoint_linearised_alpha`), and with a step's own transmittance taken at its
//! start, middle or end (`L_transmittance_at_step_*`).

use super::{U, scenes};
use crate::common::entries::Entry;
use glam::DVec3;
use volref::geometry::Span;
use volref::optics::Layer;
use volref::optics::{TransferFunction, over_length};
use volref::render::classified::steps::Steps;

const ENTRIES: &str = include_str!("../../../fixtures/known-answers/compositing.json");

fn entries(case: &str) -> Vec<Entry> {
    let mut entries = Entry::all(ENTRIES);
    entries.retain(|entry| entry.case() == case);
    assert!(!entries.is_empty(), "no entry for {case:?}");
    entries
}

#[track_caller]
fn assert_within(entry: &Entry, found: f64, expected: f64, bound: f64) {
    let id = entry.id();
    assert!(
        (found - expected).abs() <= bound,
        "{id}: {found:e} is not {expected:e}"
    );
}

#[test]
fn every_entry_has_a_test() {
    let cases = [
        "N identical samples",
        "opacity correction",
        "front-to-back sequence",
        "ray march, linear density",
        "ray march, constant emission",
    ];
    let tested: usize = cases.iter().map(|case| entries(case).len()).sum();
    assert_eq!(Entry::all(ENTRIES).len(), tested);
}

#[test]
fn identical_samples() {
    for entry in entries("N identical samples") {
        let (alpha, count) = (entry.input("alpha"), entry.input("N"));
        let mut layers = Layer::EMPTY;
        for _ in 0..count as u64 {
            layers = layers.over(Layer::sample(DVec3::ZERO, alpha));
        }
        let opacity = entry.expected("opacity");
        // The sum rounds by u of at most the final opacity in every step; the two roundings of
        // each term add up to 2u of it, the expected number has one.
        let bound = (count + 3.0) * U * opacity;
        assert_within(&entry, layers.opacity, opacity, bound);
        // A rounding for 1 − α and one for its product, and u of the expected number.
        let transmittance = entry.expected("transmittance");
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
        let ratio = entry.input("ds") / entry.input("ds0");
        let found = over_length(entry.input("alpha0"), ratio);
        // As above, and u for the ratio.
        let alpha = entry.expected("alpha");
        assert_within(&entry, found, alpha, 7.0 * U * alpha);
        assert_within(
            &entry,
            1.0 - found,
            entry.expected("one_minus_alpha"),
            8.0 * U,
        );
    }
}

#[test]
fn sequences() {
    for entry in entries("front-to-back sequence") {
        let pairs = entry.0["inputs"]["alpha_color_not_premultiplied"]
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
            let colour = entry.expected("color_premultiplied");
            assert_within(&entry, layers.colour.x, colour, 2.0 * bound);
            assert_within(&entry, layers.opacity, entry.expected("opacity"), bound);
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
fn march(entry: &Entry, sigma: impl Fn(f64) -> f64) -> [Layer; 2] {
    let length = entry.input("length");
    let transfer_function = TransferFunction {
        appearance: scenes::formula(0.0, "white"),
        reference_length: 1.0,
    };
    let steps = Steps::over(Span::new(0.0, length), length / entry.input("steps"));
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
        let (sigma0, a) = (entry.input("sigma0"), entry.input("a"));
        let sigma = |t: f64| sigma0 * (1.0 + a * t);
        for layers in march(&entry, sigma) {
            // Extinction along the way rounds 8 times up to σ, root and square 3 times more;
            // x·e^(−x) < 1 keeps that below 11u of opacity, and a sample has 6u and rounds 5u.
            let bound = (17.0 + 5.0 * entry.input("steps") + 1.0) * U;
            for name in ["T_exact", "T_midpoint_exponential"] {
                assert_within(&entry, layers.transparency, entry.expected(name), bound);
            }
        }
    }
}

#[test]
fn constant_emission() {
    for entry in entries("ray march, constant emission") {
        let (emission, sigma) = (entry.input("j"), entry.input("sigma_t"));
        for layers in march(&entry, |_| sigma) {
            // A classified sample emits d² = σ per opacity; this one is to emit j/σ.
            let radiance = layers.colour.x * (emission / (sigma * sigma));
            let bound = (17.0 + 5.0 * entry.input("steps") + 1.0) * U;
            for name in ["L_exact", "L_per_step_analytic"] {
                assert_within(&entry, radiance, entry.expected(name), bound);
            }
        }
    }
}
