//! Intersections of rays with surfaces, and rays that leave surfaces.
//!
//! # Leaving without meeting the same surface again
//!
//! A computed point lies a little beside its surface. A ray that starts there may find the
//! surface it is leaving, or slip through it. The remedy is to start a little off the surface,
//! along its normal, by more than all rounding together and no more than needed.
//!
//! Every hit carries `clearance`, a length with two properties, shown with each shape:
//!
//! 1. the computed `point` lies within a quarter of it of the true surface;
//! 2. a computed crossing `t` of a ray that starts within the shape's reach belongs to a point
//!    within a quarter of it of the true surface, whatever the angle.
//!
//! The new origin is `point ± normal · clearance`. By (1) its distance from the tangent plane is
//! at least ¾ of the clearance, less the rounding of this sum (one rounding of the coordinate,
//! and of a normal within 4u of unit length, both below ¼). A ray that heads away from that plane
//! stays at least ½ away from it for `t ≥ 0`, and by (2) no crossing `t ≥ 0` of the same plane
//! can be computed. For flat faces the reach is that of the whole shape, so that the same holds
//! for the neighbours of the face, which lie behind its plane where the surface is convex.
//!
//! The clearance is a multiple of the unit roundoff times the shape's largest coordinate
//! (`2^−44` or a little more), so scaling a scene by a power of two scales it exactly, and there
//! is no absolute length in it.
//!
//! Sources: Wächter & Binder 2019, "A fast and robust method for avoiding self-intersection",
//! Ray Tracing Gems, ch. 6; Pharr, Jakob & Humphreys 2023, *Physically Based Rendering*, §6.8.

use super::{Direction, Ray};
use glam::DVec3;

/// The unit of clearance, 2^−44 = 512u, relative to a shape's largest coordinate. Each shape
/// shows that its own roundings stay below a quarter of it, 128u.
pub(super) const RELATIVE_CLEARANCE: f64 = 1.0 / (1_u64 << 44) as f64;

/// Side of a surface that a ray hits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The side the normal points to; outside, for closed shapes.
    Front,
    /// The other side; a ray leaving a closed shape hits it.
    Back,
}

/// A point of a surface, from which rays can start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World point, on the surface up to a quarter of `clearance`.
    pub position: DVec3,
    /// Geometric normal: outward for closed shapes, by the order of edges or vertices for open
    /// ones. It does not depend on the ray.
    pub normal: Direction,
    /// Distance from the surface at which a ray must start in order not to hit it, in world units.
    pub clearance: f64,
}

/// Place where a ray crosses a surface: enough to tell which surface is the nearest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance from the ray's origin, in world units, positive.
    pub t: f64,
    /// The same distance in the space of a shape with a transform.
    pub t_in_object: f64,
    /// The side that the ray hits.
    pub side: Side,
    /// Face of a mesh or side of a box (−x, −y, −z, +x, +y, +z); 0 for other shapes.
    pub face: usize,
    /// Position on the face, each in [0, 1]: along the two edges of a rectangle, weights of the
    /// second and third vertex of a triangle; 0 for spheres and boxes.
    pub uv: [f64; 2],
}

/// Intersection of a ray with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin, in world units, positive.
    pub t: f64,
    /// The point of intersection. More accurate than `ray.at(t)`: it is projected onto the surface.
    pub point: SurfacePoint,
    /// The side that the ray hits.
    pub side: Side,
}

impl Crossing {
    /// A crossing of a shape without a transform.
    pub(super) fn new(t: f64, side: Side, face: usize, uv: [f64; 2]) -> Crossing {
        Crossing {
            t,
            t_in_object: t,
            side,
            face,
            uv,
        }
    }
}

impl Hit {
    /// The hit at `crossing`, whose point is `point`.
    pub(super) fn new(crossing: &Crossing, point: SurfacePoint) -> Hit {
        Hit {
            t: crossing.t,
            point,
            side: crossing.side,
        }
    }

    /// The normal on the side that was hit.
    pub(crate) fn facing(&self) -> Direction {
        match self.side {
            Side::Front => self.point.normal,
            Side::Back => -self.point.normal,
        }
    }
}

impl SurfacePoint {
    /// The ray that leaves the surface along `direction`, normalized again; `None` if rounding has
    /// reduced it to zero. It starts off the surface, on the side of `direction`. A direction
    /// exactly along the surface counts as leaving from the front.
    pub fn leave(&self, direction: Direction) -> Option<Ray> {
        Ray::new(self.origin_towards(*direction), *direction)
    }

    /// The ray from this point to another one, and the length of the segment between their
    /// surfaces, which excludes both. `None` if the two starting points coincide.
    pub fn towards_surface(&self, other: &SurfacePoint) -> Option<(Ray, f64)> {
        let line = other.position - self.position;
        let (from, to) = (self.origin_towards(line), other.origin_towards(-line));
        let ray = Ray::new(from, to - from)?;
        Some((ray, (to - from).dot(*ray.direction)))
    }

    /// The ray from this point to a point in free space, and its distance.
    pub(crate) fn towards_point(&self, target: DVec3) -> Option<(Ray, f64)> {
        let from = self.origin_towards(target - self.position);
        let ray = Ray::new(from, target - from)?;
        Some((ray, (target - from).dot(*ray.direction)))
    }

    fn origin_towards(&self, towards: DVec3) -> DVec3 {
        let along = towards.dot(*self.normal);
        let is_behind = if (1e-290..1e290).contains(&along.abs()) {
            along < 0.0
        } else {
            // Products of a normal and a tiny vector may vanish: compare what has length 1.
            let behind = |direction: Direction| direction.cosine_to(self.normal) < 0.0;
            Direction::of(towards).is_some_and(behind)
        };
        let off = if is_behind {
            -self.clearance
        } else {
            self.clearance
        };
        self.position + self.normal * off
    }
}
