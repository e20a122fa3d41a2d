//! A homogeneous medium: the same coefficients everywhere.

use super::{Coefficients, HenyeyGreenstein};
use glam::DVec3;

/// A medium whose properties do not depend on the place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    /// Absorption and scattering, per world length.
    pub coefficients: Coefficients,
    /// Emitted radiance per world length, `j`; finite and not negative. In thermal equilibrium
    /// it is `sigma_a` times the radiance of a black body.
    pub emission: DVec3,
    /// Where scattered light goes.
    pub phase: HenyeyGreenstein,
}
