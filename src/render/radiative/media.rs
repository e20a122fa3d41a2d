//! The media of a scene.

use super::medium::{Medium, MediumProperties, over};
use crate::geometry::{Aabb, Ray, Solid, Span, Surface};
use crate::optics::Density;
use crate::render::counters::{Counters, Event};
use crate::scene::Body;
use glam::DVec3;

/// The media of a scene, prepared for rendering.
#[derive(Debug)]
pub struct Media<'s> {
    media: Vec<Medium<'s>>,
    heterogeneous: Set,
    /// A box around those that scatter.
    scattering: Option<Aabb>,
}

/// The box around all space.
const EVERYWHERE: Aabb = Aabb {
    min: DVec3::NEG_INFINITY,
    max: DVec3::INFINITY,
};

/// A set of media: a bit for each.
pub type Set = u64;

impl<'s> Media<'s> {
    /// The media of `bodies` for random paths, which track light through heterogeneous media. With
    /// `vacuum`, media without any effect are kept, too.
    pub fn new(bodies: &'s [Body], vacuum: bool) -> Media<'s> {
        // Made here and not by the threads that first ask for them.
        for density in tracked(bodies) {
            density.blocks();
        }
        Media::with(bodies, vacuum, |unit, density| {
            if !unit.scatters() {
                return MediumProperties::default();
            }
            let typical = density.typical();
            MediumProperties {
                sigma_t: unit.sigma_t * typical,
                sigma_s: unit.sigma_s * typical,
                ..MediumProperties::default()
            }
        })
    }

    /// The media of `bodies` for integrals along lines, which need no majorants.
    pub fn for_integrals(bodies: &'s [Body], vacuum: bool) -> Media<'s> {
        Media::with(bodies, vacuum, |_, _| MediumProperties::default())
    }

    /// The media of `bodies`; `proposal` makes the properties by which points in a heterogeneous
    /// medium are sampled, from those at density 1.
    fn with(
        bodies: &'s [Body],
        vacuum: bool,
        proposal: impl Fn(&MediumProperties, &Density) -> MediumProperties,
    ) -> Media<'s> {
        let medium = |body: &'s Body| {
            // A constant density makes a homogeneous medium.
            let (unit, density) = match body.homogeneous() {
                Some(medium) => (MediumProperties::of(&medium), None),
                None => (MediumProperties::of(&body.medium), body.density.as_ref()),
            };
            Medium {
                boundary: body.boundary.as_ref(),
                unit,
                density,
                on_segment: density.map_or(unit, |density| proposal(&unit, density)),
                phase: body.medium.phase,
            }
        };
        let mut media: Vec<_> = bodies.iter().map(medium).collect();
        media.retain(|medium| vacuum || !medium.is_vacuum());
        let mut heterogeneous = 0;
        let mut scattering = None;
        for (index, medium) in media.iter().enumerate() {
            if medium.density.is_some() {
                heterogeneous |= 1 << index;
            }
            if medium.on_segment.scatters() {
                let bounds = medium.boundary.map_or(EVERYWHERE, Surface::bounds);
                scattering = Some(scattering.map_or(bounds, |others: Aabb| others.union(bounds)));
            }
        }
        Media {
            media,
            heterogeneous,
            scattering,
        }
    }

    /// All media, by index.
    pub fn all(&self) -> &[Medium<'s>] {
        &self.media
    }

