//! Media that overlap add up, and channels do not know of each other.

use crate::transport::U;
use crate::transport::scenes::*;
use crate::transport::statistics::*;
use glam::DVec3;
use volref::geometry::{Luminous, Sphere};
use volref::optics::{Asymmetry, Coefficients, Homogeneous, Phase, Sides};
use volref::scene::{AreaLight, Radiative};

/// Standard errors near 0.5 %.
const SAMPLES: u32 = 40_000;

#[track_caller]
fn close(a: DVec3, b: DVec3, roundings: f64) {
    assert!(
        (a - b).abs().max_element() <= roundings * U * b.max_element(),
        "{a} {b}"
    );
}

/// Half the matter twice.
#[test]
fn two_halves_in_one_place() {
    let half = within(cube(), grey(1.0, 0.8, 0.6));
    let whole = lit(vec![within(cube(), grey(2.0, 0.8, 0.6))]);
    let halves = lit(vec![half.clone(), half]);
    let ray = into_the_middle();
    assert_eq!(straight(&halves, &ray), straight(&whole, &ray));
    // Sums of halves are exact, but for the phase function: a sum over a sum.
    close(
        by_quadrature(&halves, &ray),
        by_quadrature(&whole, &ray),
        8.0,
    );
    let [a, ..] = sampled(&whole, None, (61, SAMPLES), |_| ray);
    let [b, ..] = sampled(&halves, None, (62, SAMPLES), |_| ray);
    same("two halves", &a, &b);
}

/// Where phase functions differ, each has the share of its scattering.
#[test]
fn phase_functions_in_proportion() {
    let (forward, backward) = (grey(1.5, 0.8, 0.7), grey(0.5, 0.6, -0.4));
    let mixed = Radiative {
        environment: DVec3::ZERO,
        ..lit(vec![within(cube(), forward), within(cube(), backward)])
    };
    // The same matter with one phase function.
    let with_g = |g| {
        let (a, b) = (forward.coefficients, backward.coefficients);
        let medium = Homogeneous {
            coefficients: Coefficients::new(a.sigma_a() + b.sigma_a(), a.sigma_s() + b.sigma_s())
                .unwrap(),
            emission: DVec3::ZERO,
            phase: Phase::henyey_greenstein(Asymmetry::new(g).unwrap()),
        };
        Radiative {
            media: vec![within(cube(), medium)],
            ..mixed.clone()
        }
    };
    let ray = into_the_middle();
    let share = 1.2 / (1.2 + 0.3);
    let [one, other] = [0.7, -0.4].map(|g| by_quadrature(&with_g(g), &ray));
    let exact = one * share + other * (1.0 - share);
    close(by_quadrature(&mixed, &ray), exact, 64.0);
    let [found, ..] = sampled(&mixed, Some(1), (65, SAMPLES), |_| ray);
    agrees("mixed phases, one turn", &found, exact.x, 0.0);
}

/// A sky that is met by turning, and the same sky as a surface that is connected to as well: the
/// density of a direction is that of the turn, also where phase functions mix and channels
/// differ.
#[test]
fn mixed_phases_under_two_kinds_of_sky() {
    let mut blue = grey(0.5, 0.6, -0.4);
    blue.coefficients =
        Coefficients::new(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.2, 0.8, 1.6)).unwrap();
    let sky = DVec3::new(1.0, 0.8, 0.6);
    let half = DVec3::new(0.0, 9.0, 0.0);
    let media = vec![within(cube(), grey(1.5, 0.8, 0.7)), within(cube(), blue)];
    // Half a sky: everything is the same from all sides of a whole one.
    let floor = volref::geometry::Rectangle::new(
        DVec3::new(-1e5, -2.0, -1e5),
        DVec3::X * 2e5,
        DVec3::Z * 2e5,
    )
    .unwrap();
    let floor = object(volref::geometry::Shape::Rectangle(floor), black());
    let met = Radiative {
        objects: vec![floor.clone()],
        media: media.clone(),
        environment: sky,
        ..empty()
    };
    let connected = Radiative {
        objects: vec![floor],
        area_lights: vec![AreaLight {
            shape: Luminous::Sphere(Sphere::new(DVec3::ZERO, 1e4).unwrap()),
            radiance: sky,
            sides: Sides::Both,
        }],
        media,
        ..empty()
    };
    let ray = ray(half, DVec3::new(0.02, -1.0, 0.03));
    let a = sampled(&met, None, (66, SAMPLES), |_| ray);
    let b = sampled(&connected, None, (67, SAMPLES), |_| ray);
    for channel in 0..3 {
        same(
            format_args!("sky, channel {channel}"),
            &a[channel],
            &b[channel],
        );
    }
}

/// Each channel of a coloured medium is a grey medium.
#[test]
fn channels_on_their_own() {
    let (sigma_t, albedo) = ([0.4, 1.0, 4.0], [0.5, 1.0, 0.9]);
    let channels = [0, 1, 2].map(|c| grey(sigma_t[c], albedo[c], 0.5));
    let of = |coefficient: fn(&Coefficients) -> DVec3| {
        DVec3::from_array(channels.map(|medium| coefficient(&medium.coefficients).x))
    };
    let coefficients =
        Coefficients::new(of(Coefficients::sigma_a), of(Coefficients::sigma_s)).unwrap();
    let coloured = Homogeneous {
        coefficients,
        ..channels[0]
    };
    let coloured = lit(vec![within(unit_ball(), coloured)]);
    let ray = into_the_middle();
    let exact = by_quadrature(&coloured, &ray);
    let found = sampled(&coloured, None, (70, 2 * SAMPLES), |_| ray);
    for (channel, medium) in channels.into_iter().enumerate() {
        let alone = lit(vec![within(unit_ball(), medium)]);
        let exact_alone = by_quadrature(&alone, &ray)[channel];
        // One cut of the interval of integration for all channels, another for one alone.
        assert!((exact[channel] - exact_alone).abs() <= 1e-13 * exact_alone);
        let found_alone = sampled(&alone, None, (71, SAMPLES), |_| ray);
        same(
            format_args!("channel {channel}"),
            &found[channel],
            &found_alone[channel],
        );
    }
}
