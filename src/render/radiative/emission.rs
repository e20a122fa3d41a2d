//! Emission of media along a ray, in three forms: closed, integrated and tracked.

use super::context::PathContext;
use super::media::{Media, Set, members};
use super::medium::over;
use super::ray_majorants::RayMajorants;
use super::sampler::NumberRow;
use super::scene_context::SceneContext;
use super::segments::{MediumSegment, MediumSegments};
use super::tracking::{
    MajorantSegment, RealCollision, TentativeNumbers, tentative_collisions, thin,
};
use super::transmittance::Transmittance;
use crate::geometry::{Ray, Span};
use crate::math::quadrature::integrate;
use crate::optics::{emission, source_factor};
use crate::render::counters::{Counters, Event};
use glam::DVec3;

/// Tentative collisions on an emissive segment in the mean, however thin the medium.
///
/// With `n` of them the estimate of a thin even emission has the relative variance `1/n`, at `n`
/// lookups: their product is the same for any `n`. At 4 a ray in 55 (`e^4`) has none, so the
/// moments of a few dozen samples are not those of a rare event, and an emissive medium costs no
/// more than one of four optical depths.
const EMISSION_SAMPLES: f64 = 4.0;

/// Emission of the media of a scene along a ray.
#[derive(Clone, Copy)]
pub struct Emission<'s>(pub &'s SceneContext<'s>);

