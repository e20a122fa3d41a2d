//! What a slab reflects and lets through of the light that falls on it.
//!
//! By reciprocity the share that a slab reflects of a beam is the radiance seen along that beam
//! where a white sky shines on the same face; the share it lets through, the radiance where the
//! sky shines on the other. The half of the sky that is to be dark is hidden by a black plane.
//! Diffuse light is a beam of random direction, its cosine as likely as it is large.

use crate::common::entries::Entry;
use crate::common::quadrature::integral;
use crate::transport::all;
use crate::transport::scenes::*;
use crate::transport::statistics::*;
use glam::DVec3;
use volref::geometry::{Luminous, Ray, Shape};
use volref::math::Moments;
use volref::math::rng::{Purpose, Stream};
use volref::math::sampling::cosine_hemisphere;
use volref::optics::Sides;
use volref::scene::{AreaLight, Radiative};

/// A share near ½ gets a standard error of 0.0035, one of 0.1 of 0.002. With albedo 0.9, depth 2
/// and g = 0.75 the slab reflects 0.0974; with the opposite g it would be 0.50, with g = 0 0.36,
/// with the albedo applied twice 0.0645: 14 standard errors away.
const SAMPLES: u32 = samples(80_000);

/// Paths of which all that is known of a path is asked.
const ASKED: u32 = 1000;

/// Where a slab is so thin that one path in a thousand is turned.
const SAMPLES_IF_THIN: u32 = samples(1_000_000);

/// The scene under a sky of radiance 1 that shines on one face of the slab.
pub fn under_sky(scene: &Radiative, lit: Face) -> Radiative {
    let plane = match lit {
        Face::Upper => plane(-1.0, 2.0 * REACH),
        Face::Lower => plane(2.0, 2.0 * REACH),
    };
    Radiative {
        objects: vec![object(Shape::Rectangle(plane), black())],
        environment: DVec3::ONE,
        ..scene.clone()
    }
}

/// A direction of diffuse light that falls on the upper face.
pub fn diffuse(random: &Stream) -> Ray {
    let from = cosine_hemisphere(random.pair(0, Purpose::Camera, 0));
    ray(DVec3::Z, -*from)
}

/// Shares of light.
struct Totals {
    reflected: Moments,
    transmitted: Moments,
    absorbed: Moments,
}

fn totals(slab: &Radiative, (seed, samples): (u64, u32), beam: impl Fn(&Stream) -> Ray) -> Totals {
    let skies = [Face::Upper, Face::Lower].map(|face| under_sky(slab, face));
    let [mut above, mut below] = [0, 1].map(|sky| Paths::new(&skies[sky], None, seed));
    let open = Radiative {
        environment: DVec3::ONE,
        ..slab.clone()
    };
    let mut open = Paths::new(&open, None, seed);
    let conservative = slab.media[0].medium.coefficients.sigma_a() == DVec3::ZERO;
    let mut totals = Totals {
        reflected: Moments::default(),
        transmitted: Moments::default(),
        absorbed: Moments::default(),
    };
    for sample in 0..samples {
        let reflected = above.radiance(sample, &beam).x;
        // The three are the same path, which leaves by one face only; a plane outside takes
        // nothing but what has left. Of an absorbing slab some samples will do, and what is known
        // to have left by one face need not be followed to the other.
        let transmitted = if sample < ASKED || reflected == 0.0 {
            below.radiance(sample, &beam).x
        } else {
            0.0
        };
        totals.reflected.add(reflected);
        totals.transmitted.add(transmitted);
        totals.absorbed.add(1.0 - (reflected + transmitted));
        if conservative {
            assert_eq!(reflected + transmitted, 1.0, "sample {sample}");
        } else if sample < ASKED {
            assert!(reflected == 0.0 || transmitted == 0.0);
            assert_eq!(reflected + transmitted, open.radiance(sample, &beam).x);
        }
    }
    totals
}

fn entries(kind: &str) -> Vec<Entry> {
    let text = include_str!("../../../fixtures/known-answers/slab_total.json");
    let mut entries = all(text, 41);
    entries.retain(|entry| entry.text("illumination") == kind);
    entries
}

#[test]
fn every_entry_has_a_test() {
    let kinds = ["collimated", "diffuse", "collimated, by scattering order"];
    let counts = kinds.map(|kind| entries(kind).len());
    assert_eq!(counts, [32, 6, 3]);
}

fn all_agree(entry: &Entry, beam: impl Fn(&Stream) -> Ray) {
    let thin = entry.input("tau") < 0.01;
    let samples = if thin { SAMPLES_IF_THIN } else { SAMPLES };
    let found = totals(&slab_of(entry), (entry.seed(3), samples), beam);
    for (name, found) in [
        ("R", &found.reflected),
        ("T_total", &found.transmitted),
        ("A", &found.absorbed),
    ] {
        share_agrees(
            format_args!("{} {name}", entry.id()),
            found,
            entry.expected(name),
        );
    }
}

