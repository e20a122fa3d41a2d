//! What a medium does to light per unit of length.

use crate::math::exp;
use glam::DVec3;
use thiserror::Error;

/// Absorption and scattering, per world length and colour channel; finite and not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    sigma_a: DVec3,
    sigma_s: DVec3,
}

/// A coefficient is negative, infinite or not a number.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{name} must be finite and not negative in every channel, got {value}")]
pub struct InvalidCoefficient {
    /// `sigma_a`, `sigma_s` or `sigma_t`, their sum.
    pub name: &'static str,
    /// What was given.
    pub value: DVec3,
}

impl Coefficients {
    /// Checks the coefficients.
    ///
    /// # Errors
    ///
    /// [`InvalidCoefficient`], also where both are finite and their sum is not.
    pub fn new(sigma_a: DVec3, sigma_s: DVec3) -> Result<Coefficients, InvalidCoefficient> {
        let sigma_t = sigma_a + sigma_s;
        for (name, value) in [
            ("sigma_a", sigma_a),
            ("sigma_s", sigma_s),
            ("sigma_t", sigma_t),
        ] {
            if !value.is_finite() || value.min_element() < 0.0 {
                return Err(InvalidCoefficient { name, value });
            }
        }
        Ok(Coefficients { sigma_a, sigma_s })
    }

    /// Absorption, per world length.
    pub fn sigma_a(&self) -> DVec3 {
        self.sigma_a
    }

    /// Scattering, per world length.
    pub fn sigma_s(&self) -> DVec3 {
        self.sigma_s
    }

    /// Extinction, their sum, per world length.
    pub fn sigma_t(&self) -> DVec3 {
        self.sigma_a + self.sigma_s
    }

    /// The share of extinction that scatters, in [0, 1]; 0 where there is no extinction.
    pub fn albedo(&self) -> DVec3 {
        let sigma_t = self.sigma_t();
        DVec3::from_array(std::array::from_fn(|channel| {
            // A sum of numbers that are not negative is 0 only if both are.
            if sigma_t[channel] == 0.0 {
                return 0.0;
            }
            self.sigma_s[channel] / sigma_t[channel]
        }))
    }
}

/// Weight, by channel, of a collision whose distance was sampled by one channel, all equally
/// likely: `σ_c T_c / mean_k(σ_k T_k)`, between 0 and 3. The albedo is not in it.
///
/// Numerator and denominator underflow together, so only their ratios are formed,
/// `σ_k/σ_c · e^(τ_c − τ_k)`: at any depth a grey medium has the weight 1, exactly.
///
/// Domain: `sigma_t`, the extinction there, positive in the channel that was sampled by;
/// `depth ≥ 0`, the optical depth up to there, finite in that channel.
pub fn collision_weight(sigma_t: DVec3, depth: DVec3) -> DVec3 {
    weight(|c, k| {
        if sigma_t[c] == 0.0 {
            return f64::INFINITY;
        }
        if sigma_t[k] == 0.0 {
            return 0.0;
        }
        sigma_t[k] / sigma_t[c] * exp(difference(depth[c], depth[k]))
    })
}

/// Weight, by channel, of a flight that left the media after the optical `depth`, its distance
/// having been sampled as for [`collision_weight`]: `T_c / mean_k(T_k)`, between 0 and 3.
pub fn escape_weight(depth: DVec3) -> DVec3 {
    weight(|c, k| exp(difference(depth[c], depth[k])))
}

/// `3 / Σ_k ratio(c, k)`. A ratio that overflows is the weight 0.
fn weight(ratio: impl Fn(usize, usize) -> f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        3.0 / (ratio(c, 0) + ratio(c, 1) + ratio(c, 2))
    }))
}

/// `a − b`, where equal depths differ by nothing, infinite ones too.
fn difference(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { a - b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficients_are_checked() {
        let fog = Coefficients::new(DVec3::ONE, DVec3::new(3.0, 1.0, 0.0)).unwrap();
        assert_eq!(fog.sigma_t(), DVec3::new(4.0, 2.0, 1.0));
        assert_eq!(fog.albedo(), DVec3::new(0.75, 0.5, 0.0));
        let vacuum = Coefficients::new(DVec3::ZERO, DVec3::ZERO).unwrap();
        assert_eq!(vacuum.albedo(), DVec3::ZERO);
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let bad = DVec3::new(0.0, bad, 0.0);
            assert_eq!(
                Coefficients::new(bad, DVec3::ZERO).unwrap_err().name,
                "sigma_a"
            );
            assert_eq!(
                Coefficients::new(DVec3::ZERO, bad).unwrap_err().name,
                "sigma_s"
            );
        }
        let huge = DVec3::splat(f64::MAX);
        assert_eq!(Coefficients::new(huge, huge).unwrap_err().name, "sigma_t");
    }

    #[test]
    fn a_channel_without_extinction_never_collides_and_always_escapes() {
        let sigma_t = DVec3::new(0.0, 2.0, 2.0);
        assert_eq!(
            collision_weight(sigma_t, sigma_t),
            DVec3::new(0.0, 1.5, 1.5)
        );
        let endless = DVec3::new(0.0, f64::INFINITY, f64::INFINITY);
        assert_eq!(escape_weight(endless), DVec3::new(3.0, 0.0, 0.0));
        assert_eq!(escape_weight(DVec3::INFINITY), DVec3::ONE);
    }
}
