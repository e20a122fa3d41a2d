//! What FLIP must do on any images.

use crate::support::pairs::{Pair, constant, image, random_pixel, varied};
use crate::support::plain_flip::{colour_difference, plain_flip};
use proptest::prelude::*;
use volref::compare::flip::{
    DEFAULT_PIXELS_PER_DEGREE, ErrorMap, SrgbImage, flip, pixels_per_degree,
};

const PPD: f64 = DEFAULT_PIXELS_PER_DEGREE;

fn errors(reference: &SrgbImage, test: &SrgbImage) -> ErrorMap {
    flip(reference, test, PPD).expect("valid input")
}

fn bits(errors: &ErrorMap) -> Vec<u64> {
    errors
        .values()
        .iter()
        .map(|value| value.to_bits())
        .collect()
}

#[test]
fn the_default_viewing_condition() {
    assert!((PPD - 67.020_643_276_582_25).abs() < 1e-13);
    // A display of half the pixels per metre at twice the distance looks the same.
    assert_eq!(pixels_per_degree(1.4, 1.4 / 3840.0), PPD);
}

#[test]
fn equal_images_have_no_error_at_all() {
    for Pair {
        reference, test, ..
    } in varied()
    {
        for image in [reference, test] {
            assert!(errors(&image, &image).values().iter().all(|&e| e == 0.0));
        }
    }
}

#[test]
fn either_image_may_be_the_reference() {
    for Pair {
        name,
        reference,
        test,
    } in varied()
    {
        let (there, back) = (errors(&reference, &test), errors(&test, &reference));
        assert_eq!(bits(&there), bits(&back), "{name}");
    }
}

/// Black and white differ by L* = 100 and nothing else, and have no features:
/// `ΔE = 0.95 + 0.05 (100^0.7 − 0.4 c)/(0.6 c)` with `c = HyAB(green, blue)^0.7`. With the L*a*b*
/// of the sRGB primaries, green (87.735, −86.183, 83.180) and blue (32.299, 79.191, −107.861),
/// the Hunt-adjusted colours are (87.735, −75.612, 72.978) and (32.299, 25.578, −34.838), HyAB is
/// 55.436 + √(101.190² + 107.816²) = 203.30, c = 41.28, and ΔE = 0.96738.
#[test]
fn black_against_white() {
    let error = errors(&constant(30, 20, [0; 3]), &constant(30, 20, [255; 3]));
    for &value in error.values() {
        assert!((value - 0.967_38).abs() < 1e-5, "{value}");
    }
    assert!(error.values().iter().all(|&value| value == error.max()));
}

#[test]
fn constant_colours_have_no_feature_difference() {
    for (seed, size) in [(1, (1, 1)), (2, (3, 5)), (3, (40, 30)), (4, (64, 1))] {
        let (width, height) = size;
        let [first, second] = [0, 1].map(|i| constant(width, height, random_pixel(seed, i)));
        let plain = plain_flip::<f64>(&first, &second, PPD)[0];
        let expected = colour_difference(plain.colour_distance);
        for &value in errors(&first, &second).values() {
            // A feature difference of no more than 1e-10 would already show.
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for Pair {
        name,
        reference,
        test,
    } in varied()
    {
        let [one, two, three] = [1, 2, 3].map(|threads| {
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a thread pool")
                .install(|| errors(&reference, &test))
        });
        assert_eq!(bits(&one), bits(&two), "{name}");
        assert_eq!(bits(&one), bits(&three), "{name}");
        assert_eq!(one.mean().to_bits(), three.mean().to_bits(), "{name}");
    }
}

#[test]
fn bad_input_is_refused() {
    let (small, large) = (constant(2, 3, [0; 3]), constant(3, 2, [0; 3]));
    let said = flip(&small, &large, PPD).unwrap_err().to_string();
    assert!(said.contains("(2, 3)") && said.contains("(3, 2)"), "{said}");
    for ppd in [0.0, -67.0, 0.999, 1e5, f64::NAN, f64::INFINITY] {
        let said = flip(&small, &small, ppd).unwrap_err().to_string();
        assert!(said.contains("pixels per degree"), "{said}");
    }
    assert!(SrgbImage::new(0, 3, vec![]).is_err());
    assert!(SrgbImage::new(2, 2, vec![[0; 3]; 3]).is_err());
    assert!(SrgbImage::new(usize::MAX, 2, vec![]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn errors_are_between_zero_and_one(
        width in 1_usize..24,
        height in 1_usize..24,
        seed: u64,
        ppd in 1.0..200.0_f64,
        extreme: bool,
    ) {
        let random = |offset: usize| image(width, height, |x, y| {
            let pixel = random_pixel(seed, offset + y * width + x);
            if extreme { pixel.map(|code| if code < 128 { 0 } else { 255 }) } else { pixel }
        });
        let (reference, test) = (random(0), random(1000));
        for &error in flip(&reference, &test, ppd).expect("valid input").values() {
            prop_assert!((0.0..=1.0).contains(&error), "{error}");
        }
    }

}
