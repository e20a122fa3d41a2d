//! Airlight: a point light in fog without end, scattered once.
//!
//! The eye looks along a ray that passes the light at distance D. At the angle φ, seen from the light,
//! from the nearest point of the ray, the place on the ray is `t = t₀ + D tan φ` along it and
//! `r = D / cos φ` from the light, so that `dt / r² = dφ / D`. Light that goes on to the eye there is
//! deflected by a cosine of −sin φ. With intensity I
//!
//! ```text
//! L = (σ_s I / D) ∫ p(−sin φ) e^(−σ_t (t(φ) + r(φ))) dφ,   from −atan(t₀/D) to π/2.
//! ```
//!
//! The integrand is smooth and bounded; without scattering in colour it is the special function of
//! the source, an integral as well. A ball of fog stands for fog without end if the eye is so deep in it
//! that nothing is seen of what is beyond.
//!
//! Source: Sun, Ramamoorthi, Narasimhan & Nayar 2005, ACM TOG 24(3), 1040–1049, eqs. 5–11; with any
//! phase function, Pegoraro & Parker 2009, Computer Graphics Forum 28(2), 329–335.

use super::bodies::Convex;
use super::formula::{AlongRay, Formula, transmittance};
use super::phase_function::phase_function;
use super::requirements::{
    dark, henyey_greenstein, only_homogeneous, require, single_scattering, without_surfaces,
};
use crate::math;
use crate::math::quadrature::{Integral, integrate};
use crate::optics::Light;
use crate::scene::Radiative;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// A point light in endless fog.
pub const AIRLIGHT: Formula = Formula {
    name: "airlight",
    what: "A point light in homogeneous fog without end, light scattered once: an integral over an \
           angle (Sun et al. 2005; Pegoraro & Parker 2009).",
    of,
};

/// Mean free paths, at least, from the eye to where the fog ends: e^(−25) is below 2e-11.
const DEEP: f64 = 25.0;

/// Relative error of the integral.
const TOLERANCE: f64 = 1e-10;

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    single_scattering(scene)?;
    without_surfaces(scene)?;
    let (body, medium) = only_homogeneous(scene)?;
    dark(medium)?;
    let eye = scene.camera.eye;
    let free_paths = medium.coefficients.sigma_t().min_element();
    let is_endless = match Convex::of(body)? {
        Convex::Everywhere => true,
        Convex::Ball { centre, radius } => (radius - (eye - centre).length()) * free_paths >= DEEP,
        Convex::Cuboid { .. } => false,
    };
    require(
        is_endless,
        "the medium ends within 25 mean free paths of the eye: leave its boundary out, or make it a \
         large `sphere`",
    )?;
    let g = henyey_greenstein(&medium.phase)?;
    let [Light::Point(light)] = &scene.lights[..] else {
        return Err("its light is not one point light".to_owned());
    };
    let coefficients = medium.coefficients;
    require(
        free_paths > 0.0,
        "the medium does not attenuate every channel",
    )?;
    Ok(Box::new(move |ray| {
        let to_light = light.position - ray.origin;
        let nearest = to_light.dot(*ray.direction);
        let beside = (to_light - *ray.direction * nearest).length();
        require(beside > 0.0, "the ray passes through the light")?;
        let integrand = |phi: f64| {
            let (sine, cosine) = (math::sin(phi), math::cos(phi));
            // The end of the ray, where nothing is left.
            if cosine <= 0.0 {
                return DVec3::ZERO;
            }
            let way = nearest + beside * (sine + 1.0) / cosine;
            transmittance(coefficients.sigma_t() * way) * phase_function(g, -sine)
        };
        let from = math::atan2(-nearest, beside);
        let integral = integrate(integrand, from, FRAC_PI_2, TOLERANCE);
        let factor = coefficients.sigma_s() * light.intensity / beside;
        Ok(Integral {
            value: integral.value * factor,
            error: integral.error * factor.max_element(),
        })
    }))
}
