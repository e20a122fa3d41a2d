//! Path tracing: light of any scattering order.
//!
//! A path begins at the eye. Along each of its rays it collects the emission of media, the single
//! scattering of positioned and area lights, and the emission of a surface at its end. Then it either
//! collides with a medium that scatters or reaches the surface; there it collects other direct light,
//! scatters, and continues.
//!
//! Every light is counted once. Lights without extent can only be connected to, directly or by
//! single scattering in a medium, and both samplers of that scattering are weighted by multiple
//! importance sampling; an area light is connected to *and* hit, weighted likewise, also by way of a
//! mirror or glass; the environment, being the same in all directions, is only hit, since directions
//! are sampled in proportion to their contribution. So in a furnace, a conservative scene with an
//! environment alone and no glass, every path returns exactly the radiance of the environment.
//!
//! Sources: Kajiya 1986, "The rendering equation", SIGGRAPH '86; Veach 1997, thesis, ch. 9–11;
//! Kulla & Fajardo 2012 for lights in media.

use super::context::{PathContext, PreviousBounce, PreviousCollision, Scratch};
use super::direct_light::{DirectLight, emitted_radiance, weight_of_hit};
use super::emission::Emission;
use super::free_flight::{Flight, FreeFlight};
use super::sampler::Sampler;
use super::scattering_function::ScatteringFunction;
use super::scene_context::{PositionedLight, SceneContext};
use super::single_scattering::{ScatteringPointSampler, SingleScattering};
use super::specular::specular_bounce;
use super::surfaces::{Intersection, SurfaceIndex};
use super::transmittance::Transmittance;
use super::variance_reduction::area_light_scattering::AreaLightScattering;
use super::variance_reduction::caustics::Caustics;
use super::variance_reduction::light_vertices::LightVertices;
use super::variance_reduction::lights_through_glass::LightsThroughGlass;
use super::variance_reduction::specular_chain::SpecularChain;
use super::vertex::Vertex;
use crate::geometry::{Hit, Ray};
use crate::math::rng::Purpose;
use crate::optics::Material;
use crate::render::counters::{Counters, Event};
use crate::render::plan::RadiativeFeatures;
use crate::scene::Radiative;
use glam::DVec3;

/// Path tracing of a scene.
pub struct PathTracer<'s> {
    scene: SceneContext<'s>,
    /// Largest number of bounces.
    limit: u32,
}

/// A path without a radiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathFault {
    /// It bounced more often than there are random numbers for.
    Endless,
    /// Its radiance is beyond the largest number.
    Infinite,
    /// An extinction was above its majorant.
    Majorant,
}

/// The next vertex of a path.
enum Interaction {
    /// A vertex that scatters into a range of directions, and the distance of a collision.
    Scattering(Vertex, Option<f64>),
    /// A mirror or glass, by its index among the objects.
    Specular(usize, Hit),
}

/// The direction in which a path continues.
struct Bounce {
    ray: Ray,
    /// Response over density, by channel.
    weight: DVec3,
    /// The part of the weight that path guiding brings about.
    guidance: f64,
    previous: PreviousBounce,
}

impl<'s> PathTracer<'s> {
    /// A tracer of paths through `scene` with `limit` bounces at most, `None` for any number.
    pub fn new(scene: &'s Radiative, limit: Option<u32>, features: RadiativeFeatures) -> Self {
        PathTracer {
            scene: SceneContext::new(scene, features),
            limit: limit.unwrap_or(u32::MAX),
        }
    }

    /// Radiance along `ray`, estimated by one path with the random numbers of `sampler`.
    ///
    /// # Errors
    ///
    /// [`PathFault::Endless`] and [`PathFault::Majorant`].
    pub fn radiance(
        &self,
        ray: Ray,
        sampler: Sampler,
        scratch: &mut Scratch,
        work: &mut Counters,
    ) -> Result<DVec3, PathFault> {
        let mut path = PathContext::new(ray, self.limit, sampler, scratch, work);
        let radiance = self.traced(&mut path);
        let tracker = path.tracker;
        let given = tracker.sampler.given();
        tracker.work.count_times(Event::RandomDraw, given);
        let radiance = radiance?;
        match std::mem::take(&mut tracker.scratch.effort.violations) {
            0 => Ok(radiance),
            _ => Err(PathFault::Majorant),
        }
    }

