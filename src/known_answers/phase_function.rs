//! Henyey and Greenstein's phase function, as its source has it.

use std::f64::consts::PI;

/// Henyey and Greenstein's phase function, per steradian; g > 0 is forward.
///
/// Source: Henyey & Greenstein 1941, ApJ 93, 70–83, eq. 2.
pub fn phase_function(g: f64, cosine: f64) -> f64 {
    let squared = 1.0 + g * g - 2.0 * g * cosine;
    (1.0 - g * g) / (4.0 * PI * squared * squared.sqrt())
}
