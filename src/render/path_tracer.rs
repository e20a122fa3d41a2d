//! Light turned any number of times: path tracing.
//!
//! A path begins at the eye. Along each of its rays it picks up what media emit there, what a
//! light without extent sends into the ray by one scattering, and what a surface at its end sends
//! out. Then it either collides with matter that scatters or reaches the surface; there it picks
//! up what arrives straight from the lights, is turned, and goes on.
//!
//! Every light is counted once: those without extent can only be connected to; an area light is
//! connected to *and* met, the two weighted by multiple importance sampling; the environment,
//! being the same in all directions, is only met, since directions are chosen in the proportion
//! in which they matter. So in a furnace, a conservative scene with an environment alone, every
//! path returns exactly the radiance of the environment.
//!
//! Sources: Kajiya 1986, "The rendering equation", SIGGRAPH '86; Veach 1997, thesis, ch. 9–11;
//! Kulla & Fajardo 2012 for lights in media.

use super::direct_light::{from_area_light, from_light, radiance_of, weight_of_meeting};
use super::effects::Effects;
use super::in_scattering;
use super::media_path::{Flight, Media, MediaPath, transmittance};
use super::surroundings::{Met, nearest};
use super::vertex::Vertex;
use super::work::{Event, Work};
use crate::geometry::{Hit, Ray, Side, Span};
use crate::math::rng::{Purpose, Stream};
use crate::optics::{Light, Material, reflected, split};
use crate::scene::Radiative;
use glam::DVec3;
use std::marker::PhantomData;

/// Path tracing of a scene, for the effects `E`.
pub struct PathTracer<'s, E> {
    scene: &'s Radiative,
    media: Media<'s>,
    /// Turns at most.
    limit: u32,
    effects: PhantomData<E>,
}

/// Memory that is kept from path to path.
#[derive(Debug, Default)]
pub struct Scratch {
    path: MediaPath,
    spans: Vec<Span>,
}

/// A path that was turned more often than there are random numbers for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Endless;

/// How the ray under way came by its direction.
#[derive(Clone, Copy, Debug)]
enum Came {
    /// From the eye, a mirror or glass: no other way finds a light along it.
    Alone,
    /// By a turn with this density per steradian.
    Turned(f64),
}

impl<'s, E: Effects> PathTracer<'s, E> {
    /// A tracer of paths through `scene` with `limit` turns at most, `None` for any number.
    /// With `null_media`, also media of no matter are asked where they are.
    pub fn new(scene: &'s Radiative, limit: Option<u32>, null_media: bool) -> Self {
        PathTracer {
            media: Media::new(&scene.media, null_media),
            scene,
            limit: limit.unwrap_or(Stream::BOUNCES - 1),
            effects: PhantomData,
        }
    }

