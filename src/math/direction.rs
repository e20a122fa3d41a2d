//! Directions.

use glam::DVec3;
use std::ops::{Deref, Mul, Neg};

/// A direction: a vector of length 1, up to rounding.
///
/// A type of its own, distinct from points and displacements. Dereferences to its vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// Along the first axis.
    pub const X: Direction = Direction(DVec3::X);
    /// Along the second axis.
    pub const Y: Direction = Direction(DVec3::Y);
    /// Along the third axis.
    pub const Z: Direction = Direction(DVec3::Z);
    /// Against the first axis.
    pub const NEG_X: Direction = Direction(DVec3::NEG_X);
    /// Against the second axis.
    pub const NEG_Y: Direction = Direction(DVec3::NEG_Y);
    /// Against the third axis.
    pub const NEG_Z: Direction = Direction(DVec3::NEG_Z);

    /// `v / |v|`; `None` for the zero vector and for vectors that are not finite.
    ///
    /// Works over the whole range of finite vectors: where `|v|²` would leave the range of normal
    /// numbers, `v` is first scaled to near 1 by a power of two, which is exact.
    pub fn of(v: DVec3) -> Option<Direction> {
        let length_squared = v.length_squared();
        if (1e-290..1e290).contains(&length_squared) {
            return Some(Direction(v / length_squared.sqrt()));
        }
        let largest = v.abs().max_element();
        // Component by component: the largest of some numbers and a NaN may be a number.
        if largest == 0.0 || !v.is_finite() {
            return None;
        }
        // 2^±300 in up to three steps reaches every finite number, subnormal ones included.
        let up = 2.0_f64.to_bits() + (299 << 52);
        let down = 0.5_f64.to_bits() - (299 << 52);
        let factor = f64::from_bits(if largest < 1.0 { up } else { down });
        let mut scaled = v * factor;
        while !(1e-290..1e290).contains(&scaled.length_squared()) {
            scaled *= factor;
        }
        Some(Direction(scaled / scaled.length()))
    }

    /// `v`, unchanged. Its formula gives it length 1: a vector divided by its length, a sine and a
    /// cosine, or a direction rotated, mirrored or refracted.
    ///
    /// The length is not checked; it differs from 1 by the rounding of that formula.
    pub const fn unit(v: DVec3) -> Direction {
        Direction(v)
    }

    /// Cosine of the angle to `other`: the dot product, which rounding may take beyond ±1.
    #[inline]
    pub fn cosine_to(self, other: Direction) -> f64 {
        self.0.dot(other.0)
    }
}

impl Deref for Direction {
    type Target = DVec3;

    #[inline]
    fn deref(&self) -> &DVec3 {
        &self.0
    }
}

impl Neg for Direction {
    type Output = Direction;

    #[inline]
    fn neg(self) -> Direction {
        Direction(-self.0)
    }
}

impl Mul<f64> for Direction {
    type Output = DVec3;

    #[inline]
    fn mul(self, length: f64) -> DVec3 {
        self.0 * length
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn length_one_over_the_whole_range() {
        for exponent in [-1074, -1060, -600, -300, -1, 0, 1, 300, 600, 1020] {
            let size = libm::exp2(f64::from(exponent));
            let direction = Direction::of(DVec3::new(size, -size, 0.0)).unwrap();
            // One rounding each in the sum, the root and the quotient.
            assert!(
                (direction.length() - 1.0).abs() <= 4.0 * f64::EPSILON,
                "2^{exponent}"
            );
            assert_eq!(direction.x, -direction.y);
        }
    }

    #[test]
    fn the_zero_vector_has_no_direction() {
        assert_eq!(Direction::of(DVec3::ZERO), None);
        assert_eq!(Direction::of(DVec3::new(-0.0, 0.0, 0.0)), None);
        assert_eq!(Direction::of(DVec3::splat(f64::INFINITY)), None);
        assert_eq!(Direction::of(DVec3::splat(f64::NAN)), None);
        for axis in 0..3 {
            for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut vector = DVec3::ONE;
                vector[axis] = odd;
                assert_eq!(Direction::of(vector), None, "{vector}");
            }
        }
    }
}
