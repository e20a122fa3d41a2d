//! The Henyey–Greenstein phase function.

use super::deflection::{Asymmetry, Deflection};
use std::f64::consts::PI;

/// The phase function `p = (1 − g²) / (4π (1 + g² − 2g cos θ)^(3/2))`, per steradian.
///
/// `θ` is the angle between the directions of travel before and after scattering; `g > 0` is
/// forward. Integrates to 1 over the sphere, with mean cosine `g`. At `g = 0` every formula below
/// is exact, so isotropic scattering needs no separate code and gives the same bits.
///
/// Source: Henyey & Greenstein 1941, ApJ 93, 70–83.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein(pub Asymmetry);

impl HenyeyGreenstein {
    /// The phase function at a deflection, per steradian; also the density with which
    /// [`HenyeyGreenstein::deflection`] chooses that direction. Relative error at most 14 · 2^-53;
    /// measured on 100 000 pairs of `g` and a cosine: at most 4.6 ulp.
    pub fn per_steradian(&self, deflection: &Deflection) -> f64 {
        let g = self.0.g();
        let squared = self.squared_distance(deflection);
        ((1.0 - g) * (1.0 + g) / squared) / (4.0 * PI * squared.sqrt())
    }

    /// Probability that the cosine is at most that of `deflection`:
    /// `(1 − g)(1 + cos θ) / (r (1 + g + r))`, `r² = 1 + g² − 2g cos θ`.
    ///
    /// The textbook's difference of reciprocals, `(1 − g²)/2g · (1/r − 1/(1 + g))`, as one
    /// fraction: without cancellation or division by `g`. Relative error at most 12 · 2^-53;
    /// measured on 100 000 pairs of `g` and a cosine: at most 5.6 ulp.
    pub fn cdf(&self, deflection: &Deflection) -> f64 {
        let g = self.0.g();
        let r = self.squared_distance(deflection).sqrt();
        (1.0 - g) * deflection.one_plus_cos / (r * (1.0 + g + r))
    }

    /// The deflection at the quantile `u` of the cosine: the inverse of [`HenyeyGreenstein::cdf`].
    /// Rises with `u`, from straight back at 0 to straight on at 1.
    ///
    /// In units of 2^-53 the distances from ±1 are off by at most 13, relatively; the cosine itself,
    /// apart from a rounding of it and one of `2u − 1`, by 13 of the difference of these two. Measured
    /// on 100 000 pairs of `g` and `u`, either of them close to its ends in half: 7.1 (and 7.1 ulp)
    /// and 4.2.
    pub fn deflection(&self, u: f64) -> Deflection {
        self.deflection_between(u, 1.0 - u, 2.0 * u - 1.0)
    }

    /// The same by the shares `below` and `above` that sum to 1, each as exact as it can be, and
    /// their difference.
    pub(super) fn deflection_between(&self, below: f64, above: f64, balance: f64) -> Deflection {
        let g = self.0.g();
        if g >= 0.0 {
            forward(g, below, above, balance)
        } else {
            // 1 − g + 2gu would cancel.
            forward(-g, above, below, -balance).mirrored()
        }
    }

    /// `1 + g² − 2g cos θ`, from the end that the peak is at: both terms are positive.
    fn squared_distance(&self, deflection: &Deflection) -> f64 {
        let g = self.0.g().abs();
        let from_peak = if self.0.g() >= 0.0 {
            deflection.one_minus_cos
        } else {
            deflection.one_plus_cos
        };
        (1.0 - g) * (1.0 - g) + 2.0 * g * from_peak
    }
}

/// The inverse for `g ≥ 0` at `u`, with `above = 1 − u` and `balance = 2u − 1`, which the caller
/// forms where they are exact. With `D = 1 − g + 2gu`:
///
/// ```text
/// 1 − cos θ = 2 (1 − g)² (1 − u) (1 + gu) / D²
/// 1 + cos θ = 2 (1 + g)² u (1 − g + gu) / D²
///     cos θ = 2u − 1 + 2gu (1 − u) ((1 − g)(3 + g) + 4gu) / D²
/// ```
///
/// No factor is a difference except `1 − g` and `1 − u`, of numbers that are given.
fn forward(g: f64, u: f64, above: f64, balance: f64) -> Deflection {
    let gap = 1.0 - g;
    let gu = g * u;
    let denominator = gap + 2.0 * gu;
    let back = gap / denominator;
    let ahead = (1.0 + g) / denominator;
    let shift = 2.0 * gu * above * (gap * (3.0 + g) + 4.0 * gu) / (denominator * denominator);
    Deflection {
        cos: (balance + shift).clamp(-1.0, 1.0),
        one_minus_cos: 2.0 * (back * back) * (above * (1.0 + gu)),
        one_plus_cos: 2.0 * (ahead * ahead) * (u * (gap + gu)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn isotropic_scattering_is_exact() {
        let phase = HenyeyGreenstein(Asymmetry::ISOTROPIC);
        for i in 0..=64 {
            let u = f64::from(i) / 64.0;
            let deflection = phase.deflection(u);
            assert_eq!(deflection, Deflection::from_cos(2.0 * u - 1.0));
            assert_eq!(phase.per_steradian(&deflection), 1.0 / (4.0 * PI));
            assert_eq!(phase.cdf(&deflection), u);
        }
    }

    #[test]
    fn forward_is_positive() {
        let phase = HenyeyGreenstein(Asymmetry::new(0.5).unwrap());
        let at = |cos| phase.per_steradian(&Deflection::from_cos(cos));
        assert!(at(1.0) > at(0.0) && at(0.0) > at(-1.0));
    }
}
