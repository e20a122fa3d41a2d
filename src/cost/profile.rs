//! Extinction along one ray: the input of every estimator of its transmittance.

use crate::geometry::Span;
use crate::render::radiative::tracking::{MajorantSegment, Majorants};
use glam::DVec3;

/// Extinction along a ray, in one channel.
pub struct Profile<'p> {
    /// Segments that follow one another without gaps, with bounds on the extinction over each.
    pub segments: Vec<BoundedSegment>,
    /// Extinction at a distance, per length; adds what it looked up to the number.
    pub extinction: Extinction<'p>,
    /// Points between which the extinction is smooth, or nearly so, beside the ends of segments.
    pub kinks: Vec<f64>,
    /// Densities that a lookup of the extinction looks up; 0 if that differs along the ray.
    pub densities: usize,
}

/// Extinction by distance; the number counts lookups.
pub type Extinction<'p> = Box<dyn Fn(f64, &mut u64) -> f64 + Send + Sync + 'p>;

/// A segment of a ray, and bounds on the extinction over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundedSegment {
    /// The segment.
    pub span: Span,
    /// Lower bound on the extinction.
    pub low: f64,
    /// Upper bound on the extinction.
    pub high: f64,
}

impl Profile<'_> {
    /// The span of the ray.
    pub fn span(&self) -> Span {
        match (self.segments.first(), self.segments.last()) {
            (Some(first), Some(last)) => Span::new(first.span.near, last.span.far),
            _ => Span::new(0.0, 0.0),
        }
    }

    /// The mean of the bounds: more than that of the extinction.
    pub fn mean(&self) -> f64 {
        self.majorant_depth() / self.span().length()
    }

    /// `∫ σ̄ dt`, the depth of the bounds.
    pub(crate) fn majorant_depth(&self) -> f64 {
        let segments = self.segments.iter();
        segments
            .map(|segment| segment.high * segment.span.length())
            .sum()
    }

    /// Extinction at `t`, without counting lookups.
    pub fn at(&self, t: f64) -> f64 {
        (self.extinction)(t, &mut 0)
    }

    /// Ends of segments and kinks, in order, each once: between two of them the extinction is
    /// smooth.
    pub fn cuts(&self) -> Vec<f64> {
        let span = self.span();
        let mut cuts: Vec<f64> = vec![span.near, span.far];
        cuts.extend(self.segments.iter().map(|segment| segment.span.near));
        cuts.extend(&self.kinks);
        cuts.retain(|&t| span.near <= t && t <= span.far);
        cuts.sort_unstable_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }

    /// The segment that holds `t`; of two that meet there, the first.
    pub(crate) fn segment_at(&self, t: f64) -> Option<&BoundedSegment> {
        let index = self
            .segments
            .partition_point(|segment| segment.span.far < t);
        self.segments.get(index)
    }

    /// The same ray in a medium `factor > 0` times as dense.
    pub fn scaled(&self, factor: f64) -> Profile<'_> {
        let segment = |segment: &BoundedSegment| BoundedSegment {
            low: segment.low * factor,
            // An extinction may round up where its bound rounds down.
            high: segment.high * factor * (1.0 + 2.0 * f64::EPSILON),
            ..*segment
        };
        Profile {
            segments: self.segments.iter().map(segment).collect(),
            extinction: Box::new(move |t, lookups| factor * (self.extinction)(t, lookups)),
            kinks: self.kinks.clone(),
            densities: self.densities,
        }
    }

    /// The ray as an iterator for the renderer's own trackers.
    pub fn walk(&self) -> ProfileWalk<'_> {
        ProfileWalk {
            profile: self,
            next: 0,
            lookups: 0,
        }
    }
}

/// A walk along a profile.
pub struct ProfileWalk<'p> {
    profile: &'p Profile<'p>,
    next: usize,
    /// Lookups so far.
    pub lookups: u64,
}

impl Iterator for ProfileWalk<'_> {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        let segment = self.profile.segments.get(self.next)?;
        self.next += 1;
        Some(MajorantSegment {
            span: segment.span,
            minorant: DVec3::splat(segment.low),
            majorant: DVec3::splat(segment.high),
            emission: DVec3::ZERO,
        })
    }
}

impl Majorants for ProfileWalk<'_> {
    fn extinction(&mut self, t: f64) -> DVec3 {
        DVec3::splat((self.profile.extinction)(t, &mut self.lookups))
    }
}
