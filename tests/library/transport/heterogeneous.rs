//! Media whose density differs from place to place, against the same light found another way.

use crate::transport::U;
use crate::transport::scenes::*;
use crate::transport::statistics::*;
use glam::DVec3;
use std::sync::Arc;
use volref::geometry::{Aabb, Boundary, Luminous, Placed, Shape, Sphere, Transform};
use volref::math::quadrature::integrate;
use volref::math::{Moments, exp};
use volref::optics::{Density, Field, Homogeneous, Material, Sides};
use volref::scene::{AreaLight, Body, Radiative};
use volref::volume::{
    Blob, DensityField, ExponentialLayer, Grid, GridDensity, Interpolation, Lattice,
};

/// Standard errors near 0.5 %.
const SAMPLES: u32 = samples(40_000);

fn cube_bounds() -> Aabb {
    Aabb::new(DVec3::NEG_ONE, DVec3::ONE).unwrap()
}

/// A grid over the cube from −1 to 1.
fn grid(nodes: [usize; 3], value: impl Fn([usize; 3]) -> f64) -> Arc<Grid<f32>> {
    let cells = DVec3::from_array(nodes.map(|nodes| (nodes - 1) as f64));
    let lattice = Lattice::new(nodes, DVec3::splat(2.0) / cells, DVec3::NEG_ONE).unwrap();
    let values = (0..lattice.node_count()).map(|index| value(lattice.node(index)) as f32);
    Arc::new(Grid::new(lattice, values.collect()).unwrap())
}

/// Densities from 0 to 2 without any order, a fifth of them 0.
fn bumpy(node: [usize; 3]) -> f64 {
    let mixed = (node[0] * 73 + node[1] * 179 + node[2] * 283) * 2_654_435_761 % 1000;
    (mixed as f64 / 400.0 - 0.5).max(0.0)
}

fn bumpy_grid() -> Arc<Grid<f32>> {
    grid([19, 14, 23], bumpy)
}

fn field(grid: Arc<Grid<f32>>) -> Field {
    Field::Grid(GridDensity::new(grid, Interpolation::Trilinear))
}

fn in_cube(field: Field, medium: Homogeneous) -> Body {
    heterogeneous(cube_bounds(), field, medium)
}

fn mean(scene: &Radiative, seed: u64) -> [Moments; 3] {
    sampled(scene, None, (seed, SAMPLES), |_| into_the_middle())
}

#[track_caller]
fn close(a: DVec3, b: DVec3, relative: f64) {
    assert!(
        (a - b).abs().max_element() <= relative * b.max_element(),
        "{a} {b}"
    );
}

/// Hard case D1: a constant grid is a homogeneous medium.
#[test]
fn a_constant_grid() {
    let dim = within(cube(), grey(0.7 * 1.25, 0.0, 0.0));
    let behind = |media| Radiative {
        environment: DVec3::ONE,
        ..lit(media)
    };
    for interpolation in [Interpolation::Trilinear, Interpolation::Nearest] {
        // 0.7 as `f32` is another number, 1.25 is not.
        let constant = GridDensity::new(grid([4, 3, 5], |_| 1.25), interpolation);
        let body = in_cube(Field::Grid(constant), grey(0.7, 0.0, 0.0));
        for towards in [DVec3::NEG_Z, DVec3::new(0.1, -0.3, -1.0)] {
            let ray = ray(DVec3::new(0.2, 0.5, 4.0), towards);
            let found = straight(&behind(vec![body.clone()]), &ray);
            close(found, straight(&behind(vec![dim.clone()]), &ray), 1e-14);
        }
    }
    let homogeneous = lit(vec![within(cube(), grey(1.25, 0.8, 0.4))]);
    let heterogeneous = lit(vec![in_cube(
        field(grid([9, 12, 20], |_| 1.25)),
        grey(1.0, 0.8, 0.4),
    )]);
    same(
        "constant",
        &mean(&heterogeneous, 1)[0],
        &mean(&homogeneous, 2)[0],
    );
    // A unit in the last place in a corner: no longer constant, and light is tracked.
    let all_but = |node: [usize; 3]| match node {
        [0, 0, 0] => f64::from(1.25_f32.next_up()),
        _ => 1.25,
    };
    let gridded = lit(vec![in_cube(
        field(grid([9, 12, 20], all_but)),
        grey(1.0, 0.8, 0.4),
    )]);
    same(
        "constant grid",
        &mean(&gridded, 3)[0],
        &mean(&homogeneous, 2)[0],
    );
}

