//! Transformed shapes.

use super::sphere_test::SphereTest;
use super::{Aabb, Crossing, Hit, Ray, Solid, Span, Surface, SurfacePoint, Transform};
use glam::DVec3;

/// A shape with a transform. Rays are mapped to object space, so a rotated box is still a box.
///
/// All distances are world distances, whatever the scale (an object ray has a direction of
/// length 1 too, and its distances are divided by the scale along it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<S> {
    shape: S,
    to_world: Transform,
    bounds: Aabb,
    sphere: SphereTest,
    /// Bound on the distance by which a world point moves on its way to the shape and back.
    rounding: f64,
}

/// Slack of the bounds, in roundings of the way to the shape and back.
const SLACK: f64 = 8.0;

impl<S: Surface> Placed<S> {
    /// `shape`, mapped to the world by `to_world`.
    pub fn new(shape: S, to_world: Transform) -> Placed<S> {
        let object = shape.bounds();
        let bounds = to_world.bounds(&object);
        let rounding = to_world.round_trip_error(bounds.reach(), object.reach());
        let (centre, radius) = to_world.bounding_sphere(shape.bounding_sphere());
        Placed {
            sphere: SphereTest::new(centre, radius + SLACK * rounding),
            shape,
            to_world,
            bounds,
            rounding,
        }
    }

    pub(super) fn moved(self, by: &Transform) -> Placed<S> {
        let to_world = self.to_world.then(by);
        Placed::new(self.shape, to_world)
    }

    /// The shape in its own space.
    pub fn shape(&self) -> &S {
        &self.shape
    }

    /// The map from object space to the world.
    pub fn to_world(&self) -> &Transform {
        &self.to_world
    }

    /// A slab of thickness δ in object space is at most `‖M‖₂·δ ≤ √3·‖M‖·δ` thick in the world,
    /// and both maps of a ray add their rounding; four times that is a quarter again.
    fn point(&self, point: SurfacePoint) -> SurfacePoint {
        SurfacePoint {
            position: self.to_world.point(point.position),
            normal: self.to_world.normal(point.normal),
            clearance: 2.0 * self.to_world.stretch() * point.clearance + 8.0 * self.rounding,
        }
    }

    /// `ray` in the space of the shape, and world lengths in its units; `None` where it misses the sphere around the
    /// shape, which spares it the way there: 13 % of the time of a Cornell box.
    fn ray_to_object(&self, ray: &Ray, limit: f64) -> Option<(Ray, f64)> {
        if !self.sphere.may_meet(ray, limit) {
            return None;
        }
        self.to_world.ray_to_object(ray)
    }
}

impl<S: Surface> Surface for Placed<S> {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn bounding_sphere(&self) -> (DVec3, f64) {
        self.to_world.bounding_sphere(self.shape.bounding_sphere())
    }

    /// The bounds are rounded, too, as far as a point on its way back.
    fn slack(&self) -> f64 {
        SLACK * self.rounding
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        let (ray, scale) = self.ray_to_object(ray, limit)?;
        let crossing = self.shape.crossing(&ray, limit * scale)?;
        let t = crossing.t / scale;
        // The way there and back may have rounded the limit.
        (t > 0.0 && t < limit).then_some(Crossing { t, ..crossing })
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        let object = self.to_world.ray_to_object(ray);
        let (ray, _) = object.expect("a ray that crosses the shape");
        let in_object = Crossing {
            t: crossing.t_in_object,
            ..*crossing
        };
        let hit = self.shape.hit_at(&ray, &in_object);
        Hit::new(crossing, self.point(hit.point))
    }

    /// The way to the shape rounds the limit: a hit within an ulp of it counts either way.
    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        let object = self.ray_to_object(ray, limit);
        object.is_some_and(|(ray, scale)| self.shape.blocks(&ray, limit * scale))
    }
}

impl<S: Solid> Solid for Placed<S> {
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        let Some((ray, scale)) = self.ray_to_object(ray, f64::INFINITY) else {
            return;
        };
        let first = spans.len();
        self.shape.append_spans(&ray, spans);
        for span in &mut spans[first..] {
            span.near /= scale;
            span.far /= scale;
        }
    }
}
