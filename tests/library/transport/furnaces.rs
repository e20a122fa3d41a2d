//! Enclosures of one radiance, in which nothing can be seen: `furnace`, and hard case S4.
//!
//! Where nothing absorbs, each path through an environment of radiance 1 returns exactly 1,
//! whatever it met. Where something absorbs and emits as much, the mean is that of the enclosure.

use crate::common::entries::Entry;
use crate::transport::all;
use crate::transport::scenes::*;
use crate::transport::statistics::*;
use glam::DVec3;
use volref::geometry::{
    Aabb, Boundary, ClosedMesh, Luminous, Mesh, Placed, Ray, Shape, Sphere, Transform,
};
use volref::math::rng::{Purpose, Stream};
use volref::math::sampling;
use volref::optics::{Asymmetry, Draine, Droplets, Homogeneous, Material, Phase, Sides};
use volref::scene::{AreaLight, Radiative};

/// Paths of which every one must return exactly 1.
const PATHS: u32 = 2_000;

/// Standard errors of 0.0025 and less, where emission by `σ_t B` instead of `σ_a B` would be off
/// by 0.3 and more.
const SAMPLES: u32 = samples(40_000);

fn entries() -> Vec<Entry> {
    let text = include_str!("../../../fixtures/known-answers/furnace.json");
    all(text, 19)
}

#[test]
fn known_answers() {
    for entry in entries() {
        match entry.case() {
            "conservative" => conservative(&entry),
            "isothermal absorber, black surroundings" | "isothermal absorber in an enclosure" => {
                absorber(&entry)
            }
            "isothermal scattering medium in an enclosure" => isothermal(&entry),
            "emitting and scattering slab" => emitting_slab(&entry),
            "absorbing and scattering sphere in a uniform environment" => grey_sphere(&entry),
            unknown => panic!("{unknown}"),
        }
    }
}

fn conservative(entry: &Entry) {
    let body = match entry.text("shape") {
        "sphere" => within(unit_ball(), grey_of(entry)),
        "cube" => cube_of(entry),
        unknown => panic!("{unknown}"),
    };
    let scene = Radiative {
        media: vec![body],
        environment: DVec3::splat(entry.input("environment_radiance")),
        ..empty()
    };
    assert_eq!(entry.expected("L"), 1.0);
    every_path_returns_one(entry.id(), &scene, |_| ray_of(entry));
}

#[track_caller]
fn every_path_returns_one(what: &str, scene: &Radiative, ray: impl Fn(&Stream) -> Ray) {
    let mut paths = Paths::new(scene, None, 51);
    for sample in 0..PATHS {
        let radiance = paths.radiance(sample, &ray);
        assert_eq!(radiance, DVec3::ONE, "{what}, sample {sample}");
    }
}

/// Without scattering the path tracer finds what the line of sight holds, with every sample.
fn absorber(entry: &Entry) {
    let source = entry.input("B");
    let medium = emissive(grey(entry.input("tau_along_ray"), 0.0, 0.0), source);
    let environment = entry.given("environment_radiance").unwrap_or(0.0);
    let scene = Radiative {
        media: vec![within(cuboid(DVec3::ZERO, DVec3::ONE), medium)],
        environment: DVec3::splat(environment),
        ..empty()
    };
    let ray = ray(DVec3::new(0.5, 0.5, 2.0), DVec3::NEG_Z);
    let found = straight(&scene, &ray);
    entry.is("L", found.x);
    let mut paths = Paths::new(&scene, None, 52);
    for sample in 0..10 {
        assert_eq!(paths.radiance(sample, |_| ray), found);
    }
}

fn isothermal(entry: &Entry) {
    let source = entry.input("B");
    let medium = grey(3.0, entry.input("albedo"), entry.input("g"));
    for (name, shape) in [("sphere", unit_ball()), ("cube", cube())] {
        let scene = Radiative {
            media: vec![within(shape, emissive(medium, source))],
            environment: DVec3::splat(entry.input("environment_radiance")),
            ..empty()
        };
        let ray = ray(DVec3::new(0.3, 0.2, 4.0), DVec3::NEG_Z);
        let [found, ..] = sampled(&scene, None, (entry.seed(53), SAMPLES), |_| ray);
        let what = format!("{} {name}", entry.id());
        agrees(what, &found, entry.expected("L"), 0.0);
    }
}

fn emitting_slab(entry: &Entry) {
    let mut scene = slab_of(entry);
    scene.media[0].medium = emissive(scene.media[0].medium, entry.input("B"));
    for face in [Face::Upper, Face::Lower] {
        let ray = leaving(face, entry.input("mu"));
        let [found, ..] = sampled(&scene, None, (entry.seed(54), SAMPLES), |_| ray);
        let what = format!("{} {face:?}", entry.id());
        agrees(what, &found, entry.expected("L_exit_at_mu"), 0.0);
    }
}

fn grey_sphere(entry: &Entry) {
    let sphere = ball(DVec3::ZERO, entry.input("radius"));
    let medium = grey_of(entry);
    let offset = DVec3::X * entry.input("impact_parameter");
    let ray = ray(offset + DVec3::Z * 4.0, DVec3::NEG_Z);
    let lit = Radiative {
        media: vec![within(sphere.clone(), medium)],
        environment: DVec3::ONE,
        ..empty()
    };
    entry.is("transmittance", straight(&lit, &ray).x);
    let emissive = Radiative {
        media: vec![within(sphere, emissive(medium, 1.0))],
        ..empty()
    };
    for (name, scene) in [
        ("L", lit),
        ("L_isothermal_emission_B1_black_surroundings", emissive),
    ] {
        let [found, ..] = sampled(&scene, None, (entry.seed(55), SAMPLES), |_| ray);
        agrees(
            format_args!("{} {name}", entry.id()),
            &found,
            entry.expected(name),
            0.0,
        );
    }
}

