//! Light turned once.

use crate::common::entries::Entry;
use crate::transport::all;
use crate::transport::scenes::*;
use crate::transport::statistics::*;
use glam::DVec3;
use std::f64::consts::PI;
use volref::geometry::{Direction, Ray, Rectangle, Shape};
use volref::math::{Frame, exp};
use volref::optics::{Asymmetry, Directional, Light, Point};
use volref::scene::{Body, Radiative};

/// Samples where quadrature has already found every digit: enough to see an albedo or a phase
/// function that the tracer applies twice or not at all, factors of 1.1 and more.
const SAMPLES: u32 = 20_000;

/// So thin that light is turned in one of 200,000 flights: nothing to be sampled.
const TOO_THIN: &str = "single_scatter-p014";

/// The scene and the ray of an entry.
fn question(entry: &Entry) -> (Radiative, Ray) {
    match entry.case() {
        "airlight" => airlight(entry),
        "slab, directional light" => slab_seen(entry),
        "exponential atmosphere, looking up" => atmosphere(entry),
        "sphere, directional light" => {
            let sphere = ball(DVec3::ZERO, entry.input("radius"));
            let scene = Radiative {
                media: vec![within(sphere, grey_of(entry))],
                lights: vec![sun_of(entry)],
                ..empty()
            };
            (scene, ray_of(entry))
        }
        "cube [-1,1]^3, directional light" => {
            let scene = Radiative {
                media: vec![within(cube(), grey_of(entry))],
                lights: vec![sun_of(entry)],
                ..empty()
            };
            (scene, ray_of(entry))
        }
        "cube [-1,1]^3, point light outside" => {
            let scene = Radiative {
                media: vec![within(cube(), grey_of(entry))],
                lights: vec![lamp_of(entry)],
                ..empty()
            };
            (scene, ray_of(entry))
        }
        unknown => panic!("{unknown}"),
    }
}

/// A point light in endless fog. Where the line of sight has an end, a black plate is held there,
/// too small to shade the light.
fn airlight(entry: &Entry) -> (Radiative, Ray) {
    let ray = ray(DVec3::ZERO, entry.vector("direction"));
    let plate = entry.given("t_max").map(|end| {
        let Frame { x, y, .. } = Frame::around(ray.direction);
        let plate = Rectangle::new(ray.at(end) - (*x + *y) * 1e-3, x * 2e-3, y * 2e-3).unwrap();
        object(Shape::Rectangle(plate), black())
    });
    let scene = Radiative {
        objects: plate.into_iter().collect(),
        media: vec![everywhere(grey_of(entry))],
        lights: vec![lamp_of(entry)],
        ..empty()
    };
    (scene, ray)
}

fn slab_seen(entry: &Entry) -> (Radiative, Ray) {
    let face = match entry.text("side") {
        "up" => Face::Upper,
        "down" => Face::Lower,
        unknown => panic!("{unknown}"),
    };
    lit_slab(slab_of(entry), face, entry)
}

/// What is turned once depends on optical depths alone where all is level: the atmosphere is the
/// slab that is as deep.
fn atmosphere(entry: &Entry) -> (Radiative, Ray) {
    let depth = entry.input("sigma0") * entry.input("scale_height");
    let scene = slab(depth, entry.input("albedo"), entry.input("g"));
    lit_slab(scene, Face::Lower, entry)
}

fn lit_slab(scene: Radiative, face: Face, entry: &Entry) -> (Radiative, Ray) {
    let irradiance = DVec3::splat(entry.input("E0"));
    let light = shining(entry.input("mu0"), entry.input("phi_deg"), irradiance);
    let scene = Radiative {
        lights: vec![light],
        ..scene
    };
    (scene, leaving(face, entry.input("mu")))
}

fn sun_of(entry: &Entry) -> volref::optics::Light {
    let travel = entry.vector("light_travel_direction");
    sun(travel, DVec3::splat(entry.input("E0")))
}

fn lamp_of(entry: &Entry) -> volref::optics::Light {
    lamp(
        entry.vector("light_position"),
        entry.input("light_intensity"),
    )
}

fn mirrored(scene: &Radiative) -> Radiative {
    let mut scene = scene.clone();
    for body in &mut scene.media {
        let negated = |g: Asymmetry| Asymmetry::new(-g.g()).unwrap();
        body.medium.phase = body.medium.phase.with_asymmetry(negated);
    }
    scene
}

fn entries() -> Vec<Entry> {
    let text = include_str!("../../../fixtures/known-answers/single_scatter.json");
    all(text, 25)
}

