//! The furnace: nothing can be seen where all there is has one temperature.
//!
//! A radiance L, the same from every direction, is a solution of the equation of transfer wherever
//! scattering only redirects it and each medium emits what it absorbs: in
//! `dL/dt = −σ_t L + σ_s ∫ p L dω + j` the terms cancel if `j = σ_a L`, for `∫ p dω = 1`. At a surface
//! they cancel if all light is reflected or refracted and none absorbed. So every ray brings back the
//! radiance of the environment, whatever the shapes, densities and phase functions.
//!
//! Source: Kirchhoff 1860, Annalen der Physik 185, 275–301; Chandrasekhar 1960, *Radiative
//! Transfer*, §2. The name of the test: Heitz 2014, JCGT 3(2), §5.

use super::formula::{AlongRay, Formula, exact};
use super::requirements::{any_order, require, without_lights};
use crate::optics::Material;
use crate::scene::Radiative;
use glam::DVec3;

/// Everything as bright as the environment.
pub const FURNACE: Formula = Formula {
    name: "furnace",
    what: "All there is loses nothing, or emits what it absorbs of the environment's radiance: that \
           radiance (Kirchhoff 1860).",
    of,
};

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    any_order(scene)?;
    without_lights(scene)?;
    require(
        scene.area_lights.is_empty(),
        "it has a lamp, and a furnace has one radiance",
    )?;
    for body in &scene.media {
        let balance = body.medium.coefficients.sigma_a() * scene.environment;
        // Equal to a rounding of the product.
        let off = (body.medium.emission - balance).abs();
        require(
            off.cmple(balance * f64::EPSILON).all(),
            "a medium does not emit its absorption times the environment's radiance",
        )?;
    }
    let is_lossless = |material: &Material| match material {
        Material::Diffuse(reflectance) | Material::Mirror(reflectance) => {
            *reflectance == DVec3::ONE
        }
        Material::Glass(_) => true,
    };
    require(
        scene.objects.iter().all(|o| is_lossless(&o.material)),
        "a surface absorbs light",
    )?;
    Ok(Box::new(move |_| Ok(exact(scene.environment))))
}
