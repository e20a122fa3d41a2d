//! The media of a scene, and what they do to light along a ray.

use super::effects::Effects;
use super::majorants::Passage;
use super::tracker::Tracker;
use super::tracking::{Control, Small, ratio_tracking};
use crate::geometry::{Aabb, Boundary, Ray, Solid, Span, Surface};
use crate::math::exp;
use crate::media::{Density, HenyeyGreenstein, Homogeneous, optical_depth};
use crate::render::counters::{Event, Work};
use crate::scene::Body;
use glam::DVec3;
use std::cell::Cell;

/// What a stretch is made of, per world length and channel.
///
/// A medium that only absorbs dims light and ends no flight: its extinction is kept apart from
/// that of the media that scatter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Matter {
    /// Extinction of the media that scatter.
    pub sigma_t: DVec3,
    /// Scattering.
    pub sigma_s: DVec3,
    /// Extinction of the media that do not scatter.
    pub dimming: DVec3,
    /// Emitted radiance per length.
    pub emission: DVec3,
}

impl Matter {
    /// The matter of `medium`.
    fn of(medium: &Homogeneous) -> Matter {
        let coefficients = medium.coefficients;
        let (sigma_t, sigma_s) = (coefficients.sigma_t(), coefficients.sigma_s());
        let scatters = sigma_s != DVec3::ZERO;
        Matter {
            sigma_t: if scatters { sigma_t } else { DVec3::ZERO },
            sigma_s,
            dimming: if scatters { DVec3::ZERO } else { sigma_t },
            emission: medium.emission,
        }
    }

    fn add(&mut self, other: &Matter) {
        self.sigma_t += other.sigma_t;
        self.sigma_s += other.sigma_s;
        self.dimming += other.dimming;
        self.emission += other.emission;
    }

    /// Whether light is turned here.
    pub fn scatters(&self) -> bool {
        self.sigma_s != DVec3::ZERO
    }
}

/// The media of a scene, ready to be laid along rays.
#[derive(Debug)]
pub struct Media<'s> {
    bodies: Vec<Medium<'s>>,
    /// Those of varying density.
    varying: Set,
    /// Where light is scattered at all.
    scattering: Reach,
}

/// A medium.
#[derive(Debug)]
pub struct Medium<'s> {
    /// The closed shape it fills; all space without one.
    pub boundary: Option<&'s Boundary>,
    /// What it is made of where its density is 1.
    pub unit: Matter,
    /// Its density, if that varies.
    pub density: Option<&'s Density>,
    /// What it is made of on a stretch; of one of varying density, what stands in for its
    /// scattering.
    pub matter: Matter,
    /// Where scattered light goes.
    pub phase: HenyeyGreenstein,
}

impl Medium<'_> {
    /// Extinction where the density is 1.
    pub fn sigma_t(&self) -> DVec3 {
        self.unit.sigma_t + self.unit.dimming
    }

    /// Whether it changes nothing.
    pub fn is_nothing(&self) -> bool {
        self.unit == Matter::default() || self.density.is_some_and(Density::is_nothing)
    }
}

/// How far something reaches.
#[derive(Debug)]
enum Reach {
    Nowhere,
    Within(Aabb),
    Everywhere,
}

/// A set of media: a bit for each.
pub type Set = u64;

