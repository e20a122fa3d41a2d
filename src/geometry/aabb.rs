//! Axis-aligned boxes.

use super::{Ray, Span};
use glam::DVec3;

/// A box with faces at `min` and `max`. Each axis is half open: a ray lying *in* a face belongs
/// to the box whose minimum face that is, so that touching boxes neither count it twice nor
/// lose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Corner with the smallest coordinates.
    pub min: DVec3,
    /// Corner with the largest coordinates, `max ≥ min` on every axis.
    pub max: DVec3,
}

impl Aabb {
    /// Edge lengths, in world units.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The point in the middle.
    pub fn centre(&self) -> DVec3 {
        self.min + self.size() * 0.5
    }

    /// The stretch of `ray` inside the box, from the origin of the ray if that lies inside;
    /// `None` where the ray misses. A ray that touches an edge has a span of length 0.
    pub fn span(&self, ray: &Ray) -> Option<Span> {
        let mut near = 0.0_f64;
        let mut far = f64::INFINITY;
        for axis in 0..3 {
            let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
            let (low, high) = (self.min[axis], self.max[axis]);
            if direction == 0.0 {
                // A branch of its own: (low − origin) · (1/0) would be 0·∞ on a face.
                if origin < low || origin >= high {
                    return None;
                }
                continue;
            }
            let (first, last) = if direction > 0.0 {
                (low, high)
            } else {
                (high, low)
            };
            near = near.max((first - origin) / direction);
            far = far.min((last - origin) / direction);
        }
        (near <= far).then_some(Span { near, far })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Aabb = Aabb {
        min: DVec3::ZERO,
        max: DVec3::ONE,
    };

    fn span(origin: [f64; 3], direction: [f64; 3]) -> Option<(f64, f64)> {
        let ray = Ray::new(origin.into(), direction.into()).unwrap();
        UNIT.span(&ray).map(|span| (span.near, span.far))
    }

    #[test]
    fn zero_components_inside_on_and_outside_a_face() {
        for zero in [0.0, -0.0] {
            assert_eq!(span([0.5, 0.5, -1.0], [zero, zero, 1.0]), Some((1.0, 2.0)));
            assert_eq!(span([0.0, 0.5, -1.0], [zero, 0.0, 1.0]), Some((1.0, 2.0)));
            assert_eq!(span([1.0, 0.5, -1.0], [zero, 0.0, 1.0]), None);
            assert_eq!(span([1.5, 0.5, -1.0], [zero, 0.0, 1.0]), None);
        }
    }

    #[test]
    fn origin_inside_on_a_face_and_box_behind() {
        assert_eq!(span([0.5, 0.5, 0.5], [0.0, 0.0, 1.0]), Some((0.0, 0.5)));
        assert_eq!(span([0.5, 0.5, 0.0], [0.0, 0.0, 1.0]), Some((0.0, 1.0)));
        assert_eq!(span([0.5, 0.5, 0.0], [0.0, 0.0, -1.0]), Some((0.0, 0.0)));
        assert_eq!(span([0.5, 0.5, 3.0], [0.0, 0.0, 1.0]), None);
    }

    #[test]
    fn the_diagonal_is_the_root_of_three() {
        let (near, far) = span([-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]).unwrap();
        // Three roundings in each of the two distances.
        assert!(
            ((far - near) - 3.0_f64.sqrt()).abs() <= 16.0 * f64::EPSILON / 2.0 * 3.0_f64.sqrt()
        );
    }
}