// Furnaces of our own: every shape, several media and surfaces at once.

fn mesh(name: &str) -> ClosedMesh {
    let path = format!("fixtures/meshes/{name}.obj");
    ClosedMesh::new(Mesh::load(path.as_ref()).unwrap()).unwrap()
}

/// A ray from anywhere within 3 of the middle of the scene, into any direction.
fn from_anywhere(random: &Stream) -> Ray {
    let [u, v] = random.pair(0, Purpose::Camera, 0);
    let place = random.pair(0, Purpose::Camera, 1);
    let [along, _] = random.pair(0, Purpose::Camera, 2);
    let origin = sampling::sphere(place) * (3.0 * along);
    ray(origin, *sampling::sphere([u, v]))
}

/// Hard case S4: an environment of radiance 1 around `media` that absorb nothing and `objects`
/// that reflect everything, seen from everywhere, inside and outside.
#[track_caller]
fn nothing_is_seen(
    what: &str,
    media: Vec<volref::scene::Body>,
    objects: Vec<volref::scene::Object>,
) {
    let scene = Radiative {
        objects,
        media,
        environment: DVec3::ONE,
        ..empty()
    };
    every_path_returns_one(what, &scene, from_anywhere);
}

#[test]
fn s4_media_of_every_shape() {
    let turned = Transform::rotation(DVec3::ONE, 40.0).unwrap();
    let stretched = Transform::scale(DVec3::new(0.5, 2.0, 1.0)).unwrap();
    let moved = turned.then(&stretched);
    let (sphere, cuboid) = (
        Sphere::new(DVec3::ZERO, 1.0).unwrap(),
        Aabb::new(DVec3::NEG_ONE, DVec3::ONE).unwrap(),
    );
    let shapes = [
        ("sphere", Boundary::Sphere(sphere)),
        ("box", Boundary::Box(cuboid)),
        (
            "placed sphere",
            Boundary::PlacedSphere(Placed::new(sphere, moved)),
        ),
        (
            "placed box",
            Boundary::PlacedBox(Placed::new(cuboid, moved)),
        ),
        ("ball", Boundary::Mesh(mesh("ball"))),
        ("gem", Boundary::Mesh(mesh("gem"))),
        ("knot", Boundary::Mesh(mesh("knot"))),
        (
            "placed knot",
            Boundary::PlacedMesh(Placed::new(mesh("knot"), moved)),
        ),
    ];
    for (name, shape) in shapes {
        for (sigma_t, g) in [(0.1, 0.0), (4.0, 0.8), (20.0, -0.6)] {
            let media = vec![within(shape.clone(), grey(sigma_t, 1.0, g))];
            nothing_is_seen(name, media, vec![]);
        }
    }
}

/// The enclosure as a surface that emits, which paths both meet and connect to.
#[test]
fn s4_an_enclosure_that_emits() {
    for sides in [Sides::Both, Sides::Front] {
        let scene = Radiative {
            objects: vec![object(
                Shape::Sphere(Sphere::new(DVec3::ZERO, 0.5).unwrap()),
                Material::Diffuse(DVec3::ONE),
            )],
            area_lights: vec![AreaLight {
                shape: Luminous::Sphere(Sphere::new(DVec3::ZERO, 2.5).unwrap()),
                radiance: DVec3::ONE,
                sides,
            }],
            media: vec![within(unit_ball(), grey(1.5, 1.0, 0.5))],
            ..empty()
        };
        let ray = ray(DVec3::new(0.3, 0.2, 2.0), DVec3::NEG_Z);
        let [found, ..] = sampled(&scene, None, (57, SAMPLES), |_| ray);
        // The front of a sphere is outside, where nobody is.
        let expected = if sides == Sides::Both { 1.0 } else { 0.0 };
        if expected == 0.0 {
            assert_eq!(found.mean(), 0.0);
        } else {
            agrees("S4 emitting enclosure", &found, expected, 0.0);
        }
    }
}

/// Phase functions: a direction sampled with another density than it is weighted by would not
/// return the radiance of an enclosure that paths both hit and connect to.
#[test]
fn phase_functions_in_an_enclosure_that_emits() {
    let phases = [
        Phase::Draine(Draine::new(Asymmetry::ISOTROPIC, 1.0).unwrap()),
        Phase::Draine(Draine::new(Asymmetry::new(-0.6).unwrap(), 5.0).unwrap()),
        Phase::Droplets(Droplets::new(8.0).unwrap()),
    ];
    for phase in phases {
        let fog = Homogeneous {
            phase,
            ..grey(1.5, 1.0, 0.0)
        };
        let furnace = Radiative {
            media: vec![within(unit_ball(), fog)],
            environment: DVec3::ONE,
            ..empty()
        };
        let ray = ray(DVec3::new(0.3, 0.2, 2.0), DVec3::NEG_Z);
        every_path_returns_one(&phase.to_string(), &furnace, |_| ray);
        let scene = Radiative {
            area_lights: vec![AreaLight {
                shape: Luminous::Sphere(Sphere::new(DVec3::ZERO, 2.5).unwrap()),
                radiance: DVec3::ONE,
                sides: Sides::Both,
            }],
            environment: DVec3::ZERO,
            ..furnace
        };
        let [found, ..] = sampled(&scene, None, (58, SAMPLES), |_| ray);
        agrees(phase.to_string(), &found, 1.0, 0.0);
    }
}
