//! Emission of a homogeneous medium along a ray, with its own absorption.

use super::optical_depth::{optical_depth, source_factor};

/// Radiance of the emission `j ≥ 0` per length: `∫₀^L j e^(−σt) dt`.
///
/// For an unbounded medium `j/σ`, infinite without absorption.
pub fn constant_emission(j: f64, sigma_t: f64, length: f64) -> f64 {
    emission_over(j, visible_length(sigma_t, length))
}

/// Radiance of the emission `j ≥ 0` per length over a [visible length](visible_length); nothing of
/// no emission, however far it is seen.
pub(crate) fn emission_over(j: f64, visible: f64) -> f64 {
    if j == 0.0 { 0.0 } else { j * visible }
}

/// `∫₀^L e^(−σt) dt`.
pub(crate) fn visible_length(sigma_t: f64, length: f64) -> f64 {
    if length.is_infinite() {
        return 1.0 / sigma_t;
    }
    length * source_factor(optical_depth(sigma_t, length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endless_media() {
        let endless = f64::INFINITY;
        assert_eq!(constant_emission(3.0, 2.0, endless), 1.5);
        assert_eq!(constant_emission(0.0, 0.0, endless), 0.0);
        assert_eq!(constant_emission(1.0, 0.0, endless), endless);
    }
}
