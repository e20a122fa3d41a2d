//! Deflections, and the asymmetry of their distribution.

use crate::geometry::{InvalidParameter, require};
use crate::math::Direction;
use crate::math::sampling::from_cosine;

/// The asymmetry parameter `g` of a phase function: −1 < g < 1, positive forward. The mean cosine
/// of the Henyey–Greenstein function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asymmetry(f64);

impl Asymmetry {
    /// Isotropic scattering.
    pub const ISOTROPIC: Asymmetry = Asymmetry(0.0);

    /// Checks `g`.
    ///
    /// # Errors
    ///
    /// At ±1 light goes straight on or back and is not scattered; these values, those beyond and
    /// NaN are refused.
    pub fn new(g: f64) -> Result<Asymmetry, InvalidParameter> {
        let message = format_args!("the asymmetry g must lie strictly between -1 and 1, got {g}");
        require(g.abs() < 1.0, "g", message)?;
        Ok(Asymmetry(g))
    }

    /// `g` itself.
    pub fn g(self) -> f64 {
        self.0
    }
}

/// A deflection, by the cosine of the angle between the directions of travel before and after: 1 is
/// straight on.
///
/// A cosine near ±1 has no digits left for the angle, so the distances from both are kept too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deflection {
    /// `cos θ`, in [−1, 1].
    pub cos: f64,
    /// `1 − cos θ`, in [0, 2].
    pub one_minus_cos: f64,
    /// `1 + cos θ`, in [0, 2].
    pub one_plus_cos: f64,
}

impl Deflection {
    /// The deflection with the given cosine, in [−1, 1]. Exactly that: the differences from ±1 are
    /// rounded once at most.
    pub fn from_cos(cos: f64) -> Deflection {
        Deflection {
            cos,
            one_minus_cos: 1.0 - cos,
            one_plus_cos: 1.0 + cos,
        }
    }

    /// `sin θ ≥ 0`.
    pub fn sine(&self) -> f64 {
        (self.one_minus_cos * self.one_plus_cos).sqrt()
    }

    /// The direction after this deflection from +z, at the fraction `v` of a turn around it.
    #[inline]
    pub fn direction(&self, v: f64) -> Direction {
        from_cosine(self.cos, self.sine(), v)
    }

    pub(super) fn mirrored(self) -> Deflection {
        Deflection {
            cos: -self.cos,
            one_minus_cos: self.one_plus_cos,
            one_plus_cos: self.one_minus_cos,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn asymmetry_is_checked() {
        assert_eq!(Asymmetry::new(0.9).map(Asymmetry::g), Ok(0.9));
        for g in [1.0, -1.0, 1.5, f64::INFINITY] {
            assert_eq!(
                Asymmetry::new(g),
                Err(InvalidParameter {
                    name: "g",
                    message: format!("the asymmetry g must lie strictly between -1 and 1, got {g}"),
                })
            );
        }
        assert!(Asymmetry::new(f64::NAN).is_err());
    }
}
