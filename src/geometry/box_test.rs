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

    /// Distances `from ≤ t ≤ limit` at which the ray may enter each of `boxes`; infinite for a certain
    /// miss.
    #[inline]
    pub fn entries(&self, boxes: &FourBoxes, from: f64, limit: f64) -> [f64; FourBoxes::COUNT] {
        let mut near = [from; FourBoxes::COUNT];
        let mut far = [limit; FourBoxes::COUNT];
        for axis in 0..3 {
            let (mut first, mut last) = (&boxes.min[axis], &boxes.max[axis]);
            if self.down[axis] {
                (first, last) = (last, first);
            }
            for it in 0..FourBoxes::COUNT {
                near[it] = larger(
                    (first[it] - self.entry[axis]) * self.inverse[axis],
                    near[it],
                );
                far[it] = smaller((last[it] - self.exit[axis]) * self.inverse[axis], far[it]);
            }
        }
        std::array::from_fn(|it| {
            if near[it] <= far[it] {
                near[it]
            } else {
                f64::INFINITY
            }
        })
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

/// Four boxes that are tested together.
#[derive(Clone, Debug)]
pub(super) struct FourBoxes {
    /// Lower ends by axis.
    min: [[f64; FourBoxes::COUNT]; 3],
    /// Upper ends by axis.
    max: [[f64; FourBoxes::COUNT]; 3],
}

impl Default for FourBoxes {
    /// Boxes that no ray meets.
    fn default() -> FourBoxes {
        FourBoxes {
            min: [[f64::INFINITY; FourBoxes::COUNT]; 3],
            max: [[f64::NEG_INFINITY; FourBoxes::COUNT]; 3],
        }
    }
}

impl FourBoxes {
    /// Their number.
    pub const COUNT: usize = 4;

    /// Sets one of them.
    pub fn set(&mut self, place: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.min[axis][place] = bounds.min[axis];
            self.max[axis][place] = bounds.max[axis];
        }
    }
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
            let mut boxes = FourBoxes::default();
            boxes.set(2, &unit);
            let entries = BoxTest::new(&ray, &unit).entries(&boxes, 0.0, limit);
            for other in [0, 1, 3] {
                assert_eq!(entries[other], f64::INFINITY, "there is no such box");
            }
            entries[2] < f64::INFINITY
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
