//! The formula: radiance along the rays of scenes of one kind.

use crate::geometry::Ray;
use crate::math;
use crate::math::quadrature::Integral;
use crate::scene::Radiative;
use glam::DVec3;

/// Radiance along a ray with a bound on its error; an error if the formula does not hold for the ray.
pub type AlongRay<'s> = Box<dyn Fn(&Ray) -> Result<Integral, String> + 's>;

/// A formula for the radiance along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Formula {
    /// Name, as in manifests.
    pub name: &'static str,
    /// The scenes it describes, and its source.
    pub what: &'static str,
    /// The formula for a scene.
    pub(super) of: fn(&Radiative) -> Result<AlongRay<'_>, String>,
}

/// A radiance without an error.
pub(super) fn exact(value: DVec3) -> Integral {
    Integral { value, error: 0.0 }
}

/// Share of the light that passes an optical depth, by channel.
pub(super) fn transmittance(depth: DVec3) -> DVec3 {
    depth.map(|depth| math::exp(-depth))
}
