//! Light that media send out along a ray.

use super::effects::Effects;
use super::majorants::Passage;
use super::media::{Media, Set, density_integral, members, over, transmittance};
use super::segments::{MediaPath, Stretch};
use super::tracker::{Numbers, Tracker};
use super::tracking::{Bounded, Bounds, Chance, tentative_collisions, thin};
use crate::geometry::{Ray, Span};
use crate::math::quadrature::integrate;
use crate::media::{emission, source_factor};
use crate::render::counters::{Event, Work};
use glam::DVec3;

/// Tentative collisions that a glowing stretch of a ray has on average, be its matter ever so
/// thin.
const GLOW_SAMPLES: f64 = 4.0;

impl MediaPath {
    /// Radiance that media which are the same everywhere send back along the ray.
    pub fn emitted<E: Effects, W: Work>(&self, work: &mut W) -> DVec3 {
        let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
        for stretch in self.stretches() {
            let through = transmittance::<E, W>(depth, work);
            radiance += through * stretch.emitted(work);
            depth += stretch.depth();
        }
        radiance
    }

    /// An estimate of the radiance that `media` send back along `ray`, where their density
    /// varies: emission is collected at the tentative collisions of ratio tracking.
    pub fn emitted_by_tracking<E: Effects, W: Work>(
        &self,
        media: &Media<'_>,
        ray: &Ray,
        chance: &mut Numbers,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let mut radiance = DVec3::ZERO;
        let mut through = DVec3::ONE;
        for stretch in self.stretches() {
            if !media.varies(stretch.set) {
                radiance += through * stretch.emitted(work);
                through *= transmittance::<E, W>(stretch.depth(), work);
                continue;
            }
            let (strands, _, effort) = tracker.parts();
            // Any rate is without bias, but an infinite one would never come to the end: a stretch
            // shorter than 2.2e-308 has fewer collisions.
            let least = (GLOW_SAMPLES / stretch.span.length()).min(f64::MAX);
            let rate = |bounds: &Bounds| {
                let glows = bounds.glow != DVec3::ZERO;
                bounds.high.max_element() + if glows { least } else { 0.0 }
            };
            let mut passage = Passage::new(media, stretch.set, ray, stretch.span, strands);
            let first = chance.tentative();
            let visit = |passage: &mut Passage<'_, '_>, bounds: &Bounds, t: f64, u: f64| {
                let extinction = passage.extinction(t);
                effort.note(bounds, extinction);
                let rate = rate(bounds);
                work.count(Event::EmissionTerm);
                radiance += through * passage.emission() / rate;
                through *= DVec3::ONE - extinction / rate;
                thin(&mut through, u)
            };
            let end = tentative_collisions(&mut passage, rate, first, chance, visit);
            passage.count(work);
            if end.is_break() {
                break;
            }
        }
        radiance
    }

    /// Radiance that `media`, whose densities have integrals, send back along `ray`: in closed
    /// form where a medium is alone, else by quadrature to a relative `tolerance` between the
    /// places where a density has a kink.
    pub fn emitted_by_quadrature<E: Effects, W: Work>(
        &self,
        media: &Media<'_>,
        ray: &Ray,
        tolerance: f64,
        work: &mut W,
    ) -> DVec3 {
        let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
        for stretch in self.stretches() {
            let sent;
            let whole;
            if !media.varies(stretch.set) {
                (sent, whole) = (stretch.emitted(work), stretch.depth());
            } else if stretch.set.count_ones() == 1 {
                let medium = media.medium(stretch.set.trailing_zeros() as usize);
                let density = medium.density.expect("it varies");
                let column = density_integral(density, ray, stretch.span, work);
                whole = over(medium.sigma_t(), column);
                work.count(Event::EmissionTerm);
                let seen = DVec3::from_array(whole.to_array().map(source_factor));
                sent = medium.unit.emission * column * seen;
            } else {
                whole = depth_over(media, stretch.set, ray, stretch.span, work);
                sent = integral_over::<E, W>(media, stretch, ray, tolerance, work);
            }
            radiance += transmittance::<E, W>(depth, work) * sent;
            depth += whole;
        }
        radiance
    }
}

impl Stretch {
    /// Radiance that a stretch of even matter sends back along the ray.
    fn emitted<W: Work>(&self, work: &mut W) -> DVec3 {
        work.count(Event::EmissionTerm);
        let extinction = self.matter.sigma_t + self.matter.dimming;
        DVec3::from_array(std::array::from_fn(|c| {
            emission::constant_emission(self.matter.emission[c], extinction[c], self.span.length())
        }))
    }
}

/// Optical depth, by channel, of the media in `set` over `span`, which lies in all of them.
fn depth_over<W: Work>(media: &Media<'_>, set: Set, ray: &Ray, span: Span, work: &mut W) -> DVec3 {
    members(set).fold(DVec3::ZERO, |depth, index| {
        let medium = media.medium(index);
        let column = match medium.density {
            None => span.length(),
            Some(density) => density_integral(density, ray, span, work),
        };
        depth + over(medium.sigma_t(), column)
    })
}

/// `∫ j e^(−τ) dt` over a stretch of several media.
fn integral_over<E: Effects, W: Work>(
    media: &Media<'_>,
    stretch: &Stretch,
    ray: &Ray,
    tolerance: f64,
    work: &mut W,
) -> DVec3 {
    let mut cuts = vec![stretch.span.far];
    for index in members(stretch.set) {
        if let Some(density) = media.medium(index).density
            && let Some((line, span)) = density.along(ray, stretch.span)
        {
            cuts.push(span.near);
            density.append_kinks(&line, span, &mut cuts);
        }
    }
    cuts.retain(|cut| stretch.span.near < *cut && *cut <= stretch.span.far);
    cuts.sort_unstable_by(f64::total_cmp);
    let (mut radiance, mut depth) = (DVec3::ZERO, DVec3::ZERO);
    let mut near = stretch.span.near;
    for far in cuts {
        let piece = depth_over(media, stretch.set, ray, Span { near, far }, work);
        let mut sent = |t: f64| {
            let way = depth_over(media, stretch.set, ray, Span { near, far: t }, work);
            work.count(Event::EmissionTerm);
            media.emission(stretch.set, ray.at(t), work) * transmittance::<E, W>(way, work)
        };
        // In a deep piece only its beginning is seen: halves of halves of it, down to where
        // light gets through.
        let deepest = piece.max_element();
        let mut halvings = 0;
        while halvings < 60 && deepest > f64::from(1 << halvings.min(30)) {
            halvings += 1;
        }
        let mut from = near;
        let mut own = DVec3::ZERO;
        for halving in (0..=halvings).rev() {
            let to = near + (far - near) / (1_u64 << halving) as f64;
            own += integrate(&mut sent, from, to, tolerance).value;
            from = to;
        }
        radiance += transmittance::<E, W>(depth, work) * own;
        depth += piece;
        near = far;
    }
    radiance
}
