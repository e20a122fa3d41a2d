//! A layer of finite thickness that scatters isotropically: what it reflects, lets through, emits.
//!
//! Under a sky of radiance 1 on one side, the mean radiance at the optical depth t below it is
//! `½ E₂(t)` unscattered. The light scattered there, `S(t)` per optical depth and direction, solves the
//! integral equation of Schwarzschild and Milne, for the albedo ϖ and the thickness τ:
//!
//! ```text
//! S(t) = (ϖ/2) E₂(t) + (ϖ/2) ∫ E₁(|t − t'|) S(t') dt',   0 ≤ t' ≤ τ.
//! ```
//!
//! At the cosine μ the layer shows on the lit side and on the other
//!
//! ```text
//! R(μ) =            ∫ S(t) e^(−t/μ) dt/μ
//! T(μ) = e^(−τ/μ) + ∫ S(t) e^(−(τ−t)/μ) dt/μ.
//! ```
//!
//! By reciprocity these are the shares of a beam that come back and go through, for which there are
//! tables. By Kirchhoff's law a layer that emits j per unit of length is seen as `(1 − R − T) j/σ_a`:
//! with as much around, all would be one furnace.
//!
//! S is found at Gauss points of intervals that halve towards both faces, where it has terms `t ln t`;
//! between them it is the polynomial through the points of the interval. The equation is solved by
//! iteration, which adds order after order of scattering.
//!
//! Source: Chandrasekhar 1960, *Radiative Transfer*, §§10–11, 60, 84; van de Hulst 1980, *Multiple Light
//! Scattering*, §§2.3, 9.1–9.6, whose tables are reproduced.

use super::exponential_integral::{e1, e2};
use super::formula::{AlongRay, Formula};
use super::plane_layer::PlaneLayer;
use super::requirements::require;
use crate::math;
use crate::math::quadrature::{Integral, gauss_legendre};
use crate::scene::Radiative;
use glam::DVec3;

/// A layer, lit or luminous.
pub const SLAB: Formula = Formula {
    name: "slab",
    what: "A layer of finite thickness, isotropic, any order, before a sky, a black plane or a luminous \
           one: the integral equation of Schwarzschild and Milne (Chandrasekhar 1960, §11).",
    of,
};

/// Intervals between a face and the middle, each half as thick as the next.
const INTERVALS: usize = 12;
/// Gauss points of an interval.
const POINTS: usize = 8;
/// Points by which the kernel, a logarithm at t = t', is integrated times a polynomial.
const KERNEL_POINTS: usize = 24;
/// The power by which these crowd towards the logarithm: `u⁴ ln u` is what is left to integrate.
const POWER: u32 = 5;
/// Orders of scattering, at most; layers of the suite need 100.
const MOST_ORDERS: usize = 20_000;
/// The contribution of an order at which it is the last.
const LAST: f64 = 1e-15;
/// Cosine below which the exponentials in R and T are narrower than the intervals resolve.
const LEAST_COSINE: f64 = 0.02;
/// Bound on the error of R and T. They are within 1e-9 of what adding and doubling gives
/// (`slab_total.json`), and as near to themselves with half the intervals.
const ERROR: f64 = 2e-9;
/// The same of layers thicker than [`THICK`] mean free paths, whose intervals are longer: at 64 they
/// are within 4e-9.
const ERROR_OF_THICK: f64 = 1e-8;
const THICK: f64 = 16.0;

fn error(tau: f64) -> f64 {
    if tau > THICK { ERROR_OF_THICK } else { ERROR }
}

/// Reflection and transmission of a layer that scatters isotropically.
#[derive(Clone, Debug)]
pub(crate) struct Slab {
    tau: f64,
    /// Optical depths, and S there times the weight of the depth in an integral.
    sources: Vec<(f64, f64)>,
}

