//! A ball or box of fog, lit from one point or one direction, light scattered once.
//!
//! Light that reaches the eye was scattered at some distance t along the ray within the body. There it
//! arrives with the irradiance E(t) of the light, attenuated by the length l(t) inside the body on its
//! way, and is attenuated again on the way to the eye:
//!
//! ```text
//! L = σ_s ∫ p(cos θ) E(t) e^(−σ_t (l(t) + t − t_near)) dt,   t_near ≤ t ≤ t_far.
//! ```
//!
//! The lengths are chords of the body, closed forms each. Kinks, where the way to the light leaves
//! through another face of a box, are found by halving.
//!
//! Source: Chandrasekhar 1960, *Radiative Transfer*, §§6–7; Pegoraro, Schott & Parker 2010, Computer
//! Graphics Forum 29(4), 1319–1327; chords of a ball, van de Hulst 1980, *Multiple Light Scattering*,
//! ch. 18.

use super::bodies::Convex;
use super::formula::{AlongRay, Formula, exact, transmittance};
use super::phase_function::phase_function;
use super::requirements::{
    dark, henyey_greenstein, only_homogeneous, require, single_scattering, without_surfaces,
};
use crate::math::quadrature::{Integral, integrate};
use crate::optics::Light;
use crate::scene::Radiative;
use glam::DVec3;

/// Relative error of the integral.
const TOLERANCE: f64 = 1e-10;

/// A body of fog and a light.
pub const LIT_BODY: Formula = Formula {
    name: "lit-body",
    what: "A homogeneous ball or box that scatters light of a point or a direction once: an integral \
           along the ray over chords (Chandrasekhar 1960, §7).",
    of,
};

/// Light that arrives at a point: irradiance, direction of travel, and distance of its source.
fn arriving(light: &Light, point: DVec3) -> (DVec3, DVec3, f64) {
    if let Light::Directional(light) = light {
        return (light.irradiance, *light.direction, f64::INFINITY);
    }
    let way = point - light.position().unwrap_or(DVec3::ZERO);
    let distance = way.length();
    (
        light.strength() / (distance * distance),
        way / distance,
        distance,
    )
}

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    single_scattering(scene)?;
    without_surfaces(scene)?;
    let (body, medium) = only_homogeneous(scene)?;
    dark(medium)?;
    let shape = Convex::of(body)?;
    require(
        !matches!(shape, Convex::Everywhere),
        "the medium has no boundary",
    )?;
    let g = henyey_greenstein(&medium.phase)?;
    let [light @ (Light::Point(_) | Light::Directional(_))] = &scene.lights[..] else {
        return Err("it has not one light, a point or directional one".to_owned());
    };
    let sigma_s = medium.coefficients.sigma_s();
    let sigma_t = medium.coefficients.sigma_t();
    Ok(Box::new(move |ray| {
        let Some([near, far]) = shape.span(ray.origin, *ray.direction) else {
            return Ok(exact(DVec3::ZERO));
        };
        let scattered = |t: f64| {
            let point = ray.origin + *ray.direction * t;
            let (irradiance, direction, distance) = arriving(light, point);
            let inside = shape.length(point, -direction, distance);
            // Light travels on to the eye, against the ray.
            let cosine = direction.dot(-*ray.direction).clamp(-1.0, 1.0);
            let depth = sigma_t * (inside + (t - near));
            irradiance * transmittance(depth) * phase_function(g, cosine)
        };
        let integral = integrate(scattered, near, far, TOLERANCE);
        Ok(Integral {
            value: integral.value * sigma_s,
            error: integral.error * sigma_s.max_element(),
        })
    }))
}
