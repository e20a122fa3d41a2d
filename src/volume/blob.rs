//! A Gaussian ball of density.

use super::{DensityField, DensityRange};
use crate::geometry::Aabb;
use crate::math::exp;
use glam::DVec3;

/// Density `peak·e^(−r²/(2 width²))` at distance `r` from a centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// Point of the largest density.
    pub centre: DVec3,
    /// Largest density, finite and not negative.
    pub peak: f64,
    /// Standard deviation along any line, > 0.
    pub width: f64,
}

impl Blob {
    /// Density at a distance given by its square in squared widths.
    fn at(&self, squared_widths: f64) -> f64 {
        self.peak * exp(-0.5 * squared_widths)
    }
}

impl DensityField for Blob {
    fn density(&self, point: DVec3) -> f64 {
        self.at(((point - self.centre) / self.width).length_squared())
    }

    /// By the nearest and the farthest point of the box, axis by axis.
    fn range_over(&self, bounds: &Aabb) -> DensityRange {
        let [low, high] = [bounds.min, bounds.max].map(|it| (it - self.centre) / self.width);
        // 0 where the centre lies between the faces.
        let nearest = low.max(-high).max(DVec3::ZERO);
        let farthest = low.abs().max(high.abs());
        // Squares, sums, quotients and differences round monotonically, and exponentials of libm
        // are off by less than an ulp: two more ulp than monotone.
        let margin = 4.0 * f64::EPSILON;
        DensityRange::new(
            self.at(farthest.length_squared()) * (1.0 - margin),
            self.at(nearest.length_squared()) * (1.0 + margin),
        )
    }
}
