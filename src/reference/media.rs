//! Media along a ray.

use crate::geometry::{Ray, Solid, Span, Surface};
use crate::media::Phase;
use crate::scene::Body;
use glam::DVec3;

/// A medium at a point; coefficients and emission per length and channel.
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

/// The parts of a ray inside media. Media may overlap.
pub struct Segments<'s> {
    ray: Ray,
    segments: Vec<(Span, &'s Body)>,
}

impl<'s> Segments<'s> {
    /// Segments of `ray` up to distance `end`, which may be infinite.
    pub fn along(ray: &Ray, end: f64, media: &'s [Body]) -> Segments<'s> {
        let mut segments = Vec::new();
        for body in media.iter().filter(|body| !is_vacuum(body)) {
            let unbounded = Span {
                near: 0.0,
                far: end,
            };
            let boundary = body.boundary.as_ref();
            for Span { near, far } in boundary.map_or(vec![unbounded], |shape| shape.spans(ray)) {
                let far = far.min(end);
                if near < far {
                    segments.push((Span { near, far }, body));
                }
            }
        }
        Segments {
            ray: *ray,
            segments,
        }
    }

    /// From the beginning of the first segment to the end of the last; without segments nothing,
    /// beyond every light.
    pub fn span(&self) -> Span {
        let spans = self.segments.iter().map(|(span, _)| *span);
        let hull = spans.reduce(|a, b| Span {
            near: a.near.min(b.near),
            far: a.far.max(b.far),
        });
        hull.unwrap_or(Span {
            near: f64::MAX,
            far: f64::MAX,
        })
    }

    /// The media at distance `t`.
    pub fn at(&self, t: f64) -> Vec<Properties> {
        let point = self.ray.at(t);
        let mut media = Vec::new();
        for (span, body) in &self.segments {
            if span.near <= t && t < span.far {
                let field = body.density.as_ref();
                let density = field.map_or(1.0, |field| field.looked_up_at(point, &mut 0));
                media.push(Properties {
                    sigma_t: body.medium.coefficients.sigma_t() * density,
                    sigma_s: body.medium.coefficients.sigma_s() * density,
                    emission: body.medium.emission * density,
                    phase: body.medium.phase,
                });
            }
        }
        media
    }

    /// Extinction of all media at distance `t`, per length and channel.
    pub fn extinction(&self, t: f64) -> DVec3 {
        self.at(t).iter().map(|medium| medium.sigma_t).sum()
    }
}

/// Whether a medium neither attenuates nor emits. Tracking through one without a boundary would
/// never end.
fn is_vacuum(body: &Body) -> bool {
    let medium = &body.medium;
    medium.coefficients.sigma_t() == DVec3::ZERO && medium.emission == DVec3::ZERO
}

/// A rate of collisions, per length, that no extinction exceeds, at any point in any channel.
///
/// Not below one over the size of a medium, however thin it is, since paths collect light at
/// collisions; not 0 in one that only emits.
pub fn majorant(media: &[Body]) -> f64 {
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
