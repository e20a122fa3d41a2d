//! Majorants along a ray through overlapping media.

use super::majorants::HeterogeneousSegment;
use super::media::{Media, Set, members};
use super::tracking::{MajorantSegment, Majorants};
use crate::geometry::{Ray, Span};
use crate::render::counters::{Counters, Event};
use glam::DVec3;

/// The ray–majorant iterator: segments of a ray within which the majorants of all media of a set
/// are constant, with properties at single points in between.
#[derive(Debug)]
pub struct RayMajorants<'m, 's> {
    media: &'m Media<'s>,
    /// Sums over the homogeneous media.
    sigma_t: DVec3,
    sigma_s: DVec3,
    emission: DVec3,
    /// The heterogeneous ones, each with its index in `media`; memory of the tracker.
    heterogeneous: &'m mut Vec<HeterogeneousSegment>,
    rest: Span,
    lookups: u64,
    blocks: u64,
}

impl<'m, 's> RayMajorants<'m, 's> {
    /// The media in `set` along `ray` over `span`, which lies within all of them.
    pub fn new(
        media: &'m Media<'s>,
        set: Set,
        ray: &Ray,
        span: Span,
        heterogeneous: &'m mut Vec<HeterogeneousSegment>,
    ) -> RayMajorants<'m, 's> {
        heterogeneous.clear();
        let [mut sigma_t, mut sigma_s, mut emission] = [DVec3::ZERO; 3];
        for index in members(set) {
            let medium = media.medium(index);
            if let Some(density) = medium.density {
                heterogeneous.extend(HeterogeneousSegment::new(index, density, ray, span));
            } else {
                sigma_t += medium.sigma_t();
                sigma_s += medium.unit.sigma_s;
                emission += medium.unit.emission;
            }
        }
        RayMajorants {
            media,
            sigma_t,
            sigma_s,
            emission,
            heterogeneous,
            rest: span,
            lookups: 0,
            blocks: 0,
        }
    }

    /// Counts the densities looked up and the blocks walked.
    pub fn count_work(&self, work: &mut Counters) {
        work.count_times(Event::DensityLookup, self.lookups);
        work.count_times(Event::CellWalked, self.blocks);
    }

    /// Scattering, by channel, where the extinction was last looked up.
    pub fn sigma_s(&self) -> DVec3 {
        self.heterogeneous
            .iter()
            .fold(self.sigma_s, |sum, segment| {
                sum + self.media.medium(segment.medium).unit.sigma_s * segment.density
            })
    }

    /// Emission, by channel, where the extinction was last looked up.
    pub fn emission(&self) -> DVec3 {
        self.heterogeneous
            .iter()
            .fold(self.emission, |sum, segment| {
                sum + self.media.medium(segment.medium).unit.emission * segment.density
            })
    }
}

impl Iterator for RayMajorants<'_, '_> {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        let Span { near, mut far } = self.rest;
        if near >= far {
            return None;
        }
        let (mut minorant, mut majorant) = (self.sigma_t, self.sigma_t);
        let mut emission = self.emission;
        for segment in self.heterogeneous.iter_mut() {
            let medium = self.media.medium(segment.medium);
            if segment.end <= near {
                self.blocks += 1;
                segment.advance(near, medium.density.expect("a heterogeneous medium"));
            }
            far = far.min(segment.end);
            let sigma_t = medium.sigma_t();
            minorant += sigma_t * segment.range.low;
            majorant += sigma_t * segment.range.high;
            emission += medium.unit.emission * segment.range.high;
        }
        self.rest.near = far;
        Some(MajorantSegment {
            span: Span { near, far },
            minorant,
            majorant,
            emission,
        })
    }
}

impl Majorants for RayMajorants<'_, '_> {
    fn extinction(&mut self, t: f64) -> DVec3 {
        let mut sigma_t = self.sigma_t;
        for segment in self.heterogeneous.iter_mut() {
            let medium = self.media.medium(segment.medium);
            let density = medium.density.expect("a heterogeneous medium");
            sigma_t += medium.sigma_t() * segment.look_up(t, density, &mut self.lookups);
        }
        sigma_t
    }
}
