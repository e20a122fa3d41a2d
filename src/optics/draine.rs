//! The phase function of Draine: dust, molecules (Rayleigh) and Cornette & Shanks.

use super::deflection::{Asymmetry, Deflection};
use super::henyey_greenstein::HenyeyGreenstein;
use crate::geometry::{InvalidParameter, require};
use std::fmt;

/// The Henyey–Greenstein function with parameter `g` times `(1 + α cos²θ)/N`, per steradian, where
/// `N = 1 + α (1 + 2g²)/3` normalizes the integral to 1.
///
/// At `g = 0`, `α = 1` Rayleigh's function, at `α = 1` that of Cornette & Shanks 1992, at `α = 0`
/// that of Henyey & Greenstein, to the bit.
///
/// Sources: Draine 2003, "Scattering by interstellar dust grains. I", ApJ 598, 1017–1025; Jendersie
/// & d'Eon 2023, "An approximate Mie scattering function for fog and cloud rendering", SIGGRAPH
/// Talks, no. 47, whose inverse of the distribution a test compares with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draine {
    henyey_greenstein: HenyeyGreenstein,
    alpha: f64,
}

/// Relative step of Newton's method that is its last: 2^-40.
const ROOT: f64 = 1.0 / (1_u64 << 40) as f64;

impl Draine {
    /// The function with parameters `g` and `alpha`.
    ///
    /// # Errors
    ///
    /// [`InvalidParameter`].
    pub fn new(g: Asymmetry, alpha: f64) -> Result<Draine, InvalidParameter> {
        let message = format_args!("alpha must be finite and not negative, got {alpha}");
        require(alpha.is_finite() && alpha >= 0.0, "alpha", message)?;
        Ok(Draine {
            henyey_greenstein: HenyeyGreenstein(g),
            alpha,
        })
    }

    /// The parameter `g`, which is not the mean cosine.
    pub fn asymmetry(&self) -> Asymmetry {
        self.henyey_greenstein.0
    }

    /// The parameter `α`.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Rayleigh's function.
    pub fn is_rayleigh(&self) -> bool {
        self.asymmetry() == Asymmetry::ISOTROPIC && self.alpha == 1.0
    }

    /// The same with `edit` of its `g`.
    pub(super) fn with_asymmetry(&self, edit: impl Fn(Asymmetry) -> Asymmetry) -> Draine {
        Draine {
            henyey_greenstein: HenyeyGreenstein(edit(self.asymmetry())),
            alpha: self.alpha,
        }
    }

    /// The phase function at a deflection, per steradian. Relative error at most 24 · 2^-53: 14 of
    /// [`HenyeyGreenstein::per_steradian`], 3 of the factor, 5 of its norm, a product and a quotient.
    pub fn per_steradian(&self, deflection: &Deflection) -> f64 {
        let factor = 1.0 + self.alpha * (deflection.cos * deflection.cos);
        self.henyey_greenstein.per_steradian(deflection) * (factor / self.norm())
    }

    /// Mean cosine, `g (1 + α (3 + 2g²)/5)/N`.
    pub fn mean_cosine(&self) -> f64 {
        let g = self.asymmetry().g();
        g * (1.0 + self.alpha * (3.0 + 2.0 * g * g) / 5.0) / self.norm()
    }

    fn norm(&self) -> f64 {
        let g = self.asymmetry().g();
        1.0 + self.alpha * (1.0 + 2.0 * g * g) / 3.0
    }

    /// The deflection at the quantile `u` of the cosine; rises with `u` from straight back at 0 to
    /// straight on at 1.
    ///
    /// It is the deflection of the Henyey–Greenstein function at another quantile `v`, the root of
    /// `v + α W(v) = N u`, where `W(v) = ∫₀^v cos² dv` has a closed form. The left side rises by
    /// `1 + α cos²`, so the root lies between `N u/(1 + α)` and `N u`, and is as well conditioned
    /// as the function itself.
    pub fn deflection(&self, u: f64) -> Deflection {
        if self.alpha == 0.0 {
            return self.henyey_greenstein.deflection(u);
        }
        let g = self.asymmetry().g();
        // From the end that is nearer, so that small shares keep their digits.
        let (below, above) = if u <= 0.5 {
            let below = self.share(g, u);
            (below, 1.0 - below)
        } else {
            let above = self.share(-g, 1.0 - u);
            (1.0 - above, above)
        };
        self.henyey_greenstein
            .deflection_between(below, above, below - above)
    }

    /// The root of `v + α W(v) = N u` for the parameter `g`, `u` in [0, ½]: Newton's method between
    /// bounds that shrink around the root, so that it ends.
    fn share(&self, g: f64, u: f64) -> f64 {
        let goal = self.norm() * u;
        let (mut low, mut high) = (goal / (1.0 + self.alpha), goal.min(1.0));
        let mut v = low;
        // Steps that leave the bounds halve them, which 64 times leaves nothing to choose.
        for _ in 0..64 {
            let (integral, cosine) = squared_cosines(g, v);
            let excess = v + self.alpha * integral - goal;
            if excess > 0.0 {
                high = v;
            } else {
                low = v;
            }
            let step = v - excess / (1.0 + self.alpha * cosine * cosine);
            let next = if low <= step && step <= high {
                step
            } else {
                low + 0.5 * (high - low)
            };
            // The error of a step is the square of that before, times half the rate at which the
            // logarithm of the derivative changes: 2^-80 of it is a rounding for any α up to 1e15.
            let is_rounding = (next - v).abs() <= ROOT * v;
            v = next;
            if is_rounding {
                break;
            }
        }
        v
    }
}

/// `∫₀^v cos² dv` over the share `v` of light that the Henyey–Greenstein function of parameter `g`
/// scatters below a cosine, and that cosine. With `D = 1 − g + 2gv`, `k = 1 − g`, `m = 1 − g + g²`:
///
/// ```text
/// cos = 2v − 1 + 2gv (1 − v)(k (3 + g) + 4gv)/D²
/// ∫   = v (6g (1 + g²)² v³ + 4k m² v² − 6k² m v + 3k³)/(3D³)
/// ```
///
/// The cosine is the inverse distribution; the integral is that of its square, as one fraction
/// without a division by `g`.
fn squared_cosines(g: f64, v: f64) -> (f64, f64) {
    let k = 1.0 - g;
    let m = k + g * g;
    let squared = 1.0 + g * g;
    let gv = g * v;
    let d = k + 2.0 * gv;
    let cosine = (2.0 * v - 1.0) + 2.0 * gv * (1.0 - v) * (k * (3.0 + g) + 4.0 * gv) / (d * d);
    let cubic = 6.0 * g * squared * squared * v + 4.0 * k * m * m;
    let polynomial = (cubic * v - 6.0 * k * k * m) * v + 3.0 * k * k * k;
    (v * polynomial / (3.0 * d * d * d), cosine)
}

impl fmt::Display for Draine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (g, alpha) = (self.asymmetry().g(), self.alpha);
        if self.is_rayleigh() {
            f.write_str("Rayleigh")
        } else {
            write!(f, "Draine, g = {g}, alpha = {alpha}")
        }
    }
}
