//! Rows of the catalogue of hard cases, by their numbers: boxes, grids and sums. Others stand with
//! the laws of what they are about, under the same numbers.
//!
//! `u` is half an ulp of 1. Tolerances are those of the catalogue.

use glam::DVec3;
use std::sync::Arc;
use volref::geometry::{Aabb, Ray, Span};
use volref::math::Sum;
use volref::media::{opacity, optical_depth, transmittance};
use volref::render::compositing::{FrontToBack, Layers, Order};
use volref::render::steps::Steps;
use volref::volume::{
    Centring, DensityField, Grid, GridDensity, GridError, Interpolation, Lattice, Walk,
};

const U: f64 = f64::EPSILON / 2.0;

fn unit_box() -> Aabb {
    Aabb::new(DVec3::ZERO, DVec3::ONE).unwrap()
}

fn ray(origin: [f64; 3], towards: [f64; 3]) -> Ray {
    Ray::new(DVec3::from(origin), DVec3::from(towards)).unwrap()
}

fn span(near: f64, far: f64) -> Option<Span> {
    Some(Span { near, far })
}

/// A zero component is a branch of its own, whatever its sign.
#[test]
fn g1_a_zero_component_within_the_slab() {
    for zero in [0.0, -0.0] {
        let ray = ray([0.5, 0.5, -1.0], [zero, zero, 1.0]);
        assert_eq!(unit_box().span(&ray), span(1.0, 2.0));
    }
}

/// In a face: the box whose minimum face it is holds the ray, the other one does not.
#[test]
fn g2_a_zero_component_on_a_face() {
    for zero in [0.0, -0.0] {
        let along = |x: f64| unit_box().span(&ray([x, 0.5, -1.0], [zero, zero, 1.0]));
        assert_eq!(along(0.0), span(1.0, 2.0));
        assert_eq!(along(-0.0), span(1.0, 2.0));
        assert_eq!(along(1.0), None);
        assert_eq!(along(-1e-300), None);
        assert_eq!(along(1.5), None);
    }
}

#[test]
fn g3_corner_and_edge() {
    let diagonal = unit_box().span(&ray([-1.0; 3], [1.0; 3])).unwrap();
    assert!((diagonal.length() - 3.0_f64.sqrt()).abs() <= 16.0 * U * 3.0_f64.sqrt());
    // Through the edge x = 0, y = 1 only.
    let touching = unit_box().span(&ray([-1.0, 0.0, 0.5], [1.0, 1.0, 0.0]));
    let length = touching.map_or(0.0, |span| span.length());
    assert_eq!(transmittance(5.0 * length), 1.0);
}

#[test]
fn g4_from_inside_from_a_face_and_away() {
    assert_eq!(
        unit_box().span(&ray([0.5; 3], [0.0, 0.0, 1.0])),
        span(0.0, 0.5)
    );
    assert_eq!(
        unit_box().span(&ray([0.5, 0.5, 0.0], [0.0, 0.0, 1.0])),
        span(0.0, 1.0)
    );
    let outwards = unit_box().span(&ray([0.5, 0.5, 0.0], [0.0, 0.0, -1.0]));
    assert_eq!(outwards.map_or(0.0, |span| span.length()), 0.0);
    assert_eq!(
        unit_box().span(&ray([0.5, 0.5, 2.0], [0.0, 0.0, 1.0])),
        None
    );
}

/// In planes between cells, along diagonals, and without an end: few cells, no length below 0, and
/// all of the chord.
#[test]
fn g12_walks_of_a_grid() {
    const SIDE: usize = 8;
    let bounds = Aabb::new(DVec3::ZERO, DVec3::splat(8.0)).unwrap();
    let mut rays = Vec::new();
    for plane in 0..SIDE {
        rays.push(ray([-1.0, plane as f64, 2.5], [1.0, 0.0, 0.0]));
        rays.push(ray([2.5, 9.0, plane as f64], [0.0, -1.0, 0.0]));
    }
    for signs in 0..8 {
        let sign = |axis: i32| if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
        let direction = [sign(0), sign(1), sign(2)];
        rays.push(ray(direction.map(|d| 4.0 - 6.0 * d), direction));
    }
    for ray in rays {
        let chord = bounds.span(&ray).unwrap();
        let visits: Vec<_> = Walk::new([SIDE; 3], ray.origin, ray.direction, chord).collect();
        assert!(visits.len() <= 3 * SIDE + 1);
        assert!(visits.iter().all(|visit| visit.span.length() >= 0.0));
        let sum: f64 = visits.iter().map(|visit| visit.span.length()).sum();
        assert!((sum - chord.length()).abs() <= 8.0 * U * chord.far);
    }
    let endless = Span {
        near: 0.0,
        far: f64::INFINITY,
    };
    let walk = Walk::new(
        [SIDE; 3],
        DVec3::splat(0.5),
        DVec3::new(1.0, 0.0, 0.0),
        endless,
    );
    assert!(walk.count() <= 3 * SIDE + 1);
}

