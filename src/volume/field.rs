//! A density in space.

use crate::geometry::Aabb;
use glam::DVec3;

/// A density at every point of space, finite and not negative.
///
/// A tracking method needs the value at a point and bounds over a box: too wide a range costs time,
/// too narrow a range is an unnoticed bias. So bounds are proved, and every lookup of a tracker is
/// checked against them.
pub trait DensityField: Sync {
    /// Density at `point`, in the coordinates of the field.
    fn density(&self, point: DVec3) -> f64;

    /// Bounds on [`DensityField::density`], as it is computed, over all points of `bounds`, faces
    /// included.
    fn range_over(&self, bounds: &Aabb) -> DensityRange;
}

/// Bounds on a density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DensityRange {
    /// Lower bound, at least 0.
    pub low: f64,
    /// Upper bound: the majorant. 0 where there is nothing.
    pub high: f64,
}

impl DensityRange {
    /// The range from `low` to `high`.
    pub const fn new(low: f64, high: f64) -> DensityRange {
        DensityRange { low, high }
    }

    /// The one value of a constant density.
    pub fn of(density: f64) -> DensityRange {
        DensityRange::new(density, density)
    }

    /// Bounds on both of two densities.
    pub(crate) fn union(self, other: DensityRange) -> DensityRange {
        DensityRange::new(self.low.min(other.low), self.high.max(other.high))
    }
}
