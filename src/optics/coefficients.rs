//! Absorption and scattering coefficients of a medium.

use crate::geometry::{InvalidParameter, require};
use crate::math::exp;
use glam::DVec3;

/// Absorption and scattering, per world length and colour channel; finite and not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    sigma_a: DVec3,
    sigma_s: DVec3,
}

impl Coefficients {
    /// Checks the coefficients.
    ///
    /// # Errors
    ///
    /// [`InvalidParameter`], also where both are finite and their sum is not.
    pub fn new(sigma_a: DVec3, sigma_s: DVec3) -> Result<Coefficients, InvalidParameter> {
        let sigma_t = sigma_a + sigma_s;
        for (name, value) in [
            ("sigma_a", sigma_a),
            ("sigma_s", sigma_s),
            ("sigma_t", sigma_t),
        ] {
            let is_coefficient = value.is_finite() && value.min_element() >= 0.0;
            let message = format_args!(
                "{name} must be finite and not negative in every channel, got {value}"
            );
            require(is_coefficient, name, message)?;
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

    /// The fraction of extinction that scatters, in [0, 1]; 0 without extinction.
    pub fn albedo(&self) -> DVec3 {
        albedo(self.sigma_s, self.sigma_t())
    }
}

/// The share of `sigma_s` in the extinction, by channel; 0 without extinction.
pub(crate) fn albedo(sigma_s: DVec3, sigma_t: DVec3) -> DVec3 {
    DVec3::select(sigma_t.cmpeq(DVec3::ZERO), DVec3::ZERO, sigma_s / sigma_t)
}

/// The channel by which a distance is sampled, chosen by `u`, uniform in [0, 1), in proportion to
/// `shares`, which are not negative and not all 0.
///
/// The shares are the throughput of a path. With equal shares in every flight its weights would
/// multiply to 3^n, with a probability of 3^(−n), in the sampled channel.
pub(crate) fn sampled_channel(shares: DVec3, u: f64) -> usize {
    let share = u * (shares.x + shares.y + shares.z);
    if share < shares.x {
        0
    } else if share < shares.x + shares.y {
        1
    } else {
        2
    }
}

/// Weight, by channel, of a collision whose distance was sampled by `sampled_channel`: with
/// `p` the shares normalized to a sum of 1, `σ_c T_c / Σ_k p_k σ_k T_k`, between 0 and `1/p_c`; 0
/// without a share. The albedo is not included.
///
/// So the weighted shares have the same sum as the shares, for any medium.
///
/// Numerator and denominator underflow together, so only their ratios are formed,
/// `σ_k/σ_c · e^(τ_c − τ_k)`: at any depth a grey medium has the weight 1, exactly.
///
/// Domain: `sigma_t`, the extinction there, positive in the channel that was sampled by;
/// `depth ≥ 0`, the optical depth up to there, finite in that channel; `survived`, by channel up
/// to a common factor, the probability of the null collisions of a tracker on the way, by which
/// `T_c` is multiplied: 1 if there were none, positive in that channel.
pub fn collision_weight(shares: DVec3, sigma_t: DVec3, depth: DVec3, survived: DVec3) -> DVec3 {
    weight(shares, |c, k| {
        if sigma_t[c] == 0.0 {
            return f64::INFINITY;
        }
        if sigma_t[k] == 0.0 {
            return 0.0;
        }
        sigma_t[k] / sigma_t[c] * survival([depth[k], depth[c]], [survived[k], survived[c]])
    })
}

/// Weight, by channel, of a flight that left the media after the optical `depth`, its distance
/// having been sampled as for [`collision_weight`]: `T_c / Σ_k p_k T_k`, between 0 and `1/p_c`.
pub fn escape_weight(shares: DVec3, depth: DVec3, survived: DVec3) -> DVec3 {
    weight(shares, |c, k| {
        survival([depth[k], depth[c]], [survived[k], survived[c]])
    })
}

/// Probability of survival in channel `k` relative to channel `c`, by depths and null collisions of
/// `[k, c]`. A path that has not survived in channel `c` has no weight in it: there the ratio is
/// infinite.
fn survival(depth: [f64; 2], survived: [f64; 2]) -> f64 {
    // Before any product: a vanishing ratio times an overflowing one would be no number.
    if survived[1] == 0.0 {
        return f64::INFINITY;
    }
    if survived[0] == 0.0 {
        return 0.0;
    }
    exp(difference(depth[1], depth[0])) * (survived[0] / survived[1])
}

/// `Σ_k s_k / Σ_k s_k ratio(c, k)` where channel `c` has a share `s_c`, else 0. Both sums in the
/// same order: equal channels have the weight 1, exactly. A ratio that overflows is the weight 0.
fn weight(shares: DVec3, ratio: impl Fn(usize, usize) -> f64) -> DVec3 {
    let all = shares.x + shares.y + shares.z;
    DVec3::from_array(std::array::from_fn(|c| {
        if shares[c] == 0.0 {
            return 0.0;
        }
        // Without a share nothing is added, be the ratio infinite.
        let part = |k: usize| match shares[k] {
            0.0 => 0.0,
            share => share * ratio(c, k),
        };
        all / (part(0) + part(1) + part(2))
    }))
}

/// `a − b`, and 0 for equal depths, even infinite ones.
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
            collision_weight(DVec3::ONE, sigma_t, sigma_t, DVec3::ONE),
            DVec3::new(0.0, 1.5, 1.5)
        );
        let endless = DVec3::new(0.0, f64::INFINITY, f64::INFINITY);
        let escaped = |depth| escape_weight(DVec3::ONE, depth, DVec3::ONE);
        assert_eq!(escaped(endless), DVec3::new(3.0, 0.0, 0.0));
        assert_eq!(escaped(DVec3::INFINITY), DVec3::ONE);
    }

    #[test]
    fn channels_are_sampled_by_their_shares() {
        let chosen = |shares, u| sampled_channel(shares, u);
        let last = 1.0 - f64::EPSILON / 2.0;
        let thirds = [0.0, 0.34, 0.67, last].map(|u| chosen(DVec3::ONE, u));
        assert_eq!(thirds, [0, 1, 2, 2]);
        let shares = DVec3::new(1.0, 0.0, 3.0);
        let uneven = [0.0, 0.24, 0.25, last].map(|u| chosen(shares, u));
        assert_eq!(uneven, [0, 0, 2, 2]);
        assert_eq!(chosen(DVec3::Y, 0.0), 1);
        assert_eq!(chosen(DVec3::Z, 0.0), 2);
        assert_eq!(chosen(DVec3::X, last), 0);
    }

    #[test]
    fn shares_times_weights_keep_their_sum() {
        let shares = DVec3::new(0.7, 0.1, 2.0);
        let sigma_t = DVec3::new(0.3, 4.0, 1e3);
        for depth in [DVec3::ZERO, sigma_t * 0.01, sigma_t * 2.0] {
            for weight in [
                collision_weight(shares, sigma_t, depth, DVec3::ONE),
                escape_weight(shares, depth, DVec3::ONE),
            ] {
                let sum = (shares * weight).element_sum();
                assert!((sum - 2.8).abs() <= 16.0 * f64::EPSILON, "{sum}");
            }
        }
        let dark = DVec3::new(0.0, 0.3, 0.7);
        let sigma_t = DVec3::new(1e300, 2.0, 2.0);
        assert_eq!(
            collision_weight(dark, sigma_t, sigma_t, DVec3::ONE),
            DVec3::new(0.0, 1.0, 1.0)
        );
        assert_eq!(
            escape_weight(dark, sigma_t, DVec3::ONE),
            DVec3::new(0.0, 1.0, 1.0)
        );
    }

    #[test]
    fn null_collisions_weigh_as_much_as_the_depth_they_stand_for() {
        let (shares, sigma_t) = (DVec3::new(0.7, 0.1, 2.0), DVec3::new(0.3, 4.0, 1.0));
        let depth = DVec3::new(0.2, 1.0, 0.5);
        let survived = DVec3::from_array(depth.to_array().map(|depth| exp(-depth)));
        let (by_depth, by_chance) = (
            collision_weight(shares, sigma_t, depth, DVec3::ONE),
            collision_weight(shares, sigma_t, DVec3::ZERO, survived),
        );
        assert!((by_depth - by_chance).abs().max_element() < 1e-15);
        // What cannot have got there carries nothing, and takes nothing from the others.
        let gone = DVec3::new(1.0, 0.0, 1.0);
        assert_eq!(escape_weight(DVec3::ONE, DVec3::ZERO, gone), gone * 1.5);
        // Each of two channels is gone for its own reason: one is too deep, one had no null
        // collision.
        let (deep, survived) = (DVec3::new(800.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.8));
        let weights = escape_weight(DVec3::ONE, deep, survived);
        assert_eq!(weights, DVec3::new(0.0, 0.0, 3.0));
    }
}
