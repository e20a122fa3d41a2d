//! Classified volumes: a grid, a transfer function, and a ray caster.
//!
//! [`RayCaster::layers`](ray_caster::RayCaster::layers) is the loop along one ray.

pub(super) mod conventional;
pub mod curve;
pub mod depth;
pub mod empty_space;
pub mod integral;
pub mod modes;
pub mod ray_caster;
pub(super) mod several;
pub mod steps;
