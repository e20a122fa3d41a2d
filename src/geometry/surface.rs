//! Interfaces of shapes to renderers.

use super::{Aabb, Crossing, Hit, Ray, Span, length_of};
use glam::DVec3;

/// A surface that rays can hit.
pub trait Surface {
    /// A bounding box of the surface.
    fn bounds(&self) -> Aabb;

    /// Centre and radius of a sphere around the surface, as small as the shape allows.
    fn bounding_sphere(&self) -> (DVec3, f64) {
        let bounds = self.bounds();
        (bounds.centre(), length_of(bounds.size()) * 0.5)
    }

    /// Distance beyond the bounds, in world units, at which a ray may still be found to hit: the
    /// rounding of a transform.
    fn slack(&self) -> f64 {
        0.0
    }

    /// A box around all hits.
    fn bounds_of_hits(&self) -> Aabb {
        let (bounds, slack) = (self.bounds(), self.slack());
        Aabb {
            min: bounds.min - slack,
            max: bounds.max + slack,
        }
    }

    /// Points whose convex hull holds all hits, up to their clearance.
    fn hull(&self) -> Vec<DVec3> {
        self.bounds_of_hits().corners().to_vec()
    }

    /// The nearest crossing with `0 < t < limit`, in world units. At the same distance, the crossing with the
    /// smallest face number.
    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing>;

    /// The hit at a `crossing` with `ray`.
    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit;

    /// The hit at the nearest crossing.
    fn hit(&self, ray: &Ray, limit: f64) -> Option<Hit> {
        let crossing = self.crossing(ray, limit)?;
        Some(self.hit_at(ray, &crossing))
    }

    /// Whether there is a crossing with `0 < t < limit`.
    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        self.crossing(ray, limit).is_some()
    }
}

/// A closed shape, the boundary of a body or a medium. Need not be convex.
pub trait Solid: Surface {
    /// The segments of `ray` inside, from the ray's origin on, appended to `spans` in order:
    /// disjoint, none of negative length. If the origin lies inside, the first begins at 0.
    ///
    /// Does not read the existing contents of `spans`. A renderer keeps these intervals along a
    /// straight path instead of asking again from a point on the boundary.
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>);

    /// The result of [`append_spans`](Solid::append_spans) as a new vector.
    fn spans(&self, ray: &Ray) -> Vec<Span> {
        let mut spans = Vec::new();
        self.append_spans(ray, &mut spans);
        spans
    }
}
