//! Transmittance of media along a ray, in three forms: closed, integrated and estimated.
//!
//! | medium | form |
//! |---|---|
//! | homogeneous | closed: `e^(−σt)` |
//! | heterogeneous, absorbing only, of a density with an integral | integrated: `e^(−σ ∫ρ dt)` |
//! | any other | estimated by residual ratio tracking |

use super::media::{Set, members};
use super::medium::over;
use super::ray_majorants::RayMajorants;
use super::sampler::NumberRow;
use super::scene_context::SceneContext;
use super::segments::MediumSegments;
use super::tracker::Tracker;
use super::tracking::{Control, Small, ratio_tracking};
use crate::geometry::{Ray, Solid, Span};
use crate::optics;
use crate::render::counters::{Counters, Event};
use glam::DVec3;

/// Transmittance of the media of a scene.
#[derive(Clone, Copy)]
pub struct Transmittance<'s>(pub &'s SceneContext<'s>);

impl Transmittance<'_> {
    /// Transmittance of the optical depth `depth`, by channel; one exponential where all channels
    /// are the same.
    pub fn closed(self, depth: DVec3, work: &mut Counters) -> DVec3 {
        work.count(Event::Attenuation);
        if self.0.features.chromatic {
            work.count_times(Event::ChannelAttenuation, 2);
        }
        if depth == DVec3::ZERO {
            // Every flight asks for the transmittance of media that only absorb, also where there are none.
            DVec3::ONE
        } else if self.0.features.chromatic {
            DVec3::from_array(depth.to_array().map(optics::transmittance))
        } else {
            DVec3::splat(optics::transmittance(depth.x))
        }
    }

    /// Transmittance, by channel, of all media from the origin of `ray` to distance `end`.
    pub fn along(self, ray: &Ray, end: f64, tracker: &mut Tracker<'_>) -> DVec3 {
        if !self.0.is_heterogeneous() {
            let spans = &mut tracker.scratch.spans;
            let depth = self.0.media.optical_depth(ray, end, spans, tracker.work);
            return self.closed(depth, tracker.work);
        }
        let mut depth = DVec3::ZERO;
        let mut estimate = DVec3::ONE;
        for (index, medium) in self.0.media.all().iter().enumerate() {
            if medium.density.is_some() && medium.is_vacuum() {
                // No random number may be drawn for it.
                continue;
            }
            let Some(boundary) = medium.boundary else {
                depth += over(medium.sigma_t(), end);
                continue;
            };
            let mut spans = std::mem::take(&mut tracker.scratch.spans);
            spans.clear();
            boundary.append_spans(ray, &mut spans);
            for &Span { near, far } in spans.iter().filter(|span| span.near < end) {
                let span = Span {
                    near,
                    far: far.min(end),
                };
                if medium.density.is_none() {
                    depth += over(medium.sigma_t(), span.length());
                } else {
                    estimate *= self.of_heterogeneous(1 << index, ray, span, tracker);
                }
            }
            tracker.scratch.spans = spans;
        }
        estimate * self.closed(depth, tracker.work)
    }

    /// Transmittance, by channel, of the media that only absorb along `ray` up to distance `t`: the
    /// homogeneous ones have the optical depth `depth`, the others lie on `segments`.
    pub(crate) fn of_absorbing(
        self,
        segments: &MediumSegments,
        ray: &Ray,
        t: f64,
        depth: DVec3,
        tracker: &mut Tracker<'_>,
    ) -> DVec3 {
        let mut transmittance = self.closed(depth, tracker.work);
        if !self.0.is_heterogeneous() {
            return transmittance;
        }
        for segment in segments.all() {
            let heterogeneous = self.0.media.heterogeneous(segment.set);
            let absorbing = heterogeneous & !self.0.media.scattering(heterogeneous);
            let span = Span::new(segment.span.near, segment.span.far.min(t));
            if absorbing != 0 && span.near < span.far {
                transmittance *= self.of_heterogeneous(absorbing, ray, span, tracker);
            }
        }
        transmittance
    }

    /// Transmittance, by channel, of the heterogeneous media in `set` along `ray` over `span`,
    /// which lies in all of them.
    fn of_heterogeneous(self, set: Set, ray: &Ray, span: Span, tracker: &mut Tracker<'_>) -> DVec3 {
        let mut depth = DVec3::ZERO;
        let mut estimated = 0;
        for index in members(set) {
            let medium = self.0.media.medium(index);
            if medium.is_integrable() && !medium.unit.scatters() {
                let column = medium.column(ray, span, tracker.work);
                depth += over(medium.sigma_t(), column);
            } else {
                estimated |= 1 << index;
            }
        }
        let integrated = self.closed(depth, tracker.work);
        if estimated == 0 {
            return integrated;
        }
        let scratch = &mut *tracker.scratch;
        let heterogeneous = &mut scratch.heterogeneous;
        let mut majorants = RayMajorants::new(&self.0.media, estimated, ray, span, heterogeneous);
        let estimate = ratio_tracking(
            &mut majorants,
            Control::Minorant,
            Small::Roulette,
            &mut tracker.sampler.tentative(NumberRow::Transmittance),
            &mut scratch.effort,
        );
        majorants.count_work(tracker.work);
        integrated * estimate
    }
}
