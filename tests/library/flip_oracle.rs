//! Our FLIP against NVIDIA's, pixel by pixel.
//!
//! The oracle (crate `nv-flip`) takes 8-bit sRGB codes, red first, and works in float32
//! throughout. Ours works in double precision, and agrees to 1e-5 at every pixel where FLIP is
//! well conditioned. Elsewhere float32 itself is further off than that:
//!
//! * **no feature difference** (d ≫ 0, m ≈ 0, for instance flat regions of different
//!   brightness). Derivative weights sum to zero only up to rounding, so float32 sums leave
//!   strengths of some 1e-7 where the exact ones are zero, and `ΔE_f = √(m/√2)` turns 1e-7 into
//!   3e-4. Seen: 1e-4 on an inverted checkerboard. Our own formulas in float32 come much nearer to the
//!   oracle there (printed for each pair) than double precision does.
//! * **next to no colour difference** (d ≈ 0, m ≫ 0, for instance the rim of an edge's
//!   blur). L* near 100 has a float32 spacing of 8e-6, and `ΔE_c = 0.058 d^0.7` turns 8e-6 into
//!   2e-5, which the exponent `1 − ΔE_f` raises further. Seen: 6e-4 beside shifted edges.
//!
//! So the bound at each pixel is derived: FLIP rises with d and with m, so in float32 it lies
//! between its values at (d − δd, m − δm) and (d + δd, m + δm), with δd and δm what float32 does
//! to d and m. These are reckoned at [`COLOUR_ERROR`] and [`FEATURE_ERROR`], and checked by
//! running the same formulas in float32 and in double precision; the oracle has no part in it.
#![cfg(flip_oracle)]

use crate::support::pairs::{Pair, varied};
use crate::support::plain_flip::{Pixel, colour_difference, feature_difference, join, plain_flip};
use volref::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};

/// The aim, and what holds where FLIP is well conditioned.
const TOLERANCE: f64 = 1e-5;

/// δd. The largest term is `a* = 500 (x − y)` with x and y cube roots up to 1, each rounded by up
/// to 3e-8: 500·2·3e-8 = 3e-5 in each image, 6e-5 in both. L*, b* and earlier roundings add to it.
const COLOUR_ERROR: f64 = 1e-4;

/// δm. A strength is a sum of 19 products (7 at 20 pixels per degree) whose partial sums reach
/// 1, and every addition below 1 rounds by up to 3e-8: at most 19·3e-8 = 6e-7 from each image,
/// mostly of differing signs.
const FEATURE_ERROR: f64 = 1e-6;

/// Colour distance from which the float32 error of d moves FLIP
/// by about the tolerance at most: 0.7·0.058·d^(−0.3)·1e-4 = 1e-5 at d = 0.05.
const CLEAR_COLOUR: f64 = 0.05;

/// The same for features: `ΔE_f` moves by δm/(2√(√2 m)), FLIP by at most `|E ln E|` ≤ 0.37 times
/// that, which is 1e-5 at m = 2.4e-4.
const CLEAR_FEATURE: f64 = 2.4e-4;

/// Rounding of the final powers in float32: half an ulp each of 1, in base and result.
const FINAL_ROUNDING: f64 = 2e-7;

/// Pixels per degree in the oracle's float32, so that both see the same viewing condition.
fn viewing_conditions() -> [f32; 3] {
    [DEFAULT_PIXELS_PER_DEGREE as f32, 67.0, 20.0]
}

fn oracle_flip(pair: &Pair, pixels_per_degree: f32) -> Vec<f64> {
    let image = |image: &SrgbImage| {
        let (width, height) = (image.width() as u32, image.height() as u32);
        nv_flip::FlipImageRgb8::with_data(width, height, image.pixels().as_flattened())
    };
    nv_flip::flip(image(&pair.reference), image(&pair.test), pixels_per_degree)
        .to_vec()
        .into_iter()
        .map(f64::from)
        .collect()
}

fn largest(differences: impl Iterator<Item = f64>) -> f64 {
    differences.fold(0.0, f64::max)
}

fn flip_at(colour_distance: f64, feature_distance: f64) -> f64 {
    join(
        colour_difference(colour_distance.max(0.0)),
        feature_difference(feature_distance.max(0.0)),
    )
}

/// How far below and above its exact value float32 may put FLIP.
fn float32_bounds(exact: Pixel) -> (f64, f64) {
    let (d, m) = (exact.colour_distance, exact.feature_distance);
    (
        flip_at(d - COLOUR_ERROR, m - FEATURE_ERROR) - FINAL_ROUNDING,
        flip_at(d + COLOUR_ERROR, m + FEATURE_ERROR) + FINAL_ROUNDING,
    )
}

#[test]
fn every_pixel_of_every_pair() {
    let pairs = varied();
    assert!(pairs.len() >= 12);
    for ppd in viewing_conditions() {
        println!("at {ppd} pixels per degree: largest difference to the oracle");
        for pair in &pairs {
            compare(pair, ppd);
        }
    }
}

fn compare(pair: &Pair, ppd: f32) {
    let name = pair.name;
    let oracle = oracle_flip(pair, ppd);
    let ppd = f64::from(ppd);
    let ours = flip(&pair.reference, &pair.test, ppd).expect("valid input");
    let ours = ours.values();
    let exact = plain_flip::<f64>(&pair.reference, &pair.test, ppd);
    let single = plain_flip::<f32>(&pair.reference, &pair.test, ppd);
    assert_eq!((ours.len(), exact.len()), (oracle.len(), oracle.len()));

    let change = |of: fn(&Pixel) -> f64| {
        largest(
            exact
                .iter()
                .zip(&single)
                .map(|(e, s)| (of(e) - of(s)).abs()),
        )
    };
    let colour_error = change(|pixel| pixel.colour_distance);
    let feature_error = change(|pixel| pixel.feature_distance);

    assert!(colour_error <= COLOUR_ERROR, "{name}: {colour_error:e}");
    assert!(feature_error <= FEATURE_ERROR, "{name}: {feature_error:e}");

    let (mut worst, mut worst_clear, mut beyond) = (0.0_f64, 0.0_f64, 0);
    let mut worst_single = 0.0_f64;
    for i in 0..oracle.len() {
        // Plain sums leave 1e-16 where ours leave zero: √1e-16 is the 1e-8.
        let sums = (ours[i] - exact[i].error).abs();
        assert!(
            sums < 1e-8,
            "{name}, pixel {i}: ours {sums:e} from plain sums"
        );

        let difference = (ours[i] - oracle[i]).abs();
        worst = worst.max(difference);
        beyond += usize::from(difference > TOLERANCE);
        let clear_colour = exact[i].colour_distance > CLEAR_COLOUR;
        if clear_colour && exact[i].feature_distance > CLEAR_FEATURE {
            worst_clear = worst_clear.max(difference);
        }
        if clear_colour {
            worst_single = worst_single.max((single[i].error - oracle[i]).abs());
        }
        let (low, high) = float32_bounds(exact[i]);
        assert!(
            (low..=high).contains(&oracle[i]),
            "{name}, pixel {i}: oracle {} outside {low} to {high}, ours {}",
            oracle[i],
            ours[i],
        );
    }
    println!(
        "{name:26} {worst:.1e}, above 1e-5 at {beyond} of {}; well conditioned {worst_clear:.1e}; \
         our float32 where colours differ {worst_single:.1e}; δd {colour_error:.1e} δm {feature_error:.1e}",
        oracle.len()
    );
    assert!(worst_clear <= TOLERANCE, "{name}: {worst_clear:e}");
}