/// Absorption along a line is an integral; a path tracer that turns nothing knows it exactly.
#[test]
fn what_only_absorbs_is_exact() {
    let body = in_cube(field(bumpy_grid()), grey(0.8, 0.0, 0.0));
    let density = body.density.clone().unwrap();
    let scene = Radiative {
        environment: DVec3::ONE,
        lights: vec![],
        ..lit(vec![body])
    };
    let ray = into_the_middle();
    let inside = cube_bounds().span(&ray).unwrap();
    let slices = 4000;
    let cut = |i: i32| inside.near + inside.length() * f64::from(i) / f64::from(slices);
    let depth: f64 = (0..slices)
        .map(|i| {
            let at = |t| DVec3::splat(density.at(ray.at(t), &mut 0));
            integrate(at, cut(i), cut(i + 1), 1e-12).value.x
        })
        .sum();
    let expected = DVec3::splat(exp(-0.8 * depth));
    close(straight(&scene, &ray), expected, 1e-9);
    let mut paths = Paths::new(&scene, None, 31);
    for sample in 0..20 {
        close(
            paths.radiance(sample, |_| ray),
            straight(&scene, &ray),
            16.0 * U,
        );
    }
}

/// Emission: in closed form, by quadrature where it overlaps with others, and by tracking.
#[test]
fn emission_in_three_ways() {
    let fire = Homogeneous {
        emission: DVec3::new(2.0, 1.0, 0.5),
        ..grey(1.5, 0.0, 0.0)
    };
    let dark = |media| Radiative {
        lights: vec![],
        environment: DVec3::ZERO,
        ..lit(media)
    };
    let alone = dark(vec![in_cube(field(bumpy_grid()), fire)]);
    let split = Homogeneous {
        emission: fire.emission * 0.5,
        ..grey(0.75, 0.0, 0.0)
    };
    let halves = dark(vec![
        in_cube(field(bumpy_grid()), split),
        in_cube(field(bumpy_grid()), split),
    ]);
    let ray = into_the_middle();
    let expected = straight(&alone, &ray);
    assert!(expected.min_element() > 0.1);
    close(straight(&halves, &ray), expected, 1e-12);
    // As deep as 60 in a cell, where only the beginning of each is seen.
    let deep = |sigma: f64| Homogeneous {
        emission: fire.emission * sigma,
        ..grey(sigma, 0.0, 0.0)
    };
    let alone_deep = dark(vec![in_cube(field(bumpy_grid()), deep(600.0))]);
    let halves_deep = dark(vec![
        in_cube(field(bumpy_grid()), deep(300.0)),
        in_cube(field(bumpy_grid()), deep(300.0)),
    ]);
    close(
        straight(&halves_deep, &ray),
        straight(&alone_deep, &ray),
        1e-12,
    );
    // The same with a little that scatters nothing back: nothing is lit.
    for (seed, scene) in [(41, &alone), (42, &halves)] {
        let found = sampled(scene, Some(0), (seed, SAMPLES), |_| ray);
        for channel in 0..3 {
            agrees("tracked emission", &found[channel], expected[channel], 0.0);
        }
    }
    // Emission without any extinction, which no collision of the medium itself would find.
    let emissive = Homogeneous {
        emission: DVec3::ONE,
        ..grey(0.0, 0.0, 0.0)
    };
    let thin = dark(vec![in_cube(field(bumpy_grid()), emissive)]);
    let found = sampled(&thin, None, (43, SAMPLES), |_| ray);
    agrees("emission", &found[0], straight(&thin, &ray).x, 0.0);
}

