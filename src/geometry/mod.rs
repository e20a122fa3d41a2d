//! Rays, spans, boxes and the camera.

mod aabb;
mod camera;
mod ray;

pub use aabb::Aabb;
pub use camera::{Camera, CameraError};
pub use ray::{Ray, Span, direction_of, length_of};
