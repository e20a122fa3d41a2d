//! What is null changes no bit: hard case A6, for surfaces and media.

use crate::transport::scenes::*;
use glam::DVec3;
use volref::geometry::{Boundary, Camera, Luminous, Rectangle, Shape, Sphere};
use volref::math::rng::{Purpose, Stream};
use volref::optics::{Coefficients, Field, Homogeneous, Material, Sides};
use volref::render::counters::Uncounted;
use volref::render::plan::RadiativeFeatures;
use volref::render::radiative::context::Scratch;
use volref::render::radiative::path_tracer::PathTracer;
use volref::render::radiative::sampler::Sampler;
use volref::render::{Effect, Plan, Sampling, render};
use volref::scene::{AreaLight, Body, Panel, Radiative, Scattering};

const SIZE: usize = 16;

fn camera() -> Camera {
    Camera::new(DVec3::new(0.4, 0.3, 4.0), DVec3::ZERO, DVec3::Y, 0.7).unwrap()
}

fn lit(media: Vec<Body>) -> Radiative {
    Radiative {
        media,
        lights: vec![
            sun(DVec3::new(0.3, -1.0, -0.4), DVec3::ONE),
            lamp(DVec3::new(0.5, 1.8, 0.4), 2.0),
        ],
        environment: DVec3::new(0.3, 0.2, 0.1),
        camera: camera(),
        samples: 4,
        seed: 9,
        ..empty()
    }
}

fn nothing() -> Homogeneous {
    grey(0.0, 0.0, 0.0)
}

fn coloured(g: f64) -> Homogeneous {
    let sigma_s = DVec3::new(0.3, 1.0, 2.0);
    Homogeneous {
        coefficients: Coefficients::new(DVec3::splat(0.1), sigma_s).unwrap(),
        ..grey(1.0, 0.5, g)
    }
}

fn with_surfaces(scene: Radiative) -> Radiative {
    let ball = Shape::Sphere(Sphere::new(DVec3::new(0.3, -0.2, 0.1), 0.4).unwrap());
    let plate = Rectangle::centred(DVec3::Y * 1.9, DVec3::X * 0.3, DVec3::Z * 0.3).unwrap();
    Radiative {
        objects: vec![
            object(ball, Material::Diffuse(DVec3::new(0.7, 0.5, 0.9))),
            object(
                Shape::Sphere(Sphere::new(DVec3::new(-0.5, 0.3, 0.4), 0.3).unwrap()),
                Material::Glass(1.5),
            ),
        ],
        area_lights: vec![AreaLight {
            shape: Luminous::Rectangle(plate),
            radiance: DVec3::splat(2.0),
            sides: Sides::Front,
        }],
        ..scene
    }
}

/// Every path through the picture, to the bit.
fn paths(scene: &Radiative, vacuum_media: bool) -> Vec<[u64; 3]> {
    let features = RadiativeFeatures {
        vacuum_media,
        ..RadiativeFeatures::ALL
    };
    let tracer = PathTracer::new(scene, None, features);
    let mut scratch = Scratch::default();
    let path = |sample| {
        let random = Stream::new(scene.seed, 0, sample);
        let [x, y] = random.pair(0, Purpose::Camera, 0);
        let ray = camera().ray_through([x, y], [1, 1]);
        let radiance = tracer.radiance(ray, Sampler::new(random), &mut scratch, &mut Uncounted);
        radiance.unwrap().to_array().map(f64::to_bits)
    };
    (0..400).map(path).collect()
}

#[track_caller]
fn same_bits(found: &[[u64; 3]], expected: &[[u64; 3]]) {
    let odd = (0..expected.len()).find(|&path| found[path] != expected[path]);
    if let Some(path) = odd {
        let [found, expected] = [found, expected].map(|all| all[path].map(f64::from_bits));
        panic!("path {path} is {found:?}, not {expected:?}");
    }
}

