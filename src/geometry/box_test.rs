//! A quick test of a ray against many boxes.

use super::{Aabb, Ray};
use glam::DVec3;

/// Rounding of a computed crossing relative to the farthest coordinate, as seen from the ray's
/// origin: 52u by the derivation in [`super::crossing`], and 6u for the slabs here. 2^−46 is
/// 128u; boxes are widened by it, so that no surface is skipped whose own test would find a hit,
/// and the test changes no bit of any answer.
const WIDENING: f64 = 1.0 / (1_u64 << 46) as f64;

/// A ray, ready to be tested against boxes.
pub(super) struct BoxTest {
    /// By axis, one over the direction; infinite where that is 0.
    inverse: DVec3,
    /// Origins from which the planes are seen where the ray enters and where it leaves a box that is
    /// wider by the rounding.
    entry: DVec3,
    exit: DVec3,
    /// By axis, the ray runs down.
    down: [bool; 3],
}

impl BoxTest {
    /// `ray` for boxes within `bounds`, widened by their rounding.
    pub fn new(ray: &Ray, bounds: &Aabb) -> BoxTest {
        let (low, high) = (bounds.min - ray.origin, bounds.max - ray.origin);
        let wider = WIDENING * low.abs().max(high.abs()).max_element();
        let inverse = ray.direction.recip();
        let down = inverse.to_array().map(|inverse| inverse < 0.0);
        let shift = DVec3::from_array(down.map(|down| if down { -wider } else { wider }));
        BoxTest {
            inverse,
            entry: ray.origin + shift,
            exit: ray.origin - shift,
            down,
        }
    }

    /// The distance `from ≤ t ≤ limit` at which the ray may enter a box; infinite for a certain miss.
    #[inline]
    pub fn entry(&self, bounds: &Aabb, from: f64, limit: f64) -> f64 {
        let (mut near, mut far) = (from, limit);
        for axis in 0..3 {
            let (mut first, mut last) = (bounds.min[axis], bounds.max[axis]);
            if self.down[axis] {
                (first, last) = (last, first);
            }
            near = larger((first - self.entry[axis]) * self.inverse[axis], near);
            far = smaller((last - self.exit[axis]) * self.inverse[axis], far);
        }
        if near <= far { near } else { f64::INFINITY }
    }
}

/// The larger of both, `b` where `a` is NaN: 0·∞, on a face of a box that the ray is parallel
/// to, counts as inside.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of both, `b` where `a` is NaN.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along an axis and in the plane of a face, from outside, inside and behind.
    #[test]
    fn rays_in_the_plane_of_a_face_may_meet_the_box() {
        let unit = Aabb {
            min: DVec3::ZERO,
            max: DVec3::ONE,
        };
        let meets = |origin: [f64; 3], direction: [f64; 3], limit: f64| {
            let ray = Ray::new(origin.into(), direction.into()).unwrap();
            let test = BoxTest::new(&ray, &unit);
            test.entry(&unit, 0.0, limit) < f64::INFINITY
        };
        for zero in [0.0, -0.0] {
            for face in [0.0, 0.5, 1.0] {
                assert!(meets([face, 0.0, -1.0], [zero, 0.0, 1.0], 2.0));
                assert!(meets([face, 1.0, 3.0], [zero, zero, -1.0], 2.0));
                assert!(!meets([face, 1.0, -1.0], [zero, zero, 1.0], 0.5));
                assert!(!meets([face, 1.0, 3.0], [zero, zero, 1.0], f64::INFINITY));
            }
            for beside in [-0.001, 1.001] {
                assert!(!meets([0.5, beside, -1.0], [zero, zero, 1.0], 9.0));
            }
        }
    }
}
