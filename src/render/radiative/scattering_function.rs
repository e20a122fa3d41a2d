//! The scattering function at a vertex: the phase functions of media, the reflectance of diffuse
//! surfaces.

use super::media::{Set, members};
use super::medium::{Medium, quotient};
use super::sampler::Sampler;
use super::scene_context::SceneContext;
use super::tracker::Tracker;
use super::variance_reduction::guiding::{Guide, Technique};
use super::vertex::Vertex;
use crate::geometry::{Direction, Ray};
use crate::math::Frame;
use crate::math::rng::Purpose;
use crate::math::sampling::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::optics::{Deflection, Density, Phase};
use crate::render::counters::{Counters, Event};
use glam::DVec3;
use std::cell::Cell;
use std::f64::consts::PI;

/// The response of a vertex to light from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// By channel, radiance scattered back along the path per radiance that arrives, per steradian:
    /// the phase function, or the reflectance over π times the cosine.
    pub value: DVec3,
    /// Density with which [`ScatteringFunction::sample`] samples the direction, per steradian; of
    /// overlapping media, which it chooses by the throughput, one that stands in for it. All
    /// weights of multiple importance sampling use it, so they add up to 1 either way.
    pub pdf: f64,
}

/// A direction sampled at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct SampledDirection {
    /// The continuing ray.
    pub ray: Ray,
    /// By channel, response over density.
    pub weight: DVec3,
    /// Density of the direction, per steradian, as [`Response::pdf`].
    pub pdf: f64,
    /// Density without path guiding over that with it: the part of the weight that guiding brings
    /// about.
    pub guidance: f64,
}

/// The scattering function at the vertices of a scene.
#[derive(Clone, Copy)]
pub struct ScatteringFunction<'s>(pub &'s SceneContext<'s>);

impl<'s> ScatteringFunction<'s> {
    /// The response of `vertex` to light from `direction`, seen from there.
    pub fn response(self, vertex: &Vertex, direction: Direction, work: &mut Counters) -> Response {
        match vertex {
            Vertex::Medium {
                point,
                direction: arrived,
                set,
            } => {
                let response =
                    self.medium_response(*set, *point, arrived.cosine_to(direction), work);
                let guide = self.guide(*set, *point);
                let pdf = guide.map_or(response.pdf, |it| it.pdf(direction, response.pdf));
                Response { pdf, ..response }
            }
            Vertex::Diffuse {
                normal,
                reflectance,
                ..
            } => {
                let cosine = normal.cosine_to(direction);
                Response {
                    value: *reflectance * (cosine.max(0.0) / PI),
                    pdf: cosine_hemisphere_pdf(cosine),
                }
            }
        }
    }

    /// Samples the direction in which a path of `throughput` continues from `vertex`.
    pub fn sample(
        self,
        vertex: &Vertex,
        throughput: DVec3,
        tracker: &mut Tracker<'_>,
    ) -> Option<SampledDirection> {
        let Tracker { sampler, work, .. } = tracker;
        match vertex {
            Vertex::Medium {
                point,
                direction,
                set,
            } => {
                let guide = self.guide(*set, *point);
                let [u, v] = sampler.pair(Purpose::PhaseDirection, 0);
                let (technique, u) = match &guide {
                    Some(guide) => guide.technique(u),
                    None => (Technique::Phase, u),
                };
                if let (Some(guide), Technique::Guide) = (&guide, technique) {
                    let ray = vertex.leave(guide.sample([u, v])?)?;
                    let cosine = direction.cosine_to(ray.direction);
                    let response = self.medium_response(*set, *point, cosine, work);
                    let pdf = guide.pdf(ray.direction, response.pdf);
                    return Some(SampledDirection {
                        ray,
                        weight: response.value / pdf,
                        pdf,
                        guidance: response.pdf / pdf,
                    });
                }
                let (phase, weight) = self.sample_phase(*set, *point, throughput, sampler, work);
                let deflection = if self.0.features.anisotropic {
                    phase.deflection(u)
                } else {
                    Deflection::from_cos(2.0 * u - 1.0)
                };
                let local = deflection.direction(v);
                let ray = vertex.leave(Frame::around(*direction).to_world(local))?;
                let by_phase = self.medium_response(*set, *point, deflection.cos, work).pdf;
                let (pdf, guidance) = match &guide {
                    Some(guide) => {
                        let pdf = guide.pdf(ray.direction, by_phase);
                        (pdf, by_phase / pdf)
                    }
                    // Not a quotient: a density may be 0.
                    None => (by_phase, 1.0),
                };
                Some(SampledDirection {
                    ray,
                    weight: weight * guidance,
                    pdf,
                    guidance,
                })
            }
            Vertex::Diffuse {
                normal,
                reflectance,
                ..
            } => {
                let local = cosine_hemisphere(sampler.pair(Purpose::Surface, 0));
                let ray = vertex.leave(Frame::around(*normal).to_world(local))?;
                let pdf = cosine_hemisphere_pdf(local.z);
                Some(SampledDirection {
                    ray,
                    weight: *reflectance,
                    pdf,
                    guidance: 1.0,
                })
            }
        }
    }

