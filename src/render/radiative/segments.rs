//! The media along a ray: segments between their boundaries.
//!
//! Boundaries of media do not refract here (their refractive index is that of their surroundings),
//! so a straight path crosses them all. It is cut where any medium begins or ends; in between,
//! coefficients and emissions of overlapping media add up. No state is kept from one ray to the
//! next: the origin of a ray determines the media around it, so no count of crossings can go wrong.
//!
//! A heterogeneous medium has no coefficients of its own on a segment. There light is
//! [tracked](super::tracking), and the properties of the segment are those of a homogeneous medium
//! by which points are sampled: any is valid.

use super::media::{Media, Set};
use super::medium::{MediumProperties, over};
use crate::geometry::{Ray, Solid, Span};
use crate::optics::optical_depth;
use glam::DVec3;

/// A segment of a ray within which no medium begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumSegment {
    /// Distances from the origin of the ray.
    pub span: Span,
    /// Properties of the media there, as [`Medium::on_segment`](super::medium::Medium::on_segment).
    pub properties: MediumProperties,
    /// The media there.
    pub set: Set,
}

/// Optical depths by channel from the origin of a ray to a point on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct OpticalDepths {
    /// Depths of the media that scatter.
    pub scattering: DVec3,
    /// Depths of the media that only absorb.
    pub absorbing: DVec3,
}

impl OpticalDepths {
    /// Depths of all media.
    pub fn total(&self) -> DVec3 {
        self.scattering + self.absorbing
    }
}

/// The media along one ray, in order; memory is kept from ray to ray.
#[derive(Debug, Default)]
pub struct MediumSegments {
    segments: Vec<MediumSegment>,
    edges: Vec<MediumEdge>,
    spans: Vec<Span>,
}

/// The beginning or end of a medium.
#[derive(Clone, Copy, Debug)]
struct MediumEdge {
    t: f64,
    medium: usize,
}

impl MediumSegments {
    /// Builds the segments of `media` along `ray`, from its origin to `end`, which may be infinite.
    pub fn build(&mut self, media: &Media<'_>, ray: &Ray, end: f64) {
        self.segments.clear();
        self.edges.clear();
        for (index, medium) in media.all().iter().enumerate() {
            self.spans.clear();
            match medium.boundary {
                None => self.spans.push(Span::new(0.0, end)),
                Some(boundary) => boundary.append_spans(ray, &mut self.spans),
            }
            if medium.is_vacuum() {
                // A cut here would round the depths of the others.
                continue;
            }
            for span in &self.spans {
                let far = span.far.min(end);
                if span.near < far {
                    let edge = |t| MediumEdge { t, medium: index };
                    self.edges.extend([span.near, far].map(edge));
                }
            }
        }
        // Two are the beginning and the end of one medium, in this order.
        if self.edges.len() > 2 {
            self.edges
                .sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.medium.cmp(&b.medium)));
        }
        let (mut set, mut near) = (0, 0.0);
        for &MediumEdge { t, medium } in &self.edges {
            if set != 0 && near < t {
                self.segments.push(MediumSegment {
                    span: Span { near, far: t },
                    properties: media.on_segment(set),
                    set,
                });
            }
            // A medium whose spans touch ends and begins at one distance: twice is not at all.
            set ^= 1 << medium;
            near = t;
        }
    }

    /// The segments, in order.
    pub fn all(&self) -> &[MediumSegment] {
        &self.segments
    }

    /// Optical depth by channel over the whole ray.
    pub fn optical_depth(&self) -> DVec3 {
        self.segments.iter().map(MediumSegment::optical_depth).sum()
    }

    /// Optical depths by channel up to distance `t`, and the segment there, if there is a medium.
    pub(crate) fn depths_to(&self, t: f64) -> (OpticalDepths, Option<&MediumSegment>) {
        let mut depths = OpticalDepths::default();
        for segment in &self.segments {
            if t < segment.span.near {
                break;
            }
            let inside = t < segment.span.far;
            let length = if inside { t } else { segment.span.far } - segment.span.near;
            depths.scattering += over(segment.properties.sigma_t, length);
            depths.absorbing += over(segment.properties.absorbing, length);
            if inside {
                return (depths, Some(segment));
            }
        }
        (depths, None)
    }

    /// Distance at which the depth of the media that scatter reaches `depth` in one channel; the
    /// end of the last of them where it does not.
    pub(crate) fn distance_at(&self, depth: f64, channel: usize) -> f64 {
        let (mut passed, mut last) = (0.0, 0.0);
        for segment in self.segments.iter().filter(|s| s.properties.scatters()) {
            let sigma_t = segment.properties.sigma_t[channel];
            let Span { near, far } = segment.span;
            let whole = optical_depth(sigma_t, far - near);
            let rest = (depth - passed).max(0.0);
            if rest < whole {
                return (near + rest / sigma_t).min(far);
            }
            passed += whole;
            last = far;
        }
        last
    }

    /// The span from the beginning of the first medium that scatters to the end of the last.
    pub(crate) fn scattering_span(&self) -> Option<Span> {
        let mut scattering = self.segments.iter().filter(|s| s.properties.scatters());
        let first = scattering.next()?.span;
        let last = scattering.next_back().map_or(first, |segment| segment.span);
        Some(Span::new(first.near, last.far))
    }
}

impl MediumSegment {
    /// Optical depth, by channel, of the whole segment.
    pub fn optical_depth(&self) -> DVec3 {
        over(self.properties.extinction(), self.span.length())
    }
}
