//! Phase functions: the directions of scattered light.

use super::deflection::{Asymmetry, Deflection};
use super::draine::Draine;
use super::droplets::Droplets;
use super::henyey_greenstein::HenyeyGreenstein;
use crate::geometry::forward;
use std::fmt;

/// The phase function of a medium.
///
/// A new one has a file beside this one, a variant here, a key in `scene/radiative/phases.rs` and a
/// line in each exporter that can say it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// Henyey & Greenstein 1941; isotropic at `g = 0`.
    HenyeyGreenstein(HenyeyGreenstein),
    /// Draine 2003; Rayleigh's at `g = 0`, `α = 1`.
    Draine(Draine),
    /// Droplets of water, Jendersie & d'Eon 2023.
    Droplets(Droplets),
}

impl Phase {
    /// Isotropic scattering.
    pub const ISOTROPIC: Phase = Phase::HenyeyGreenstein(HenyeyGreenstein(Asymmetry::ISOTROPIC));

    /// The Henyey–Greenstein function of mean cosine `g`.
    pub fn henyey_greenstein(g: Asymmetry) -> Phase {
        Phase::HenyeyGreenstein(HenyeyGreenstein(g))
    }

    forward! { (Phase: HenyeyGreenstein | Draine | Droplets)
        /// The phase function at a deflection, per steradian; also the density with which
        /// [`Phase::deflection`] samples that direction.
        pub fn per_steradian(deflection: &Deflection) -> f64;

        /// The deflection that belongs to `u`, uniform in [0, 1).
        pub fn deflection(u: f64) -> Deflection;
    }

    /// Mean cosine of the deflection.
    pub fn mean_cosine(&self) -> f64 {
        match self {
            Phase::HenyeyGreenstein(phase) => phase.0.g(),
            Phase::Draine(phase) => phase.mean_cosine(),
            Phase::Droplets(phase) => phase.mean_cosine(),
        }
    }

    /// Scatters into every direction alike, to the bit.
    pub(crate) fn is_isotropic(&self) -> bool {
        match self {
            Phase::HenyeyGreenstein(phase) => phase.0.g() == 0.0,
            Phase::Draine(phase) => phase.alpha() == 0.0 && phase.asymmetry().g() == 0.0,
            Phase::Droplets(_) => false,
        }
    }

    /// The same function of other asymmetries: `edit` of each that it has.
    pub fn with_asymmetry(&self, edit: impl Fn(Asymmetry) -> Asymmetry) -> Phase {
        match self {
            Phase::HenyeyGreenstein(phase) => Phase::henyey_greenstein(edit(phase.0)),
            Phase::Draine(phase) => Phase::Draine(phase.with_asymmetry(edit)),
            Phase::Droplets(phase) => Phase::Droplets(phase.with_asymmetry(edit)),
        }
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Phase::HenyeyGreenstein(phase) => write!(f, "Henyey–Greenstein, g = {}", phase.0.g()),
            Phase::Draine(phase) => phase.fmt(f),
            Phase::Droplets(phase) => phase.fmt(f),
        }
    }
}
