//! Pixels that the largest code of an image of 8 bits may have cut off, left out of a comparison.
//!
//! A cut-off makes means too dark, the more so the more noise there is. Whether it may have met a pixel must not
//! be judged by that pixel: without those that were met, the others are too dark. Nor by the variance that it states,
//! which is large where a wild sample made it bright. So it is judged by the
//! reference and the noise that the test image has on the whole: a pixel is left out if its reference and
//! [`DEVIATIONS`] standard errors are above the largest code. By Chebyshev's inequality one of sixteen of the
//! others, at most, is met, and of normal noise one in 30,000.
//!
//! A reference of fewer samples than the test image would leave out pixels by its own noise, and the others would be
//! too dark in it. Then the neighbours of a pixel decide, in the test image and by what it states of them: their noise
//! is independent of the pixel's.
//!
//! The loss of a mean by a cut-off at a distance of Δ is (√(σ² + Δ²) − Δ)/2 at most (Scarf 1958, "A min-max solution of
//! an inventory problem"), a sixteenth of its standard error σ at four of them, which adds up over an image. Where
//! the test image states its noise, that is allowed for as rounding is; else only as far as half a code is as large. Simulated images of all cases are not rejected (`tests/library/precision.rs`).

use super::comparison::Comparison;
use super::variance::Stated;
use crate::compare::around;
use crate::film::{Film, Quantisation};

/// Standard errors of the noise of a pixel.
const DEVIATIONS: f64 = 4.0;

/// Two images, of which pixels are left out: black in both, without noise.
pub(super) struct WithinCodes {
    pub reference: Film,
    pub test: Film,
    pub share_left_out: f64,
}

impl WithinCodes {
    /// The images without the pixels that `test` may cut off; `None` where it is not quantised.
    pub fn of(reference: &Film, test: &Film, level: f64) -> Option<WithinCodes> {
        let quantisation = test.quantisation()?;
        let left_out = if Stated::by(test) > Stated::by(reference) {
            beside_cut_off(test, quantisation)
        } else {
            by_reference(reference, test, quantisation, level)
        };
        Some(WithinCodes {
            reference: reference.without(&left_out),
            test: test.without(&left_out),
            share_left_out: left_out.iter().filter(|is| **is).count() as f64
                / left_out.len() as f64,
        })
    }
}

/// Pixels that the largest code may cut off by a reference that is no noisier than the test image.
fn by_reference(
    reference: &Film,
    test: &Film,
    quantisation: Quantisation,
    level: f64,
) -> Vec<bool> {
    let count = reference.radiance().len();
    // The noise of the test image, from what is cut off for certain in no way.
    let mut left_out: Vec<bool> = (0..count)
        .map(|index| quantisation.cuts_off(reference.radiance()[index]))
        .collect();
    let [certain, certain_test] = [reference, test].map(|film| film.without(&left_out));
    let comparison = Comparison::new(&certain, &certain_test, level);
    let largest = quantisation.largest();
    // Each of which was cut off, with its own noise.
    let renderings = f64::from(test.renderings().unwrap_or(1));
    for (index, is_left_out) in left_out.iter_mut().enumerate() {
        for c in 0..3 {
            let radiance = f64::from(reference.radiance()[index][c]);
            let stated = [reference, test].map(|film| film.variance_at(index, c));
            let [_, guard] = comparison.shape.guard(stated, radiance);
            let error = (guard * renderings).sqrt();
            *is_left_out |= error > 0.0 && radiance + DEVIATIONS * error > largest;
        }
    }
    left_out
}

/// Pixels with a neighbour in `test`, which states its noise, that the largest code may cut off.
fn beside_cut_off(test: &Film, quantisation: Quantisation) -> Vec<bool> {
    let (width, height) = (test.width(), test.height());
    let renderings = f64::from(test.renderings().unwrap_or(1));
    let may_be_cut_off = |index: usize| {
        (0..3).any(|c| {
            let error = (test.variance_at(index, c) * renderings).sqrt();
            f64::from(test.radiance()[index][c]) + DEVIATIONS * error > quantisation.largest()
        })
    };
    let may_be: Vec<bool> = (0..width * height).map(may_be_cut_off).collect();
    let is_left_out = |index: usize| {
        let mut others = around(index, [width, height], 1);
        others.any(|other| other != index && may_be[other])
    };
    (0..width * height).map(is_left_out).collect()
}