/// Media of no matter, across media of some, beside them and everywhere.
#[test]
fn media_of_nothing() {
    let some = |g| {
        vec![
            within(cube(), grey(1.0, 0.8, g)),
            within(ball(DVec3::X, 0.8), coloured(g)),
        ]
    };
    for scene in [lit(some(0.0)), with_surfaces(lit(some(0.5)))] {
        let bare = paths(&scene, false);
        let null: [Vec<Body>; 3] = [
            vec![within(ball(DVec3::new(0.2, 0.1, 0.3), 0.7), nothing())],
            vec![everywhere(nothing())],
            vec![
                within(cuboid(DVec3::splat(-0.3), DVec3::splat(0.4)), nothing()),
                within(
                    Boundary::Sphere(Sphere::new(DVec3::Y, 0.9).unwrap()),
                    nothing(),
                ),
            ],
        ];
        for null in null {
            for first in [false, true] {
                let mut with_null = scene.clone();
                if first {
                    with_null.media.splice(0..0, null.clone());
                } else {
                    with_null.media.extend(null.clone());
                }
                same_bits(&paths(&with_null, false), &bare);
                same_bits(&paths(&with_null, true), &bare);
            }
        }
    }
}

fn panel(radiative: Radiative) -> Panel {
    Panel::of(radiative.into(), [SIZE; 2])
}

fn film(plan: Plan<'_>) -> Vec<u8> {
    let rendering = render(&[plan], Sampling::default(), &|| {}).unwrap();
    rendering.film.to_exr().unwrap()
}

/// Every null effect of a scene, forced alone and with all others; returns which.
#[track_caller]
fn force_all(radiative: Radiative) -> Vec<Effect> {
    let panel = panel(radiative);
    let plan = Plan::new(&panel);
    let bare = film(plan.clone());
    let null = Plan::null_effects(&panel);
    for &effect in &null {
        let forced = Plan::forcing(&panel, &[effect]).unwrap();
        assert!(film(forced) == bare, "{effect} forced changes the film");
    }
    let all = Plan::forcing(&panel, &null).unwrap();
    assert!(film(all) == bare, "all forced change the film");
    null
}

#[test]
fn null_effects_forced() {
    use Effect::*;
    let plain = lit(vec![within(cube(), grey(1.0, 1.0, 0.0))]);
    assert_eq!(
        force_all(plain.clone()),
        [
            Surfaces,
            Absorption,
            Emission,
            SurfaceShadow,
            Heterogeneity,
            ChromaticCoefficients,
            AnisotropicPhase
        ]
    );
    force_all(with_surfaces(plain.clone()));
    // A medium of nothing across the other.
    let mut with_null = plain.clone();
    with_null.media.push(within(ball(DVec3::X, 0.9), nothing()));
    force_all(with_null);
    // A density of nothing, first in the row: no random number is drawn for it.
    let bounds = volref::geometry::Aabb::new(DVec3::NEG_ONE, DVec3::ONE).unwrap();
    let constant =
        |density| Field::Constant(volref::volume::ConstantDensity::new(density).unwrap());
    let blob = Field::Blob(volref::volume::Blob {
        centre: DVec3::ZERO,
        peak: 1.0,
        width: 0.5,
    });
    let smoke = lit(vec![
        heterogeneous(bounds, constant(0.0), grey(1.0, 1.0, 0.0)),
        heterogeneous(bounds, blob, grey(2.0, 1.0, 0.0)),
    ]);
    assert!(force_all(smoke).contains(&Emission));
    let empty_only = lit(vec![heterogeneous(
        bounds,
        constant(0.0),
        grey(1.0, 0.8, 0.0),
    )]);
    assert!(force_all(empty_only).contains(&Heterogeneity));
    // Surfaces and no medium; a medium of nothing alone.
    force_all(with_surfaces(lit(vec![])));
    force_all(with_surfaces(lit(vec![within(cube(), nothing())])));
    force_all(lit(vec![within(cube(), nothing())]));
    // Light turned once, by integrals and by paths.
    let single = |scene: Radiative| Radiative {
        scattering: Scattering::Single,
        ..scene
    };
    force_all(single(plain.clone()));
    force_all(single(Radiative {
        environment: DVec3::ZERO,
        ..plain.clone()
    }));
    // Never turned; nothing there to turn it; nothing there to be turned.
    force_all(Radiative {
        scattering: Scattering::None,
        ..plain.clone()
    });
    let absorbing = lit(vec![within(cube(), emissive(grey(1.0, 0.0, 0.0), 0.5))]);
    let forced = force_all(absorbing);
    assert!(forced.contains(&MultipleScattering), "{forced:?}");
    force_all(Radiative {
        lights: vec![],
        environment: DVec3::ZERO,
        ..plain
    });
}
