//! Densities that vary along one direction, or not at all: along a ray they have closed forms.

use super::{DensityField, DensityRange};
use crate::geometry::{Aabb, Direction, InvalidParameter, require};
use crate::math::exp;
use glam::DVec3;

/// A density that falls by the factor e per scale height, `density·e^(−h/H)`: air, or fog on the
/// ground. `h` is the height above `base` in the direction `up`; below the base the density
/// grows on, up to the largest number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExponentialLayer {
    /// Density at the base.
    pub(crate) density: f64,
    /// A point at height 0.
    pub(crate) base: DVec3,
    /// The direction of rising height.
    pub(crate) up: Direction,
    /// Height over which the density falls by the factor e.
    pub(crate) scale_height: f64,
}

/// A density that is linear in space, `density + gradient·(p − origin)`, where that is positive,
/// else 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearRamp {
    /// Density at the origin; it may be negative there.
    pub density: f64,
    /// Point that has this density.
    pub origin: DVec3,
    /// Change of the density per unit of length along x, y, z.
    pub gradient: DVec3,
}

impl ExponentialLayer {
    /// The layer that has `density`, finite and not negative, at `base`; `up` may have any length.
    ///
    /// # Errors
    ///
    /// [`InvalidParameter`].
    pub fn new(
        density: f64,
        base: DVec3,
        up: DVec3,
        scale_height: f64,
    ) -> Result<ExponentialLayer, InvalidParameter> {
        let message = format_args!(
            "scale height must be positive and finite, and not below 2.3e-308, got {scale_height:?}"
        );
        let divides = scale_height.is_normal() && scale_height > 0.0;
        require(divides, "scale_height", message)?;
        Ok(ExponentialLayer {
            density,
            base,
            up: Direction::of(up).ok_or_else(|| {
                let message = format!("up must be finite and not zero, got {up}");
                InvalidParameter::new("up", message)
            })?,
            scale_height,
        })
    }

    /// Scale heights above the base.
    fn height(&self, point: DVec3) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| rise(*self.up, self.base, point, axis));
        (x + y + z) / self.scale_height
    }

    /// Density where `e^(−h)` is `share`, which may be infinite.
    fn of_share(&self, share: f64) -> f64 {
        // 0 times infinity would be no number.
        (self.density * share.min(f64::MAX)).min(f64::MAX)
    }
}

impl LinearRamp {
    /// The linear function, which may be negative.
    pub(crate) fn value(&self, point: DVec3) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| rise(self.gradient, self.origin, point, axis));
        self.density + (x + y + z)
    }
}

impl DensityField for ExponentialLayer {
    fn density(&self, point: DVec3) -> f64 {
        self.of_share(exp(-self.height(point)))
    }

    /// Proof. Heights, as they are computed, are extreme at two corners: `extremes`. `exp` is
    /// less than a unit in the last place off, so it may fall where it should rise by less than
    /// two of them, of four at most in the finer spacing below a power of two; the product with
    /// the density keeps order.
    fn range_over(&self, bounds: &Aabb) -> DensityRange {
        let [low, high] = extremes(bounds, *self.up).map(|corner| self.height(corner));
        let steps_of_four = |share: f64, step: fn(f64) -> f64| (0..4).fold(share, |x, _| step(x));
        DensityRange::new(
            self.of_share(steps_of_four(exp(-high), f64::next_down).max(0.0)),
            self.of_share(steps_of_four(exp(-low), f64::next_up)),
        )
    }
}

impl DensityField for LinearRamp {
    fn density(&self, point: DVec3) -> f64 {
        self.value(point).clamp(0.0, f64::MAX)
    }

    /// Proof: `extremes`.
    fn range_over(&self, bounds: &Aabb) -> DensityRange {
        let [low, high] = extremes(bounds, self.gradient).map(|corner| self.density(corner));
        DensityRange { low, high }
    }
}

/// Part of `slope·(point − origin)` along an axis. At most an eighth of the largest number, so
/// that three of them have a finite sum.
fn rise(slope: DVec3, origin: DVec3, point: DVec3, axis: usize) -> f64 {
    // 0 times infinity would be no number.
    let distance = (point[axis] - origin[axis]).clamp(f64::MIN, f64::MAX);
    (slope[axis] * distance).clamp(f64::MIN / 8.0, f64::MAX / 8.0)
}

