//! What a surface does to light.

use glam::DVec3;

/// What a surface does to the light that meets it. Everything is two-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Lambert's: reflects into the half-space it was met from, with the same radiance in every
    /// direction. The reflectance, by channel, lies in [0, 1].
    Diffuse(DVec3),
    /// Reflects as a perfect mirror. The reflectance, by channel, lies in [0, 1].
    Mirror(DVec3),
    /// Smooth, clear glass: reflects and refracts by Fresnel's equations. The index of
    /// refraction of what lies behind the surface (inside a closed shape), relative to what lies
    /// in front; positive.
    Glass(f64),
}

/// The sides of a surface that emit light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The side the normal points to; outside, for closed shapes.
    Front,
    /// Both.
    Both,
}
