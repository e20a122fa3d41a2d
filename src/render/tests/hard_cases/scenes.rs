//! Scenes set up in code, rendered by the fast renderers.

use super::margin::U;
use crate::film::Film;
use crate::geometry::{Aabb, Boundary, Camera, Ray, Sphere};
use crate::math::Moments;
use crate::math::rng::{Purpose, Stream};
use crate::optics::{
    Appearance, Asymmetry, Coefficients, Colormap, Density, Field, Homogeneous, Phase, Phong,
    TransferFunction, TransferOpacity, TransferPoint, TransferPoints,
};
use crate::render::counters::Counters;
use crate::render::plan::RadiativeFeatures;
use crate::render::radiative::context::Scratch;
use crate::render::radiative::line_of_sight::{LineOfSight, TOLERANCE};
use crate::render::radiative::path_tracer::PathTracer;
use crate::render::radiative::sampler::Sampler;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::{RenderError, Rendering, Sampling, plans, render};
use crate::scene::{
    Body, Classified, Compositing, Conventions, Mode, Model, Objects, Panel, Radiative, Scattering,
    Scene, Shadow,
};
use crate::volume::{Grid, GridDensity, Interpolation, Lattice};
use glam::DVec3;
use std::sync::Arc;

/// The largest random number there is.
pub const LAST: f64 = 1.0 - U;

pub fn ray(origin: impl Into<DVec3>, towards: impl Into<DVec3>) -> Ray {
    Ray::new(origin.into(), towards.into()).expect("a direction")
}

/// Through the middle of the cube from 0 to 1, along +z.
pub fn middle() -> Ray {
    ray([0.5, 0.5, -1.0], DVec3::Z)
}

pub fn cuboid(min: impl Into<DVec3>, max: impl Into<DVec3>) -> Aabb {
    Aabb::new(min.into(), max.into()).expect("corners in order")
}

/// The cube from 0 to 1.
pub fn unit_box() -> Aabb {
    cuboid(DVec3::ZERO, DVec3::ONE)
}

pub fn ball(centre: DVec3, radius: f64) -> Sphere {
    Sphere::new(centre, radius).expect("a radius above 0")
}

/// Numbers in [0, 1), the same in every run: `count` sets of three.
pub fn numbers(seed: u64, count: u32) -> impl Iterator<Item = [f64; 3]> {
    (0..count).map(move |sample| {
        let stream = Stream::new(seed, 0, sample);
        let [u, v] = stream.pair(0, Purpose::Camera, 0);
        [u, v, stream.uniform(0, Purpose::Camera, 2)]
    })
}

pub fn grid(
    nodes: [usize; 3],
    spacing: impl Into<DVec3>,
    value: impl Fn([usize; 3]) -> f32,
) -> Arc<Grid<f32>> {
    let lattice = Lattice::new(nodes, spacing.into(), DVec3::ZERO).expect("a lattice");
    let values = (0..lattice.node_count()).map(|index| value(lattice.node(index)));
    Arc::new(Grid::new(lattice, values.collect()).expect("a value for each node"))
}

/// A medium that is the same in all channels.
pub fn grey(sigma_t: f64, albedo: f64, g: f64) -> Homogeneous {
    let sigma_s = sigma_t * albedo;
    coloured(
        DVec3::splat(sigma_t - sigma_s),
        DVec3::splat(sigma_s),
        Asymmetry::new(g).expect("within ±1"),
    )
}

pub fn coloured(sigma_a: DVec3, sigma_s: DVec3, g: Asymmetry) -> Homogeneous {
    Homogeneous {
        coefficients: Coefficients::new(sigma_a, sigma_s).expect("coefficients"),
        emission: DVec3::ZERO,
        phase: Phase::henyey_greenstein(g),
    }
}

fn within(boundary: Boundary, medium: Homogeneous) -> Body {
    Body {
        boundary: Some(boundary),
        medium,
        density: None,
    }
}

pub fn in_box(bounds: Aabb, medium: Homogeneous) -> Body {
    within(Boundary::Box(bounds), medium)
}

pub fn in_ball(sphere: Sphere, medium: Homogeneous) -> Body {
    within(Boundary::Sphere(sphere), medium)
}

/// A medium in a box, with a density of its own.
pub fn heterogeneous(bounds: Aabb, field: Field, medium: Homogeneous) -> Body {
    Body {
        density: Some(Density::new(field, bounds, None)),
        ..in_box(bounds, medium)
    }
}

/// A medium whose density is a grid, in the box of that grid.
pub fn in_grid(density: &GridDensity, medium: Homogeneous) -> Body {
    heterogeneous(density.bounds(), Field::Grid(density.clone()), medium)
}

/// Media before an environment of radiance 1, seen along +z from z = −3.
pub fn before_sky(media: Vec<Body>) -> Radiative {
    let eye = DVec3::new(0.0, 0.0, -3.0);
    Radiative {
        scattering: Scattering::Multiple(None),
        objects: vec![],
        area_lights: vec![],
        media,
        lights: vec![],
        environment: DVec3::ONE,
        camera: Camera::new(eye, DVec3::ZERO, DVec3::Y, 0.7).expect("a view"),
        samples: 4,
        seed: 0,
    }
}