fn grid(nodes: [usize; 3], spacing: DVec3, value: impl Fn([usize; 3]) -> f32) -> Arc<Grid<f32>> {
    let lattice = Lattice::new(nodes, spacing, DVec3::ZERO).unwrap();
    let values = (0..lattice.node_count()).map(|index| value(lattice.node(index)));
    Arc::new(Grid::new(lattice, values.collect()).unwrap())
}

const BOTH: [Interpolation; 2] = [Interpolation::Nearest, Interpolation::Trilinear];

/// `∫ density dt` along `ray`, and how long the ray is in the box.
fn depth(density: &GridDensity, ray: &Ray) -> (f64, f64) {
    let inside = density.bounds().span(ray).unwrap();
    let depth = density.integral(ray.origin, ray.direction, inside, &mut 0);
    (depth, inside.length())
}

#[test]
fn d1_a_constant_grid_is_homogeneous() {
    let constant = grid([5, 4, 3], DVec3::splat(0.3), |_| 0.7);
    for interpolation in BOTH {
        let density = GridDensity::new(constant.clone(), interpolation);
        for number in 0..200 {
            let turn = f64::from(number) / 200.0;
            let ray = ray(
                [-1.0, 0.3, 0.25],
                [1.2 + turn, 0.3 * turn, 0.1 - 0.2 * turn],
            );
            let (depth, length) = depth(&density, &ray);
            let right = f64::from(0.7_f32) * length;
            assert!((depth - right).abs() <= 1e-14 * right, "{depth} {right}");
        }
    }
}

#[test]
fn d2_a_trilinear_cell_is_a_cubic_along_a_ray() {
    let product = grid([2; 3], DVec3::ONE, |[i, j, k]| (i * j * k) as f32);
    let density = GridDensity::new(product, Interpolation::Trilinear);
    let (depth, _) = depth(&density, &ray([0.0; 3], [1.0; 3]));
    let right = 3.0_f64.sqrt() / 4.0;
    assert!((depth - right).abs() <= 8.0 * U * right, "{depth}");
}

/// One voxel, and one voxel thick: constant along the thin axis, in a slab one spacing thick.
#[test]
fn d3_one_voxel() {
    for (nodes, axis) in [([1, 1, 1], 0), ([1, 16, 16], 0), ([16, 1, 16], 1)] {
        for centring in [Centring::Nodes, Centring::Cells] {
            let lattice = Lattice::new(nodes, DVec3::splat(0.5), DVec3::ZERO).unwrap();
            let lattice = lattice.with_centring(centring).unwrap();
            let values = vec![2.0; lattice.node_count()];
            let grid = Arc::new(Grid::new(lattice, values).unwrap());
            for interpolation in BOTH {
                let density = GridDensity::new(grid.clone(), interpolation);
                let mut towards = [0.0; 3];
                towards[axis] = 1.0;
                let mut origin = density.bounds().centre();
                origin[axis] = -10.0;
                let (depth, length) = depth(&density, &ray(origin.to_array(), towards));
                assert!((length - 0.5).abs() <= 1e-14, "{length}");
                assert!((depth - 1.0).abs() <= 1e-14, "{depth}");
            }
        }
    }
}

/// At the upper bound the last voxel; so an ulp below; beyond it a medium has no density.
#[test]
fn d4_the_upper_bound() {
    let ramp = grid([4; 3], DVec3::ONE, |[i, _, _]| i as f32);
    let at = |x: f64, interpolation| {
        GridDensity::new(ramp.clone(), interpolation).density(DVec3::new(x, 1.5, 1.5))
    };
    for interpolation in BOTH {
        assert_eq!(at(3.0, interpolation), 3.0);
        let below = 3.0_f64.next_down();
        assert!((at(below, interpolation) - 3.0).abs() <= 4.0 * U * 3.0);
    }
    let beyond = ray([3.0_f64.next_up(), 1.5, -1.0], [0.0, 0.0, 1.0]);
    let density = GridDensity::new(ramp.clone(), Interpolation::Trilinear);
    assert_eq!(density.bounds().span(&beyond), None);
}

