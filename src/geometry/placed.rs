//! Transformed shapes.

use super::{Aabb, Hit, Ray, Solid, Span, Surface, SurfacePoint, Transform};

/// A shape with a transform. Rays are mapped to object space, so a rotated box is still a box.
///
/// All distances are world distances, whatever the scale (an object ray has a direction of
/// length 1 too, and its distances are divided by the scale along it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<S> {
    shape: S,
    to_world: Transform,
}

impl<S: Surface> Placed<S> {
    /// `shape`, mapped to the world by `to_world`.
    pub fn new(shape: S, to_world: Transform) -> Placed<S> {
        Placed { shape, to_world }
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
        let (object, world) = (self.shape.bounds(), self.bounds());
        let rounding = self
            .to_world
            .round_trip_error(world.reach(), object.reach());
        SurfacePoint {
            position: self.to_world.point(point.position),
            normal: self.to_world.normal(point.normal),
            clearance: 2.0 * self.to_world.stretch() * point.clearance + 8.0 * rounding,
        }
    }
}

impl<S: Surface> Surface for Placed<S> {
    fn bounds(&self) -> Aabb {
        self.to_world.bounds(&self.shape.bounds())
    }

    fn hit(&self, ray: &Ray, limit: f64) -> Option<Hit> {
        let (ray, scale) = self.to_world.ray_to_object(ray)?;
        let hit = self.shape.hit(&ray, limit * scale)?;
        let t = hit.t / scale;
        // The way there and back may have rounded the limit.
        (t > 0.0 && t < limit).then(|| Hit {
            t,
            point: self.point(hit.point),
            ..hit
        })
    }
}

impl<S: Solid> Solid for Placed<S> {
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        let Some((ray, scale)) = self.to_world.ray_to_object(ray) else {
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
