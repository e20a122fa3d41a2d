//! Mirrors and glass: surfaces where light goes on in one or two directions.

use crate::geometry::{Hit, Ray, Side};
use crate::optics::{Material, reflected, split};
use glam::DVec3;

/// A way on from a mirror or glass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpecularBounce {
    /// The ray that leaves.
    pub ray: Ray,
    /// Share of the light that takes this way; the shares of all ways add up to 1.
    pub share: f64,
    /// Radiance before the bounce over that after it, by channel, without the share.
    pub weight: DVec3,
}

/// The ways on from a mirror or glass at `hit`: reflected and refracted. Refraction scales radiance, as
/// it is measured per solid angle, by the square of the ratio of indices. None from a diffuse surface,
/// nor where no ray leaves.
pub(crate) fn specular_bounces(
    material: &Material,
    ray: &Ray,
    hit: &Hit,
) -> [Option<SpecularBounce>; 2] {
    let normal = hit.facing();
    let leaving = |direction, share, weight| {
        let ray = hit.point.leave(direction)?;
        Some(SpecularBounce { ray, share, weight })
    };
    let mirrored = |share, weight| leaving(reflected(ray.direction, normal), share, weight);
    match *material {
        Material::Diffuse(_) => [None, None],
        Material::Mirror(reflectance) => [mirrored(1.0, reflectance), None],
        Material::Glass(index) => {
            let ratio = match hit.side {
                Side::Front => 1.0 / index,
                Side::Back => index,
            };
            let split = split(ray.direction, normal, ratio);
            let refracted = split.refracted.and_then(|direction| {
                let weight = DVec3::splat(ratio * ratio);
                leaving(direction, 1.0 - split.reflectance, weight)
            });
            [mirrored(split.reflectance, DVec3::ONE), refracted]
        }
    }
}

/// One of the ways on from a mirror or glass, in proportion to the light by `choice`, a number in
/// [0, 1).
pub(crate) fn specular_bounce(
    material: &Material,
    ray: &Ray,
    hit: &Hit,
    choice: impl FnOnce() -> f64,
) -> Option<SpecularBounce> {
    let [reflected, refracted] = specular_bounces(material, ray, hit);
    let Some(refracted) = refracted else {
        return reflected;
    };
    if choice() < 1.0 - refracted.share {
        return reflected;
    }
    Some(refracted)
}
