//! A vertex of a path: a collision in media, or a point of a diffuse surface.

use super::media::Set;
use crate::geometry::{Direction, Hit, Ray, SurfacePoint};
use glam::DVec3;

/// A vertex that scatters into a range of directions.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Vertex {
    /// A collision in media.
    Medium {
        /// World point.
        point: DVec3,
        /// Direction of the path that arrived.
        direction: Direction,
        /// The media there.
        set: Set,
    },
    /// A point of a diffuse surface.
    Diffuse {
        /// The point.
        point: SurfacePoint,
        /// Normal on the side that the path arrived from.
        normal: Direction,
        /// Share of light reflected, by channel.
        reflectance: DVec3,
    },
}

impl Vertex {
    /// The point of a diffuse surface at `hit`.
    pub fn on_surface(hit: &Hit, reflectance: DVec3) -> Vertex {
        Vertex::Diffuse {
            point: hit.point,
            normal: hit.facing(),
            reflectance,
        }
    }

    /// World point.
    pub fn point(&self) -> DVec3 {
        match self {
            Vertex::Medium { point, .. } => *point,
            Vertex::Diffuse { point, .. } => point.position,
        }
    }

    /// Whether light from `direction`, seen from here, may be scattered back along the path.
    pub fn faces(&self, direction: Direction) -> bool {
        match self {
            Vertex::Medium { .. } => true,
            Vertex::Diffuse {
                normal,
                reflectance,
                ..
            } => normal.cosine_to(direction) > 0.0 && *reflectance != DVec3::ZERO,
        }
    }

    /// The ray from here to `target`, and its length.
    pub(crate) fn towards_point(&self, target: DVec3) -> Option<(Ray, f64)> {
        match self {
            Vertex::Medium { point, .. } => {
                let ray = Ray::new(*point, target - *point)?;
                Some((ray, (target - *point).dot(*ray.direction)))
            }
            Vertex::Diffuse { point, .. } => point.towards_point(target),
        }
    }

    /// The ray from here to a point of a surface, and its length up to that surface.
    pub fn towards_surface(&self, target: &SurfacePoint) -> Option<(Ray, f64)> {
        match self {
            Vertex::Medium { point, .. } => {
                let (back, length) = target.towards_point(*point)?;
                let ray = Ray {
                    origin: *point,
                    direction: -back.direction,
                };
                Some((ray, length))
            }
            Vertex::Diffuse { point, .. } => point.towards_surface(target),
        }
    }

    /// The ray from here along `direction`, as [`SurfacePoint::leave`] makes it.
    pub fn leave(&self, direction: Direction) -> Option<Ray> {
        match self {
            Vertex::Medium { point, .. } => Ray::new(*point, *direction),
            Vertex::Diffuse { point, .. } => point.leave(direction),
        }
    }
}