/// The corners of a box where a function linear in space, of this slope, is least and largest, as
/// it is computed from [`rise`] too: differences, products and sums keep the order of numbers
/// when they are rounded, so along each axis it rises or falls throughout.
fn extremes(bounds: &Aabb, slope: DVec3) -> [DVec3; 2] {
    let rising = slope.cmpge(DVec3::ZERO);
    [
        DVec3::select(rising, bounds.min, bounds.max),
        DVec3::select(rising, bounds.max, bounds.min),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::tests::failures_in;
    use proptest::prelude::*;

    #[test]
    fn densities_by_hand() {
        let up = DVec3::new(0.0, 0.0, 3.0);
        let layer = ExponentialLayer::new(2.0, DVec3::ONE, up, 0.5).unwrap();
        assert_eq!(layer.density(DVec3::new(7.0, -9.0, 1.0)), 2.0);
        let above = layer.density(DVec3::new(0.0, 0.0, 2.0));
        assert_eq!(above, 2.0 * exp(-2.0));
        assert_eq!(layer.density(DVec3::new(0.0, 0.0, f64::MIN)), f64::MAX);
        assert_eq!(layer.density(DVec3::new(0.0, 0.0, f64::MAX)), 0.0);
        let nothing = ExponentialLayer::new(0.0, DVec3::ONE, up, 0.5).unwrap();
        assert_eq!(nothing.density(DVec3::new(0.0, 0.0, f64::MIN)), 0.0);

        let gradient = DVec3::new(1.0, -2.0, 0.0);
        let ramp = LinearRamp {
            density: 0.5,
            origin: DVec3::ZERO,
            gradient,
        };
        assert_eq!(ramp.density(DVec3::new(1.0, 0.25, 9.0)), 1.0);
        assert_eq!(ramp.density(DVec3::new(1.0, 1.0, 0.0)), 0.0);
        let bounds = Aabb::new(DVec3::ZERO, DVec3::ONE).unwrap();
        let range = DensityRange {
            low: 0.0,
            high: 1.5,
        };
        assert_eq!(ramp.range_over(&bounds), range);
    }

    #[test]
    fn parameters_are_checked() {
        let layer = |density, up, height| ExponentialLayer::new(density, DVec3::ZERO, up, height);
        let message = |density, up, height| layer(density, up, height).unwrap_err().message;
        let up = "up must be finite and not zero, got [0, 0, 0]";
        assert_eq!(message(1.0, DVec3::ZERO, 1.0), up);
        let height = "scale height must be positive and finite, and not below 2.3e-308, got 0.0";
        assert_eq!(message(1.0, DVec3::Y, 0.0), height);
    }

    fn number() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => -4.0..4.0_f64,
            1 => prop::num::f64::NORMAL | prop::num::f64::ZERO | prop::num::f64::SUBNORMAL,
        ]
    }

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(number()).prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 1000, ..failures_in("fixtures/proptest-regressions/layers.txt") })]

        /// Densities are finite, not negative and within the range over any box around them.
        #[test]
        fn densities_lie_within_their_range(
            density in number(),
            origin in vector(),
            slope in vector(),
            scale_height in number(),
            corner in vector(),
            opposite in vector(),
            shares in prop::collection::vec(prop::array::uniform3(
                prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0_f64]), 16),
        ) {
            let Ok(bounds) = Aabb::new(corner.min(opposite), corner.max(opposite)) else {
                return Ok(());
            };
            let layer = ExponentialLayer::new(density.abs(), origin, slope, scale_height.abs());
            let ramp = LinearRamp { density, origin, gradient: slope };
            let mut fields: Vec<&dyn DensityField> = vec![&ramp];
            fields.extend(layer.iter().map(|layer| layer as &dyn DensityField));
            for field in fields {
                let range = field.range_over(&bounds);
                prop_assert!(0.0 <= range.low && range.high.is_finite());
                for share in &shares {
                    let point = bounds.min + bounds.size() * DVec3::from_array(*share);
                    let density = field.density(point.clamp(bounds.min, bounds.max));
                    prop_assert!(range.low <= density && density <= range.high);
                }
            }
        }
    }
}