/// In conservative media every path returns 1, whatever it met: exactly in one alone, as the
/// furnaces show, and here, where one of several is chosen at every turn, but for a few roundings
/// a turn.
#[test]
fn conservative_whatever_the_density() {
    let scene = Radiative {
        environment: DVec3::ONE,
        lights: vec![],
        ..lit(vec![
            in_cube(field(bumpy_grid()), grey(4.0, 1.0, 0.7)),
            in_cube(
                Field::Blob(Blob {
                    centre: DVec3::ZERO,
                    peak: 5.0,
                    width: 0.2,
                }),
                grey(1.0, 1.0, -0.2),
            ),
            within(cube(), grey(0.3, 1.0, 0.0)),
        ])
    };
    let mut paths = Paths::new(&scene, None, 61);
    for sample in 0..2000 {
        let radiance = paths.radiance(sample, |_| into_the_middle());
        assert!((radiance - 1.0).abs().max_element() < 1e-12, "{radiance}");
    }
}

/// Surfaces and lamps in heterogeneous smoke, against the same in homogeneous smoke.
#[test]
fn among_surfaces() {
    let around = |media| Radiative {
        objects: vec![object(
            Shape::Sphere(Sphere::new(DVec3::new(0.3, -0.2, 0.1), 0.4).unwrap()),
            Material::Diffuse(DVec3::new(0.7, 0.5, 0.9)),
        )],
        area_lights: vec![AreaLight {
            shape: Luminous::Sphere(Sphere::new(DVec3::new(-0.4, 0.5, 0.3), 0.2).unwrap()),
            radiance: DVec3::splat(2.0),
            sides: Sides::Front,
        }],
        ..lit(media)
    };
    let homogeneous = around(vec![within(cube(), grey(1.5, 0.8, 0.4))]);
    // Uneven bounds over a homogeneous density: null collisions everywhere.
    let patched = grid(
        [40, 40, 40],
        |node| if node == [0, 0, 0] { 1.5 } else { 1.0 },
    );
    let uneven = around(vec![in_cube(field(patched), grey(1.5, 0.8, 0.4))]);
    let [a, b] = [(&homogeneous, 71), (&uneven, 72)].map(|(scene, seed)| mean(scene, seed)[1]);
    same("among surfaces", &a, &b);
}

/// Placed elsewhere, turned and stretched, a field goes along with its boundary.
#[test]
fn placed_elsewhere() {
    let turn = Transform::rotation(DVec3::new(1.0, 2.0, 0.5), 50.0).unwrap();
    let far = Transform::translation(DVec3::new(10.0, -4.0, 3.0)).unwrap();
    let to_world = Transform::scale(DVec3::new(2.0, 0.5, 1.0))
        .unwrap()
        .then(&turn)
        .then(&far);
    let placed = Body {
        boundary: Some(Boundary::PlacedBox(Placed::new(cube_bounds(), to_world))),
        medium: grey(0.8, 0.0, 0.0),
        density: Some(Density::new(
            field(bumpy_grid()),
            cube_bounds(),
            Some(to_world),
        )),
    };
    let density = placed.density.clone().unwrap();
    let scene = Radiative {
        environment: DVec3::ONE,
        lights: vec![],
        ..lit(vec![placed])
    };
    let target = to_world.point(DVec3::new(0.1, 0.2, -0.3));
    let view = ray(
        target + DVec3::new(3.0, 4.0, 5.0),
        DVec3::new(-3.0, -4.0, -5.0),
    );
    let slices = 40_000;
    let step = 14.0 / f64::from(slices);
    let inside = |point: DVec3| {
        let local = to_world.inverse().point(point).abs();
        local.max_element() < 1.0
    };
    let depth: f64 = (0..slices)
        .map(|i| view.at((f64::from(i) + 0.5) * step))
        .filter(|&point| inside(point))
        .map(|point| density.at(point, &mut 0) * step)
        .sum();
    // Steps of 3.5e-4 miss each of the two ends by at most that, of densities below 2.
    let found = straight(&scene, &view).x;
    assert!((found - exp(-0.8 * depth)).abs() < 2e-3, "{found}");
    assert!(depth > 0.3);
}

