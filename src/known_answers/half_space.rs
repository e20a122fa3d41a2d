//! A half-space that scatters isotropically, under a uniform sky.
//!
//! By reciprocity the radiance seen at the cosine μ is that of the sky times the plane albedo, the
//! share of a beam that comes back: `1 − H(μ) √(1 − ϖ)`, for the albedo ϖ of a single scattering.
//! Chandrasekhar's function H, which solves `H(μ) = 1 + (ϖ/2) μ H(μ) ∫ H(μ')/(μ + μ') dμ'`, is
//!
//! ```text
//! ln H(μ) = −(μ/π) ∫ ln(1 − ϖ φ cot φ) / (cos² φ + μ² sin² φ) dφ,   0 ≤ φ ≤ π/2.
//! ```
//!
//! A layer stands for it, if it is so thick that nothing comes back from its end: deep in it light
//! fades as e^(−kτ), `1 = ϖ atanh(k)/k`, there and back.
//!
//! Source: Chandrasekhar 1960, *Radiative Transfer*, §§37–39, 87; the integral is that of Stibbs &
//! Weir 1959, MNRAS 119, 512–525. Isotropic tables: van de Hulst 1980, *Multiple Light Scattering*,
//! ch. 8.

use super::formula::{AlongRay, Formula, exact};
use super::plane_layer::PlaneLayer;
use super::requirements::{dark, require};
use crate::math;
use crate::math::quadrature::{Integral, integrate};
use crate::scene::Radiative;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// A half-space under the sky.
pub const HALF_SPACE: Formula = Formula {
    name: "half-space",
    what: "A layer too thick for its end to matter, isotropic, any order, under a uniform sky: \
           Chandrasekhar's function H (1960, §87; Stibbs & Weir 1959).",
    of,
};

/// Relative error of the integral in [`h_function`].
const TOLERANCE: f64 = 1e-11;

/// The missing light behind the end of a layer fades there and back: e^(−2kτ) below this.
const FADED: f64 = 1e-10;

/// Chandrasekhar's H of isotropic scattering with the albedo of each channel, in [0, 1], at the cosine
/// `mu`, in [0, 1]; with a bound on its error.
pub(crate) fn h_function(albedo: DVec3, mu: f64) -> Integral {
    let integrand = |phi: f64| {
        // φ cot φ, which is 1 − φ²/3 near 0: the difference from 1 has to keep its digits.
        let (sine, cosine) = (math::sin(phi), math::cos(phi));
        let below_one = if phi < 1e-3 {
            let squared = phi * phi;
            squared * (1.0 / 3.0 + squared * (1.0 / 45.0 + squared * 2.0 / 945.0))
        } else {
            1.0 - phi * cosine / sine
        };
        let weight = 1.0 / (cosine * cosine + mu * mu * sine * sine);
        let term = |albedo: f64| -weight * math::ln((1.0 - albedo) + albedo * below_one);
        albedo.map(term)
    };
    // Without a tolerance relative to 0: there is nothing to be integrated.
    if albedo == DVec3::ZERO {
        return exact(DVec3::ONE);
    }
    let logarithm = integrate(integrand, 0.0, FRAC_PI_2, TOLERANCE);
    let scaled = logarithm.value * (mu / PI);
    let value = scaled.map(math::exp);
    Integral {
        value,
        error: value.max_element() * logarithm.error * (mu / PI),
    }
}

/// k of light that fades as e^(−kτ) deep in a medium of this albedo: 1 = ϖ atanh(k)/k.
fn diffusion_exponent(albedo: f64) -> f64 {
    if albedo >= 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    // To the last bit.
    for _ in 0..60 {
        let k = 0.5 * (low + high);
        let atanh = 0.5 * (math::ln_1p(k) - math::ln_1p(-k));
        if albedo * atanh < k {
            low = k;
        } else {
            high = k;
        }
    }
    low
}

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    let layer = PlaneLayer::of(scene)?;
    dark(&scene.media[0].medium)?;
    require(layer.back.is_none(), "it has a surface or a lamp")?;
    let albedo = layer.coefficients.albedo();
    let depth = layer.coefficients.sigma_t() * layer.thickness();
    for c in 0..3 {
        let left = math::exp(-2.0 * diffusion_exponent(albedo[c]) * depth[c]);
        require(
            left < FADED,
            "the layer is too thin to stand for a half-space",
        )?;
    }
    let absorbed = albedo.map(|albedo| (1.0 - albedo).sqrt());
    let sky = scene.environment;
    Ok(layer.along(0.0, move |mu| {
        let h = h_function(albedo, mu);
        let error = h.error * absorbed.max_element() + FADED;
        Integral {
            value: sky * (DVec3::ONE - h.value * absorbed),
            error: error * sky.max_element(),
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// H by another solution of its equation, twelve digits: `semi_infinite.json`.
    #[test]
    fn h_has_its_tabulated_values() {
        let text = include_str!("../../fixtures/known-answers/semi_infinite.json");
        let known: serde_json::Value = serde_json::from_str(text).unwrap();
        let mut compared = 0;
        for entry in known["entries"].as_array().unwrap() {
            let inputs = &entry["inputs"];
            let (Some(albedo), Some(mus)) = (inputs["albedo"].as_f64(), inputs["mu"].as_array())
            else {
                continue;
            };
            let values = entry["expected"]["H"].as_array().unwrap();
            for (mu, value) in mus.iter().zip(values) {
                let (mu, right) = (mu.as_f64().unwrap(), value.as_f64().unwrap());
                let found = h_function(DVec3::splat(albedo), mu).value.x;
                assert!(
                    (found / right - 1.0).abs() < 1e-9,
                    "{albedo} {mu}: {found} {right}"
                );
                compared += 1;
            }
        }
        assert!(compared >= 20, "{compared}");
    }
}
