//! Exponential integrals.

use crate::math;

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// `E₁(x) = ∫ e^(−x/μ) dμ/μ` over [0, 1], for x > 0.
///
/// By its series up to 1, and by its continued fraction beyond, whose terms fall as e^(−4√(nx)).
///
/// Source: Abramowitz & Stegun 1964, *Handbook of Mathematical Functions*, 5.1.11 and 5.1.22.
pub fn e1(x: f64) -> f64 {
    if x <= 1.0 {
        let (mut sum, mut term) = (0.0, 1.0);
        // (−x)ⁿ/n! is below 2⁻⁵³ from n = 18 on.
        for n in 1..=20 {
            term *= -x / f64::from(n);
            sum -= term / f64::from(n);
        }
        return sum - math::ln(x) - EULER;
    }
    // Backwards from a tail that is nothing at x = 1 already.
    let mut tail = 0.0;
    for n in (1..=100).rev() {
        let n = f64::from(n);
        tail = n / (1.0 + n / (x + tail));
    }
    math::exp(-x) / (x + tail)
}

/// `E₂(x) = ∫ e^(−x/μ) dμ` over [0, 1], for x ≥ 0.
pub fn e2(x: f64) -> f64 {
    if x == 0.0 {
        return 1.0;
    }
    math::exp(-x) - x * e1(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz & Stegun, tables 5.1 and 5.2, and mpmath.
    #[test]
    fn tabulated_values() {
        for (x, right) in [
            (0.01, 4.037_929_576_538_114),
            (0.5, 0.559_773_594_776_160_8),
            (1.0, 0.219_383_934_395_520_3),
            (1.000_001, 0.219_383_566_516_447),
            (2.0, 0.048_900_510_708_061_12),
            (10.0, 4.156_968_929_685_324e-6),
        ] {
            assert!((e1(x) / right - 1.0).abs() < 1e-14, "{x}: {:e}", e1(x));
        }
        assert!((e2(1.0) / 0.148_495_506_775_922_05 - 1.0).abs() < 1e-14);
    }
}