    /// Radiance that one path brings back along `ray`.
    pub fn radiance<W: Work>(
        &self,
        mut ray: Ray,
        random: &Stream,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> Result<DVec3, Endless> {
        let mut radiance = DVec3::ZERO;
        let mut throughput = DVec3::ONE;
        let mut came = Came::Alone;
        let mut first = DVec3::ONE;
        for bounce in 0.. {
            let met = if E::SURFACES {
                nearest(self.scene, &ray, work)
            } else {
                None
            };
            let end = met.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
            let turns_left = bounce < self.limit;
            if E::MEDIA {
                scratch.path.lay(&self.media, &ray, end);
                radiance +=
                    throughput * self.along(&ray, turns_left, random, bounce, scratch, work);
            }
            if let Some((Met::AreaLight(index), hit)) = &met {
                radiance += throughput * self.met_light(*index, &ray, hit, came, scratch);
            }

            let (vertex, weight) = match self.flight(random, bounce, scratch, work) {
                Flight::Collided(collision) => {
                    let vertex = Vertex::Medium {
                        point: ray.at(collision.t),
                        direction: ray.direction,
                        set: collision.set,
                    };
                    (Ok(vertex), collision.weight)
                }
                Flight::Escaped(weight) => match met {
                    None => {
                        radiance += throughput * weight * self.scene.environment;
                        return Ok(radiance);
                    }
                    // Black, and what it sends out has been counted.
                    Some((Met::AreaLight(_), _)) => return Ok(radiance),
                    Some((Met::Object(index), hit)) => (self.surface(index, &ray, hit), weight),
                },
            };
            throughput *= weight;
            if bounce == 0 {
                first = throughput;
            }
            if !turns_left {
                if self.limit == Stream::BOUNCES - 1 {
                    return Err(Endless);
                }
                return Ok(radiance);
            }
            if throughput == DVec3::ZERO {
                return Ok(radiance);
            }

            match vertex {
                Ok(vertex) => {
                    radiance += throughput * self.straight(&vertex, random, bounce, scratch, work);
                    let Some(turn) = vertex.turn::<E, W>(&self.media, random, bounce, work) else {
                        return Ok(radiance);
                    };
                    throughput *= turn.weight;
                    came = Came::Turned(turn.pdf);
                    ray = turn.ray;
                }
                Err(smooth) => {
                    let Some((next, weight)) = smooth.turn(&ray, random, bounce, work) else {
                        return Ok(radiance);
                    };
                    throughput *= weight;
                    came = Came::Alone;
                    ray = next;
                }
            }
            match survival(throughput, first) {
                1.0 => {}
                survival => {
                    work.count(Event::RandomDraw);
                    if random.uniform(bounce, Purpose::Roulette, 0) >= survival {
                        return Ok(radiance);
                    }
                    throughput /= survival;
                }
            }
        }
        unreachable!("the number of turns is limited")
    }

    /// What the media along the ray under way send back: their emission, and light without
    /// extent that they turn once.
    fn along<W: Work>(
        &self,
        ray: &Ray,
        turns_left: bool,
        random: &Stream,
        bounce: u32,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> DVec3 {
        let Scratch { path, spans } = scratch;
        let mut radiance = DVec3::ZERO;
        if E::EMISSION {
            radiance += path.emitted::<E>();
        }
        if !turns_left {
            return radiance;
        }
        for (index, light) in self.scene.lights.iter().enumerate() {
            if let Some(position) = position(light) {
                let source = (random, bounce, index as u32);
                radiance += in_scattering::from_light::<E, W>(
                    self.scene,
                    &self.media,
                    path,
                    ray,
                    (light, position),
                    source,
                    spans,
                    work,
                );
            }
        }
        radiance
    }

    /// What an area light that the ray has met sends back through the media in between, weighted
    /// against the connection that the last vertex made with it.
    fn met_light(
        &self,
        index: usize,
        ray: &Ray,
        hit: &Hit,
        came: Came,
        scratch: &Scratch,
    ) -> DVec3 {
        let light = &self.scene.area_lights[index];
        let weight = match came {
            Came::Alone => 1.0,
            Came::Turned(pdf) => weight_of_meeting(light, ray, hit, pdf),
        };
        let through = if E::MEDIA {
            transmittance::<E>(scratch.path.depth())
        } else {
            DVec3::ONE
        };
        radiance_of(light, hit) * through * weight
    }

    fn flight<W: Work>(
        &self,
        random: &Stream,
        bounce: u32,
        scratch: &Scratch,
        work: &mut W,
    ) -> Flight {
        if !E::MEDIA || scratch.path.stretches().is_empty() {
            return Flight::Escaped(DVec3::ONE);
        }
        let channel = if E::CHROMATIC {
            work.count(Event::RandomDraw);
            (3.0 * random.uniform(bounce, Purpose::Channel, 0)) as usize
        } else {
            0
        };
        work.count(Event::RandomDraw);
        let u = random.uniform(bounce, Purpose::FreeFlight, 0);
        scratch.path.flight::<E>(u, channel)
    }

    /// What lights send straight to a vertex and it sends back along the path. Lights with a
    /// position have been counted along the ray, for vertices in media.
    fn straight<W: Work>(
        &self,
        vertex: &Vertex,
        random: &Stream,
        bounce: u32,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> DVec3 {
        let (scene, spans) = (self.scene, &mut scratch.spans);
        let mut radiance = DVec3::ZERO;
        let in_medium = matches!(vertex, Vertex::Medium { .. });
        for light in &scene.lights {
            if !(in_medium && position(light).is_some()) {
                radiance += from_light::<E, W>(scene, &self.media, vertex, light, spans, work);
            }
        }
        for index in 0..scene.area_lights.len() {
            let source = (random, bounce);
            radiance +=
                from_area_light::<E, W>(scene, &self.media, vertex, index, source, spans, work);
        }
        radiance
    }

    fn surface(&self, index: usize, ray: &Ray, hit: Hit) -> Result<Vertex, Smooth> {
        let normal = match hit.side {
            Side::Front => hit.point.normal,
            Side::Back => -hit.point.normal,
        };
        match self.scene.objects[index].material {
            Material::Diffuse(reflectance) => Ok(Vertex::Diffuse {
                point: hit.point,
                normal,
                reflectance,
            }),
            material => {
                let _ = ray;
                Err(Smooth {
                    material,
                    hit,
                    normal,
                })
            }
        }
    }
}

/// The probability with which a path is carried on, by its throughput as a share of that which
/// it had when it first was turned: certain down to a half, so that a conservative path is never
/// cut and a pixel behind something dark is not noisier for it. Half because it is cheapest: in
/// the Cornell room, error squared times time is 10 to 25 % larger if paths are cut from the
/// start, from the second or from the fifth turn on in proportion to what they carry.
fn survival(throughput: DVec3, first: DVec3) -> f64 {
    (2.0 * throughput.max_element() / first.max_element()).min(1.0)
}

/// A mirror or glass: a path that meets it goes on in one or two directions.
struct Smooth {
    material: Material,
    hit: Hit,
    normal: DVec3,
}

impl Smooth {
    /// The ray that goes on, and its weight by channel.
    fn turn<W: Work>(
        &self,
        ray: &Ray,
        random: &Stream,
        bounce: u32,
        work: &mut W,
    ) -> Option<(Ray, DVec3)> {
        let mirrored = reflected(ray.direction, self.normal);
        let leave = |direction| self.hit.point.leave(direction);
        match self.material {
            Material::Mirror(reflectance) => Some((leave(mirrored)?, reflectance)),
            Material::Glass(index) => {
                let ratio = match self.hit.side {
                    Side::Front => 1.0 / index,
                    Side::Back => index,
                };
                let split = split(ray.direction, self.normal, ratio);
                work.count(Event::RandomDraw);
                let choice = random.uniform(bounce, Purpose::Surface, 0);
                match split.refracted {
                    // Radiance is measured per solid angle, which refraction stretches.
                    Some(refracted) if choice >= split.reflectance => {
                        Some((leave(refracted)?, DVec3::splat(ratio * ratio)))
                    }
                    _ => Some((leave(mirrored)?, DVec3::ONE)),
                }
            }
            Material::Diffuse(_) => unreachable!("a diffuse surface is a vertex"),
        }
    }
}

/// Where a light stands; `None` for one infinitely far away.
fn position(light: &Light) -> Option<DVec3> {
    match light {
        Light::Point(light) => Some(light.position),
        Light::Spot(light) => Some(light.position),
        Light::Directional(_) => None,
    }
}