    /// The medium with this index.
    pub fn medium(&self, index: usize) -> &Medium<'s> {
        &self.media[index]
    }

    /// Properties, on a segment, of the media in `set` together.
    pub(crate) fn on_segment(&self, set: Set) -> MediumProperties {
        let mut properties = MediumProperties::default();
        for index in members(set) {
            properties.add(&self.media[index].on_segment);
        }
        properties
    }

    /// Heterogeneous media of `set`.
    pub fn heterogeneous(&self, set: Set) -> Set {
        set & self.heterogeneous
    }

    /// Scattering media of `set`.
    pub fn scattering(&self, set: Set) -> Set {
        let scatters = |&index: &usize| self.media[index].unit.scatters();
        members(set).filter(scatters).map(|index| 1 << index).sum()
    }

    /// Whether any medium scatters.
    pub fn scatter(&self) -> bool {
        self.scattering.is_some()
    }

    /// A segment of `ray` that holds all points where light is scattered, if there are any.
    pub(crate) fn scattering_span(&self, ray: &Ray) -> Option<Span> {
        let span = self.scattering?.span(ray)?;
        (span.near < span.far).then_some(span)
    }

    /// Scattering coefficient, by channel, of the media in `set` at the world point `point`,
    /// which lies in the boundaries of all of them. No density is looked up for a coefficient of 0.
    pub fn sigma_s(&self, set: Set, point: DVec3, work: &mut Counters) -> DVec3 {
        let mut lookups = 0;
        let scatterers = members(set).map(|index| &self.media[index]);
        let sigma_s = scatterers
            .filter(|medium| medium.unit.scatters())
            .fold(DVec3::ZERO, |sum, medium| {
                sum + medium.sigma_s(point, &mut lookups)
            });
        work.count_times(Event::DensityLookup, lookups);
        sigma_s
    }

    /// Emitted radiance per length, by channel, of the media in `set` at the world point `point`,
    /// which lies in the boundaries of all of them. No density is looked up for an emission of 0.
    pub fn emission(&self, set: Set, point: DVec3, work: &mut Counters) -> DVec3 {
        let mut lookups = 0;
        let emitters = members(set).map(|index| &self.media[index]);
        let emission = emitters
            .filter(|medium| medium.unit.emission != DVec3::ZERO)
            .fold(DVec3::ZERO, |sum, medium| {
                // Integrals have no majorants to tell where the density is 0.
                let density = medium
                    .density
                    .map_or(1.0, |density| density.looked_up_at(point, &mut lookups));
                sum + medium.unit.emission * density
            });
        work.count_times(Event::DensityLookup, lookups);
        emission
    }

    /// Optical depth by channel from the origin of `ray` to distance `end`: in closed form, and
    /// cell by cell through grids.
    ///
    /// # Panics
    ///
    /// If a density on the way has no integral.
    pub fn optical_depth(
        &self,
        ray: &Ray,
        end: f64,
        spans: &mut Vec<Span>,
        work: &mut Counters,
    ) -> DVec3 {
        let mut depth = DVec3::ZERO;
        for medium in &self.media {
            if medium.density.is_some() && medium.is_vacuum() {
                continue;
            }
            let column = match medium.boundary {
                None => end,
                Some(boundary) => {
                    spans.clear();
                    boundary.append_spans(ray, spans);
                    let spans = spans
                        .iter()
                        .map(|span| Span::new(span.near, span.far.min(end).max(span.near)));
                    spans.map(|span| medium.column(ray, span, work)).sum()
                }
            };
            depth += over(medium.sigma_t(), column);
        }
        depth
    }
}

/// The densities in `bodies` through which light may be tracked. If any medium emits, these are all; else the ones that
/// have no integral along a line, or belong to media that scatter.
pub(in crate::render) fn tracked(bodies: &[Body]) -> impl Iterator<Item = &Density> {
    let emissive = bodies
        .iter()
        .any(|body| body.medium.emission != DVec3::ZERO);
    let heterogeneous = bodies.iter().filter(|body| body.homogeneous().is_none());
    heterogeneous.filter_map(move |body| {
        let density = body.density.as_ref()?;
        let scatters = body.medium.coefficients.sigma_s() != DVec3::ZERO;
        (emissive || scatters || !density.is_integrable()).then_some(density)
    })
}

/// The media of a set, by rising index.
pub fn members(set: Set) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let index = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (index < Set::BITS).then_some(index as usize)
    })
}
