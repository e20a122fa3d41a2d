//! Mirrors and glass: surfaces where a path continues in one or two directions.

use super::sampler::Sampler;
use crate::geometry::{Direction, Hit, Ray, Side};
use crate::math::rng::Purpose;
use crate::optics::{reflected, split};

/// The ray reflected by a mirror at `hit`.
pub fn mirrored(ray: &Ray, hit: &Hit) -> Option<Ray> {
    hit.point.leave(reflected(ray.direction, facing(hit)))
}

/// The ray that continues from glass of refractive `index`, reflected or refracted in proportion to
/// the light, and its weight: radiance is measured per solid angle, which refraction scales by the
/// square of the ratio of indices.
pub fn through_glass(
    ray: &Ray,
    hit: &Hit,
    index: f64,
    sampler: &mut Sampler,
) -> Option<(Ray, f64)> {
    let ratio = match hit.side {
        Side::Front => 1.0 / index,
        Side::Back => index,
    };
    let split = split(ray.direction, facing(hit), ratio);
    let choice = sampler.one(Purpose::Surface);
    match split.refracted {
        Some(refracted) if choice >= split.reflectance => {
            Some((hit.point.leave(refracted)?, ratio * ratio))
        }
        _ => Some((mirrored(ray, hit)?, 1.0)),
    }
}

/// The normal on the side that was hit.
pub fn facing(hit: &Hit) -> Direction {
    match hit.side {
        Side::Front => hit.point.normal,
        Side::Back => -hit.point.normal,
    }
}
