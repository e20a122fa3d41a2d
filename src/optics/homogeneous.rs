//! A homogeneous medium.

use super::{Coefficients, Phase};
use glam::DVec3;

/// A medium with the same properties at every point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    /// Absorption and scattering, per world length.
    pub coefficients: Coefficients,
    /// Emitted radiance per world length, `j`; finite and not negative. In thermal equilibrium
    /// it is `sigma_a` times the radiance of a black body.
    pub emission: DVec3,
    /// Directions of scattered light.
    pub phase: Phase,
}