/// What passes along one beam without being turned.
fn direct(entry: &Entry, mu0: f64) -> f64 {
    let sky = under_sky(&slab_of(entry), Face::Lower);
    straight(&sky, &incoming(mu0)).x
}

fn incoming(mu0: f64) -> Ray {
    // Where light leaves, seen from outside, is where it comes in.
    leaving(Face::Upper, mu0)
}

#[test]
fn collimated() {
    for entry in entries("collimated") {
        let mu0 = entry.input("mu0");
        entry.is("T_direct", direct(&entry, mu0));
        if entry.input("albedo") == 0.0 {
            // Nothing is sampled: to all digits.
            let found = totals(&slab_of(&entry), (3, 2), |_| incoming(mu0));
            entry.is("R", found.reflected.mean());
            entry.is("T_total", found.transmitted.mean());
            entry.is("A", found.absorbed.mean());
            continue;
        }
        all_agree(&entry, |_| incoming(mu0));
    }
}

#[test]
fn diffuse_light() {
    for entry in entries("diffuse") {
        // Flux is the mean of the transmittance with the cosine as the weight. Smooth: what lies
        // near the horizon does not get through.
        let flux = integral(0.0, 1.0, 256, |mu| 2.0 * mu * direct(&entry, mu));
        entry.is("T_direct", flux);
        all_agree(&entry, diffuse);
    }
}

/// Each order on its own, and with all before it.
#[test]
fn by_scattering_order() {
    for entry in entries("collimated, by scattering order") {
        let beam = incoming(entry.input("mu0"));
        for (name, lit) in [("R_order", Face::Upper), ("T_order", Face::Lower)] {
            let expected = entry.answers(name);
            let sky = under_sky(&slab_of(&entry), lit);
            let found = by_order(
                &sky,
                expected.len() as u32,
                (entry.seed(4), SAMPLES),
                |_| beam,
            );
            // Light that is not turned reaches the sky on the other side only.
            let unturned = direct(&entry, entry.input("mu0"));
            let unturned = if lit == Face::Lower { unturned } else { 0.0 };
            share_agrees(format_args!("{} {name} 0", entry.id()), &found[0], unturned);
            for (index, expected) in expected.into_iter().enumerate() {
                let order = index + 1;
                let what = format!("{} {name} {order}", entry.id());
                share_agrees(what, &found[order], expected);
            }
        }
    }
}

/// The same sky as a surface that emits: connected to as well as met.
#[test]
fn under_an_emitting_plane() {
    for entry in entries("collimated") {
        if !["slab_total-p001", "slab_total-p027", "slab_total-p028"].contains(&entry.id()) {
            continue;
        }
        for (name, height) in [("R", 2.0), ("T_total", -1.0)] {
            let sky = AreaLight {
                shape: Luminous::Rectangle(plane(height, 2.0 * REACH)),
                radiance: DVec3::ONE,
                sides: Sides::Both,
            };
            let scene = Radiative {
                area_lights: vec![sky],
                ..slab_of(&entry)
            };
            let beam = incoming(entry.input("mu0"));
            let [found, ..] = sampled(&scene, None, (entry.seed(5), SAMPLES), |_| beam);
            let what = format!("{} {name} from a plane", entry.id());
            agrees(what, &found, entry.expected(name), 0.0);
        }
    }
}

/// The comparison can fail: what each likely mistake would make of p001 is more than ten standard
/// errors away from it.
#[test]
fn mistakes_are_seen() {
    let entry = &entries("collimated")[0];
    let (albedo, tau, g) = (0.9, 2.0, 0.75);
    assert_eq!(
        [entry.input("albedo"), entry.input("tau"), entry.input("g")],
        [albedo, tau, g]
    );
    for (mistake, slab) in [
        ("the albedo twice", slab(tau, albedo * albedo, g)),
        ("no albedo", slab(tau, 1.0, g)),
        ("g the other way", slab(tau, albedo, -g)),
        ("no g", slab(tau, albedo, 0.0)),
        ("a tenth more matter", slab(1.1 * tau, albedo, g)),
    ] {
        let found = totals(&slab, (entry.seed(3), SAMPLES), |_| incoming(1.0));
        let off = |name: &str, found: &Moments| {
            let variance = found.variance_of_mean().unwrap();
            (found.mean() - entry.expected(name)).abs() / variance.sqrt()
        };
        let worst = off("R", &found.reflected).max(off("T_total", &found.transmitted));
        println!("{mistake}: {worst:.1} standard errors");
        assert!(worst > 10.0, "{mistake}: {worst}");
    }
}