#[test]
fn by_integrals_along_the_line_of_sight() {
    for entry in entries() {
        let (scene, ray) = question(&entry);
        let found = by_quadrature(&scene, &ray);
        assert_eq!(found, DVec3::splat(found.x));
        entry.is("L", found.x);
        if let Some(wrong) = entry.answer("L_if_cosine_sign_is_wrong") {
            let found = by_quadrature(&mirrored(&scene), &ray);
            entry.compare("L_if_cosine_sign_is_wrong", found.x, wrong, 0.0);
        }
        if entry.answer("transmittance").is_some() {
            let white = Radiative {
                environment: DVec3::ONE,
                ..scene
            };
            let through = straight(&white, &ray);
            entry.is("transmittance", through.x);
        }
    }
}

#[test]
fn by_tracing_paths() {
    for entry in entries() {
        if entry.id() == TOO_THIN {
            continue;
        }
        let (scene, ray) = question(&entry);
        let [found, ..] = sampled(&scene, Some(1), (entry.seed(11), SAMPLES), |_| ray);
        agrees(entry.id(), &found, entry.expected("L"), 0.0);
    }
}

/// However dense a slab is, what is lit of it is found: `E·ω/(4π(1 + 1))` straight back from an
/// endless depth, lit from the eye's side.
#[test]
fn dense_media_by_quadrature() {
    for sigma in [1.0e2, 1.0e5, 1.0e6, 1.0e9] {
        let scene = Radiative {
            media: vec![within(cube(), grey(sigma, 0.8, 0.0))],
            lights: vec![sun(DVec3::NEG_Z, DVec3::ONE)],
            ..empty()
        };
        let seen = by_quadrature(&scene, &ray(DVec3::new(0.2, 0.1, 5.0), DVec3::NEG_Z)).x;
        let expected = 0.8 / (8.0 * PI);
        // Distances within the cube are rounded where it is entered, at 5 · 2^-53 of 4 units:
        // by as much times sigma in depth.
        let rounding = 1e-13 + 8.0 * f64::EPSILON * sigma;
        assert!(
            (seen / expected - 1.0).abs() < rounding.min(0.5),
            "{sigma}: {seen}"
        );
    }
}

/// A lamp at the eye, and fog ahead: every ray's line goes through the lamp, no ray meets it in
/// matter. `∫₁³ σ_s/(4π) e^(−2σ(t − 1))/t² dt`.
#[test]
fn a_lamp_at_the_eye() {
    let fog = cuboid(DVec3::new(-9.0, -9.0, 1.0), DVec3::new(9.0, 9.0, 3.0));
    let scene = Radiative {
        media: vec![within(fog, grey(1.0, 1.0, 0.0))],
        lights: vec![Light::Point(Point {
            position: DVec3::ZERO,
            intensity: DVec3::ONE,
        })],
        ..empty()
    };
    let seen = by_quadrature(&scene, &ray(DVec3::ZERO, DVec3::Z)).x * 4.0 * PI;
    assert!((seen - 0.276_558_892_139_184_2).abs() < 1e-12, "{seen}");
}

/// The shadow of an absorber a thousandth as wide as the fog behind it: a rule of few points that
/// did not begin anew at its edges would step over it.
#[test]
fn a_narrow_shadow_is_seen() {
    let (width, sigma) = (1e-3, 0.2);
    let fog = within(
        cuboid(DVec3::ZERO, DVec3::new(2.0, 1.0, 1.0)),
        grey(sigma, 1.0, 0.0),
    );
    let strip = |x: f64, opaque: f64| {
        let min = DVec3::new(x, 2.0, -9.0);
        let max = DVec3::new(x + width, 3.0, 9.0);
        within(cuboid(min, max), grey(opaque, 0.0, 0.0))
    };
    let radiance = |media: Vec<Body>| {
        let scene = Radiative {
            media,
            lights: vec![Light::Directional(Directional {
                direction: Direction::NEG_Y,
                irradiance: DVec3::ONE,
            })],
            ..empty()
        };
        let view = Ray::new(DVec3::new(-1.0, 0.5, 0.5), DVec3::X).unwrap();
        by_quadrature(&scene, &view).x
    };
    let open = radiance(vec![fog.clone()]);
    for x in [0.1, 0.7, 1.234_567] {
        let shaded = radiance(vec![fog.clone(), strip(x, 1e4)]);
        // σ/4π · e^(−σ/2) · ∫ e^(−σx) dx over the strip: light from above, half of the fog deep.
        let at = |x: f64| exp(-sigma * x) / sigma;
        let lost = sigma / (4.0 * PI) * exp(-0.5 * sigma) * (at(x) - at(x + width));
        let found = open - shaded;
        // The difference of integrals to 1e-14 of 0.02.
        assert!((found - lost).abs() <= 1e-15, "{x}: {found:e} {lost:e}");
    }
}
