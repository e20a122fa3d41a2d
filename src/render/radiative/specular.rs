//! Mirrors and glass: surfaces where a path goes on in one or two directions.

use super::sampler::Draws;
use crate::geometry::{Hit, Ray, Side};
use crate::math::rng::Purpose;
use crate::optics::{reflected, split};
use crate::render::counters::Work;
use glam::DVec3;

/// The ray that a mirror makes of one that met it at `hit`.
pub fn mirrored(ray: &Ray, hit: &Hit) -> Option<Ray> {
    hit.point.leave(reflected(ray.direction, facing(hit)))
}

/// The ray that goes on from glass of refractive `index`, reflected or refracted by chance in
/// the proportion of the light that is, and its weight: radiance is measured per solid angle,
/// which refraction stretches by the square of the ratio of indices.
pub fn through_glass<W: Work>(
    ray: &Ray,
    hit: &Hit,
    index: f64,
    draws: &Draws<'_>,
    work: &mut W,
) -> Option<(Ray, f64)> {
    let ratio = match hit.side {
        Side::Front => 1.0 / index,
        Side::Back => index,
    };
    let split = split(ray.direction, facing(hit), ratio);
    let choice = draws.one(Purpose::Surface, work);
    match split.refracted {
        Some(refracted) if choice >= split.reflectance => {
            Some((hit.point.leave(refracted)?, ratio * ratio))
        }
        _ => Some((mirrored(ray, hit)?, 1.0)),
    }
}

/// The unit normal on the side that was met.
pub fn facing(hit: &Hit) -> DVec3 {
    match hit.side {
        Side::Front => hit.point.normal,
        Side::Back => -hit.point.normal,
    }
}