#[test]
fn d5_anisotropic_spacing() {
    let constant = grid([5, 4, 3], DVec3::new(1.0, 2.0, 4.0), |_| 0.5);
    for interpolation in BOTH {
        let density = GridDensity::new(constant.clone(), interpolation);
        let centre = density.bounds().centre();
        for towards in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
            let ray = Ray::new(centre - 20.0 * towards, towards).unwrap();
            let (depth, length) = depth(&density, &ray);
            assert!((depth - 0.5 * length).abs() <= 1e-14 * depth, "{towards}");
        }
    }
}

/// What is no density is named, with its place.
#[test]
fn d9_voxels_that_are_no_densities() {
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0] {
        let grid = grid([4; 3], DVec3::ONE, |node| match node {
            [1, 2, 3] => wrong,
            _ => 1.0,
        });
        let Err(GridError::Density { node, value }) = grid.check_densities() else {
            panic!("{wrong} is a density");
        };
        assert_eq!(node, [1, 2, 3]);
        assert_eq!(value.to_bits(), f64::from(wrong).to_bits());
    }
}

/// Subnormal voxels and huge ones: transparent, opaque, and never no number.
#[test]
fn d10_subnormal_and_huge_voxels() {
    for (value, right) in [(1e-45_f32, 1.0), (f32::MAX, 0.0)] {
        let density = GridDensity::new(
            grid([3; 3], DVec3::ONE, |_| value),
            Interpolation::Trilinear,
        );
        let (depth, _) = depth(&density, &ray([-1.0, 0.7, 0.7], [1.0, 0.1, 0.1]));
        assert_eq!(transmittance(depth), right);
        // What overflows is infinitely deep, what underflows is nothing.
        for sigma in [1e300, 1e-300] {
            let seen = transmittance(optical_depth(sigma, depth));
            assert!((0.0..=1.0).contains(&seen), "{sigma} {value}");
        }
    }
}

/// Positions come from an index: no drift in ten million steps.
#[test]
fn a2_positions_do_not_drift() {
    let steps = Steps::over(
        Span {
            near: 0.0,
            far: 1e6,
        },
        0.1,
    );
    let (middle, length) = steps.sample(steps.count() - 1);
    assert!((middle + 0.5 * length - 1e6).abs() <= 1e6 * f64::EPSILON);
}

/// A million thin layers, by the product and by the compensated depth.
#[test]
fn a1_a_million_thin_layers() {
    let right = 0.632_120_742_768_355;
    let mut layers = Layers::default();
    let mut depth = Sum::default();
    for _ in 0..1_000_000 {
        layers = FrontToBack::add(layers, DVec3::ZERO, 1e-6);
        depth.add(-volref::math::ln_1p(-1e-6));
    }
    assert!(
        (layers.opacity - right).abs() <= 1e-10 * right,
        "{}",
        layers.opacity
    );
    assert!(
        (opacity(depth.value()) - right).abs() <= 1e-15,
        "{}",
        opacity(depth.value())
    );
}

/// A homogeneous medium by any number of steps, one of them longer than the box: by the summed
/// depth, and by the product of what the steps let through.
#[test]
fn e8_any_number_of_steps() {
    let sigma = 10.0;
    let box_of_one = Span {
        near: 0.5,
        far: 1.5,
    };
    let right = transmittance(sigma);
    for length in [3.0, 1.0, 0.5, 1.0 / 7.0, 1e-3, 1e-6] {
        let steps = Steps::over(box_of_one, length);
        let mut sum = Sum::default();
        let mut layers = Layers::default();
        for index in 0..steps.count() {
            let own = optical_depth(sigma, steps.sample(index).1);
            sum.add(own);
            layers = FrontToBack::add(layers, DVec3::ZERO, opacity(own));
        }
        let by_sum = transmittance(sum.value());
        assert!(
            (by_sum - right).abs() <= 1e-12 * right,
            "{length}: {by_sum}"
        );
        // The ray caster carries opacity, which rounds to a unit of 1 at every step, however little
        // is let through. A million steps are off by 1.3e-10 here: more than the row allows.
        if steps.count() <= 1000 {
            let by_product = 1.0 - layers.opacity;
            assert!(
                (by_product - right).abs() <= 1e-10 * right,
                "{length}: {by_product}"
            );
        }
    }
}