impl Slab {
    /// The slab of optical thickness `tau`, more than 0, and the `albedo`, in [0, 1], of a single
    /// scattering.
    ///
    /// # Errors
    ///
    /// If the layer is too thick for the sum over orders to end.
    pub fn new(albedo: f64, tau: f64) -> Result<Slab, String> {
        let intervals = intervals(tau);
        let rule = gauss_legendre(POINTS);
        let (mut depths, mut weights) = (Vec::new(), Vec::new());
        for [from, to] in &intervals {
            for (x, w) in &rule {
                depths.push(from + (to - from) * (0.5 + 0.5 * x));
                weights.push(0.5 * (to - from) * w);
            }
        }
        let rows: Vec<Vec<f64>> = depths
            .iter()
            .map(|&depth| kernel_row(depth, &intervals, &depths))
            .collect();
        let mut order: Vec<f64> = depths.iter().map(|&t| 0.5 * albedo * e2(t)).collect();
        let mut source = vec![0.0; depths.len()];
        for _ in 0..MOST_ORDERS {
            for (sum, term) in source.iter_mut().zip(&order) {
                *sum += term;
            }
            if order.iter().copied().fold(0.0, f64::max) < LAST {
                let weighted = source.iter().zip(&weights).map(|(s, w)| s * w);
                return Ok(Slab {
                    tau,
                    sources: depths.into_iter().zip(weighted).collect(),
                });
            }
            let next = |row: &Vec<f64>| {
                let products = row.iter().zip(&order).map(|(k, s)| k * s);
                0.5 * albedo * products.sum::<f64>()
            };
            order = rows.iter().map(next).collect();
        }
        Err(format!(
            "of an albedo of {albedo} and a thickness of {tau} too many orders of scattering count"
        ))
    }

    /// Shares of a beam with the cosine `mu`, from 0.02 to 1, that are reflected, and let through with
    /// the unscattered light.
    pub fn shares(&self, mu: f64) -> [f64; 2] {
        let (mut reflected, mut transmitted) = (0.0, math::exp(-self.tau / mu));
        for (depth, source) in &self.sources {
            reflected += source / mu * math::exp(-depth / mu);
            transmitted += source / mu * math::exp((depth - self.tau) / mu);
        }
        [reflected, transmitted]
    }
}

