//! The phase function of fog and clouds: water droplets.

use super::deflection::{Asymmetry, Deflection};
use super::draine::Draine;
use super::henyey_greenstein::HenyeyGreenstein;
use crate::geometry::{InvalidParameter, require};
use crate::math::exp;
use std::fmt;

/// Scattering by water droplets larger than the wavelength of light: a narrow Henyey–Greenstein
/// lobe and a wide one of [`Draine`], fitted to Mie's theory over the visible spectrum.
///
/// Source: Jendersie & d'Eon 2023, "An approximate Mie scattering function for fog and cloud
/// rendering", SIGGRAPH Talks, no. 47, eq. 4 to 7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Droplets {
    diameter: f64,
    narrow: HenyeyGreenstein,
    wide: Draine,
    /// Weight of the wide lobe.
    weight: f64,
}

impl Droplets {
    /// Droplets of a `diameter` in micrometres, in [5, 50].
    ///
    /// # Errors
    ///
    /// [`InvalidParameter`].
    pub fn new(diameter: f64) -> Result<Droplets, InvalidParameter> {
        let d = diameter;
        let message =
            format_args!("the diameter of droplets must lie in [5, 50] micrometres, got {d}");
        require((5.0..=50.0).contains(&d), "diameter", message)?;
        // In this range both g lie in (0.5, 1) and α in (16, 33).
        let narrow = Asymmetry::new(exp(-0.099_056_7 / (d - 1.671_54)))?;
        let wide = Asymmetry::new(exp(-2.206_79 / (d + 3.910_29) - 0.428_934))?;
        let alpha = exp(3.624_89 - 8.292_88 / (d + 5.528_25));
        Ok(Droplets {
            diameter,
            narrow: HenyeyGreenstein(narrow),
            wide: Draine::new(wide, alpha)?,
            weight: exp(-0.599_085 / (d - 0.641_583) - 0.665_888),
        })
    }

    /// The narrow lobe, the wide one, and the weight of the wide one.
    pub fn lobes(&self) -> (HenyeyGreenstein, Draine, f64) {
        (self.narrow, self.wide, self.weight)
    }

    /// The same lobes with `edit` of their `g`.
    pub(super) fn with_asymmetry(&self, edit: impl Fn(Asymmetry) -> Asymmetry) -> Droplets {
        Droplets {
            narrow: HenyeyGreenstein(edit(self.narrow.0)),
            wide: self.wide.with_asymmetry(edit),
            ..*self
        }
    }

    /// The phase function at a deflection, per steradian.
    pub fn per_steradian(&self, deflection: &Deflection) -> f64 {
        let narrow = self.narrow.per_steradian(deflection);
        narrow + self.weight * (self.wide.per_steradian(deflection) - narrow)
    }

    /// The deflection for `u`, uniform in [0, 1): its lower part samples the wide lobe, the rest
    /// the narrow one.
    pub fn deflection(&self, u: f64) -> Deflection {
        if u < self.weight {
            self.wide.deflection(u / self.weight)
        } else {
            self.narrow
                .deflection((u - self.weight) / (1.0 - self.weight))
        }
    }

    /// Mean cosine.
    pub fn mean_cosine(&self) -> f64 {
        let narrow = self.narrow.0.g();
        narrow + self.weight * (self.wide.mean_cosine() - narrow)
    }
}

impl fmt::Display for Droplets {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "droplets of {} micrometres", self.diameter)
    }
}
