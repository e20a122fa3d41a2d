//! Pixels that the largest code of an image of 8 bits may have cut off, left out of a comparison.
//!
//! A cut-off makes means too dark, the more so the more noise there is. Whether it may have met a pixel must not
//! be judged by that pixel: without those that were met, the others are too dark. Nor by the variance that it states,
//! which is large where a wild sample made it bright. So it is judged by the
//! reference and the noise that the test image has on the whole: a pixel is left out if its reference and
//! [`DEVIATIONS`] standard errors are above the largest code. By Chebyshev's inequality one of sixteen of the
//! others, at most, is met, and of normal noise one in 30,000.
//!
//! The loss of a mean by a cut-off at a distance of Δ is (√(σ² + Δ²) − Δ)/2 at most (Scarf 1958, "A min-max solution of
//! an inventory problem"), a sixteenth of its standard error σ at four of them, which adds up over an image. Where
//! the test image states its noise, that is allowed for as rounding is; else only as far as half a code is as large. Simulated images of all cases are not rejected (`tests/library/precision.rs`).

use super::comparison::Comparison;
use crate::film::Film;

/// Standard errors of the noise of a pixel.
const DEVIATIONS: f64 = 4.0;

/// Two images, of which pixels are left out: black in both, without noise.
pub(super) struct WithinCodes {
    pub reference: Film,
    pub test: Film,
    pub left_out: Vec<bool>,
    pub share_left_out: f64,
}

impl WithinCodes {
    /// The images without the pixels that `test` may cut off; `None` where it is not quantised.
    pub fn of(reference: &Film, test: &Film, level: f64) -> Option<WithinCodes> {
        let quantisation = test.quantisation()?;
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
        let count_left_out = left_out.iter().filter(|is| **is).count();
        Some(WithinCodes {
            reference: reference.without(&left_out),
            test: test.without(&left_out),
            share_left_out: count_left_out as f64 / count as f64,
            left_out,
        })
    }
}
