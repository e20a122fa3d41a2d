//! Free flight: distances to the next collision.

use super::context::PathContext;
use super::media::Set;
use super::medium::{over, quotient};
use super::ray_majorants::RayMajorants;
use super::sampler::NumberRow;
use super::scene_context::SceneContext;
use super::segments::MediumSegment;
use super::tracker::Tracker;
use super::tracking::{RealCollision, Tentative, TentativeNumbers, delta_tracking};
use super::transmittance::Transmittance;
use crate::geometry::{Ray, Span};
use crate::math::rng::Purpose;
use crate::optics::{self, optical_depth, sampled_channel};
use crate::render::counters::Event;
use glam::DVec3;
use std::ops::ControlFlow;

/// A collision with a medium that scatters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collision {
    /// Distance from the origin of the ray.
    pub t: f64,
    /// `σ_s T / p` by channel, with `p` the density of the distance.
    pub weight: DVec3,
    /// The media there.
    pub set: Set,
}

/// The end of a flight through media.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Flight {
    /// A collision.
    Collided(Collision),
    /// The end of the ray. By channel, transmittance over probability.
    Escaped(DVec3),
}

/// The media that a flight has passed.
#[derive(Clone, Copy, Debug)]
struct Passed {
    /// Optical depth, by channel, of the homogeneous media that scatter.
    depth: DVec3,
    /// By channel, up to a common factor, the probability of the null collisions.
    survived: DVec3,
    /// Optical depth, by channel, of the homogeneous media that only absorb.
    absorbing: DVec3,
}

/// Free flight in the media of a scene that scatter.
#[derive(Clone, Copy)]
pub struct FreeFlight<'s>(pub &'s SceneContext<'s>);

impl FreeFlight<'_> {
    /// Samples the collision of a path with media that scatter along its ray.
    ///
    /// In a chromatic medium the density is the mean of those of the three channels in the
    /// proportion of the throughput, so that the channels of a path together never carry more than
    /// at its beginning. In a grey medium the weight of a collision is the albedo, and that of an
    /// escape 1, both exactly, but for media that only absorb.
    pub fn sample(self, path: &mut PathContext<'_>) -> Flight {
        if !self.0.features.media || path.segments.all().is_empty() {
            return Flight::Escaped(DVec3::ONE);
        }
        let PathContext {
            ray,
            throughput,
            segments,
            tracker,
            ..
        } = path;
        let (ray, segments): (&Ray, &_) = (ray, segments);
        let channel = if self.0.features.chromatic {
            sampled_channel(*throughput, tracker.sampler.one(Purpose::Channel))
        } else {
            0
        };
        let mut next = tracker.sampler.tentative(NumberRow::FreeFlight).next();
        // Optical depth of the homogeneous media at which the flight ends.
        let mut goal = next.optical_distance;
        let mut passed = Passed {
            depth: DVec3::ZERO,
            survived: DVec3::ONE,
            absorbing: DVec3::ZERO,
        };
        for segment in segments.all() {
            // A rest below 0 is a rounding.
            let rest = (goal - passed.depth[channel]).max(0.0);
            let Span { near, far } = segment.span;
            let (properties, length) = (segment.properties, far - near);
            let collision = if self.has_heterogeneous_scatterer(segment.set) {
                next.optical_distance = rest;
                match self.track(ray, segment, channel, next, &mut passed.survived, tracker) {
                    ControlFlow::Break((real, sigma_s)) => Some((real.t - near, real, sigma_s)),
                    ControlFlow::Continue(left) => {
                        next = left;
                        goal = passed.depth[channel] + left.optical_distance;
                        None
                    }
                }
            } else {
                let extinction = properties.sigma_t;
                let collides = rest < optical_depth(extinction[channel], length);
                let into = if collides {
                    rest / extinction[channel]
                } else {
                    length
                };
                passed.depth += over(extinction, into);
                let t = (near + into).min(far);
                collides.then_some((into, RealCollision { t, extinction }, properties.sigma_s))
            };
            let Some((into, RealCollision { t, extinction }, sigma_s)) = collision else {
                passed.absorbing += over(properties.absorbing, length);
                continue;
            };
            let absorbing = passed.absorbing + properties.absorbing * into;
            let transmittance =
                Transmittance(self.0).of_absorbing(segments, ray, t, absorbing, tracker);
            let weight = if self.0.features.chromatic {
                optics::collision_weight(*throughput, extinction, passed.depth, passed.survived)
            } else {
                DVec3::ONE
            };
            return Flight::Collided(Collision {
                t,
                weight: weight * transmittance * quotient(sigma_s, extinction),
                set: segment.set,
            });
        }
        let weight = if self.0.features.chromatic {
            optics::escape_weight(*throughput, passed.depth, passed.survived)
        } else {
            DVec3::ONE
        };
        let end = f64::INFINITY;
        let transmittance =
            Transmittance(self.0).of_absorbing(segments, ray, end, passed.absorbing, tracker);
        Flight::Escaped(weight * transmittance)
    }

    fn has_heterogeneous_scatterer(self, set: Set) -> bool {
        let heterogeneous = self.0.media.heterogeneous(set);
        self.0.features.heterogeneous && self.0.media.scattering(heterogeneous) != 0
    }

    /// Delta tracking over a segment with heterogeneous media: the collision with its scattering
    /// coefficient, or the rest of the optical distance.
    fn track(
        self,
        ray: &Ray,
        segment: &MediumSegment,
        channel: usize,
        first: Tentative,
        survived: &mut DVec3,
        tracker: &mut Tracker<'_>,
    ) -> ControlFlow<(RealCollision, DVec3), Tentative> {
        let (media, scratch) = (&self.0.media, &mut *tracker.scratch);
        let set = media.scattering(segment.set);
        let mut majorants =
            RayMajorants::new(media, set, ray, segment.span, &mut scratch.heterogeneous);
        let effort = &mut scratch.effort;
        let before = effort.lookups;
        let numbers = &mut tracker.sampler.tentative(NumberRow::FreeFlight);
        let end = delta_tracking(&mut majorants, channel, first, numbers, survived, effort);
        let real = u64::from(end.is_break());
        let nulls = effort.lookups - before - real;
        tracker.work.count_times(Event::NullCollision, nulls);
        majorants.count_work(tracker.work);
        end.map_break(|collision| (collision, majorants.sigma_s()))
    }
}
