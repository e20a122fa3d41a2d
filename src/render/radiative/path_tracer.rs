//! Light turned any number of times: path tracing.
//!
//! A path begins at the eye. Along each of its rays it picks up what media emit there, what a
//! light without extent sends into the ray by one scattering, and what a surface at its end sends
//! out. Then it either collides with matter that scatters or reaches the surface; there it picks
//! up what arrives straight from the lights, is turned, and goes on.
//!
//! Every light is counted once. Lights without extent can only be connected to, straight or by
//! one turn in a medium, and both ways of finding that turn are weighted by multiple importance
//! sampling; an area light is connected to *and* met, weighted likewise; the environment, being
//! the same in all directions, is only met, since directions are chosen in the proportion in
//! which they matter. So in a furnace, a conservative scene with an environment alone and no
//! glass, every path returns exactly the radiance of the environment.
//!
//! Sources: Kajiya 1986, "The rendering equation", SIGGRAPH '86; Veach 1997, thesis, ch. 9–11;
//! Kulla & Fajardo 2012 for lights in media.

use super::direct_light::{radiance_of, weight_of_meeting};
use super::effects::Effects;
use super::free_flight::Flight;
use super::intersection::{Met, Surroundings};
use super::light_vertices::{weight_of_finding, weight_of_reaching};
use super::media::transmittance;
use super::sampler::Draws;
use super::scattering::Vertex;
use super::segments::MediaPath;
use super::specular::{facing, mirrored, through_glass};
use super::tracker::{Numbers, Tracker};
use crate::geometry::{Hit, Ray};
use crate::math::rng::{Purpose, Stream};
use crate::media::sampled_channel;
use crate::optics::{Light, Material};
use crate::render::counters::{Event, Work};
use crate::scene::Radiative;
use glam::DVec3;

/// Path tracing of a scene, for the effects `E`.
pub struct PathTracer<'s, E> {
    around: Surroundings<'s, E>,
    /// Turns at most.
    limit: u32,
}

/// Memory that is kept from path to path.
#[derive(Debug, Default)]
pub struct Scratch {
    path: MediaPath,
    connection: MediaPath,
    tracker: Tracker,
}

