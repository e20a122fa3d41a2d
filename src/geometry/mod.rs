//! Rays, spans, shapes, transforms and the camera.
//!
//! [`Surface`], [`Solid`] and [`Emitter`] are the interfaces of a shape: the nearest hit, the
//! segments of a ray inside, uniform points by area. [`Sphere`], [`Aabb`], [`Rectangle`], [`Mesh`]
//! and [`ClosedMesh`] implement them; [`Placed`] transforms any of them, and [`Shape`],
//! [`Boundary`] and [`Luminous`] are enums over them. [`SurfacePoint`] starts rays so that they do
//! not hit their own surface again.

mod aabb;
mod aabb_surface;
mod box_test;
mod bvh;
mod camera;
mod closed_mesh;
mod crossing;
mod emitter;
mod forward;
mod hit;
mod mesh;
mod mesh_file;
mod obj_text;
mod parameter;
mod placed;
mod polygon;
mod ray;
mod rectangle;
mod shape;
mod sphere;
mod sphere_test;
mod spherical_rectangle;
mod surface;
mod transform;

pub use crate::math::Direction;
pub use aabb::Aabb;
pub(crate) use bvh::Bvh;
pub use camera::{Camera, Intrinsics};
pub use closed_mesh::ClosedMesh;
pub use emitter::{Emitter, EmitterExtent, EmitterPdf};
pub(crate) use forward::{forward, within};
pub use hit::{Crossing, Hit, Side, SurfacePoint};
pub use mesh::Mesh;
pub use obj_text::ObjFault;
pub(crate) use obj_text::{Statements, Word};
pub use parameter::InvalidParameter;
pub(crate) use parameter::{require, require_finite};
pub use placed::Placed;
pub use ray::{Line, Ray, Span, length_of};
pub use rectangle::Rectangle;
pub use shape::{Boundary, Luminous, Shape};
pub use sphere::Sphere;
pub use surface::{Solid, Surface};
pub use transform::Transform;
