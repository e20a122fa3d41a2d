//! What leaves a slab in one direction, of a beam that falls on it.

use crate::common::entries::{Entry, numbers};
use crate::transport::all;
use crate::transport::scenes::*;
use crate::transport::slab_totals::under_sky;
use crate::transport::statistics::*;
use glam::DVec3;
use volref::scene::Radiative;

/// Standard errors of 1 % or less but behind thick slabs, where few paths find the light: there
/// up to 4 %. To turn g around changes every anisotropic entry by a factor.
const SAMPLES: u32 = samples(20_000);

/// Where a slab is so thin that few paths are turned.
const SAMPLES_IF_THIN: u32 = samples(200_000);

/// Darker than this nothing is sampled well: a path that gets there is as improbable as that.
const DARK: f64 = 1e-12;

/// The slab under beams with the azimuths of the entry, up to three, one for each channel.
fn question(entry: &Entry) -> Radiative {
    let azimuths = entry.inputs("phi_deg");
    assert!(azimuths.len() <= 3);
    let lights = azimuths.iter().zip(DVec3::AXES).map(|(&phi, channel)| {
        let irradiance = channel * entry.input("E0");
        shining(entry.input("mu0"), phi, irradiance)
    });
    Radiative {
        lights: lights.collect(),
        ..slab_of(entry)
    }
}

/// Calls `ask` for each cosine of the entry and each face, with the answers by azimuth.
fn for_each_direction(entry: &Entry, suffix: &str, ask: impl Fn(Face, f64, Vec<f64>)) {
    for (name, face) in [("L_up", Face::Upper), ("L_down", Face::Lower)] {
        let answers = &entry.0["expected"][format!("{name}{suffix}")];
        let Some(answers) = answers.as_array() else {
            continue;
        };
        let cosines = entry.inputs("mu");
        assert_eq!(answers.len(), cosines.len());
        for (mu, answers) in cosines.into_iter().zip(answers) {
            ask(face, mu, numbers(answers));
        }
    }
}

fn entries() -> Vec<Entry> {
    let text = include_str!("../../../fixtures/known-answers/slab_radiance.json");
    all(text, 11)
}

#[test]
fn first_order() {
    for entry in entries() {
        let scene = question(&entry);
        for_each_direction(&entry, "_first_order", |face, mu, expected| {
            let found = by_quadrature(&scene, &leaving(face, mu)).to_array();
            for (expected, found) in expected.into_iter().zip(found) {
                entry.compare("first order", found, expected, 0.0);
            }
        });
    }
}

#[test]
fn all_orders() {
    for entry in entries() {
        let scene = question(&entry);
        let thin = entry.input("tau") < 0.2;
        let samples = if thin { SAMPLES_IF_THIN } else { SAMPLES };
        for_each_direction(&entry, "", |face, mu, expected| {
            let ray = leaving(face, mu);
            let found = sampled(&scene, None, (entry.seed(21), samples), |_| ray);
            for (channel, (expected, found)) in expected.into_iter().zip(&found).enumerate() {
                let what = format!("{} {face:?} {mu} {channel}", entry.id());
                if expected < DARK {
                    assert!(found.mean() <= DARK, "{what}: {:e}", found.mean());
                } else {
                    agrees(what, found, expected, 0.0);
                }
            }
        });
    }
}

/// The flux that leaves is the incident one times the share of [`crate::transport::slab_totals`].
#[test]
fn fluxes() {
    let with_flux = entries()
        .into_iter()
        .filter(|entry| entry.answer("flux_up").is_some());
    let mut asked = 0;
    for entry in with_flux {
        let incident = entry.input("mu0") * entry.input("E0");
        let beam = leaving(Face::Upper, entry.input("mu0"));
        for (name, lit) in [("flux_up", Face::Upper), ("flux_down_diffuse", Face::Lower)] {
            let sky = under_sky(&slab_of(&entry), lit);
            // Without what is not turned: it is on the other side of the slab only.
            let direct = straight(&sky, &beam).x;
            let [found, ..] = sampled(&sky, None, (entry.seed(22), SAMPLES), |_| beam);
            let share = entry.expected(name) / incident + direct;
            share_agrees(format_args!("{} {name}", entry.id()), &found, share);
            asked += 1;
        }
    }
    assert_eq!(asked, 6);
}
