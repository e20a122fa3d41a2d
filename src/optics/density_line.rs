//! Straight lines in the coordinates of a density.

use glam::DVec3;

/// A straight line in the coordinates of a density, parametrised by world distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityLine {
    /// The point at distance 0.
    pub origin: DVec3,
    /// Change of the coordinates per world unit, of any length.
    pub direction: DVec3,
}

impl DensityLine {
    /// The point at world distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// The same line, from distance `t` on.
    pub fn from(&self, t: f64) -> DensityLine {
        DensityLine {
            origin: self.at(t),
            direction: self.direction,
        }
    }
}
