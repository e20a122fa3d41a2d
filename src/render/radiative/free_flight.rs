//! Free flight: distances to the next collision.

use super::context::PathContext;
use super::media::{Media, Set};
use super::medium::over;
use super::ray_majorants::RayMajorants;
use super::sampler::NumberRow;
use super::scene_context::SceneContext;
use super::segments::MediumSegment;
use super::tracker::Tracker;
use super::tracking::{RealCollision, Tentative, TentativeNumbers, delta_tracking};
use super::transmittance::Transmittance;
use crate::geometry::Ray;
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
            if self.0.features.heterogeneous && self.has_heterogeneous_scatterer(segment.set) {
                next.optical_distance = rest;
                let survived = &mut passed.survived;
                match track(
                    &self.0.media,
                    ray,
                    segment,
                    channel,
                    next,
                    survived,
                    tracker,
                ) {
                    ControlFlow::Break((RealCollision { t, extinction }, sigma_s)) => {
                        let into = t - segment.span.near;
                        let absorbing = passed.absorbing + segment.properties.absorbing * into;
                        let transmittance = Transmittance(self.0)
                            .of_absorbing(segments, ray, t, absorbing, tracker);
                        let weight = self.collision_weight(&passed, *throughput, extinction);
                        return Flight::Collided(Collision {
                            t,
                            weight: weight * transmittance * quotient(sigma_s, extinction),
                            set: segment.set,
                        });
                    }
                    ControlFlow::Continue(left) => {
                        next = left;
                        goal = passed.depth[channel] + left.optical_distance;
                    }
                }
                let length = segment.span.length();
                passed.absorbing += over(segment.properties.absorbing, length);
                continue;
            }
            let properties = segment.properties;
            let sigma_t = properties.sigma_t;
            let length = segment.span.length();
            if rest < optical_depth(sigma_t[channel], length) {
                let into = rest / sigma_t[channel];
                let t = (segment.span.near + into).min(segment.span.far);
                let absorbing = passed.absorbing + properties.absorbing * into;
                let transmittance =
                    Transmittance(self.0).of_absorbing(segments, ray, t, absorbing, tracker);
                passed.depth += over(sigma_t, into);
                let weight = self.collision_weight(&passed, *throughput, sigma_t);
                return Flight::Collided(Collision {
                    t,
                    weight: weight * transmittance * quotient(properties.sigma_s, sigma_t),
                    set: segment.set,
                });
            }
            passed.depth += over(sigma_t, length);
            passed.absorbing += over(properties.absorbing, length);
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

    /// Weight, by channel, of a collision where the extinction is `sigma_t`, without the albedo.
    fn collision_weight(self, passed: &Passed, throughput: DVec3, sigma_t: DVec3) -> DVec3 {
        if self.0.features.chromatic {
            optics::collision_weight(throughput, sigma_t, passed.depth, passed.survived)
        } else {
            DVec3::ONE
        }
    }

    fn has_heterogeneous_scatterer(self, set: Set) -> bool {
        let heterogeneous = self.0.media.heterogeneous(set);
        heterogeneous != 0 && self.0.media.scattering(heterogeneous) != 0
    }
}

/// Delta tracking over a segment with heterogeneous media: the collision with its scattering
/// coefficient, or the rest of the optical distance.
fn track(
    media: &Media<'_>,
    ray: &Ray,
    segment: &MediumSegment,
    channel: usize,
    first: Tentative,
    survived: &mut DVec3,
    tracker: &mut Tracker<'_>,
) -> ControlFlow<(RealCollision, DVec3), Tentative> {
    let scratch = &mut *tracker.scratch;
    let set = media.scattering(segment.set);
    let mut majorants =
        RayMajorants::new(media, set, ray, segment.span, &mut scratch.heterogeneous);
    let effort = &mut scratch.effort;
    let before = effort.lookups;
    let end = delta_tracking(
        &mut majorants,
        channel,
        first,
        &mut tracker.sampler.tentative(NumberRow::FreeFlight),
        survived,
        effort,
    );
    let real = u64::from(end.is_break());
    let work = &mut *tracker.work;
    work.count_times(Event::NullCollision, effort.lookups - before - real);
    majorants.count_work(work);
    match end {
        ControlFlow::Break(collision) => ControlFlow::Break((collision, majorants.sigma_s())),
        ControlFlow::Continue(left) => ControlFlow::Continue(left),
    }
}

/// `a/b` by channel, 0 where both are 0.
fn quotient(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        if a[c] == 0.0 { 0.0 } else { a[c] / b[c] }
    }))
}
