//! Caustics: light of area lights that reaches a vertex by way of a mirror or glass.
//!
//! A path finds this light only if its direction happens to meet the mirror or the glass, and goes on to
//! a light from there. Few paths do, and each returns the whole radiance of the light. So directions are
//! also sampled within the cone around a mirror or glass, and followed while they bounce on it. A path
//! that hits a light after the same bounces finds the same light; both samplers are weighted by multiple
//! importance sampling at the vertex, the only place where their densities differ. Light by two objects,
//! or for a vertex within the sphere around one, is left to paths.
//!
//! Occlusion and the response of the vertex come last: most of the directions end at no light.
//!
//! Source: Veach 1997, thesis, ch. 9, for the weights.

use super::specular_chain::{Follower, SpecularChain};
use super::specular_objects::SpecularObject;
use crate::geometry::{Ray, Surface};
use crate::math::Frame;
use crate::math::rng::Purpose;
use crate::math::sampling::power_heuristic;
use crate::render::counters::Event;
use crate::render::radiative::context::PathContext;
use crate::render::radiative::direct_light::emitted_radiance;
use crate::render::radiative::scattering_function::ScatteringFunction;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::radiative::specular::specular_bounce;
use crate::render::radiative::surfaces::SurfaceIndex;
use crate::render::radiative::tracker::Tracker;
use crate::render::radiative::transmittance::Transmittance;
use crate::render::radiative::vertex::Vertex;
use arrayvec::ArrayVec;
use glam::DVec3;

/// Part of the vertices behind the first from which a mirror or glass is aimed at. An aim takes half
/// the time of a bounce. Error squared times time in rooms of fog, over that of 0.1: of 0 it is 1.00
/// to 1.12, of 0.25 it is 0.95 to 1.03, of 0.5 it is 0.92 where the fog only absorbs and 1.08 where it
/// only scatters.
const AIMS: f64 = 0.1;

/// A straight piece of a chain: a ray, and the surface at its end.
struct Link {
    ray: Ray,
    t: f64,
    surface: SurfaceIndex,
}

/// A chain from a vertex to an area light.
struct Chain {
    links: ArrayVec<Link, { Follower::FROM_VERTEX + 1 }>,
    /// Radiance at its beginning, by channel, through vacuum.
    radiance: DVec3,
}

/// Caustics of the mirrors and glass of a scene.
#[derive(Clone, Copy)]
pub struct Caustics<'s>(pub &'s SceneContext<'s>);

impl Caustics<'_> {
    /// Radiance scattered at `vertex` of `path` of the light of area lights by way of mirrors and glass,
    /// one of which is aimed at, or none. `None` where nothing is found.
    pub fn radiance(self, vertex: &Vertex, path: &mut PathContext<'_>) -> Option<DVec3> {
        let probability = self.aim_probability(path.vertices)?;
        let tracker = &mut path.tracker;
        let [u, v] = tracker.sampler.pair(Purpose::Caustic, 0);
        // The rest of the choice is uniform again.
        let choice = u / probability;
        let target = self.0.specular_objects.get(choice as usize)?;
        let (cone, axis) = target.seen_from(vertex.point())?;
        let direction = cone.direction([choice.fract(), v]);
        let direction = Frame::around(axis).to_world(direction);
        if !vertex.faces(direction) {
            return None;
        }
        // One bounce is that at the vertex.
        let most = path.bounces_left.saturating_sub(1) as usize;
        let most = most.min(Follower::FROM_VERTEX);
        let chain = self.chain_to_light(vertex.leave(direction)?, target, most, tracker)?;
        for link in &chain.links {
            let nearest = self.0.intersect(&link.ray, tracker.work)?;
            if nearest.surface != link.surface {
                return None;
            }
        }
        let response = ScatteringFunction(self.0).response(vertex, direction, tracker.work);
        let mut radiance = chain.radiance;
        if self.0.features.media {
            for link in &chain.links {
                radiance *= Transmittance(self.0).along(&link.ray, link.t, tracker);
            }
        }
        let pdf = probability * cone.pdf();
        let weight = power_heuristic(pdf, response.pdf) / pdf;
        Some(response.value * radiance * weight)
    }

    /// The chain that begins with `ray`, bounces on `target` at most `most` times, and ends at an area
    /// light, as if no other surface were there.
    fn chain_to_light(
        self,
        mut ray: Ray,
        target: &SpecularObject,
        most: usize,
        tracker: &mut Tracker<'_>,
    ) -> Option<Chain> {
        let object = &self.0.radiative.objects[target.object];
        let lights = self.0.radiative.area_lights.len() as u64;
        let mut links = ArrayVec::new();
        let mut throughput = DVec3::ONE;
        let mut choices = [0.0; 2];
        loop {
            tracker.work.count(Event::SurfaceTest);
            let crossing = object.shape.crossing(&ray, f64::INFINITY);
            let bounces = links.len();
            if bounces > 0 {
                let limit = crossing.map_or(f64::INFINITY, |crossing| crossing.t);
                tracker.work.count_times(Event::SurfaceTest, lights);
                if let Some((index, hit)) = self.0.surfaces.nearest_light(&ray, limit) {
                    let emitted = emitted_radiance(&self.0.radiative.area_lights[index], &hit);
                    let (t, surface) = (hit.t, SurfaceIndex::AreaLight(index));
                    links.push(Link { ray, t, surface });
                    let radiance = throughput * emitted;
                    return (radiance != DVec3::ZERO).then_some(Chain { links, radiance });
                }
            }
            if bounces == most {
                return None;
            }
            let hit = object.shape.hit_at(&ray, &crossing?);
            let choice = || {
                if bounces % 2 == 0 {
                    choices = tracker.sampler.pair(Purpose::Caustic, 1 + bounces / 2);
                }
                choices[bounces % 2]
            };
            let bounce = specular_bounce(&object.material, &ray, &hit, choice)?;
            let (t, surface) = (hit.t, SurfaceIndex::Object(target.object));
            links.push(Link { ray, t, surface });
            throughput *= bounce.weight;
            ray = bounce.ray;
        }
    }

    /// The chain that the bounce of `path` on `object` begins, in a direction that was sampled with the
    /// density `scattered_pdf`.
    pub fn chain_from_vertex(
        self,
        object: usize,
        path: &PathContext<'_>,
        scattered_pdf: f64,
    ) -> SpecularChain {
        let mut objects = self.0.specular_objects.iter();
        let target = objects.find(|it| it.object == object);
        let cone = target.and_then(|target| target.seen_from(path.ray.origin));
        let (Some(probability), Some((cone, _))) = (self.aim_probability(path.vertices - 1), cone)
        else {
            return SpecularChain::ALONE;
        };
        let weight = power_heuristic(scattered_pdf, probability * cone.pdf());
        SpecularChain::begun(Follower::Vertex(object), weight)
    }

    /// Probability that each of the objects is aimed at from a vertex behind `before` others.
    fn aim_probability(self, before: u32) -> Option<f64> {
        let objects = self.0.specular_objects.len();
        let aims = if before == 0 { 1.0 } else { AIMS };
        (objects > 0).then_some(aims / objects as f64)
    }
}