/// From one face to the other.
fn intervals(tau: f64) -> Vec<[f64; 2]> {
    let mut ends = vec![0.0];
    let of = |n: usize| 0.5 * tau * math::exp2(-(n as f64));
    ends.extend((0..INTERVALS).rev().map(of));
    ends.extend((1..INTERVALS).map(|n| tau - of(n)));
    ends.push(tau);
    ends.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Weights of S at `depths` in `∫ E₁(|at − t|) S(t) dt`.
fn kernel_row(at: f64, intervals: &[[f64; 2]], depths: &[f64]) -> Vec<f64> {
    let mut row = vec![0.0; depths.len()];
    let rule = gauss_legendre(KERNEL_POINTS);
    for (interval, (points, row)) in intervals
        .iter()
        .zip(depths.chunks(POINTS).zip(row.chunks_mut(POINTS)))
    {
        let [from, to] = *interval;
        let middle = at.clamp(from, to);
        // Away from the depth asked for, on both sides of it.
        for end in [from, to] {
            let length = end - middle;
            for (x, w) in &rule {
                let u = 0.5 + 0.5 * x;
                let t = middle + length * math::powu(u, POWER);
                let slope = f64::from(POWER) * math::powu(u, POWER - 1) * length.abs();
                let distance = (t - at).abs();
                if slope == 0.0 || distance == 0.0 {
                    continue;
                }
                let weight = 0.5 * w * slope * e1(distance);
                for (i, sum) in row.iter_mut().enumerate() {
                    *sum += weight * basis(points, i, t);
                }
            }
        }
    }
    row
}

/// The polynomial that is 1 at point `i` of an interval and 0 at the others.
fn basis(points: &[f64], i: usize, t: f64) -> f64 {
    let others = points.iter().enumerate().filter(|(j, _)| *j != i);
    others
        .map(|(_, other)| (t - other) / (points[i] - other))
        .product()
}

fn of(scene: &Radiative) -> Result<AlongRay<'_>, String> {
    let layer = PlaneLayer::of(scene)?;
    let albedo = layer.coefficients.albedo();
    let tau = layer.coefficients.sigma_t() * layer.thickness();
    let sigma_a = layer.coefficients.sigma_a();
    let mut functions = Vec::new();
    for c in 0..3 {
        require(tau[c] > 0.0, "the layer is empty in a channel")?;
        require(
            sigma_a[c] > 0.0 || layer.emission[c] == 0.0,
            "the layer emits in a channel that it does not absorb",
        )?;
        functions.push(Slab::new(albedo[c], tau[c])?);
    }
    let sky = scene.environment;
    let behind = layer.back.unwrap_or(sky);
    let emission = layer.emission;
    let error = error(tau.max_element());
    Ok(layer.along(LEAST_COSINE, move |mu| {
        let radiance = |c: usize| {
            let [reflected, transmitted] = functions[c].shares(mu);
            let emitted = if emission[c] > 0.0 {
                (1.0 - reflected - transmitted) * emission[c] / sigma_a[c]
            } else {
                0.0
            };
            reflected * sky[c] + transmitted * behind[c] + emitted
        };
        let value = DVec3::from_array([0, 1, 2].map(radiance));
        Integral {
            value,
            error: error * (sky + behind + emission).max_element(),
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No scattering: nothing comes back, and Lambert's law goes through.
    #[test]
    fn a_layer_without_scattering() {
        let layer = Slab::new(0.0, 1.5).unwrap();
        assert_eq!(layer.shares(0.5), [0.0, math::exp(-3.0)]);
    }

    /// Without absorption all light comes out, at every angle.
    #[test]
    fn a_layer_without_absorption() {
        for tau in [0.1, 1.0, 4.0] {
            let layer = Slab::new(1.0, tau).unwrap();
            for mu in [0.05, 0.3, 0.7, 1.0] {
                let [reflected, transmitted] = layer.shares(mu);
                let off = (reflected + transmitted - 1.0).abs();
                assert!(off < ERROR, "{tau} {mu}: {off:e}");
            }
        }
    }

    /// Adding and doubling, ten digits: `slab_total.json`.
    #[test]
    fn layers_by_adding_and_doubling() {
        let text = include_str!("../../fixtures/known-answers/slab_total.json");
        let known: serde_json::Value = serde_json::from_str(text).unwrap();
        let mut compared = 0;
        for entry in known["entries"].as_array().unwrap() {
            let (inputs, expected) = (&entry["inputs"], &entry["expected"]);
            let number = |key: &str| inputs[key].as_f64();
            let beam = inputs["illumination"] == "collimated";
            let (Some(albedo), Some(tau), Some(g), Some(mu), true) = (
                number("albedo"),
                number("tau"),
                number("g"),
                number("mu0"),
                beam,
            ) else {
                continue;
            };
            // Thick and without absorption, there are too many orders to be added one by one.
            if g != 0.0 || mu < LEAST_COSINE || (albedo == 1.0 && tau > 16.0) {
                continue;
            }
            let layer = Slab::new(albedo, tau).unwrap();
            let digits = entry["digits"].as_f64().unwrap();
            for (found, name) in layer.shares(mu).into_iter().zip(["R", "T_total"]) {
                let right = expected[name].as_f64().unwrap();
                let allowed = error(tau) + right * math::pow(10.0, -digits);
                let off = (found - right).abs();
                assert!(off <= allowed, "{} {name}: {found} {right}", entry["id"]);
                compared += 1;
            }
        }
        assert!(compared >= 20, "{compared}");
    }

    /// A layer of sixty is a half-space.
    #[test]
    fn a_thick_layer_is_a_half_space() {
        use crate::known_answers::half_space::h_function;
        let layer = Slab::new(0.9, 60.0).unwrap();
        for mu in [0.3, 0.6, 1.0] {
            let h = h_function(DVec3::splat(0.9), mu).value.x;
            let off = layer.shares(mu)[0] - (1.0 - h * 0.1_f64.sqrt());
            assert!(off.abs() < 1e-7, "{mu}: {off:e}");
        }
    }
}