/// Light along the line of sight that is not scattered.
pub fn straight(scene: &Radiative, ray: &Ray) -> DVec3 {
    line_of_sight(scene, ray, false, TOLERANCE)
}

/// Light along the line of sight, without or with what is scattered once, by integrals to
/// `tolerance`.
pub fn line_of_sight(scene: &Radiative, ray: &Ray, scattered: bool, tolerance: f64) -> DVec3 {
    let renderer = LineOfSight {
        scene: SceneContext::new(scene, RadiativeFeatures::ALL),
        scattering: scattered,
        tolerance,
    };
    renderer.radiance(ray, &mut Scratch::default(), &mut Counters::default())
}

/// Radiance of path number `sample` along `ray`, scattered `limit` times at most.
pub fn paths<'s>(
    scene: &'s Radiative,
    limit: Option<u32>,
    ray: Ray,
) -> impl FnMut(u32) -> DVec3 + use<'s> {
    let tracer = PathTracer::new(scene, limit, RadiativeFeatures::ALL);
    let mut scratch = Scratch::default();
    move |sample| {
        let sampler = Sampler::new(Stream::new(scene.seed, 0, sample));
        let radiance = tracer.radiance(ray, sampler, &mut scratch, &mut Counters::default());
        // A path without an end brings back nothing that could be compared.
        radiance.unwrap_or(DVec3::NAN)
    }
}

/// By channel, the moments of what `samples` paths bring back along `ray`.
pub fn sampled(scene: &Radiative, limit: Option<u32>, samples: u32, ray: Ray) -> [Moments; 3] {
    by_channel((0..samples).map(paths(scene, limit, ray)))
}

/// The moments of `samples` by channel.
pub fn by_channel(samples: impl Iterator<Item = DVec3>) -> [Moments; 3] {
    let mut moments = [Moments::default(); 3];
    for sample in samples {
        for (moments, channel) in moments.iter_mut().zip(sample.to_array()) {
            moments.add(channel);
        }
    }
    moments
}

/// A picture of `model` in a scene of its own, by the code of `volref render`.
pub fn scene_of(model: impl Into<Model>, size: [usize; 2]) -> Scene {
    Scene::of(Panel::of(model.into(), size))
}

/// The film of `scene`, or nothing where it has none.
pub fn film(scene: &Scene) -> Option<Film> {
    rendered(scene).ok().map(|rendering| rendering.film)
}

/// A hash of the bits of the film of `scene`.
pub fn bits(scene: &Scene) -> Option<String> {
    film(scene).map(|film| film.pixel_hash())
}

pub fn rendered(scene: &Scene) -> Result<Rendering, RenderError> {
    render(&plans(scene), Sampling::default(), &|| ())
}

/// A classified volume, bumpy, lit and shadowed, seen by a camera in front of it.
pub fn plume(scale: f64) -> Classified {
    let bump = |[i, j, k]: [usize; 3]| ((i * 7 + j * 3 + k * 5) % 11) as f32 / 11.0;
    Classified {
        mode: Mode::Composited,
        phong: Some(Phong {
            ambient: 0.1,
            diffuse: 1.0,
            specular: 0.5,
            shininess: 8,
        }),
        shadow: Some(Shadow {
            step: 0.25 * scale,
            reference_step: 0.125 * scale,
        }),
        ..classified(
            grid([6, 5, 4], DVec3::splat(0.25 * scale), bump),
            by_formula(0.5 * scale),
        )
    }
}

/// The opacity curve of the ray-casting assignment, grey.
pub fn by_formula(reference_length: f64) -> TransferFunction {
    let colormap = Colormap::named("grey").expect("a map of that name");
    TransferFunction {
        appearance: Appearance::Formula {
            opacity: TransferOpacity { floor: 0.36 },
            colormap,
            range: None,
        },
        reference_length,
    }
}

/// A point of a transfer function.
pub fn point(value: f64, opacity: f64, colour: DVec3) -> TransferPoint {
    TransferPoint {
        value,
        colour,
        opacity,
    }
}

/// A transfer function by its points.
pub fn table(points: Vec<TransferPoint>, reference_length: f64) -> TransferFunction {
    TransferFunction {
        appearance: Appearance::Points(TransferPoints::new(points).expect("a table")),
        reference_length,
    }
}

/// `grid` as `transfer_function` has it, neither shaded nor shadowed, seen along +z from twice its
/// size away, in steps of half a voxel.
pub fn classified(grid: Arc<Grid<f32>>, transfer_function: TransferFunction) -> Classified {
    let bounds = grid.lattice().bounds();
    let (centre, size) = (bounds.centre(), bounds.size().max_element());
    let eye = centre - DVec3::Z * (2.0 * size);
    Classified {
        mode: Mode::Composited,
        step: 0.5 * grid.lattice().voxel(),
        grid,
        to_world: None,
        interpolation: Interpolation::Trilinear,
        continuous: false,
        compositing: Compositing::FrontToBack,
        transfer_function,
        phong: None,
        shadow: None,
        light: eye + DVec3::Y * size,
        background: DVec3::ZERO,
        camera: Camera::new(eye, centre, DVec3::Y, 0.7).expect("a view"),
        conventions: Conventions::default(),
        objects: Objects::default(),
    }
}
