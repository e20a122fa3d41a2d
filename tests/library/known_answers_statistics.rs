//! Worked numbers of tests between noisy images, from `fixtures/known-answers/`.

use crate::common::entries::Entry;
use volref::compare::significance::{critical, deviation, two_sided};
use volref::math::{exp_m1, ln_1p};

fn entries_of(case: &str) -> Vec<Entry> {
    let text = include_str!("../../fixtures/known-answers/image_statistics.json");
    let mut found = Entry::all(text);
    found.retain(|entry| entry.case().starts_with(case));
    found
}

#[test]
fn a_pixel_against_a_known_variance() {
    let entries = entries_of("one pixel");
    assert_eq!(entries.len(), 5);
    for entry in &entries {
        let input = |name: &str| entry.input(name);
        // The floor under the variance is part of that rule, not of ours.
        let variance = input("reference_variance_per_sample").max(1e-4);
        entry.is("clamped_variance", variance);
        let difference = input("test_mean") - input("reference_mean");
        let z = deviation(difference, variance / input("spp"));
        entry.is("z", z.abs());
        entry.is("p_value", two_sided(z));
        // Of so many independent tests together: Šidák 1967, JASA 62, 626–633.
        let tests = input("width") * input("height");
        let level = -exp_m1(ln_1p(-input("significance_level")) / tests);
        entry.is("alpha_sidak", level);
        entry.is("z_critical", critical(level));
        let accepted = entry.0["expected"]["pixel_accepted"].as_bool().unwrap();
        assert_eq!(two_sided(z) > level, accepted);
        assert_eq!(z.abs() < critical(level), accepted);
    }
}

#[test]
fn two_noisy_means() {
    let entries = entries_of("two noisy images");
    assert_eq!(entries.len(), 1);
    for entry in &entries {
        let input = |name: &str| entry.input(name);
        let variance = input("variance_a") / input("n_a") + input("variance_b") / input("n_b");
        let z = deviation(input("mean_a") - input("mean_b"), variance);
        entry.is("z", z);
        entry.is("p_value", two_sided(z));
    }
}