/// A path that came to nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It was turned more often than there are random numbers for.
    Endless,
    /// It brought back more light than a number can be.
    Infinite,
    /// So many extinctions were above what was to be their bound.
    Majorant(u64),
}

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
            around: Surroundings::new(scene, null_media),
            limit: limit.unwrap_or(u32::MAX),
        }
    }

    /// Radiance that one path brings back along `ray`.
    pub fn radiance<W: Work>(
        &self,
        ray: Ray,
        random: &Stream,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> Result<DVec3, Fault> {
        let radiance = self.traced(ray, random, scratch, work)?;
        match scratch.tracker.take_violations() {
            0 => Ok(radiance),
            violations => Err(Fault::Majorant(violations)),
        }
    }

    fn traced<W: Work>(
        &self,
        mut ray: Ray,
        random: &Stream,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> Result<DVec3, Fault> {
        let around = &self.around;
        let mut radiance = DVec3::ZERO;
        let mut throughput = DVec3::ONE;
        let mut first = DVec3::ONE;
        let mut came = Came::Alone;
        for bounce in 0..=self.limit {
            let draws = Draws { random, bounce };
            let turns_left = self.limit - bounce;
            let met = around.nearest(&ray, work);
            let end = met.as_ref().map_or(f64::INFINITY, |(_, hit)| hit.t);
            if E::MEDIA {
                scratch.path.lay(&around.media, &ray, end);
                if E::HETEROGENEOUS {
                    scratch.tracker.at_turn(random, bounce);
                }
                if E::EMISSION {
                    radiance += throughput * self.emitted(&ray, &draws, scratch, work);
                }
                if turns_left >= 1 {
                    radiance +=
                        throughput * self.by_turning_into(&ray, came, &draws, scratch, work);
                }
            }
            if let Some((Met::AreaLight(index), hit)) = &met {
                radiance += throughput * self.met_light(*index, &ray, hit, came, scratch, work);
            }

            let turned_by = match self.flight(&ray, throughput, &draws, scratch, work) {
                Flight::Collided(collision) => {
                    throughput *= collision.weight;
                    TurnedBy::Range(Vertex::Medium {
                        point: ray.at(collision.t),
                        direction: ray.direction,
                        set: collision.set,
                    })
                }
                Flight::Escaped(weight) => {
                    throughput *= weight;
                    match met {
                        None => {
                            radiance += throughput * around.scene.environment;
                            return Ok(radiance);
                        }
                        // Black, and what it sends out has been counted.
                        Some((Met::AreaLight(_), _)) => return Ok(radiance),
                        Some((Met::Object(index), hit)) => self.surface(index, hit),
                    }
                }
            };
            if turns_left == 0 || throughput == DVec3::ZERO {
                break;
            }
            work.count(turn_after(bounce));
            if bounce == 0 {
                first = throughput;
            }

            let next = match turned_by {
                TurnedBy::Range(vertex) => {
                    let arrived = (&ray, came);
                    radiance += throughput
                        * self.connected(&vertex, arrived, turns_left, &draws, scratch, work);
                    let turn = vertex.turn::<E, W>(&around.media, throughput, &draws, work);
                    turn.map(|turn| (turn.ray, turn.weight, Came::Turned(turn.pdf)))
                }
                TurnedBy::Mirror(hit, reflectance) => {
                    mirrored(&ray, &hit).map(|ray| (ray, reflectance, Came::Alone))
                }
                TurnedBy::Glass(hit, index) => through_glass(&ray, &hit, index, &draws, work)
                    .map(|(ray, weight)| (ray, DVec3::splat(weight), Came::Alone)),
            };
            let Some((next, weight, by)) = next else {
                break;
            };
            (ray, came) = (next, by);
            throughput *= weight;
            let survival = survival(throughput, first);
            if survival < 1.0 {
                if draws.one(Purpose::Roulette, work) >= survival {
                    break;
                }
                throughput /= survival;
            }
            if bounce == Stream::BOUNCES - 1 {
                return Err(Fault::Endless);
            }
        }
        Ok(radiance)
    }

    /// What lights with a position send into the ray by one turn in the media along it, weighted
    /// against the connection that the last vertex made with it.
    fn by_turning_into<W: Work>(
        &self,
        ray: &Ray,
        came: Came,
        draws: &Draws<'_>,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> DVec3 {
        let Scratch { path, tracker, .. } = scratch;
        let mut radiance = DVec3::ZERO;
        for (light, position, index) in self.positioned() {
            let source = (light, position, index);
            match self
                .around
                .by_turning_into(path, ray, source, draws, tracker, work)
            {
                Err(_) => return DVec3::INFINITY,
                Ok(None) => {}
                Ok(Some((sent, place))) => {
                    work.count(turn_after(draws.bounce));
                    let weight = match came {
                        Came::Alone => 1.0,
                        Came::Turned(pdf) => {
                            weight_of_finding(&self.around, (light, position), ray, &place, pdf)
                        }
                    };
                    radiance += sent * weight;
                }
            }
        }
        radiance
    }

    /// What an area light that the ray has met sends back through the media in between, weighted
    /// against the connection that the last vertex made with it.
    fn met_light<W: Work>(
        &self,
        index: usize,
        ray: &Ray,
        hit: &Hit,
        came: Came,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> DVec3 {
        let light = &self.around.scene.area_lights[index];
        let weight = match came {
            Came::Alone => 1.0,
            Came::Turned(pdf) => weight_of_meeting(light, ray, hit, pdf),
        };
        let through = if !E::MEDIA {
            DVec3::ONE
        } else if E::HETEROGENEOUS && self.around.media.vary() {
            let media = &self.around.media;
            media.transmittance::<E, W>(ray, hit.t, &mut scratch.tracker, work)
        } else {
            transmittance::<E, W>(scratch.path.depth(), work)
        };
        radiance_of(light, hit) * through * weight
    }

    /// What the media along the ray send back along it.
    fn emitted<W: Work>(
        &self,
        ray: &Ray,
        draws: &Draws<'_>,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> DVec3 {
        let media = &self.around.media;
        let Scratch { path, tracker, .. } = scratch;
        if E::HETEROGENEOUS && media.vary() {
            let mut chance = Numbers::new(draws.random, draws.bounce, Purpose::Emission);
            path.emitted_by_tracking::<E, W>(media, ray, &mut chance, tracker, work)
        } else {
            path.emitted::<E, W>(work)
        }
    }

    fn flight<W: Work>(
        &self,
        ray: &Ray,
        throughput: DVec3,
        draws: &Draws<'_>,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> Flight {
        if !E::MEDIA || scratch.path.stretches().is_empty() {
            return Flight::Escaped(DVec3::ONE);
        }
        let channel = if E::CHROMATIC {
            sampled_channel(throughput, draws.one(Purpose::Channel, work))
        } else {
            0
        };
        let mut chance = Numbers::new(draws.random, draws.bounce, Purpose::FreeFlight);
        let Scratch { path, tracker, .. } = scratch;
        let (media, carried) = (&self.around.media, (channel, throughput));
        let flight = path.flight::<E, W>(media, ray, carried, &mut chance, tracker, work);
        work.count_times(Event::RandomDraw, 2 * u64::from(chance.drawn) - 1);
        flight
    }

    /// What is sent back from a vertex for light that it is connected to: from lights, straight,
    /// and from places that they shine on. What lights with a position send straight to a vertex
    /// in a medium has been counted along the ray; what they send to a surface is weighted
    /// against the connection that the last vertex made with it.
    #[allow(
        clippy::too_many_arguments,
        reason = "a step of an estimator, and memory to work in"
    )]
    fn connected<W: Work>(
        &self,
        vertex: &Vertex,
        (ray, came): (&Ray, Came),
        turns_left: u32,
        draws: &Draws<'_>,
        scratch: &mut Scratch,
        work: &mut W,
    ) -> DVec3 {
        let around = &self.around;
        let Scratch {
            connection,
            tracker,
            ..
        } = scratch;
        let mut radiance = DVec3::ZERO;
        for light in &around.scene.lights {
            let weight = match (vertex, light.position(), came) {
                (Vertex::Medium { .. }, Some(_), _) => continue,
                (Vertex::Diffuse { point, .. }, Some(position), Came::Turned(pdf)) => {
                    weight_of_reaching((light, position), ray, point, pdf)
                }
                _ => 1.0,
            };
            radiance += around.by_light(vertex, light, tracker, work) * weight;
        }
        if turns_left >= 2 {
            for source in self.positioned() {
                work.count(Event::FurtherScattering);
                radiance += around.by_lit_places(vertex, source, draws, connection, tracker, work);
            }
        }
        for index in 0..around.scene.area_lights.len() {
            radiance += around.by_area_light(vertex, index, draws, tracker, work);
        }
        radiance
    }

    /// The lights that shine from somewhere, with their places and numbers.
    fn positioned(&self) -> impl Iterator<Item = (&'s Light, DVec3, usize)> {
        let lights = self.around.scene.lights.iter().enumerate();
        let shining = lights.filter(|(_, light)| light.strength() != DVec3::ZERO);
        shining.filter_map(|(index, light)| Some((light, light.position()?, index)))
    }

    fn surface(&self, index: usize, hit: Hit) -> TurnedBy {
        match self.around.scene.objects[index].material {
            Material::Diffuse(reflectance) => TurnedBy::Range(Vertex::Diffuse {
                point: hit.point,
                normal: facing(&hit),
                reflectance,
            }),
            Material::Mirror(reflectance) => TurnedBy::Mirror(hit, reflectance),
            Material::Glass(index) => TurnedBy::Glass(hit, index),
        }
    }
}

/// The turn of a path that has been turned `bounce` times.
fn turn_after(bounce: u32) -> Event {
    match bounce {
        0 => Event::FirstScattering,
        _ => Event::FurtherScattering,
    }
}

/// What turns a path.
enum TurnedBy {
    /// Something that turns it into a range of directions.
    Range(Vertex),
    /// A mirror of this reflectance.
    Mirror(Hit, DVec3),
    /// Glass of this refractive index.
    Glass(Hit, f64),
}

/// The probability with which a path is carried on, by its throughput as a share of that which
/// it had when it first was turned: certain down to a half, so that a conservative path is never
/// cut (but in glass, where radiance is measured in other solid angles) and a pixel behind something dark is not noisier for it. Half because it is cheapest: in
/// the Cornell room, error squared times time is 10 to 25 % larger if paths are cut from the
/// start, from the second or from the fifth turn on in proportion to what they carry.
fn survival(throughput: DVec3, first: DVec3) -> f64 {
    (2.0 * throughput.max_element() / first.max_element()).min(1.0)
}
