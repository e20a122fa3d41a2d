//! Light that reaches a vertex straight from a light.

use super::effects::Effects;
use super::intersection::Surroundings;
use super::sampler::Draws;
use super::scattering::Vertex;
use super::tracker::Tracker;
use crate::geometry::{Emitter, Hit, Ray, Side};
use crate::math::rng::Purpose;
use crate::math::sampling::power_heuristic;
use crate::optics::{Light, Sides};
use crate::render::counters::Work;
use crate::scene::AreaLight;
use glam::DVec3;

impl<E: Effects> Surroundings<'_, E> {
    /// Radiance sent back from `vertex` for what arrives there from a light without extent.
    pub fn by_light<W: Work>(
        &self,
        vertex: &Vertex,
        light: &Light,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let (position, strength) = (light.position(), light.strength_towards(vertex.point()));
        if strength == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let connection = match light {
            Light::Directional(light) => vertex
                .leave(-light.direction)
                .map(|ray| (ray, f64::INFINITY)),
            _ => position.and_then(|position| vertex.towards_point(position)),
        };
        let Some((ray, distance)) = connection else {
            // The vertex is where the light stands: nothing is as improbable.
            return DVec3::ZERO;
        };
        let irradiance = match position {
            Some(_) => strength / (distance * distance),
            None => strength,
        };
        let response = vertex.response::<E, W>(&self.media, ray.direction, work);
        if response.value == DVec3::ZERO {
            return DVec3::ZERO;
        }
        response.value * irradiance * self.visibility(&ray, distance, tracker, work)
    }

    /// Radiance sent back from `vertex` for what arrives there from the area light with number
    /// `index`: one point of the light, weighted against [`Vertex::turn`] meeting it by itself.
    pub fn by_area_light<W: Work>(
        &self,
        vertex: &Vertex,
        index: usize,
        draws: &Draws<'_>,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let light = &self.scene.area_lights[index];
        if light.radiance == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let point = light
            .shape
            .sample(draws.pair(Purpose::LightPoint, index, work));
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
        let response = vertex.response::<E, W>(&self.media, ray.direction, work);
        if response.value == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let pdf = solid_angle_pdf(light, distance, cosine);
        let weight = power_heuristic(pdf, response.pdf);
        let visible = self.visibility(&ray, distance, tracker, work);
        response.value * light.radiance * visible * (weight / pdf)
    }
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
