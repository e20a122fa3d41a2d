//! A stretch of a ray through media whose density differs from place to place.

use super::media::{Media, Set, members};
use super::tracking::{Bounded, Bounds};
use crate::geometry::{Aabb, Ray, Span};
use crate::media::Line;
use crate::render::counters::{Event, Work};
use crate::volume::{DensityField, DensityRange, Visit, Walk};
use glam::DVec3;

/// The media of a set along a stretch of a ray, block by block of each of them.
#[derive(Debug)]
pub struct Passage<'m, 's> {
    media: &'m Media<'s>,
    /// What the media of one density are together.
    even: Sums,
    /// Those of varying density; memory of the tracker.
    strands: &'m mut Vec<Strand>,
    rest: Span,
    lookups: u64,
    blocks: u64,
}

/// Extinction, scattering and emission, per length and channel.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    sigma_t: DVec3,
    sigma_s: DVec3,
    emission: DVec3,
}

/// A medium of varying density along a ray.
#[derive(Clone, Debug)]
pub struct Strand {
    medium: usize,
    line: Line,
    walk: Walk,
    /// The visit to a block that the ray has not come to yet.
    coming: Option<Visit>,
    /// Where the present block, or gap, ends.
    until: f64,
    /// Bounds on the density up to there.
    range: DensityRange,
    /// The present block, in the coordinates of the field.
    block: Aabb,
    /// The density last looked up.
    density: f64,
}

impl<'m, 's> Passage<'m, 's> {
    /// The media in `set` along `ray` over `span`, which lies within all of them.
    pub fn new(
        media: &'m Media<'s>,
        set: Set,
        ray: &Ray,
        span: Span,
        strands: &'m mut Vec<Strand>,
    ) -> Passage<'m, 's> {
        strands.clear();
        let mut even = Sums::default();
        for index in members(set) {
            let medium = media.medium(index);
            let Some(density) = medium.density else {
                even.sigma_t += medium.sigma_t();
                even.sigma_s += medium.unit.sigma_s;
                even.emission += medium.unit.emission;
                continue;
            };
            let Some((line, inside)) = density.along(ray, span) else {
                continue;
            };
            strands.push(Strand {
                medium: index,
                line,
                walk: density.walk(&line, inside),
                coming: None,
                until: span.near,
                range: DensityRange::of(0.0),
                block: *density.blocks().bounds(),
                density: 0.0,
            });
        }
        Passage {
            media,
            even,
            strands,
            rest: span,
            lookups: 0,
            blocks: 0,
        }
    }

    /// Tells of the densities looked up and the blocks walked.
    pub fn count<W: Work>(&self, work: &mut W) {
        work.count_times(Event::DensityLookup, self.lookups);
        work.count_times(Event::CellWalked, self.blocks);
    }

    /// Scattering, by channel, where the extinction was last looked up.
    pub fn sigma_s(&self) -> DVec3 {
        self.strands.iter().fold(self.even.sigma_s, |sum, strand| {
            sum + self.media.medium(strand.medium).unit.sigma_s * strand.density
        })
    }

    /// Emission, by channel, where the extinction was last looked up.
    pub fn emission(&self) -> DVec3 {
        self.strands.iter().fold(self.even.emission, |sum, strand| {
            sum + self.media.medium(strand.medium).unit.emission * strand.density
        })
    }
}

impl Bounded for Passage<'_, '_> {
    fn next_stretch(&mut self) -> Option<Bounds> {
        let Span { near, mut far } = self.rest;
        if near >= far {
            return None;
        }
        let (mut low, mut high) = (self.even.sigma_t, self.even.sigma_t);
        let mut glow = self.even.emission;
        for strand in self.strands.iter_mut() {
            let medium = self.media.medium(strand.medium);
            if strand.until <= near {
                self.blocks += 1;
                strand.advance(near, medium.density.expect("a strand varies"));
            }
            far = far.min(strand.until);
            let sigma_t = medium.sigma_t();
            low += sigma_t * strand.range.low;
            high += sigma_t * strand.range.high;
            glow += medium.unit.emission * strand.range.high;
        }
        self.rest.near = far;
        Some(Bounds {
            span: Span { near, far },
            low,
            high,
            glow,
        })
    }

    fn extinction(&mut self, t: f64) -> DVec3 {
        let mut sigma_t = self.even.sigma_t;
        for strand in self.strands.iter_mut() {
            let medium = self.media.medium(strand.medium);
            strand.density = if strand.range.high == 0.0 {
                0.0
            } else {
                self.lookups += 1;
                let density = medium.density.expect("a strand varies");
                // Roundings must not move a point to the next block, whose bounds are others.
                let point = strand.line.at(t).clamp(strand.block.min, strand.block.max);
                density.field().density(point)
            };
            sigma_t += medium.sigma_t() * strand.density;
        }
        sigma_t
    }
}

impl Strand {
    /// Goes on to the block, or gap, that begins at `at`.
    fn advance(&mut self, at: f64, density: &crate::media::Density) {
        let blocks = density.blocks();
        match self.coming.take().or_else(|| self.walk.next()) {
            Some(visit) if visit.span.near > at => {
                self.range = DensityRange::of(0.0);
                self.until = visit.span.near;
                self.coming = Some(visit);
            }
            Some(visit) => {
                self.range = blocks.range_in(visit.cell);
                self.block = blocks.cell_bounds(visit.cell);
                self.until = visit.span.far;
            }
            None => {
                self.range = DensityRange::of(0.0);
                self.until = f64::INFINITY;
            }
        }
    }
}
