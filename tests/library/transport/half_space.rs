//! Chandrasekhar's half-space of isotropic scattering: `semi_infinite`, and hard case S5.
//!
//! A slab stands for it. Where matter absorbs, it is 400 deep: light fades as e^(−kτ) with
//! k ≥ 0.0547 (ω = 0.999), so less than e^(−21) = 1e-9 comes back from what is missing, or through
//! from the sky below. Where nothing absorbs, what is missing is felt at any depth, but by a law
//! that is exact up to e^(−τ): with the extrapolation length q of the entry,
//!
//! ```text
//! transmitted from cosine μ    T = H(μ) / (√3 (τ + 2q))
//! reflected radiance           L = L∞ (1 − (μ + μ0)/(τ + 2q))
//! ```
//!
//! Source: van de Hulst 1980, Multiple Light Scattering, ch. 5; `slab_total` p007 is an instance.

use crate::common::entries::{Entry, numbers};
use crate::transport::all;
use crate::transport::scenes::*;
use crate::transport::slab_totals::{diffuse, under_sky};
use crate::transport::statistics::*;
use glam::DVec3;
use volref::geometry::Ray;
use volref::math::Moments;
use volref::math::rng::{Purpose, Stream};
use volref::scene::Radiative;

/// Errors of an albedo below 0.004: with ω applied twice it would be that of ω², 0.081 instead of
/// 0.115 at ω = 0.5 and normal incidence, and more than 0.1 away for the others up to 0.99.
const SAMPLES: u32 = samples(20_000);

/// Depth of the slab that absorbs.
const DEEP: f64 = 400.0;
/// Depth of the slab that does not: e^(−16) = 1e-7.
const SHALLOW: f64 = 16.0;

fn entries() -> Vec<Entry> {
    let text = include_str!("../../../fixtures/known-answers/semi_infinite.json");
    all(text, 8)
}

/// Measured along a beam: the share of light that is not reflected.
///
/// It is √(1−ω) H(μ) of a half-space, and H(μ)/(√3 (τ + 2q)) of the conservative slab. Returned
/// with that factor of H.
fn not_reflected(entry: &Entry, purpose: u64, beam: impl Fn(&Stream) -> Ray) -> (Moments, f64) {
    let (seed, albedo) = (entry.seed(purpose), entry.input("albedo"));
    if albedo < 1.0 {
        let scene = Radiative {
            environment: DVec3::ONE,
            ..slab(DEEP, albedo, 0.0)
        };
        let mut paths = Paths::new(&scene, None, seed);
        let sample = |sample| 1.0 - paths.radiance(sample, &beam).x;
        ((0..SAMPLES).map(sample).collect(), (1.0 - albedo).sqrt())
    } else {
        let q = entry.expected("hopf_extrapolation_length");
        let scene = under_sky(&slab(SHALLOW, 1.0, 0.0), Face::Lower);
        let [found, ..] = sampled(&scene, None, (seed, SAMPLES), beam);
        (found, 1.0 / (3.0_f64.sqrt() * (SHALLOW + 2.0 * q)))
    }
}

#[test]
fn plane_albedo_and_h() {
    for entry in entries() {
        let values = entry.answers("H");
        let albedos = entry.answers("plane_albedo");
        assert_eq!(albedos, entry.answers("L_uniform_sky"));
        for ((mu, h), plane_albedo) in entry.inputs("mu").into_iter().zip(values).zip(albedos) {
            let (found, factor) = not_reflected(&entry, 31, |_| leaving(Face::Upper, mu));
            let what = format!("{} H({mu})", entry.id());
            share_agrees(what, &found, factor * h);
            if entry.input("albedo") < 1.0 {
                let what = format!("{} plane albedo {mu}", entry.id());
                share_agrees(what, &found, 1.0 - plane_albedo);
            } else {
                // All of it comes back: as it does, path by path, from every conservative slab.
                assert_eq!(plane_albedo, 1.0);
            }
        }
    }
}

/// The moments of H are what beams of all cosines, and diffuse light, do.
#[test]
fn spherical_albedo_and_moments_of_h() {
    let uniform =
        |random: &Stream| leaving(Face::Upper, 1.0 - random.uniform(0, Purpose::Camera, 0));
    for entry in entries() {
        let (found, factor) = not_reflected(&entry, 32, uniform);
        let alpha0 = entry.expected("alpha0");
        share_agrees(
            format_args!("{} alpha0", entry.id()),
            &found,
            factor * alpha0,
        );
        // The weight of diffuse light is 2μ.
        let (found, factor) = not_reflected(&entry, 33, diffuse);
        let alpha1 = entry.expected("alpha1");
        share_agrees(
            format_args!("{} alpha1", entry.id()),
            &found,
            factor * 2.0 * alpha1,
        );
        let spherical = entry.expected("spherical_albedo");
        if entry.input("albedo") < 1.0 {
            let what = format!("{} spherical albedo", entry.id());
            share_agrees(what, &found, 1.0 - spherical);
        } else {
            assert_eq!(spherical, 1.0);
        }
    }
}

#[test]
fn reflected_radiance() {
    for entry in entries() {
        let pairs = entry.0["inputs"]["mu0_mu_pairs"].as_array().unwrap();
        for (pair, whole) in pairs.iter().map(numbers).zip(entry.answers("L")) {
            let (mu0, mu) = (pair[0], pair[1]);
            let albedo = entry.input("albedo");
            let (tau, missing) = match entry.answer("hopf_extrapolation_length") {
                Some(q) => (SHALLOW, (mu + mu0) / (SHALLOW + 2.0 * q)),
                None => (DEEP, 0.0),
            };
            let scene = Radiative {
                lights: vec![shining(mu0, 0.0, DVec3::splat(entry.input("E0")))],
                ..slab(tau, albedo, 0.0)
            };
            let ray = leaving(Face::Upper, mu);
            let [found, ..] = sampled(&scene, None, (entry.seed(34), SAMPLES), |_| ray);
            let what = format!("{} L({mu0}, {mu})", entry.id());
            agrees(what, &found, whole * (1.0 - missing), 0.0);
        }
    }
}
