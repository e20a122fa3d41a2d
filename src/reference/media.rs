//! Media along a ray.

use crate::geometry::{Ray, Solid, Span, Surface};
use crate::scene::Body;
use glam::DVec3;

/// The parts of a ray inside media, each with its medium. Media may overlap.
pub struct Segments<'s> {
    ray: Ray,
    segments: Vec<(Span, &'s Body)>,
}

impl<'s> Segments<'s> {
    /// Segments of `ray` up to distance `end`, which may be infinite.
    pub fn along(ray: &Ray, end: f64, media: &'s [Body]) -> Segments<'s> {
        let mut segments = Vec::new();
        for medium in media.iter().filter(|medium| !is_vacuum(medium)) {
            let spans = match &medium.boundary {
                Some(boundary) => boundary.spans(ray),
                None => vec![Span {
                    near: 0.0,
                    far: end,
                }],
            };
            for Span { near, far } in spans {
                let far = far.min(end);
                if near < far {
                    segments.push((Span { near, far }, medium));
                }
            }
        }
        Segments {
            ray: *ray,
            segments,
        }
    }

    /// From the beginning of the first segment to the end of the last; `None` without media.
    pub fn span(&self) -> Option<Span> {
        let spans = self.segments.iter().map(|(span, _)| *span);
        spans.reduce(|a, b| Span {
            near: a.near.min(b.near),
            far: a.far.max(b.far),
        })
    }

    /// The media at distance `t`, and their densities there: factors on coefficients and emission.
    pub fn at(&self, t: f64) -> impl Iterator<Item = (&'s Body, f64)> {
        let point = self.ray.at(t);
        let inside = self
            .segments
            .iter()
            .filter(move |(span, _)| span.near <= t && t < span.far);
        inside.map(move |(_, medium)| (*medium, density(medium, point)))
    }

    /// Extinction of all media at distance `t`, per length and channel.
    pub fn extinction(&self, t: f64) -> DVec3 {
        let media = self.at(t);
        media
            .map(|(medium, density)| medium.medium.coefficients.sigma_t() * density)
            .sum()
    }
}

/// Whether a medium neither attenuates nor emits: tracking through one without a boundary would
/// never end.
fn is_vacuum(Body { medium, .. }: &Body) -> bool {
    medium.coefficients.sigma_t() == DVec3::ZERO && medium.emission == DVec3::ZERO
}

/// Density of a medium at a world point.
fn density(medium: &Body, point: DVec3) -> f64 {
    let field = medium.density.as_ref();
    field.map_or(1.0, |field| field.looked_up_at(point, &mut 0))
}

/// A rate of collisions, per length, that no extinction exceeds, at any point in any channel.
///
/// At least one collision per crossing of a medium on average, however thin the medium: paths
/// collect light at collisions.
pub fn majorant(media: &[Body]) -> f64 {
    let of_medium = |medium: &Body| {
        let density = medium
            .density
            .as_ref()
            .map_or(1.0, |field| field.range().high);
        let extinction = medium.medium.coefficients.sigma_t().max_element() * density;
        let size = medium
            .boundary
            .as_ref()
            .map(|shape| shape.bounds().size().max_element());
        extinction.max(size.map_or(0.0, |size| 1.0 / size))
    };
    media.iter().map(of_medium).sum()
}
