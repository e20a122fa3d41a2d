//! Worked numbers of tests between noisy images, from `fixtures/known-answers/`.

use serde_json::Value;
use volref::compare::significance::{critical, deviation, two_sided};
use volref::math::{exp_m1, ln_1p};

fn entries() -> Vec<Value> {
    let text = include_str!("../../fixtures/known-answers/image_statistics.json");
    let file: Value = serde_json::from_str(text).unwrap();
    file["entries"].as_array().unwrap().clone()
}

/// The numbers are given to nine digits.
fn assert_close(found: f64, entry: &Value, name: &str) {
    let expected = entry["expected"][name].as_f64().unwrap();
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs(),
        "{}: {name} is {found}, expected {expected}",
        entry["id"]
    );
}

fn entries_of(case: &str) -> Vec<Value> {
    let mut found = entries();
    found.retain(|entry| entry["inputs"]["case"].as_str().unwrap().starts_with(case));
    found
}

#[test]
fn a_pixel_against_a_known_variance() {
    let entries = entries_of("one pixel");
    assert_eq!(entries.len(), 5);
    for entry in &entries {
        let input = |name: &str| entry["inputs"][name].as_f64().unwrap();
        // The floor under the variance is part of that rule, not of ours.
        let variance = input("reference_variance_per_sample").max(1e-4);
        assert_close(variance, entry, "clamped_variance");
        let difference = input("test_mean") - input("reference_mean");
        let z = deviation(difference, variance / input("spp"));
        assert_close(z.abs(), entry, "z");
        assert_close(two_sided(z), entry, "p_value");
        // Of so many independent tests together: Šidák 1967, JASA 62, 626–633.
        let tests = input("width") * input("height");
        let level = -exp_m1(ln_1p(-input("significance_level")) / tests);
        assert_close(level, entry, "alpha_sidak");
        assert_close(critical(level), entry, "z_critical");
        let accepted = entry["expected"]["pixel_accepted"].as_bool().unwrap();
        assert_eq!(two_sided(z) > level, accepted);
        assert_eq!(z.abs() < critical(level), accepted);
    }
}

#[test]
fn two_noisy_means() {
    let entries = entries_of("two noisy images");
    assert_eq!(entries.len(), 1);
    for entry in &entries {
        let input = |name: &str| entry["inputs"][name].as_f64().unwrap();
        let variance = input("variance_a") / input("n_a") + input("variance_b") / input("n_b");
        let z = deviation(input("mean_a") - input("mean_b"), variance);
        assert_close(z, entry, "z");
        assert_close(two_sided(z), entry, "p_value");
    }
}
