//! Light in surroundings: surfaces, participating media, lights, and who looks at it.

use crate::geometry::{Boundary, Camera, Luminous, Shape};
use crate::media::Homogeneous;
use crate::optics::{Light, Material, Sides};
use glam::DVec3;

/// How often light may be turned on its way from a light to the eye, by media and surfaces
/// together. To cross the boundary of a medium is no turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scattering {
    /// Never: lights are seen straight, through what absorbs.
    None,
    /// Once at most.
    Single,
    /// Any number of times, or up to a limit of at least 2.
    Multiple(Option<u32>),
}

/// A surface that reflects or refracts.
#[derive(Clone, Debug)]
pub struct Object {
    /// Where it is.
    pub shape: Shape,
    /// What it does to light.
    pub material: Material,
}

/// A surface that sends out light and reflects none.
#[derive(Clone, Debug)]
pub struct AreaLight {
    /// Where it is.
    pub shape: Luminous,
    /// Radiance by channel, the same in every direction.
    pub radiance: DVec3,
    /// Which sides send it out.
    pub sides: Sides,
}

/// A medium and the space it fills.
#[derive(Clone, Debug)]
pub struct Body {
    /// The closed shape it fills; without one it fills all space.
    pub boundary: Option<Boundary>,
    /// What it is made of. Where bodies overlap, their coefficients and emissions add up.
    pub medium: Homogeneous,
}

/// Surfaces, participating media and lights.
#[derive(Clone, Debug)]
pub struct Radiative {
    /// How often light may be turned.
    pub scattering: Scattering,
    /// Surfaces that reflect or refract.
    pub objects: Vec<Object>,
    /// Surfaces that send out light.
    pub area_lights: Vec<AreaLight>,
    /// Media; at most [`Radiative::MOST_MEDIA`].
    pub media: Vec<Body>,
    /// Lights without extent.
    pub lights: Vec<Light>,
    /// Radiance by channel from infinitely far away, the same from every direction.
    pub environment: DVec3,
    /// The eye.
    pub camera: Camera,
    /// Samples per pixel, where random numbers are needed.
    pub samples: u32,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Radiative {
    /// Media in a scene, at most: a set of them is a word of 64 bits.
    pub const MOST_MEDIA: usize = 64;
}
