//! The matter along a ray: stretches within which nothing changes.
//!
//! Boundaries of media do not turn light here (their refractive index is that of what surrounds
//! them), so a straight path crosses them all. It is cut where any medium begins or ends; in
//! between, coefficients and emissions of the media that overlap add up. Nothing is remembered
//! from one ray to the next: where a ray begins decides what it begins in, so no count of
//! crossings can go wrong.
//!
//! A medium of varying density has no coefficients of its own on a stretch. There light is
//! followed by [tracking](super::tracking), and what the stretch is said to be made of stands in
//! for it where a density of choosing places is needed, which may be any.

use super::media::{Matter, Media, Set, over};
use crate::geometry::{Ray, Solid, Span};
use crate::media::optical_depth;
use glam::DVec3;

/// A stretch of a ray through the same matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// From where to where, in world units from the origin of the ray.
    pub span: Span,
    /// Its matter; where a density varies, with what stands in for it.
    pub matter: Matter,
    /// The media there.
    pub set: Set,
}

/// Optical depths by channel from the origin of a ray to a place on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Depths {
    /// Of the media that scatter.
    pub scattering: DVec3,
    /// Of those that only absorb.
    pub dimming: DVec3,
}

impl Depths {
    /// Of everything.
    pub fn all(&self) -> DVec3 {
        self.scattering + self.dimming
    }
}

/// The media along one ray, in order; memory is kept from ray to ray.
#[derive(Debug, Default)]
pub struct MediaPath {
    stretches: Vec<Stretch>,
    edges: Vec<Edge>,
    spans: Vec<Span>,
}

/// Where a medium begins or ends.
#[derive(Clone, Copy, Debug)]
struct Edge {
    t: f64,
    medium: usize,
}

impl MediaPath {
    /// Lays `media` along `ray`, from its origin to `end`, which may be infinite.
    pub fn lay(&mut self, media: &Media<'_>, ray: &Ray, end: f64) {
        self.edges.clear();
        self.stretches.clear();
        for (medium, body) in media.all().iter().enumerate() {
            self.spans.clear();
            match body.boundary {
                None => self.spans.push(Span {
                    near: 0.0,
                    far: end,
                }),
                Some(boundary) => boundary.append_spans(ray, &mut self.spans),
            }
            if body.is_nothing() {
                // Nothing begins here: a cut would round the depths of what goes on.
                continue;
            }
            for span in &self.spans {
                let far = span.far.min(end);
                if span.near < far {
                    self.edges.push(Edge {
                        t: span.near,
                        medium,
                    });
                    self.edges.push(Edge { t: far, medium });
                }
            }
        }
        // Two are the beginning and the end of one stretch, in this order.
        if self.edges.len() > 2 {
            self.edges
                .sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.medium.cmp(&b.medium)));
        }
        let (mut set, mut near) = (0, 0.0);
        for &Edge { t, medium } in &self.edges {
            if set != 0 && near < t {
                self.stretches.push(Stretch {
                    span: Span { near, far: t },
                    matter: media.matter(set),
                    set,
                });
            }
            // A medium whose stretches touch ends and begins at one place: twice is not at all.
            set ^= 1 << medium;
            near = t;
        }
    }

    /// The stretches, in order.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// Optical depth by channel over the whole ray.
    pub fn depth(&self) -> DVec3 {
        self.stretches.iter().map(Stretch::depth).sum()
    }

    /// Optical depths by channel up to distance `t`, and the stretch there, if there is matter.
    pub fn depths_to(&self, t: f64) -> (Depths, Option<&Stretch>) {
        let mut depths = Depths::default();
        for stretch in &self.stretches {
            if t < stretch.span.near {
                break;
            }
            let inside = t < stretch.span.far;
            let length = if inside { t } else { stretch.span.far } - stretch.span.near;
            depths.scattering += over(stretch.matter.sigma_t, length);
            depths.dimming += over(stretch.matter.dimming, length);
            if inside {
                return (depths, Some(stretch));
            }
        }
        (depths, None)
    }

    /// Where the depth of the media that scatter, in one channel, reaches `goal`; the end of the
    /// last of them where it does not.
    pub fn place_at(&self, goal: f64, channel: usize) -> f64 {
        let (mut depth, mut last) = (0.0, 0.0);
        for stretch in self.stretches.iter().filter(|s| s.matter.scatters()) {
            let sigma_t = stretch.matter.sigma_t[channel];
            let Span { near, far } = stretch.span;
            let whole = optical_depth(sigma_t, far - near);
            let rest = (goal - depth).max(0.0);
            if rest < whole {
                return (near + rest / sigma_t).min(far);
            }
            depth += whole;
            last = far;
        }
        last
    }

    /// From where the first medium that scatters begins to where the last ends.
    pub fn scattering_span(&self) -> Option<Span> {
        let mut scattering = self.stretches.iter().filter(|s| s.matter.scatters());
        let first = scattering.next()?.span;
        let last = scattering.next_back().map_or(first, |stretch| stretch.span);
        Some(Span {
            near: first.near,
            far: last.far,
        })
    }
}

impl Stretch {
    /// Optical depth, by channel, of the whole stretch.
    pub fn depth(&self) -> DVec3 {
        let extinction = self.matter.sigma_t + self.matter.dimming;
        over(extinction, self.span.length())
    }
}
