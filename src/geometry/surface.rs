//! What a renderer asks of a shape.

use super::{Aabb, Hit, Ray, Span, SurfacePoint};

/// Anything a ray can meet.
pub trait Surface {
    /// A box that holds the whole surface.
    fn bounds(&self) -> Aabb;

    /// The nearest hit with `0 < t < limit`, in world units. Of hits at the same distance, the
    /// one with the smallest face number.
    fn hit(&self, ray: &Ray, limit: f64) -> Option<Hit>;

    /// Whether there is a hit with `0 < t < limit`, wherever it is.
    fn blocks(&self, ray: &Ray, limit: f64) -> bool {
        self.hit(ray, limit).is_some()
    }
}

/// A closed shape, the boundary of a body or a medium. Need not be convex.
pub trait Solid: Surface {
    /// The segments of `ray` inside, from the ray's origin on, appended to `spans` in order:
    /// disjoint, none shorter than nothing. If the origin lies inside, the first begins at 0.
    ///
    /// Does not look at what is in `spans` already. A renderer carries these intervals along a
    /// straight path rather than asking again from a point on the boundary.
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>);

    /// [`append_spans`](Solid::append_spans) into a vector of its own.
    fn spans(&self, ray: &Ray) -> Vec<Span> {
        let mut spans = Vec::new();
        self.append_spans(ray, &mut spans);
        spans
    }
}

/// A surface that light can leave from: points uniform by area.
pub trait Emitter: Surface {
    /// Area of one side, in world units squared.
    fn area(&self) -> f64;

    /// The point that belongs to two numbers in [0, 1). Uniform numbers give points uniform by
    /// area, with density [`pdf`](Emitter::pdf).
    fn sample(&self, uv: [f64; 2]) -> SurfacePoint;

    /// Density of [`sample`](Emitter::sample), per world unit squared; the same everywhere.
    fn pdf(&self) -> f64 {
        1.0 / self.area()
    }
}