    /// Path guiding at a collision with the media in `set` at `point`.
    fn guide(self, set: Set, point: DVec3) -> Option<Guide<'s>> {
        if !self.0.features.surfaces {
            return None;
        }
        let mean_cosine = if self.0.features.anisotropic {
            let phases = self.scattering_members(set).map(|medium| medium.phase);
            phases.fold(0.0, |most: f64, phase| most.max(phase.mean_cosine().abs()))
        } else {
            0.0
        };
        self.0.guiding.at(point, mean_cosine)
    }

    /// Response of the media in `set` at `point`: their phase functions in the proportion of their
    /// scattering.
    fn medium_response(self, set: Set, point: DVec3, cosine: f64, work: &mut Counters) -> Response {
        let deflection = Deflection::from_cos(cosine.clamp(-1.0, 1.0));
        let value = |phase: &Phase| {
            if self.0.features.anisotropic {
                phase.per_steradian(&deflection)
            } else {
                1.0 / (4.0 * PI)
            }
        };
        if let Some(phase) = self.only_scatterer(set) {
            self.count_evaluation(work);
            let value = value(phase);
            return Response {
                value: DVec3::splat(value),
                pdf: value,
            };
        }
        let lookups = Cell::new(0);
        let mut scatterers = self.scatterers(set, point, &lookups);
        let Some((first, phase)) = scatterers.next() else {
            return Response {
                value: DVec3::ZERO,
                pdf: 0.0,
            };
        };
        self.count_evaluation(work);
        let of_first = value(phase);
        let (mut all, mut weighted) = (first, first * of_first);
        for (sigma_s, phase) in scatterers {
            self.count_evaluation(work);
            all += sigma_s;
            weighted += sigma_s * value(phase);
        }
        work.count_times(Event::DensityLookup, lookups.get());
        // The point of the collision is rounded: it may lie where none of them is.
        if all == DVec3::ZERO {
            return Response {
                value: DVec3::splat(of_first),
                pdf: of_first,
            };
        }
        Response {
            value: quotient(weighted, all),
            pdf: (weighted.x + weighted.y + weighted.z) / (all.x + all.y + all.z),
        }
    }

    /// One of the overlapping media, sampled in the proportion of their scattering of the
    /// throughput, and by channel its fraction of the scattering over its probability. So the sum
    /// of the channels is preserved, however often media are sampled.
    fn sample_phase(
        self,
        set: Set,
        point: DVec3,
        throughput: DVec3,
        sampler: &mut Sampler,
        work: &mut Counters,
    ) -> (&'s Phase, DVec3) {
        if let Some(phase) = self.only_scatterer(set) {
            return (phase, DVec3::ONE);
        }
        let lookups = Cell::new(0);
        let mut scatterers = self.scatterers(set, point, &lookups);
        let (first, phase) = scatterers
            .next()
            .expect("a collision is in a medium that scatters");
        let all = scatterers.fold(first, |sum, (sigma_s, _)| sum + sigma_s);
        let carried = |sigma_s: DVec3| throughput.dot(quotient(sigma_s, all));
        if all == DVec3::ZERO || carried(all) == 0.0 {
            // The point of the collision is rounded: it may lie where the scattering is of a colour
            // that the path does not carry.
            return (phase, DVec3::ONE);
        }
        let mut left = sampler.one(Purpose::Collision) * carried(all);
        let (mut chosen, mut sigma_s) = (phase, first);
        for (candidate, phase) in self.scatterers(set, point, &lookups) {
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
        let weight = quotient(sigma_s, all) * (carried(all) / carried(sigma_s));
        (chosen, weight)
    }

    /// Counts the value of a phase function; an isotropic one is constant.
    fn count_evaluation(self, work: &mut Counters) {
        if self.0.features.anisotropic {
            work.count(Event::PhaseEvaluation);
        }
    }

    /// The phase function of the only medium in `set` that scatters, with which no other has to be
    /// compared.
    fn only_scatterer(self, set: Set) -> Option<&'s Phase> {
        let mut scatterers = self.scattering_members(set);
        let only = scatterers.next()?;
        scatterers.next().is_none().then_some(&only.phase)
    }

    /// Scattering coefficient and phase function of each medium in `set` that scatters, at the
    /// world point `point`, which lies in all of them. Adds to `lookups`.
    fn scatterers(
        self,
        set: Set,
        point: DVec3,
        lookups: &Cell<u64>,
    ) -> impl Iterator<Item = (DVec3, &'s Phase)> {
        self.scattering_members(set).map(move |medium| {
            let mut count = lookups.get();
            let sigma_s = medium.sigma_s(point, &mut count);
            lookups.set(count);
            (sigma_s, &medium.phase)
        })
    }

    /// The media of `set` that scatter, not by their properties on a segment: those may vanish where
    /// the scattering does not.
    fn scattering_members(self, set: Set) -> impl Iterator<Item = &'s Medium<'s>> {
        let media = &self.0.media;
        let members = members(set).map(move |index| media.medium(index));
        members.filter(|medium| {
            medium.unit.scatters() && !medium.density.is_some_and(Density::is_nothing)
        })
    }
}
