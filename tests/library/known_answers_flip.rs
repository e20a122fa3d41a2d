//! FLIP of stored image pairs, against values of NVIDIA's tool.
//!
//! The tool works in float32; each entry says in `abs_tol` what that leaves uncertain. Entries
//! for HDR-FLIP, another measure on the same file, are not read: this crate has LDR-FLIP only,
//! and their images are not stored here.

use std::path::{Path, PathBuf};

use serde_json::Value;
use volref::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, ErrorMap, SrgbImage, flip};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/known-answers")
}

fn read_png(name: &Value) -> SrgbImage {
    let path = fixtures().join(name.as_str().expect("a file name"));
    let image = image::open(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .into_rgb8();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let pixels = image.pixels().map(|pixel| pixel.0).collect();
    SrgbImage::new(width, height, pixels).expect("as many pixels as the size says")
}

fn mean_square_code_difference(reference: &SrgbImage, test: &SrgbImage) -> f64 {
    let codes = |image: &SrgbImage| image.pixels().as_flattened().to_vec();
    let (reference, test) = (codes(reference), codes(test));
    let squares = reference.iter().zip(&test).map(|(&r, &t)| {
        let difference = (f64::from(r) - f64::from(t)) / 255.0;
        difference * difference
    });
    squares.sum::<f64>() / reference.len() as f64
}

/// The error that `percent` of the pixels do not exceed: linear between order statistics.
fn percentile(errors: &ErrorMap, percent: f64) -> f64 {
    let mut sorted = errors.values().to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let position = percent / 100.0 * (sorted.len() - 1) as f64;
    let below = position.floor() as usize;
    let above = (below + 1).min(sorted.len() - 1);
    sorted[below] + (position - below as f64) * (sorted[above] - sorted[below])
}

fn statistic(name: &str, errors: &ErrorMap) -> f64 {
    match name {
        "mean" => errors.mean(),
        "min" => percentile(errors, 0.0),
        "max" => errors.max(),
        "p50" => percentile(errors, 50.0),
        "p75" => percentile(errors, 75.0),
        "p95" => percentile(errors, 95.0),
        "p99" => percentile(errors, 99.0),
        "weighted_median" => errors.weighted_percentile(50.0),
        "weighted_p99" => errors.weighted_percentile(99.0),
        _ => panic!("unknown statistic {name}"),
    }
}

/// Compares every statistic of `expected`; gives how many there were.
fn check(id: &str, expected: &Value, errors: &ErrorMap, tolerance: f64) -> usize {
    let mut checked = 0;
    for (name, value) in expected.as_object().expect("named statistics") {
        let Some(value) = value.as_f64().filter(|_| name != "mse_srgb_code_values") else {
            continue;
        };
        let ours = statistic(name, errors);
        assert!(
            (ours - value).abs() <= tolerance,
            "{id} {name}: {ours} instead of {value} ± {tolerance:e}"
        );
        println!("{id} {name}: {:.1e} off", (ours - value).abs());
        checked += 1;
    }
    checked
}

#[test]
fn every_ldr_entry() {
    let text = std::fs::read_to_string(fixtures().join("flip.json")).expect("the fixture");
    let file: Value = serde_json::from_str(&text).expect("JSON");
    let mut entries = 0;
    let mut statistics = 0;
    for entry in file["entries"].as_array().expect("entries") {
        let inputs = &entry["inputs"];
        if inputs["dynamic_range"] != "LDR" {
            continue;
        }
        let id = entry["id"].as_str().expect("an id");
        let (reference, test) = (read_png(&inputs["reference"]), read_png(&inputs["test"]));
        let tolerance = entry["abs_tol"].as_f64().expect("abs_tol");
        let expected = &entry["expected"];

        let pixels_per_degree = inputs["ppd"].as_f64().expect("ppd");
        let errors = flip(&reference, &test, pixels_per_degree).expect("valid input");
        statistics += check(id, expected, &errors, tolerance);
        if let Some(mse) = expected["mse_srgb_code_values"].as_f64() {
            // Not FLIP: shows that the images are read as they were meant.
            assert!((mean_square_code_difference(&reference, &test) - mse).abs() < 1e-12);
        }
        if let Some(expected) = expected.get("at_default_ppd") {
            let errors = flip(&reference, &test, DEFAULT_PIXELS_PER_DEGREE).expect("valid input");
            statistics += check(id, expected, &errors, tolerance);
        }
        entries += 1;
    }
    assert_eq!((entries, statistics), (6, 5 * 2 * 9 + 2));
}
