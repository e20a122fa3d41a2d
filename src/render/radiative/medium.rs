//! One medium of a scene: its properties at a point, its majorants along a ray, its phase function.

use crate::geometry::{Boundary, Ray, Span};
use crate::optics::{Density, Homogeneous, Phase, optical_depth};
use crate::render::counters::{Counters, Event};
use glam::DVec3;

/// Coefficients of one medium, or of several together, per world length and channel.
///
/// A medium that only absorbs attenuates light and ends no flight: its extinction is kept apart
/// from that of the media that scatter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MediumProperties {
    /// Extinction of the media that scatter.
    pub sigma_t: DVec3,
    /// Scattering coefficient.
    pub sigma_s: DVec3,
    /// Extinction of the media that only absorb.
    pub absorbing: DVec3,
    /// Emitted radiance per length.
    pub emission: DVec3,
}

impl MediumProperties {
    /// The properties of `medium`.
    pub fn of(medium: &Homogeneous) -> MediumProperties {
        let coefficients = medium.coefficients;
        let (sigma_t, sigma_s) = (coefficients.sigma_t(), coefficients.sigma_s());
        let scatters = sigma_s != DVec3::ZERO;
        MediumProperties {
            sigma_t: if scatters { sigma_t } else { DVec3::ZERO },
            sigma_s,
            absorbing: if scatters { DVec3::ZERO } else { sigma_t },
            emission: medium.emission,
        }
    }

    /// Adds those of a medium that overlaps.
    pub fn add(&mut self, other: &MediumProperties) {
        self.sigma_t += other.sigma_t;
        self.sigma_s += other.sigma_s;
        self.absorbing += other.absorbing;
        self.emission += other.emission;
    }

    /// Extinction of all media.
    pub fn extinction(&self) -> DVec3 {
        self.sigma_t + self.absorbing
    }

    /// Whether any light is scattered.
    pub fn scatters(&self) -> bool {
        self.sigma_s != DVec3::ZERO
    }
}

/// A medium of a scene.
#[derive(Debug)]
pub struct Medium<'s> {
    /// The closed shape it fills; all space without one.
    pub boundary: Option<&'s Boundary>,
    /// Its properties at density 1.
    pub unit: MediumProperties,
    /// Its density; `None` for a homogeneous medium.
    pub density: Option<&'s Density>,
    /// Its properties on a segment. A heterogeneous medium has those of a homogeneous one, by which
    /// points on a ray are sampled.
    pub on_segment: MediumProperties,
    /// The phase function of its scattering.
    pub phase: Phase,
}

impl Medium<'_> {
    /// Extinction at density 1.
    pub fn sigma_t(&self) -> DVec3 {
        self.unit.extinction()
    }

    /// Whether it changes no light: all its properties are 0, or its density is.
    pub(crate) fn is_vacuum(&self) -> bool {
        self.unit == MediumProperties::default() || self.density.is_some_and(Density::is_nothing)
    }

    /// Scattering, by channel, at the world point `point` in its boundary. Adds to `lookups`.
    pub fn sigma_s(&self, point: DVec3, lookups: &mut u64) -> DVec3 {
        match self.density {
            Some(density) => self.unit.sigma_s * density.at(point, lookups),
            None => self.unit.sigma_s,
        }
    }

    /// Whether its density has an integral along lines.
    pub(crate) fn is_integrable(&self) -> bool {
        self.density.is_none_or(Density::is_integrable)
    }

    /// Its density integrated along `ray` over `span`, which lies in its boundary: a length.
    ///
    /// # Panics
    ///
    /// If the density has no integral.
    pub fn column(&self, ray: &Ray, span: Span, work: &mut Counters) -> f64 {
        let Some(density) = self.density else {
            return span.length();
        };
        let Some((line, span)) = density.along(ray, span) else {
            return 0.0;
        };
        let mut lookups = 0;
        let integral = density.integral(&line, span, &mut lookups);
        work.count_times(Event::DensityLookup, lookups);
        integral
    }
}

/// `a/b` by channel; 0 where `b` is 0.
pub(in crate::render) fn quotient(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| {
        if b[c] == 0.0 { 0.0 } else { a[c] / b[c] }
    }))
}

/// `σ·t` by channel; 0 of a coefficient of 0 over any length.
pub(in crate::render) fn over(sigma: DVec3, length: f64) -> DVec3 {
    DVec3::from_array(sigma.to_array().map(|sigma| optical_depth(sigma, length)))
}
