//! Rays, spans, shapes, transforms and the camera.
//!
//! [`Surface`], [`Solid`] and [`Emitter`] are what a renderer asks of a shape: the nearest hit,
//! the segments of a ray inside, points uniform by area. [`Sphere`], [`Aabb`], [`Rectangle`],
//! [`Mesh`] and [`ClosedMesh`] answer; [`Placed`] puts any of them somewhere else, and
//! [`Shape`], [`Boundary`] and [`Luminous`] hold one of several. How a ray
//! leaves a surface without meeting it again is [`SurfacePoint`]'s.

mod aabb;
mod aabb_surface;
mod bvh;
mod camera;
mod closed_mesh;
mod crossing;
mod hit;
mod mesh;
mod mesh_error;
mod mesh_file;
mod placed;
mod ray;
mod rectangle;
mod shape;
mod shape_error;
mod sphere;
mod surface;
mod transform;

pub use crate::math::Direction;
pub use aabb::{Aabb, longest_axis};
pub use camera::{Camera, CameraError};
pub use closed_mesh::ClosedMesh;
pub use hit::{Hit, Side, SurfacePoint};
pub use mesh::Mesh;
pub use mesh_error::MeshError;
pub use placed::Placed;
pub use ray::{Ray, Span, length_of};
pub use rectangle::Rectangle;
pub use shape::{Boundary, Luminous, Shape};
pub use shape_error::ShapeError;
pub use sphere::Sphere;
pub use surface::{Emitter, Solid, Surface};
pub use transform::{Transform, TransformError};