/// A grid reaches no farther than its own box, be the shape of its medium larger: not for rays,
/// and not for the places on them that a lamp is connected to.
#[test]
fn a_shape_larger_than_its_grid() {
    let medium = grey(2.0, 0.8, 0.3);
    let alone = in_cube(field(bumpy_grid()), medium);
    let large = Body {
        boundary: Some(ball(DVec3::ZERO, 5.0)),
        ..alone.clone()
    };
    let around = |body| Radiative {
        lights: vec![lamp(DVec3::new(0.5, 1.8, 0.4), 2.0)],
        ..lit(vec![body, within(ball(DVec3::X, 0.5), grey(0.5, 0.8, 0.0))])
    };
    let [alone, large] =
        [(alone, 101), (large, 102)].map(|(body, seed)| mean(&around(body), seed)[0]);
    same("larger shape", &large, &alone);
}

/// Rays that look down into a layer from a thousand scale heights above: its depth has a closed
/// form, whichever end they begin at.
#[test]
fn a_layer_from_far_above() {
    let layer = ExponentialLayer::new(2.0, DVec3::ZERO, DVec3::Y, 1.0).unwrap();
    let bounds = Aabb::new(DVec3::ZERO, DVec3::new(1.0, 1e3, 1.0)).unwrap();
    let body = heterogeneous(bounds, Field::Exponential(layer), grey(0.3, 0.0, 0.0));
    let scene = Radiative {
        environment: DVec3::ONE,
        lights: vec![],
        ..lit(vec![body])
    };
    for (from, towards) in [(2e3, DVec3::NEG_Y), (-1.0, DVec3::Y)] {
        let share = straight(&scene, &ray(DVec3::new(0.5, from, 0.5), towards)).x;
        assert!((share - exp(-0.6)).abs() <= 1e-14, "{share}");
    }
}

/// What emits where another medium lies, though it be narrower than any rule of few points.
#[test]
fn narrow_emitters_that_overlap() {
    let blob = Field::Blob(Blob {
        centre: DVec3::new(0.1, 0.0, 0.2),
        peak: 1.0,
        width: 0.004,
    });
    let fire = Homogeneous {
        emission: DVec3::splat(50.0),
        ..grey(20.0, 0.0, 0.0)
    };
    let faint = Homogeneous {
        emission: DVec3::splat(0.1),
        ..grey(0.1, 0.0, 0.0)
    };
    let scene = Radiative {
        lights: vec![],
        environment: DVec3::ZERO,
        ..lit(vec![in_cube(blob.clone(), fire), within(cube(), faint)])
    };
    let view = ray(DVec3::new(0.1, 0.0, 4.0), DVec3::NEG_Z);
    let found = straight(&scene, &view).x;
    // The blob is a point for the homogeneous medium: τ of it 20·√(2π)·0.004, at z = 0.2.
    let tau = 20.0 * 0.004 * (2.0 * std::f64::consts::PI).sqrt();
    let front = 1.0 - exp(-0.08);
    let behind = exp(-0.08 - tau) * (1.0 - exp(-0.12));
    let expected = front + exp(-0.08) * 2.5 * (1.0 - exp(-tau)) + behind;
    // It is not quite one: the homogeneous medium makes 1e-3 within it, which it dims by up to 0.2.
    assert!((found - expected).abs() < 2e-4, "{found} {expected}");
}

#[test]
fn the_density_at_a_point_is_that_of_its_field() {
    let body = in_cube(field(bumpy_grid()), grey(1.0, 0.8, 0.0));
    let point = DVec3::new(0.1, 0.2, 0.3);
    let density = body.density.as_ref().unwrap();
    assert_eq!(density.at(point, &mut 0), density.field().density(point));
}
