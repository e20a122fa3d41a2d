//! A place where a path is turned, and what it does to the light that arrives there.

use super::effects::Effects;
use super::media::{Media, Set};
use super::sampler::Draws;
use crate::geometry::{Ray, SurfacePoint};
use crate::math::rng::Purpose;
use crate::math::sampling::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::math::{Frame, cos, sin};
use crate::media::{Deflection, HenyeyGreenstein};
use crate::render::counters::{Event, Work};
use glam::DVec3;
use std::cell::Cell;
use std::f64::consts::{PI, TAU};

/// A place where a path is turned into a range of directions.
#[derive(Clone, Copy, Debug)]
pub enum Vertex {
    /// A collision in media.
    Medium {
        /// World point.
        point: DVec3,
        /// Direction of the path that arrived.
        direction: DVec3,
        /// The media there.
        set: Set,
    },
    /// A point of a diffuse surface.
    Diffuse {
        /// The point.
        point: SurfacePoint,
        /// Unit normal on the side that the path arrived from.
        normal: DVec3,
        /// Share of light reflected, by channel.
        reflectance: DVec3,
    },
}

/// What a vertex does to light from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// By channel, radiance sent back along the path for a unit of radiance that arrives, per
    /// steradian: the phase function, or the reflectance over π times the cosine.
    pub value: DVec3,
    /// Density with which [`Vertex::turn`] chooses the direction, per steradian; of overlapping
    /// media, which it chooses by what the path carries, one that stands in for it. Weights of
    /// ways to find the same light use it on all sides, so they add up to 1 either way.
    pub pdf: f64,
}

/// A direction that a path was turned into.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// The ray that goes on.
    pub ray: Ray,
    /// By channel, response over density.
    pub weight: DVec3,
    /// Density of the direction, per steradian, as [`Response::pdf`].
    pub pdf: f64,
}

impl Vertex {
    /// The place, world units.
    pub fn point(&self) -> DVec3 {
        match self {
            Vertex::Medium { point, .. } => *point,
            Vertex::Diffuse { point, .. } => point.position,
        }
    }

    /// The response to light from `direction`, of length 1, seen from here.
    pub fn response<E: Effects, W: Work>(
        &self,
        media: &Media<'_>,
        direction: DVec3,
        work: &mut W,
    ) -> Response {
        match self {
            Vertex::Medium {
                point,
                direction: arrived,
                set,
            } => scattered::<E, W>(media, (*set, *point), arrived.dot(direction), work),
            Vertex::Diffuse {
                normal,
                reflectance,
                ..
            } => {
                let cosine = normal.dot(direction);
                Response {
                    value: *reflectance * (cosine.max(0.0) / PI),
                    pdf: cosine_hemisphere_pdf(cosine),
                }
            }
        }
    }

    /// The ray from here to `target`, and its length.
    pub fn towards_point(&self, target: DVec3) -> Option<(Ray, f64)> {
        match self {
            Vertex::Medium { point, .. } => {
                let ray = Ray::new(*point, target - *point)?;
                Some((ray, (target - *point).dot(ray.direction)))
            }
            Vertex::Diffuse { point, .. } => point.towards_point(target),
        }
    }

    /// The ray from here to a point of a surface, and its length up to that surface.
    pub fn towards(&self, target: &SurfacePoint) -> Option<(Ray, f64)> {
        match self {
            Vertex::Medium { point, .. } => {
                let (back, length) = target.towards_point(*point)?;
                let ray = Ray {
                    origin: *point,
                    direction: -back.direction,
                };
                Some((ray, length))
            }
            Vertex::Diffuse { point, .. } => point.towards(target),
        }
    }

    /// The ray from here along `direction`, of length 1.
    pub fn leave(&self, direction: DVec3) -> Option<Ray> {
        match self {
            Vertex::Medium { point, .. } => Ray::new(*point, direction),
            Vertex::Diffuse { point, .. } => point.leave(direction),
        }
    }

