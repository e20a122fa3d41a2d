//! A quick test of a ray against one sphere, without a division.

use super::Ray;
use glam::DVec3;

/// Relative widening of the squared radius and of the squared distance of the centre. Their difference
/// below takes some twenty roundings of terms no larger than the square of the distance, and a crossing that
/// the shape's own test finds may be 128u of the distance beside it; squared, 256u. 2^-40 is 8192u.
const WIDENING: f64 = 1.0 / (1_u64 << 40) as f64;

/// A sphere around a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SphereTest {
    centre: DVec3,
    radius_squared: f64,
}

impl SphereTest {
    /// The sphere around `centre`, world units.
    pub fn new(centre: DVec3, radius: f64) -> SphereTest {
        SphereTest {
            centre,
            radius_squared: radius * radius,
        }
    }

    /// Whether the ray may meet the inside at a distance with `0 ≤ t ≤ limit`. `false` is certain; `true` may
    /// still be a miss, by rounding. A sphere that leaves the range of numbers may be met.
    #[inline]
    pub fn may_meet(&self, ray: &Ray, limit: f64) -> bool {
        let away = self.centre - ray.origin;
        let distance_squared = away.length_squared();
        let slack = WIDENING * (self.radius_squared + distance_squared);
        let along = away.dot(*ray.direction);
        // Distance between the two points nearest to the centre, of the segment and of the line.
        let beyond = if along < 0.0 {
            along
        } else {
            (along - limit).max(0.0)
        };
        let from_line = distance_squared - along * along;
        let misses = from_line + beyond * beyond > self.radius_squared + slack;
        !misses
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_beside_before_and_behind() {
        let sphere = SphereTest::new(DVec3::new(3.0, 1.0, 0.0), 1.0);
        let meets = |origin: [f64; 3], direction: [f64; 3], limit: f64| {
            let ray = Ray::new(origin.into(), direction.into()).unwrap();
            sphere.may_meet(&ray, limit)
        };
        let x = [1.0, 0.0, 0.0];
        for height in [0.0, 0.5, 1.0, 2.0] {
            assert!(meets([0.0, height, 0.0], x, f64::INFINITY), "{height}");
            assert!(!meets([0.0, height, 0.0], x, 1.9), "{height}");
            assert!(!meets([4.1, height, 0.0], x, 1.9), "{height}");
        }
        assert!(!meets([0.0, -0.001, 0.0], x, f64::INFINITY));
        assert!(!meets([0.0, 2.001, 0.0], x, 9.0));
        assert!(meets([3.5, 1.0, 0.5], x, 0.0));
    }
}