impl Emission<'_> {
    /// Radiance that homogeneous media emit on `segment` towards the origin of the ray.
    fn emitted(self, segment: &MediumSegment, work: &mut Counters) -> DVec3 {
        work.count(Event::EmissionTerm);
        let (emission, extinction) = (segment.properties.emission, segment.properties.extinction());
        let length = segment.span.length();
        if self.0.features.chromatic {
            DVec3::from_array(std::array::from_fn(|c| {
                emission::constant_emission(emission[c], extinction[c], length)
            }))
        } else {
            // The extinction of all channels is the same.
            let visible = emission::visible_length(extinction.x, length);
            let over = |emission| emission::emission_over(emission, visible);
            DVec3::from_array(emission.to_array().map(over))
        }
    }

    /// Radiance that homogeneous media emit along a ray towards its origin.
    pub fn closed(self, segments: &MediumSegments, work: &mut Counters) -> DVec3 {
        let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
        for segment in segments.all() {
            let transmittance = Transmittance(self.0).closed(depth, work);
            radiance += transmittance * self.emitted(segment, work);
            depth += segment.optical_depth();
        }
        radiance
    }

    /// An estimate of the radiance that media emit along the ray of a path towards its origin,
    /// collected at the tentative collisions of ratio tracking.
    pub fn tracked(self, path: &mut PathContext<'_>) -> DVec3 {
        let (ray, tracker) = (&path.ray, &mut path.tracker);
        let scratch = &mut *tracker.scratch;
        let work = &mut *tracker.work;
        let mut numbers = tracker.sampler.tentative(NumberRow::Emission);
        let mut radiance = DVec3::ZERO;
        let mut throughput = DVec3::ONE;
        for segment in path.segments.all() {
            if self.0.media.heterogeneous(segment.set) == 0 {
                radiance += throughput * self.emitted(segment, work);
                throughput *= Transmittance(self.0).closed(segment.optical_depth(), work);
                continue;
            }
            // Any rate is without bias, but an infinite one would never come to the end: a segment
            // shorter than 2.2e-308 has fewer collisions.
            let least = (EMISSION_SAMPLES / segment.span.length()).min(f64::MAX);
            let rate = |segment: &MajorantSegment| {
                let emissive = segment.emission != DVec3::ZERO;
                segment.majorant.max_element() + if emissive { least } else { 0.0 }
            };
            let heterogeneous = &mut scratch.heterogeneous;
            let mut majorants =
                RayMajorants::new(&self.0.media, segment.set, ray, segment.span, heterogeneous);
            let first = numbers.next();
            let effort = &mut scratch.effort;
            let visit = |majorants: &RayMajorants<'_, '_>, segment: &_, at: RealCollision, u| {
                let rate = rate(segment);
                work.count(Event::EmissionTerm);
                radiance += throughput * majorants.emission() / rate;
                throughput *= DVec3::ONE - at.extinction / rate;
                thin(&mut throughput, u)
            };
            let end =
                tentative_collisions(&mut majorants, rate, first, &mut numbers, effort, visit);
            majorants.count_work(work);
            if end.is_break() {
                break;
            }
        }
        radiance
    }

    /// Radiance that media, whose densities have integrals, emit along `ray` towards its origin:
    /// in closed form where a medium is alone, else by quadrature to a relative `tolerance` between
    /// the kinks of the densities.
    pub fn integrated(
        self,
        segments: &MediumSegments,
        ray: &Ray,
        tolerance: f64,
        work: &mut Counters,
    ) -> DVec3 {
        let media = &self.0.media;
        let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
        for segment in segments.all() {
            let emitted;
            let whole;
            if media.heterogeneous(segment.set) == 0 {
                (emitted, whole) = (self.emitted(segment, work), segment.optical_depth());
            } else if segment.set.count_ones() == 1 {
                let medium = media.medium(segment.set.trailing_zeros() as usize);
                let column = medium.column(ray, segment.span, work);
                whole = over(medium.sigma_t(), column);
                work.count(Event::EmissionTerm);
                let seen = DVec3::from_array(whole.to_array().map(source_factor));
                emitted = medium.unit.emission * column * seen;
            } else {
                whole = depth_over(media, segment.set, ray, segment.span, work);
                emitted = self.quadrature(segment, ray, tolerance, work);
            }
            radiance += Transmittance(self.0).closed(depth, work) * emitted;
            depth += whole;
        }
        radiance
    }

    /// `∫ j e^(−τ) dt` over a segment of several media.
    fn quadrature(
        self,
        segment: &MediumSegment,
        ray: &Ray,
        tolerance: f64,
        work: &mut Counters,
    ) -> DVec3 {
        let media = &self.0.media;
        let mut cuts = vec![segment.span.far];
        for index in members(segment.set) {
            if let Some(density) = media.medium(index).density
                && let Some((line, span)) = density.along(ray, segment.span)
            {
                cuts.push(span.near);
                density.append_kinks(&line, span, &mut cuts);
            }
        }
        cuts.retain(|cut| segment.span.near < *cut && *cut <= segment.span.far);
        cuts.sort_unstable_by(f64::total_cmp);
        let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
        let mut near = segment.span.near;
        for far in cuts {
            let whole = depth_over(media, segment.set, ray, Span { near, far }, work);
            let mut emitted = |t: f64| {
                let depth = depth_over(media, segment.set, ray, Span { near, far: t }, work);
                work.count(Event::EmissionTerm);
                let emission = media.emission(segment.set, ray.at(t), work);
                emission * Transmittance(self.0).closed(depth, work)
            };
            // Only the beginning of a deep piece is seen: it is halved again and again, down to an optical
            // depth of 1.
            let deepest = whole.max_element();
            let mut halvings = 0;
            while halvings < 60 && deepest > f64::from(1 << halvings.min(30)) {
                halvings += 1;
            }
            let mut from = near;
            let mut piece = DVec3::ZERO;
            for halving in (0..=halvings).rev() {
                let to = near + (far - near) / (1_u64 << halving) as f64;
                piece += integrate(&mut emitted, from, to, tolerance).value;
                from = to;
            }
            radiance += Transmittance(self.0).closed(depth, work) * piece;
            depth += whole;
            near = far;
        }
        radiance
    }
}

/// Optical depth, by channel, of the media in `set` over `span`, which lies in all of them.
fn depth_over(media: &Media<'_>, set: Set, ray: &Ray, span: Span, work: &mut Counters) -> DVec3 {
    members(set).fold(DVec3::ZERO, |depth, index| {
        let medium = media.medium(index);
        depth + over(medium.sigma_t(), medium.column(ray, span, work))
    })
}