    /// Samples the direction in which a path that carries `throughput` goes on.
    pub fn turn<E: Effects, W: Work>(
        &self,
        media: &Media<'_>,
        throughput: DVec3,
        draws: &Draws<'_>,
        work: &mut W,
    ) -> Option<Turn> {
        match self {
            Vertex::Medium {
                point,
                direction,
                set,
            } => {
                let place = (*set, *point);
                let (phase, weight) = chosen_phase::<E, W>(media, place, throughput, draws, work);
                let [u, v] = draws.pair(Purpose::PhaseDirection, 0, work);
                let turn = if E::ANISOTROPIC {
                    phase.deflection(u)
                } else {
                    Deflection::from_cos(2.0 * u - 1.0)
                };
                let azimuth = TAU * v;
                let sine = turn.sin();
                let local = DVec3::new(sine * cos(azimuth), sine * sin(azimuth), turn.cos);
                let towards = Frame::around(*direction).to_world(local);
                let ray = self.leave(towards)?;
                let pdf = scattered::<E, W>(media, place, turn.cos, work).pdf;
                Some(Turn { ray, weight, pdf })
            }
            Vertex::Diffuse {
                normal,
                reflectance,
                ..
            } => {
                let local = cosine_hemisphere(draws.pair(Purpose::Surface, 0, work));
                let ray = self.leave(Frame::around(*normal).to_world(local))?;
                let pdf = cosine_hemisphere_pdf(local.z);
                Some(Turn {
                    ray,
                    weight: *reflectance,
                    pdf,
                })
            }
        }
    }
}

/// Response of overlapping media: their phase functions in the proportion of their scattering.
fn scattered<E: Effects, W: Work>(
    media: &Media<'_>,
    (set, point): (Set, DVec3),
    cosine: f64,
    work: &mut W,
) -> Response {
    let turn = Deflection::from_cos(cosine.clamp(-1.0, 1.0));
    let value = |phase: HenyeyGreenstein| {
        if E::ANISOTROPIC {
            phase.per_steradian(&turn)
        } else {
            1.0 / (4.0 * PI)
        }
    };
    let lookups = Cell::new(0);
    let mut scatterers = media.scatterers::<E>(set, point, &lookups);
    let Some((first, phase)) = scatterers.next() else {
        return Response {
            value: DVec3::ZERO,
            pdf: 0.0,
        };
    };
    count_value::<E, W>(work);
    let only = value(phase);
    let (mut all, mut weighted) = (first, first * only);
    let mut alone = true;
    for (sigma_s, phase) in scatterers {
        count_value::<E, W>(work);
        all += sigma_s;
        weighted += sigma_s * value(phase);
        alone = false;
    }
    work.count_times(Event::DensityLookup, lookups.get());
    // The place of the collision is rounded: it may lie where none of them is.
    if alone || all == DVec3::ZERO {
        return Response {
            value: DVec3::splat(only),
            pdf: only,
        };
    }
    Response {
        value: share(weighted, all),
        pdf: (weighted.x + weighted.y + weighted.z) / (all.x + all.y + all.z),
    }
}

/// Counts a value of a phase function; where every direction is alike there is none to compute.
fn count_value<E: Effects, W: Work>(work: &mut W) {
    if E::ANISOTROPIC {
        work.count(Event::PhaseEvaluation);
    }
}

/// One of the overlapping media, chosen in the proportion of what they scatter of the throughput
/// of the path, and by channel its share of the scattering over the probability of the choice.
/// So the channels together carry as much as before, however often media are chosen.
fn chosen_phase<E: Effects, W: Work>(
    media: &Media<'_>,
    (set, point): (Set, DVec3),
    throughput: DVec3,
    draws: &Draws<'_>,
    work: &mut W,
) -> (HenyeyGreenstein, DVec3) {
    let lookups = Cell::new(0);
    let mut scatterers = media.scatterers::<E>(set, point, &lookups);
    let (first, phase) = scatterers
        .next()
        .expect("a collision is in matter that scatters");
    let all = scatterers.fold(first, |sum, (sigma_s, _)| sum + sigma_s);
    if media
        .scatterers::<E>(set, point, &Cell::new(0))
        .nth(1)
        .is_none()
        || all == DVec3::ZERO
    {
        return (phase, DVec3::ONE);
    }
    let carried = |sigma_s: DVec3| throughput.dot(share(sigma_s, all));
    if carried(all) == 0.0 {
        // The place of the collision is rounded: it may lie where what scatters is of a colour
        // that the path does not carry.
        return (phase, DVec3::ONE);
    }
    let mut left = draws.one(Purpose::Collision, work) * carried(all);
    let (mut chosen, mut sigma_s) = (phase, first);
    for (candidate, phase) in media.scatterers::<E>(set, point, &lookups) {
        let carried = carried(candidate);
        if carried == 0.0 {
            continue;
        }
        (chosen, sigma_s) = (phase, candidate);
        if left < carried {
            break;
        }
        left -= carried;
    }
    work.count_times(Event::DensityLookup, lookups.get());
    let weight = share(sigma_s, all) * (carried(all) / carried(sigma_s));
    (chosen, weight)
}

/// `a/b` by channel; 0 where nothing scatters.
fn share(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        if b[c] == 0.0 { 0.0 } else { a[c] / b[c] }
    }))
}