impl<'s> Media<'s> {
    /// The media of `bodies`, through which light is followed by tracking where their density
    /// varies. With `all`, also those of no matter, which change nothing.
    pub fn new(bodies: &'s [Body], all: bool) -> Media<'s> {
        // Made here and not by the threads that first ask for them.
        for density in tracked(bodies) {
            density.blocks();
        }
        Media::with(bodies, all, |unit, density| {
            if !unit.scatters() {
                return Matter::default();
            }
            let typical = density.typical();
            Matter {
                sigma_t: unit.sigma_t * typical,
                sigma_s: unit.sigma_s * typical,
                ..Matter::default()
            }
        })
    }

    /// The same for integrals along lines, which ask for no place by chance: nothing stands in for
    /// what varies, and no bounds on it are made.
    pub fn for_integrals(bodies: &'s [Body], all: bool) -> Media<'s> {
        Media::with(bodies, all, |_, _| Matter::default())
    }

    /// The media of `bodies`; `stand_in` makes what stands in for one of varying density, from
    /// what it is made of where its density is 1.
    fn with(
        bodies: &'s [Body],
        all: bool,
        stand_in: impl Fn(&Matter, &Density) -> Matter,
    ) -> Media<'s> {
        let medium = |body: &'s Body| {
            // One of a constant density is as good as one without.
            let (unit, density) = match body.even() {
                Some(medium) => (Matter::of(&medium), None),
                None => (Matter::of(&body.medium), body.density.as_ref()),
            };
            let matter = density.map_or(unit, |density| stand_in(&unit, density));
            Medium {
                boundary: body.boundary.as_ref(),
                unit,
                density,
                matter,
                phase: body.medium.phase,
            }
        };
        let mut bodies: Vec<_> = bodies.iter().map(medium).collect();
        bodies.retain(|body| all || !body.is_nothing());
        let mut scattering = Reach::Nowhere;
        for body in bodies.iter().filter(|body| body.matter.scatters()) {
            let bounds = body.boundary.map(Surface::bounds);
            scattering = match (scattering, bounds) {
                (Reach::Nowhere, Some(bounds)) => Reach::Within(bounds),
                (Reach::Within(others), Some(bounds)) => Reach::Within(others.union(bounds)),
                (Reach::Everywhere, _) | (_, None) => Reach::Everywhere,
            };
        }
        let varies = |(index, body): (usize, &Medium<'_>)| body.density.map(|_| 1 << index);
        let varying = bodies.iter().enumerate().filter_map(varies).sum();
        Media {
            bodies,
            varying,
            scattering,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.bodies.len()
    }

    /// All of them, in order.
    pub fn all(&self) -> &[Medium<'s>] {
        &self.bodies
    }

    /// What the media in `set` are together.
    pub fn matter(&self, set: Set) -> Matter {
        let mut matter = Matter::default();
        for index in members(set) {
            matter.add(&self.bodies[index].matter);
        }
        matter
    }

    /// One of them.
    pub fn medium(&self, index: usize) -> &Medium<'s> {
        &self.bodies[index]
    }

    /// Whether any of them has a varying density.
    pub fn vary(&self) -> bool {
        self.varying != 0
    }

    /// A stretch of `ray` that holds all places where light is scattered, if there are any.
    pub fn scattering_span(&self, ray: &Ray) -> Option<Span> {
        match &self.scattering {
            Reach::Nowhere => None,
            Reach::Within(bounds) => bounds.span(ray).filter(|span| span.near < span.far),
            Reach::Everywhere => Some(Span {
                near: 0.0,
                far: f64::INFINITY,
            }),
        }
    }

    /// Whether any of those in `set` has a varying density.
    pub fn varies(&self, set: Set) -> bool {
        set & self.varying != 0
    }

    /// Of those in `set`, the ones of varying density that scatter, and those that do not.
    pub fn varying_in(&self, set: Set) -> [Set; 2] {
        let varying = set & self.varying;
        if varying == 0 {
            return [0, 0];
        }
        let scattering = self.scattering_in(varying);
        [scattering, varying & !scattering]
    }

    /// Those in `set` that scatter.
    pub fn scattering_in(&self, set: Set) -> Set {
        let scatters = |&index: &usize| self.bodies[index].unit.scatters();
        members(set).filter(scatters).map(|index| 1 << index).sum()
    }

    /// Scattering coefficient and phase function of each medium in `set` that scatters, at the
    /// world point `point`, which lies in all of them. Of one medium alone, the coefficient is
    /// not looked up: it has nothing to be compared with. `lookups` counts those of densities.
    pub fn scatterers<E: Effects>(
        &self,
        set: Set,
        point: DVec3,
        lookups: &Cell<u64>,
    ) -> impl Iterator<Item = (DVec3, HenyeyGreenstein)> {
        // Not by what stands in for its scattering, which may vanish where that does not.
        let scatters = |&index: &usize| {
            let Medium { unit, density, .. } = &self.bodies[index];
            unit.scatters() && density.is_none_or(|density| !density.is_nothing())
        };
        let alone = !E::HETEROGENEOUS || members(set).filter(scatters).nth(1).is_none();
        members(set).filter(scatters).map(move |index| {
            let medium = &self.bodies[index];
            let sigma_s = match medium.density {
                Some(density) if !alone => {
                    let mut count = lookups.get();
                    let density = density.at(point, &mut count);
                    lookups.set(count);
                    medium.unit.sigma_s * density
                }
                _ => medium.unit.sigma_s,
            };
            (sigma_s, medium.phase)
        })
    }

    /// Scattering coefficient, by channel, of the media in `set` at the world point `point`,
    /// which lies in the boundaries of all of them.
    pub fn sigma_s<W: Work>(&self, set: Set, point: DVec3, work: &mut W) -> DVec3 {
        self.sum_at(
            set,
            |unit| unit.sigma_s,
            |density, lookups| density.at(point, lookups),
            work,
        )
    }

    /// Radiance sent out per length, by channel, by the media in `set` at the world point
    /// `point`, which lies in the boundaries of all of them. No bounds are looked at.
    pub fn emission<W: Work>(&self, set: Set, point: DVec3, work: &mut W) -> DVec3 {
        let at = |density: &Density, lookups: &mut u64| density.looked_up_at(point, lookups);
        self.sum_at(set, |unit| unit.emission, at, work)
    }

    /// The sum of a property of the media in `set`, each times its density `at` a place; a density
    /// is not looked up for a property of 0.
    fn sum_at<W: Work>(
        &self,
        set: Set,
        property: impl Fn(&Matter) -> DVec3,
        at: impl Fn(&Density, &mut u64) -> f64,
        work: &mut W,
    ) -> DVec3 {
        members(set).fold(DVec3::ZERO, |sum, index| {
            let medium = &self.bodies[index];
            let unit = property(&medium.unit);
            let density = match medium.density {
                Some(density) if unit != DVec3::ZERO => {
                    let mut lookups = 0;
                    let density = at(density, &mut lookups);
                    work.count_times(Event::DensityLookup, lookups);
                    density
                }
                _ => 1.0,
            };
            sum + unit * density
        })
    }

    /// Optical depth by channel from the origin of `ray` to distance `end`: in closed form, and
    /// cell by cell through grids.
    ///
    /// # Panics
    ///
    /// If a density on the way has no integral.
    pub fn depth<W: Work>(
        &self,
        ray: &Ray,
        end: f64,
        spans: &mut Vec<Span>,
        work: &mut W,
    ) -> DVec3 {
        let mut depth = DVec3::ZERO;
        for body in &self.bodies {
            if body.density.is_some() && body.is_nothing() {
                continue;
            }
            let length = match (body.boundary, body.density) {
                (None, _) => end,
                (Some(boundary), density) => {
                    spans.clear();
                    boundary.append_spans(ray, spans);
                    let spans = spans.iter().map(|span| Span {
                        near: span.near,
                        far: span.far.min(end).max(span.near),
                    });
                    match density {
                        None => spans.map(|span| span.length()).sum(),
                        Some(density) => spans
                            .map(|span| density_integral(density, ray, span, work))
                            .sum(),
                    }
                }
            };
            depth += over(body.sigma_t(), length);
        }
        depth
    }

    /// The share of light, by channel, that gets from the origin of `ray` to distance `end`; an
    /// estimate, if a medium on the way has a density that varies and scatters, or one that has
    /// no integral.
    pub fn transmittance<E: Effects, W: Work>(
        &self,
        ray: &Ray,
        end: f64,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        if !E::HETEROGENEOUS || !self.vary() {
            let depth = self.depth(ray, end, &mut tracker.spans, work);
            return transmittance::<E, W>(depth, work);
        }
        let mut depth = DVec3::ZERO;
        let mut estimate = DVec3::ONE;
        for index in 0..self.bodies.len() {
            let body = &self.bodies[index];
            if body.density.is_some() && body.is_nothing() {
                // No random number may be drawn for what is not there.
                continue;
            }
            let Some(boundary) = body.boundary else {
                depth += over(body.sigma_t(), end);
                continue;
            };
            let mut spans = std::mem::take(&mut tracker.spans);
            spans.clear();
            boundary.append_spans(ray, &mut spans);
            for &Span { near, far } in spans.iter().filter(|span| span.near < end) {
                let span = Span {
                    near,
                    far: far.min(end),
                };
                match body.density {
                    None => depth += over(body.sigma_t(), span.length()),
                    Some(_) => {
                        estimate *= self.through::<E, W>(1 << index, ray, span, tracker, work);
                    }
                }
            }
            tracker.spans = spans;
        }
        estimate * transmittance::<E, W>(depth, work)
    }

    /// The share of light, by channel, that crosses the media of varying density in `set` along
    /// `ray` over `span`, which lies in all of them. Exact through one that does not scatter, if
    /// its density has an integral; else an estimate.
    pub fn through<E: Effects, W: Work>(
        &self,
        set: Set,
        ray: &Ray,
        span: Span,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let mut depth = DVec3::ZERO;
        let mut unknown = 0;
        for index in members(set & self.varying) {
            let medium = &self.bodies[index];
            match medium.density {
                Some(density) if !medium.unit.scatters() && density.is_integrable() => {
                    let integral = density_integral(density, ray, span, work);
                    depth += over(medium.sigma_t(), integral);
                }
                _ => unknown |= 1 << index,
            }
        }
        let known = transmittance::<E, W>(depth, work);
        match unknown {
            0 => known,
            _ => known * self.estimated(unknown, ray, span, tracker, work),
        }
    }

    /// An estimate of the share of light, by channel, that crosses the media in `set`.
    fn estimated<W: Work>(
        &self,
        set: Set,
        ray: &Ray,
        span: Span,
        tracker: &mut Tracker,
        work: &mut W,
    ) -> DVec3 {
        let (strands, chance, effort) = tracker.parts();
        let mut passage = Passage::new(self, set, ray, span, strands);
        let (control, small) = (Control::LowerBound, Small::Thinned);
        let share = ratio_tracking(&mut passage, control, small, chance, effort);
        passage.count(work);
        share
    }
}

/// The densities in `bodies` through which light may be followed by tracking: of what scatters, of
/// what has no integral, and, where anything glows, of all.
pub(in crate::render) fn tracked(bodies: &[Body]) -> impl Iterator<Item = &Density> {
    let glows = bodies
        .iter()
        .any(|body| body.medium.emission != DVec3::ZERO);
    let varying = bodies.iter().filter(|body| body.even().is_none());
    varying.filter_map(move |body| {
        let density = body.density.as_ref()?;
        let scatters = body.medium.coefficients.sigma_s() != DVec3::ZERO;
        (glows || scatters || !density.is_integrable()).then_some(density)
    })
}

/// `∫ density dt` along `ray` over `span`.
pub(in crate::render) fn density_integral<W: Work>(
    density: &Density,
    ray: &Ray,
    span: Span,
    work: &mut W,
) -> f64 {
    let Some((line, span)) = density.along(ray, span) else {
        return 0.0;
    };
    let mut lookups = 0;
    let integral = density.integral(&line, span, &mut lookups);
    work.count_times(Event::DensityLookup, lookups);
    integral
}

/// `σ·t` by channel, where nothing over any length is nothing.
pub(in crate::render) fn over(sigma: DVec3, length: f64) -> DVec3 {
    DVec3::from_array(sigma.to_array().map(|sigma| optical_depth(sigma, length)))
}

/// The media of a set.
pub fn members(set: Set) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || {
        let index = left.trailing_zeros();
        left &= left.wrapping_sub(1);
        (index < Set::BITS).then_some(index as usize)
    })
}

/// `e^(−τ)` by channel; one exponential where all channels are the same.
pub fn transmittance<E: Effects, W: Work>(depth: DVec3, work: &mut W) -> DVec3 {
    work.count(Event::Attenuation);
    if E::CHROMATIC {
        work.count_times(Event::ChannelAttenuation, 2);
        DVec3::from_array(depth.to_array().map(|depth| exp(-depth)))
    } else {
        DVec3::splat(exp(-depth.x))
    }
}