    fn traced(&self, path: &mut PathContext<'_>) -> Result<DVec3, PathFault> {
        let scene = &self.scene;
        let mut radiance = DVec3::ZERO;
        let mut first_throughput = DVec3::ONE;
        loop {
            let intersection = scene.intersect(&path.ray, path.tracker.work);
            if self.scene.features.media {
                let end = intersection.map_or(f64::INFINITY, |nearest| nearest.hit.t);
                path.segments.build(&scene.media, &path.ray, end);
                if self.scene.features.emission {
                    radiance += path.throughput * self.emission(path);
                }
                if path.bounces_left >= 1 {
                    radiance += path.throughput * self.single_scattering(path);
                    if self.scene.features.surfaces {
                        radiance += path.throughput * self.area_lights_along(path);
                    }
                }
            }
            if let Some(end @ Intersection { surface, hit }) = &intersection {
                if let SurfaceIndex::AreaLight(index) = *surface {
                    radiance += path.throughput * self.area_light(index, hit, path);
                } else if path.depth == 0 {
                    let (ray, limit) = (&path.ray, path.bounces_left);
                    radiance +=
                        LightsThroughGlass(scene).radiance(ray, end, limit, &mut path.tracker);
                }
            }

            let interaction = match FreeFlight(scene).sample(path) {
                Flight::Collided(collision) => {
                    path.throughput *= collision.weight;
                    let vertex = Vertex::Medium {
                        point: path.ray.at(collision.t),
                        direction: path.ray.direction,
                        set: collision.set,
                    };
                    Interaction::Scattering(vertex, Some(collision.t))
                }
                Flight::Escaped(weight) => {
                    path.throughput *= weight;
                    let Some(Intersection { surface, hit }) = intersection else {
                        radiance += path.throughput * scene.radiative.environment;
                        return Ok(radiance);
                    };
                    match surface {
                        // Black, and its emission has been counted.
                        SurfaceIndex::AreaLight(_) => return Ok(radiance),
                        SurfaceIndex::Object(index) => self.surface(index, hit),
                    }
                }
            };
            if path.bounces_left == 0 || path.throughput == DVec3::ZERO {
                return Ok(radiance);
            }
            path.tracker.work.count(scattering_at(path.depth));
            if path.depth == 0 {
                first_throughput = path.throughput;
            }
            if let Interaction::Scattering(vertex, _) = &interaction {
                radiance += path.throughput * self.connections(vertex, path);
                path.vertices += 1;
            }
            let Some(bounce) = self.bounce(&interaction, path) else {
                return Ok(radiance);
            };
            path.throughput *= bounce.weight;
            path.guidance *= bounce.guidance;
            // A path that is guided to much light has a small weight; it must not end for that.
            let survival = survival(path.throughput / path.guidance, first_throughput);
            if survival < 1.0 {
                if path.tracker.sampler.one(Purpose::Roulette) >= survival {
                    return Ok(radiance);
                }
                path.throughput /= survival;
            }
            if path.depth == Sampler::BOUNCES - 1 {
                return Err(PathFault::Endless);
            }
            path.go_on(bounce.ray, bounce.previous);
        }
    }

    /// Emission of the media along the ray.
    fn emission(&self, path: &mut PathContext<'_>) -> DVec3 {
        if self.scene.is_heterogeneous() {
            Emission(&self.scene).tracked(path)
        } else {
            Emission(&self.scene).closed(path.segments, path.tracker.work)
        }
    }

