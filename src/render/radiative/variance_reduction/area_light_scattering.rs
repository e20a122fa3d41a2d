//! Single scattering of area lights along a ray: a point of the ray, then a point of the light.
//!
//! A path that is connected to a light where it happens to collide returns the solid angle of the
//! light, seen from there. Few paths collide near the light, and those return far more than the others:
//! in a room of fog with a lamp that is most of the variance. So each ray is connected to each light,
//! whether its path collides or not, at a point that is sampled for the light as for a positioned one.
//! In place of the squared distance of a point stands the mean over the surface, so that no density
//! grows without limit. A path that collides and hits the light by its direction finds the same points;
//! both samplers are weighted by multiple importance sampling.
//!
//! Sources: Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in participating
//! media", Computer Graphics Forum 31, 1519–1528; Veach 1997, thesis, ch. 9.

use crate::geometry::{Direction, Hit, Ray, Span};
use crate::math::rng::Purpose;
use crate::math::sampling::power_heuristic;
use crate::optics::Sides;
use crate::render::radiative::context::{PathContext, PreviousCollision};
use crate::render::radiative::direct_light::{DirectLight, pdf_of_hit};
use crate::render::radiative::scene_context::SceneContext;
use crate::render::radiative::segments::MediumSegments;
use crate::render::radiative::single_scattering::{ScatteringPointSampler, SingleScattering};
use glam::DVec3;

/// Single scattering of the area lights of a scene.
#[derive(Clone, Copy)]
pub struct AreaLightScattering<'s>(pub &'s SceneContext<'s>);

impl AreaLightScattering<'_> {
    /// Radiance of the area light with number `index` that media scatter into the ray of `path`, seen
    /// from its origin.
    pub fn radiance(self, index: usize, path: &mut PathContext<'_>) -> Option<DVec3> {
        let light = &self.0.radiative.area_lights[index];
        if light.radiance == DVec3::ZERO {
            return None;
        }
        let (ray, tracker) = (&path.ray, &mut path.tracker);
        let mut numbers = |which| {
            let index = 2 * index + which;
            tracker.sampler.pair(Purpose::AreaLightAlong, index)
        };
        let points = self.points(index, path.segments, ray)?;
        let point = points.sample(numbers(0))?;
        let on_light = numbers(1);
        let weight = |pdf, response_pdf| {
            let pdf = point.pdf * pdf;
            power_heuristic(
                pdf,
                point.flight_pdf(self.0.features.chromatic) * response_pdf,
            ) / pdf
        };
        let radiance = SingleScattering(self.0).at(ray, &point, tracker, |vertex, tracker| {
            DirectLight(self.0).weighted_area_light(vertex, light, on_light, weight, tracker)
        });
        Some(radiance)
    }

    /// Weight of the area light with number `index`, hit by the ray of `path` after `collision`.
    pub fn weight_after_collision(
        self,
        index: usize,
        hit: &Hit,
        path: &PathContext<'_>,
        collision: &PreviousCollision,
    ) -> f64 {
        let points = self.points(index, path.previous_segments, &collision.ray);
        let Some(point) = points.and_then(|points| points.at(collision.t)) else {
            return 1.0;
        };
        let light = &self.0.radiative.area_lights[index];
        let other = point.pdf * pdf_of_hit(light, &path.ray, hit);
        power_heuristic(
            point.flight_pdf(self.0.features.chromatic) * collision.pdf,
            other,
        )
    }

    /// The sampler of points of `ray` for the area light with number `index`, if it shines on media
    /// that scatter.
    fn points<'p>(
        self,
        index: usize,
        segments: &'p MediumSegments,
        ray: &Ray,
    ) -> Option<ScatteringPointSampler<'p>> {
        let extent = &self.0.area_light_extents[index];
        let scattering = segments.scattering_span()?;
        let lit = match (self.0.radiative.area_lights[index].sides, extent.normal) {
            (Sides::Front, Some(normal)) => in_front_of(extent.centre, normal, ray, scattering)?,
            _ => scattering,
        };
        let centre = (extent.centre, extent.spread);
        ScatteringPointSampler::within(lit, segments, ray, centre, self.0.features.chromatic).ok()
    }
}

/// The part of `span` of `ray` in front of the plane through `point` with the normal `normal`.
fn in_front_of(point: DVec3, normal: Direction, ray: &Ray, span: Span) -> Option<Span> {
    let height = (ray.origin - point).dot(*normal);
    let climb = ray.direction.cosine_to(normal);
    let crossing = -height / climb;
    let Span { mut near, mut far } = span;
    if climb > 0.0 {
        near = near.max(crossing);
    } else if climb < 0.0 {
        far = far.min(crossing);
    } else if height <= 0.0 {
        return None;
    }
    (near < far).then_some(Span { near, far })
}
