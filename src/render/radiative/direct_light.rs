//! Direct light: next-event estimation at a vertex.

use super::scattering_function::ScatteringFunction;
use super::scene_context::SceneContext;
use super::tracker::Tracker;
use super::vertex::Vertex;
use super::visibility::Visibility;
use crate::geometry::{Emitter, Hit, Ray, Side};
use crate::math::rng::Purpose;
use crate::math::sampling::power_heuristic;
use crate::optics::{Light, Sides};
use crate::scene::AreaLight;
use glam::DVec3;

/// Direct light in a scene.
#[derive(Clone, Copy)]
pub struct DirectLight<'s>(pub &'s SceneContext<'s>);

impl DirectLight<'_> {
    /// Radiance scattered at `vertex` of the direct light of `light`, which has no extent.
    pub fn of_light(self, vertex: &Vertex, light: &Light, tracker: &mut Tracker<'_>) -> DVec3 {
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
            // The vertex is the position of the light: an event of probability 0.
            return DVec3::ZERO;
        };
        let irradiance = match position {
            Some(_) => strength / (distance * distance),
            None => strength,
        };
        let response = ScatteringFunction(self.0).response(vertex, ray.direction, tracker.work);
        if response.value == DVec3::ZERO {
            return DVec3::ZERO;
        }
        response.value * irradiance * Visibility(self.0).along(&ray, distance, tracker)
    }

    /// Radiance scattered at `vertex` from the area light `index`. Samples one point of the light, weighted by the power
    /// heuristic against [`ScatteringFunction::sample`].
    pub fn of_area_light(self, vertex: &Vertex, index: usize, tracker: &mut Tracker<'_>) -> DVec3 {
        let light = &self.0.radiative.area_lights[index];
        if light.radiance == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let numbers = tracker.sampler.pair(Purpose::LightPoint, index);
        let weight = |pdf, response_pdf| power_heuristic(pdf, response_pdf) / pdf;
        self.weighted_area_light(vertex, light, numbers, weight, tracker)
    }

    /// Radiance scattered at `vertex` from the point of an area light that `numbers` selects, times `weight`. That
    /// function takes two densities per steradian at the vertex: of the point, and of the direction
    /// ([`Response::pdf`](super::scattering_function::Response::pdf)).
    pub fn weighted_area_light(
        self,
        vertex: &Vertex,
        light: &AreaLight,
        numbers: [f64; 2],
        weight: impl FnOnce(f64, f64) -> f64,
        tracker: &mut Tracker<'_>,
    ) -> DVec3 {
        let (point, pdf) = light.shape.sample_towards(vertex.point(), numbers);
        let Some((ray, distance)) = vertex.towards_surface(&point) else {
            return DVec3::ZERO;
        };
        let cosine = -ray.direction.cosine_to(point.normal);
        let emits = match light.sides {
            Sides::Front => cosine > 0.0,
            Sides::Both => cosine != 0.0,
        };
        if !emits {
            return DVec3::ZERO;
        }
        let response = ScatteringFunction(self.0).response(vertex, ray.direction, tracker.work);
        if response.value == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let weight = weight(pdf.per_steradian(distance, cosine), response.pdf);
        let visibility = Visibility(self.0).along(&ray, distance, tracker);
        response.value * light.radiance * visibility * weight
    }
}

/// Radiance that an area light emits back along a ray that hit it.
pub fn emitted_radiance(light: &AreaLight, hit: &Hit) -> DVec3 {
    match (light.sides, hit.side) {
        (Sides::Both, _) | (_, Side::Front) => light.radiance,
        (Sides::Front, Side::Back) => DVec3::ZERO,
    }
}

/// Weight of a light hit by a direction of density `scattered_pdf`, against direct light from
/// that point.
pub fn weight_of_hit(light: &AreaLight, ray: &Ray, hit: &Hit, scattered_pdf: f64) -> f64 {
    power_heuristic(scattered_pdf, pdf_of_hit(light, ray, hit))
}

/// Density with which a point sampled on the light is the one that `ray` hits, per steradian at the
/// origin of the ray.
pub fn pdf_of_hit(light: &AreaLight, ray: &Ray, hit: &Hit) -> f64 {
    let pdf = light.shape.pdf_towards(ray.origin);
    pdf.per_steradian(hit.t, ray.direction.cosine_to(hit.point.normal))
}