    /// Single scattering of positioned lights in the media along the ray, weighted against the
    /// light vertices of the bounce before.
    fn single_scattering(&self, path: &mut PathContext<'_>) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for light in self.scene.positioned_lights() {
            let (ray, tracker) = (&path.ray, &mut path.tracker);
            let Ok(sampler) = ScatteringPointSampler::new(
                path.segments,
                ray,
                &light,
                self.scene.features.chromatic,
            ) else {
                return DVec3::INFINITY;
            };
            let Some(sampler) = sampler else {
                continue;
            };
            let numbers = tracker.sampler.pair(Purpose::LightDistance, light.index);
            let Some(point) = sampler.sample(numbers) else {
                continue;
            };
            let scene = &self.scene;
            let scattered = SingleScattering(scene).at(ray, &point, tracker, |vertex, tracker| {
                DirectLight(scene).of_light(vertex, light.light, tracker)
            });
            tracker.work.count(scattering_at(path.depth));
            let weight = path.previous.pdf().map_or(1.0, |pdf| {
                LightVertices(scene).weight_in_medium(&light, ray, &point, pdf)
            });
            radiance += scattered / point.pdf * weight;
        }
        radiance
    }

    /// Single scattering of area lights in the media along the ray, weighted against hits of the
    /// lights after a collision there.
    fn area_lights_along(&self, path: &mut PathContext<'_>) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        for index in 0..self.scene.radiative.area_lights.len() {
            if let Some(scattered) = AreaLightScattering(&self.scene).radiance(index, path) {
                path.tracker.work.count(scattering_at(path.depth));
                radiance += scattered;
            }
        }
        radiance
    }

    /// Emission of an area light that the ray hits, through the media in between, weighted against
    /// the direct light of the bounce before.
    fn area_light(&self, index: usize, hit: &Hit, path: &mut PathContext<'_>) -> DVec3 {
        let scene = &self.scene;
        let light = &scene.radiative.area_lights[index];
        let weight = match path.previous {
            PreviousBounce::Eye => 1.0,
            PreviousBounce::Specular(chain) => chain.weight,
            PreviousBounce::Surface(pdf) => weight_of_hit(light, &path.ray, hit, pdf),
            PreviousBounce::Medium(collision) => {
                AreaLightScattering(scene).weight_after_collision(index, hit, path, &collision)
            }
        };
        let transmittance = if !self.scene.features.media {
            DVec3::ONE
        } else if scene.is_heterogeneous() {
            Transmittance(scene).along(&path.ray, hit.t, &mut path.tracker)
        } else {
            Transmittance(scene).closed(path.segments.optical_depth(), path.tracker.work)
        };
        emitted_radiance(light, hit) * transmittance * weight
    }

    /// Radiance scattered at a vertex of the light it is connected to: of lights, straight, and of
    /// light vertices. Direct light of positioned and area lights at a vertex in a medium has been
    /// counted along the ray; at a surface that of positioned lights is weighted against the light
    /// vertices of the bounce before.
    fn connections(&self, vertex: &Vertex, path: &mut PathContext<'_>) -> DVec3 {
        let scene = &self.scene;
        let mut radiance = DVec3::ZERO;
        for (index, light) in scene.radiative.lights.iter().enumerate() {
            let weight = match (vertex, light.position(), path.previous.pdf()) {
                (Vertex::Medium { .. }, Some(_), _) => continue,
                (Vertex::Diffuse { point, .. }, Some(position), Some(pdf)) => {
                    let light = PositionedLight {
                        light,
                        position,
                        index,
                    };
                    LightVertices(scene).weight_on_surface(&light, &path.ray, point, pdf)
                }
                _ => 1.0,
            };
            radiance += DirectLight(scene).of_light(vertex, light, &mut path.tracker) * weight;
        }
        if path.bounces_left >= 2 {
            for light in scene.positioned_lights() {
                path.tracker.work.count(Event::FurtherScattering);
                radiance += LightVertices(scene).radiance(vertex, &light, path);
            }
        }
        if !self.scene.features.surfaces {
            return radiance;
        }
        radiance += Caustics(scene)
            .radiance(vertex, path)
            .unwrap_or(DVec3::ZERO);
        if let Vertex::Diffuse { .. } = vertex {
            for index in 0..scene.radiative.area_lights.len() {
                radiance += DirectLight(scene).of_area_light(vertex, index, &mut path.tracker);
            }
        }
        radiance
    }

    /// Samples the direction in which the path continues.
    fn bounce(&self, interaction: &Interaction, path: &mut PathContext<'_>) -> Option<Bounce> {
        match interaction {
            Interaction::Scattering(vertex, collided_at) => {
                let throughput = path.throughput;
                let scattered = ScatteringFunction(&self.scene).sample(
                    vertex,
                    throughput,
                    &mut path.tracker,
                )?;
                let (ray, pdf) = (path.ray, scattered.pdf);
                Some(Bounce {
                    ray: scattered.ray,
                    weight: scattered.weight,
                    guidance: scattered.guidance,
                    previous: match *collided_at {
                        Some(t) => PreviousBounce::Medium(PreviousCollision { pdf, ray, t }),
                        None => PreviousBounce::Surface(pdf),
                    },
                })
            }
            Interaction::Specular(object, hit) => {
                let sampler = &mut path.tracker.sampler;
                let choice = || sampler.one(Purpose::Surface);
                let material = &self.scene.radiative.objects[*object].material;
                let bounce = specular_bounce(material, &path.ray, hit, choice)?;
                Some(Bounce {
                    ray: bounce.ray,
                    weight: bounce.weight,
                    guidance: 1.0,
                    previous: PreviousBounce::Specular(self.specular_chain(*object, path)),
                })
            }
        }
    }

    /// The chain of specular bounces that the bounce of `path` on `object` begins or continues.
    fn specular_chain(&self, object: usize, path: &PathContext<'_>) -> SpecularChain {
        let scene = &self.scene;
        match path.previous {
            PreviousBounce::Eye => LightsThroughGlass(scene).chain_from_eye(),
            PreviousBounce::Specular(chain) => chain.continued(object),
            PreviousBounce::Surface(pdf)
            | PreviousBounce::Medium(PreviousCollision { pdf, .. }) => {
                Caustics(scene).chain_from_vertex(object, path, pdf)
            }
        }
    }

    fn surface(&self, index: usize, hit: Hit) -> Interaction {
        match self.scene.radiative.objects[index].material {
            Material::Diffuse(reflectance) => {
                Interaction::Scattering(Vertex::on_surface(&hit, reflectance), None)
            }
            Material::Mirror(_) | Material::Glass(_) => Interaction::Specular(index, hit),
        }
    }
}

/// The counter of a scattering behind `depth` bounces.
fn scattering_at(depth: u32) -> Event {
    if depth == 0 {
        Event::FirstScattering
    } else {
        Event::FurtherScattering
    }
}

/// Probability that a path continues, by its throughput relative to that at its first bounce: 1
/// down to a half, so that a conservative path never ends (except in glass, where radiance is
/// measured in other solid angles) and a pixel behind a dark object has no more noise. One half is
/// the cheapest: in the Cornell box, error squared times time is 10 to 25 % larger if paths end in
/// proportion to their throughput from the start, from the second or from the fifth bounce on.
fn survival(throughput: DVec3, first_throughput: DVec3) -> f64 {
    (2.0 * throughput.max_element() / first_throughput.max_element()).min(1.0)
}
