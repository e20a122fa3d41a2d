//! Media along a ray.

use crate::geometry::{Ray, Solid, Span, Surface};
use crate::optics::Phase;
use crate::scene::Body;
use glam::DVec3;

/// A medium at a point; coefficients and emission per length and channel, at the density there.
pub struct Properties {
    /// Extinction.
    pub sigma_t: DVec3,
    /// Scattering.
    pub sigma_s: DVec3,
    /// Emitted radiance.
    pub emission: DVec3,
    /// Phase function.
    pub phase: Phase,
}

/// A part of a ray inside a medium.
pub struct Segment<'s> {
    /// Where it begins and ends.
    pub span: Span,
    ray: Ray,
    body: &'s Body,
}

impl<'s> Segment<'s> {
    /// Segments of `ray` up to distance `end`, which may be infinite. They overlap where media do.
    pub fn along(ray: &Ray, end: f64, media: &'s [Body]) -> Vec<Segment<'s>> {
        let mut segments = Vec::new();
        for body in media.iter().filter(|body| !is_vacuum(body)) {
            let unbounded = Span::new(0.0, end);
            let boundary = body.boundary.as_ref();
            for Span { near, far } in boundary.map_or(vec![unbounded], |shape| shape.spans(ray)) {
                let far = far.min(end);
                if near < far {
                    let (span, ray) = (Span { near, far }, *ray);
                    segments.push(Segment { span, ray, body });
                }
            }
        }
        segments
    }

    /// The medium scatters somewhere.
    pub fn scatters(&self) -> bool {
        self.body.medium.coefficients.sigma_s() != DVec3::ZERO
    }

    /// The medium at distance `t`; `None` outside the segment.
    pub fn at(&self, t: f64) -> Option<Properties> {
        if !(self.span.near <= t && t < self.span.far) {
            return None;
        }
        let Body {
            medium, density, ..
        } = self.body;
        let density = density
            .as_ref()
            .map_or(1.0, |field| field.looked_up_at(self.ray.at(t), &mut 0));
        Some(Properties {
            sigma_t: medium.coefficients.sigma_t() * density,
            sigma_s: medium.coefficients.sigma_s() * density,
            emission: medium.emission * density,
            phase: medium.phase,
        })
    }
}

/// From the beginning of the first segment to the end of the last; `None` without segments.
pub fn hull(segments: &[Segment]) -> Option<Span> {
    let spans = segments.iter().map(|segment| segment.span);
    spans.reduce(|a, b| Span::new(a.near.min(b.near), a.far.max(b.far)))
}

/// Extinction of all media at distance `t`, per length and channel.
pub fn extinction(segments: &[Segment], t: f64) -> DVec3 {
    let media = segments.iter().filter_map(|segment| segment.at(t));
    media.map(|medium| medium.sigma_t).sum()
}

/// Whether a medium neither attenuates nor emits. Tracking through one without a boundary would
/// never end.
fn is_vacuum(body: &Body) -> bool {
    let medium = &body.medium;
    medium.coefficients.sigma_t() == DVec3::ZERO && medium.emission == DVec3::ZERO
}

/// A rate of collisions, per length, that no extinction exceeds, at any point in any channel.
///
/// At least 1 / (size of the medium), however thin it is, because light is gathered at collisions;
/// nonzero even in a medium that only emits.
pub fn global_majorant(media: &[Body]) -> f64 {
    let mut majorant = 0.0;
    for body in media.iter().filter(|body| !is_vacuum(body)) {
        let density = body
            .density
            .as_ref()
            .map_or(1.0, |field| field.range().high);
        let extinction = body.medium.coefficients.sigma_t().max_element() * density;
        let least = match &body.boundary {
            Some(boundary) => 1.0 / boundary.bounds().size().max_element(),
            None if extinction == 0.0 => 1.0,
            None => 0.0,
        };
        majorant += extinction.max(least);
    }
    majorant
}
