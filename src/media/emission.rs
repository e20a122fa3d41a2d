//! Light that a homogeneous medium sends to the viewer, itself absorbing part of it.
//!
//! `t` is the distance from the viewer, where the medium begins; behind its length `L` lies what
//! is behind it. Emission per length `j` and source `S` are related by `j = σ S`.

use super::optical_depth::{opacity, optical_depth, source_factor, transmittance};

/// Radiance of a constant source `S`: `S (1 − e^(−τ))`, exactly `S` where nothing shines through.
pub fn constant_source(source: f64, depth: f64) -> f64 {
    source * opacity(depth)
}

/// Radiance of the emission `j ≥ 0` per length: `∫₀^L j e^(−σt) dt`.
///
/// An endless medium is meant too: `j/σ`, infinite where nothing absorbs.
pub fn constant_emission(j: f64, sigma_t: f64, length: f64) -> f64 {
    if j == 0.0 {
        return 0.0;
    }
    j * visible_length(sigma_t, length)
}

/// Radiance of the emission `j0 + j1·t` per length: `∫₀^L (j0 + j1·t) e^(−σt) dt`.
///
/// Domain: not negative anywhere on the path. Where `j1 < 0` the two terms cancel as far as the
/// emission itself does.
pub fn linear_emission(j0: f64, j1: f64, sigma_t: f64, length: f64) -> f64 {
    let constant = constant_emission(j0, sigma_t, length);
    if j1 == 0.0 {
        return constant;
    }
    constant + j1 * visible_moment(sigma_t, length)
}

/// Radiance that arrives through a layer which adds `emitted` of its own.
pub fn through_layer(emitted: f64, depth: f64, behind: f64) -> f64 {
    emitted + transmittance(depth) * behind
}

/// `∫₀^L e^(−σt) dt`: the length that is seen.
fn visible_length(sigma_t: f64, length: f64) -> f64 {
    if length.is_infinite() {
        return 1.0 / sigma_t;
    }
    length * source_factor(optical_depth(sigma_t, length))
}

/// `∫₀^L t e^(−σt) dt`.
fn visible_moment(sigma_t: f64, length: f64) -> f64 {
    if length.is_infinite() {
        return 1.0 / (sigma_t * sigma_t);
    }
    length * length * first_moment(optical_depth(sigma_t, length))
}

/// `∫₀¹ x e^(−τx) dx = (1 − (1 + τ) e^(−τ))/τ²`; ½ at 0.
fn first_moment(depth: f64) -> f64 {
    if depth < 2.0 {
        // The closed form cancels here; e^(−τ) Σ τ^k/(k + 2)! has positive terms only. At
        // τ = 2 the 24th is 2^24/26! = 4e-20 of a sum above ½.
        let mut sum = 0.0;
        for k in (0..24).rev() {
            sum = (1.0 + sum * depth) / f64::from(k + 2);
        }
        return transmittance(depth) * sum;
    }
    // From 2 on the difference keeps at least 1 − 3e^(−2) = 0.59: under two roundings are lost.
    // In two quotients, since the square may overflow.
    (opacity(depth) / depth - transmittance(depth)) / depth
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
        assert_eq!(linear_emission(0.0, 4.0, 2.0, endless), 1.0);
        assert_eq!(linear_emission(1.0, 0.0, 2.0, endless), 0.5);
    }

    #[test]
    fn the_two_forms_of_the_first_moment_meet() {
        let (below, above) = (first_moment(2.0_f64.next_down()), first_moment(2.0));
        assert!((below / above - 1.0).abs() < 8.0 * f64::EPSILON);
        assert_eq!(first_moment(0.0), 0.5);
    }
}
