//! The faces of an axis-aligned box as a surface, and its inside as a solid.

use super::hit::RELATIVE_CLEARANCE;
use super::{Aabb, Crossing, Direction, Hit, Ray, Side, Solid, Span, Surface, SurfacePoint};

/// Outward normals, by face.
const NORMALS: [Direction; 6] = [
    Direction::NEG_X,
    Direction::NEG_Y,
    Direction::NEG_Z,
    Direction::X,
    Direction::Y,
    Direction::Z,
];

impl Surface for Aabb {
    fn bounds(&self) -> Aabb {
        *self
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        let [near, far] = self.crossings(&ray.into())?;
        let (crossing, side) = if near.t > 0.0 {
            (near, Side::Front)
        } else {
            (far, Side::Back)
        };
        if !(crossing.t > 0.0 && crossing.t < limit) {
            return None;
        }
        let forward = ray.direction[crossing.axis] > 0.0;
        let upper = forward == (side == Side::Back);
        let face = crossing.axis + if upper { 3 } else { 0 };
        Some(Crossing::new(crossing.t, side, face, [0.0; 2]))
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        Hit::new(crossing, point(self, ray, crossing.t, crossing.face))
    }
}

impl Solid for Aabb {
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        spans.extend(self.span(ray));
    }
}

/// The point where the ray passes a face, at distance `t`: exactly in that face, and not beyond
/// its edges.
///
/// So the point needs no clearance for itself. A ray that starts off the face by more than
/// a rounding of its coordinate is on the right side of it in [`crossings`](Aabb::crossings),
/// where the sign of `face − origin` is exact.
fn point(bounds: &Aabb, ray: &Ray, t: f64, face: usize) -> SurfacePoint {
    let (corner, axis) = ([bounds.min, bounds.max][face / 3], face % 3);
    let mut position = ray.at(t).clamp(bounds.min, bounds.max);
    position[axis] = corner[axis];
    SurfacePoint {
        position,
        normal: NORMALS[face],
        clearance: RELATIVE_CLEARANCE * bounds.reach(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const UNIT: Aabb = Aabb {
        min: DVec3::ZERO,
        max: DVec3::ONE,
    };

    #[test]
    fn g5_flat_boxes_hold_nothing_and_inverted_ones_are_refused() {
        let flat = Aabb::new(DVec3::ZERO, DVec3::new(1.0, 0.0, 1.0)).unwrap();
        let lengths = |towards: DVec3| {
            let ray = Ray::new(DVec3::new(0.5, -1.0, 0.5), towards).unwrap();
            flat.spans(&ray).iter().map(Span::length).sum::<f64>()
        };
        assert_eq!(lengths(DVec3::Y), 0.0);
        assert_eq!(lengths(DVec3::X), 0.0);
        let along = Ray::new(DVec3::new(-1.0, 0.0, 0.5), DVec3::X).unwrap();
        assert!(flat.spans(&along).is_empty());
        let refused = Aabb::new(DVec3::ONE, DVec3::new(2.0, 0.5, 2.0));
        assert!(refused.is_err());
        assert!(Aabb::new(DVec3::splat(f64::NAN), DVec3::ONE).is_err());
        assert!(Aabb::new(DVec3::splat(-1e308), DVec3::splat(1e308)).is_err());
    }

    #[test]
    fn hits_name_the_face_and_lie_in_it() {
        let hit = |origin: [f64; 3], direction: [f64; 3]| {
            let ray = Ray::new(origin.into(), direction.into()).unwrap();
            let crossing = UNIT.crossing(&ray, f64::INFINITY).unwrap();
            let hit = UNIT.hit_at(&ray, &crossing);
            (hit.t, crossing.face, hit.side, hit.point.normal)
        };
        let up = [0.0, 0.0, 1.0];
        assert_eq!(
            hit([0.5, 0.5, -1.0], up),
            (1.0, 2, Side::Front, Direction::NEG_Z)
        );
        assert_eq!(hit([0.5, 0.5, 0.5], up), (0.5, 5, Side::Back, Direction::Z));
        assert_eq!(
            hit([2.0, 0.5, 0.5], [-1.0, 0.0, 0.0]),
            (1.0, 3, Side::Front, Direction::X)
        );
        assert_eq!(
            hit([0.5, 0.5, 0.5], [-1.0, 0.0, 0.0]),
            (0.5, 0, Side::Back, Direction::NEG_X)
        );
    }
}
