//! Materials of surfaces.

use glam::DVec3;

/// Scattering of light at a surface. All materials are two-sided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Material {
    /// Lambertian: reflects into the half-space of the incoming light, with the same radiance in
    /// every direction. The reflectance, by channel, lies in [0, 1].
    Diffuse(DVec3),
    /// Reflects as a perfect mirror. The reflectance, by channel, lies in [0, 1].
    Mirror(DVec3),
    /// Smooth, clear glass: reflects and refracts by Fresnel's equations. The refractive index
    /// behind the surface (inside a closed shape) relative to that in front; positive.
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
