//! Light that reaches a vertex straight from a light.

use super::effects::Effects;
use super::media_path::{Media, transmittance};
use super::surroundings::is_clear;
use super::vertex::Vertex;
use super::work::{Event, Work};
use crate::geometry::{Emitter, Hit, Ray, Side, Span};
use crate::math::rng::{Purpose, Stream};
use crate::optics::{Directional, Light, Sides};
use crate::scene::{AreaLight, Radiative};
use glam::DVec3;

/// A light without extent as one point sees it.
#[derive(Clone, Copy, Debug)]
pub struct Arriving {
    /// Where the light stands; `None` for one infinitely far away.
    pub position: Option<DVec3>,
    /// By channel: intensity towards the point, per steradian, or irradiance of a light that is
    /// infinitely far away.
    pub strength: DVec3,
}

/// What `light` sends towards `point`.
pub fn arriving(light: &Light, point: DVec3) -> Arriving {
    match light {
        Light::Point(light) => Arriving {
            position: Some(light.position),
            strength: light.intensity,
        },
        Light::Spot(light) => {
            let towards = crate::geometry::direction_of(point - light.position);
            let falloff = towards.map_or(0.0, |towards| light.falloff(towards));
            Arriving {
                position: Some(light.position),
                strength: light.intensity * falloff,
            }
        }
        Light::Directional(light) => Arriving {
            position: None,
            strength: light.irradiance,
        },
    }
}

/// By channel, the share of light that gets through from the origin of `ray` to `distance`.
pub fn visibility<E: Effects, W: Work>(
    scene: &Radiative,
    media: &Media<'_>,
    ray: &Ray,
    distance: f64,
    spans: &mut Vec<Span>,
    work: &mut W,
) -> DVec3 {
    work.count(Event::ShadowRay);
    if E::SURFACES && !is_clear(scene, ray, distance, work) {
        return DVec3::ZERO;
    }
    if !E::MEDIA {
        return DVec3::ONE;
    }
    transmittance::<E>(media.depth(ray, distance, spans))
}

/// Radiance sent back from `vertex` for what arrives there from a light without extent.
pub fn from_light<E: Effects, W: Work>(
    scene: &Radiative,
    media: &Media<'_>,
    vertex: &Vertex,
    light: &Light,
    spans: &mut Vec<Span>,
    work: &mut W,
) -> DVec3 {
    let Arriving { position, strength } = arriving(light, vertex.point());
    if strength == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let (to_light, irradiance) = match (position, light) {
        (Some(position), _) => {
            let Some((ray, distance)) = vertex.towards_point(position) else {
                // The vertex is where the light stands: nothing is as improbable.
                return DVec3::ZERO;
            };
            ((ray, distance), strength / (distance * distance))
        }
        (None, Light::Directional(Directional { direction, .. })) => {
            let Some(ray) = vertex.leave(-*direction) else {
                return DVec3::ZERO;
            };
            ((ray, f64::INFINITY), strength)
        }
        (None, _) => unreachable!("every other light has a position"),
    };
    let (ray, distance) = to_light;
    let response = vertex.response::<E, W>(media, ray.direction, work);
    if response.value == DVec3::ZERO {
        return DVec3::ZERO;
    }
    response.value * irradiance * visibility::<E, W>(scene, media, &ray, distance, spans, work)
}

/// Radiance sent back from `vertex` for what arrives there from the area light with number
/// `index`: one point of the light, weighted against [`Vertex::turn`] meeting it by itself.
#[allow(
    clippy::too_many_arguments,
    reason = "a step of an estimator, given what it works on"
)]
pub fn from_area_light<E: Effects, W: Work>(
    scene: &Radiative,
    media: &Media<'_>,
    vertex: &Vertex,
    index: usize,
    (random, bounce): (&Stream, u32),
    spans: &mut Vec<Span>,
    work: &mut W,
) -> DVec3 {
    let light = &scene.area_lights[index];
    work.count_times(Event::RandomDraw, 2);
    let point = light
        .shape
        .sample(random.pair(bounce, Purpose::LightPoint, index as u32));
    let Some((ray, distance)) = vertex.towards(&point) else {
        return DVec3::ZERO;
    };
    let cosine = -ray.direction.dot(point.normal);
    let lit = match light.sides {
        Sides::Front => cosine > 0.0,
        Sides::Both => cosine != 0.0,
    };
    if !lit {
        return DVec3::ZERO;
    }
    let response = vertex.response::<E, W>(media, ray.direction, work);
    if response.value == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let pdf = solid_angle_pdf(light, distance, cosine);
    let weight = power_heuristic(pdf, response.pdf);
    let visible = visibility::<E, W>(scene, media, &ray, distance, spans, work);
    response.value * light.radiance * visible * (weight / pdf)
}

/// Radiance that an area light sends back along a ray that met it at `hit`.
pub fn radiance_of(light: &AreaLight, hit: &Hit) -> DVec3 {
    match (light.sides, hit.side) {
        (Sides::Both, _) | (_, Side::Front) => light.radiance,
        (Sides::Front, Side::Back) => DVec3::ZERO,
    }
}

/// The weight of having met the light at `hit` by a turn with the density `pdf`, against having
/// chosen that point of the light.
pub fn weight_of_meeting(light: &AreaLight, ray: &Ray, hit: &Hit, pdf: f64) -> f64 {
    let cosine = ray.direction.dot(hit.point.normal);
    power_heuristic(pdf, solid_angle_pdf(light, hit.t, cosine))
}

/// Density of a point chosen on the light, per steradian, as seen from `distance`, where
/// the normal there and the direction to it have that cosine.
fn solid_angle_pdf(light: &AreaLight, distance: f64, cosine: f64) -> f64 {
    light.shape.pdf() * (distance * distance) / cosine.abs()
}

/// The weight of what was sampled with density `mine`, where `other` could have found it too:
/// the shares of both are in the proportion of their squares.
///
/// Source: Veach & Guibas 1995, "Optimally combining sampling techniques for Monte Carlo
/// rendering", SIGGRAPH '95, §4.2.
fn power_heuristic(mine: f64, other: f64) -> f64 {
    let ratio = other / mine;
    1.0 / (1.0 + ratio * ratio)
}
