//! Orders of convergence, against theory: of `volref cost` on small scenes, and of reconstruction on fields of which
//! everything is known.
//!
//! A fitted order may be off by 0.1, by 0.2 in the largest error: what is left of the next term of an expansion in the
//! settings that are fitted.

use crate::common::quadrature;
use crate::effects::scenes::parsed;
use glam::DVec3;
use std::sync::Arc;
use volref::cost::norms::{Norms, norms};
use volref::cost::order::{ExpectedOrder, OrderVerdict, order};
use volref::cost::timing::Clock;
use volref::cost::{Cost, Options, Parameter, Sweep, cost};
use volref::geometry::Ray;
use volref::math::rng::{Purpose, Stream};
use volref::optics::collocation::{Collocation, LocalProperties};
use volref::volume::{
    Blob, Cell, DensityField, Grid, GridDensity, Interpolation, Lattice, gradients,
};

/// What accuracy costs in the scene of `text`, without times.
fn measured(text: &str) -> Cost {
    let options = Options {
        clock: Clock::NONE,
        seed: 0,
    };
    let costs = cost(&parsed(text), "scene", &options, &|_| ());
    costs.unwrap().swap_remove(0)
}

/// A hill in a grid, seen from aside.
fn hill(keys: &str) -> String {
    format!(
        "[film]\nwidth = 12\nheight = 12\n\
         [camera]\neye = [0.35, 0.4, -2.2]\ntarget = [0.12, 0.1, 0.1]\nvertical_fov = 34\n\
         [transfer_function]\nreference_length = '1 voxel'\n\
         [classified]\n{keys}\n[classified.volume]\nfile = '../../volumes/hard/hill.nrrd'\n"
    )
}

fn names(cost: &Cost) -> Vec<&str> {
    cost.sweeps.iter().map(|sweep| sweep.name).collect()
}

#[track_caller]
fn is_as_expected(sweep: &Sweep, expected: f64) {
    println!("{}: {:?}", sweep.name, sweep.order);
    assert_eq!(sweep.order.expected, Some(expected));
    assert_eq!(sweep.order.verdict, OrderVerdict::AsExpected, "{sweep:?}");
}

/// Emission and absorption by the midpoint rule: order 2 in what is continuous, against the integral itself; order 1
/// across the jumps between nearest nodes, against much finer steps.
#[test]
fn steps_along_a_ray() {
    let smooth = measured(&hill(""));
    assert_eq!(names(&smooth), ["step"]);
    let sweep = &smooth.sweeps[0];
    is_as_expected(sweep, 2.0);
    assert!(sweep.reference.method.starts_with("the integral"));
    // Half the step takes twice the lookups, but for whole blocks without opacity, which rays leap over.
    let [coarser, finest] = [7, 8].map(|level: usize| sweep.levels[level].work.lookups());
    assert!(
        (1.8..2.05).contains(&(finest / coarser)),
        "{coarser} {finest}"
    );
    let nearest = hill("interpolation = 'nearest'").replace("= 12", "= 48");
    let nearest = measured(&nearest).sweeps.swap_remove(0);
    assert_eq!(nearest.order.expected, Some(1.0));
    // Over the last three halvings: the reference, 32 times finer, is off by at most a 31st of the last error, which adds
    // log2(32/31)/3 = 0.015 to their mean order.
    let local = nearest.order.local[5..].iter().flatten();
    let mean = local.sum::<f64>() / 3.0;
    assert!((mean - 1.0).abs() < 0.1, "{mean}");
    assert!(
        nearest
            .reference
            .method
            .starts_with("the same image with steps of")
    );
}

/// With light there is a sweep without it beside, and one of the shadow's step; every setting of the finer half is better
/// than the one before.
#[test]
fn steps_with_shading_and_shadow() {
    let lit = measured(&hill(
        "step = '0.5 voxels'\n[classified.phong]\n[classified.shadow]\nreference_step = '1 voxel'",
    ));
    assert_eq!(names(&lit), ["step", "step without light", "shadow step"]);
    is_as_expected(&lit.sweeps[1], 2.0);
    let shadow = &lit.sweeps[2];
    assert_eq!(shadow.parameter, Parameter::ShadowStep);
    for sweep in &lit.sweeps {
        let errors: Vec<f64> = sweep.levels.iter().map(|level| level.error.l2).collect();
        assert!(
            errors.windows(2).skip(3).all(|pair| pair[1] < pair[0]),
            "{errors:?}"
        );
    }
    let effects: Vec<&str> = lit.effects.iter().map(|effect| &*effect.effect).collect();
    let alone = [
        "absorption and emission",
        "with gradient shading",
        "with volume shadow",
        "with both",
    ];
    assert_eq!(effects, alone);
    assert!(
        lit.recommendations[0]
            .text
            .contains("the scene's own steps of 0.5 voxels")
    );
}

/// What else is sampled has a price, too, though no order that is known: projections, several volumes among clips.
#[test]
fn modes_and_objects_have_errors_without_an_expected_order() {
    let clip = "[[classified.clip]]\npoint = [0.1, 0.1, 0.1]\nnormal = [1, 0.5, 0]\n";
    for text in [hill("mode = 'mean'"), format!("{}{clip}", hill(""))] {
        let cost = measured(&text);
        let sweep = &cost.sweeps[0];
        assert_eq!(sweep.order.verdict, OrderVerdict::NothingExpected);
        assert!(
            sweep.levels[8].error.l2 < 0.02 * sweep.levels[0].error.l2,
            "{sweep:?}"
        );
    }
}

/// Noise falls as the root of the samples.
#[test]
fn samples_per_pixel() {
    let cost = measured(
        "[film]\nwidth = 4\nheight = 4\n[camera]\neye = [0, 0, -3]\ntarget = [0, 0, 0]\n\
         [radiative]\nenvironment = 1\n[[radiative.medium]]\n\
         sphere = { centre = [0, 0, 0], radius = 1.5 }\nsigma_s = 1\nsigma_a = 0.5\n",
    );
    assert_eq!(names(&cost), ["samples"]);
    let found = &cost.sweeps[0].order;
    println!("{found:?}");
    let expected = [OrderVerdict::AsExpected, OrderVerdict::TooFewRays];
    assert_eq!(found.expected, Some(-0.5));
    assert!(expected.contains(&found.verdict), "{found:?}");
}

/// Requires an order, of what is known to `bound`.
#[track_caller]
fn falls_as(what: &str, expected: f64, values: &[f64], errors: &[Norms], bound: f64) {
    let found = order(values, errors, ExpectedOrder::of_step(expected), bound);
    println!(
        "{what}: order {:.3} of {expected}, of the largest error {:.3}",
        found.fitted.unwrap_or(f64::NAN),
        found.fitted_max.unwrap_or(f64::NAN)
    );
    assert_eq!(found.verdict, OrderVerdict::AsExpected, "{what}: {found:?}");
}

/// A smooth field: nothing of it is flat or straight.
fn blob() -> Blob {
    Blob {
        peak: 2.0,
        centre: DVec3::new(0.43, 0.52, 0.57),
        width: 0.35,
    }
}

/// The blob at the nodes of a grid of `count` cells a side in the unit box.
fn sampled(count: usize) -> Arc<Grid<f32>> {
    let lattice = Lattice::new(
        [count + 1; 3],
        DVec3::splat(1.0 / count as f64),
        DVec3::ZERO,
    )
    .unwrap();
    let values = (0..lattice.node_count())
        .map(|index| blob().density(lattice.position(lattice.node(index))) as f32);
    Arc::new(Grid::new(lattice, values.collect()).unwrap())
}

/// Rays through the unit box in all directions: along one that nearly is an axis, steps and cells
/// keep pace, and errors add up for long.
fn rays() -> Vec<Ray> {
    (0..2000)
        .map(|number| {
            let stream = Stream::new(3, number, 0);
            let u = |index: u32| stream.uniform(0, Purpose::Camera, index);
            let towards = DVec3::new(0.4 + u(0), 0.4 + u(1), 0.4 + u(2));
            let through = DVec3::new(0.2 + 0.6 * u(3), 0.2 + 0.6 * u(4), 0.2 + 0.6 * u(5));
            Ray::new(through - 3.0 * towards, towards).unwrap()
        })
        .collect()
}

/// Two ways to the integral of a grid along a ray, cell by cell, give the same number.
#[test]
fn cell_by_cell_nothing_is_left() {
    let grid = sampled(16);
    for interpolation in [Interpolation::Trilinear, Interpolation::Nearest] {
        let density = GridDensity::new(grid.clone(), interpolation);
        let collocation = Collocation::new();
        for ray in rays() {
            let span = density.bounds().span(&ray).unwrap();
            let exact = density.integral(ray.origin, *ray.direction, span, &mut 0);
            let mut cuts = vec![span.near];
            let pieces = density.smooth_segments(ray.origin, *ray.direction, span);
            cuts.extend(pieces.map(|piece| piece.far));
            let light = collocation.light(&cuts, 1e-14, |t| LocalProperties {
                extinction: density.density(ray.at(t)),
                emission: DVec3::ZERO,
            });
            // Roundings of some fifty cells each.
            assert!(
                (light.depth - exact).abs() < 1e-13,
                "{} {exact}",
                light.depth
            );
        }
    }
}

/// Numbers of cells a side, and the spacings they mean.
const CELLS: [usize; 5] = [8, 16, 32, 64, 128];

fn spacings() -> [f64; 5] {
    CELLS.map(|count| 1.0 / count as f64)
}

/// Finer data: trilinear interpolation has order 2, in points and in depths; the nearest node
/// order 1 in points. Grids are stored in 32 bits: what is below 1e-7 is not known.
#[test]
fn finer_data() {
    let points: Vec<DVec3> = (0..20_000)
        .map(|number| {
            let stream = Stream::new(5, number, 0);
            DVec3::from_array(std::array::from_fn(|axis| {
                stream.uniform(0, Purpose::Camera, axis as u32)
            }))
        })
        .collect();
    let pointwise = |interpolation: Interpolation| {
        CELLS.map(|count| {
            let density = GridDensity::new(sampled(count), interpolation);
            let mut errors = Vec::new();
            for point in &points {
                errors.push((density.density(*point) - blob().density(*point)) / 2.0);
            }
            norms(errors.into_iter(), 1.0)
        })
    };
    let trilinear = pointwise(Interpolation::Trilinear);
    falls_as("trilinear, in points", 2.0, &spacings(), &trilinear, 1e-9);
    let found = order(&spacings(), &trilinear, ExpectedOrder::of_step(2.0), 1e-9);
    assert!((found.fitted_max.unwrap() - 2.0).abs() <= 0.2);
    let nearest = pointwise(Interpolation::Nearest);
    falls_as("nearest, in points", 1.0, &spacings(), &nearest, 1e-9);
    let found = order(&spacings(), &nearest, ExpectedOrder::of_step(1.0), 1e-9);
    assert!((found.fitted_max.unwrap() - 1.0).abs() <= 0.2);

    let rays = rays();
    let depths = |interpolation: Interpolation| {
        CELLS.map(|count| {
            let density = GridDensity::new(sampled(count), interpolation);
            let mut errors = Vec::new();
            for ray in &rays {
                let span = density.bounds().span(ray).unwrap();
                let exact =
                    quadrature::integral(span.near, span.far, 64, |t| blob().density(ray.at(t)));
                let found = density.integral(ray.origin, *ray.direction, span, &mut 0);
                errors.push((found - exact) / exact);
            }
            norms(errors.into_iter(), 1.0)
        })
    };
    let trilinear = depths(Interpolation::Trilinear);
    falls_as("trilinear, in depths", 2.0, &spacings(), &trilinear, 1e-9);
    // Errors of neighbouring cells cancel along an oblique ray: better than order 1, by an amount
    // that depends on the rays.
    let nearest = depths(Interpolation::Nearest);
    let found = order(&spacings(), &nearest, ExpectedOrder::NOTHING, 1e-9);
    let fitted = found.fitted.unwrap();
    println!("nearest, in depths: order {fitted:.3}");
    assert!((1.1..2.1).contains(&fitted), "{fitted}");
}

/// Gradients of the same blob, at points away from the border: central differences, as they are
/// stored and interpolated, have order 2, forward differences and the derivative of the
/// interpolant itself order 1. Of the largest error, as directions of shading are.
#[test]
fn gradients_of_finer_data() {
    let points: Vec<DVec3> = (0..4000)
        .map(|number| {
            let stream = Stream::new(6, number, 0);
            DVec3::from_array(std::array::from_fn(|axis| {
                0.2 + 0.6 * stream.uniform(0, Purpose::Camera, axis as u32)
            }))
        })
        .collect();
    let right = |point: DVec3| {
        let blob = blob();
        (blob.centre - point) * (blob.density(point) / (blob.width * blob.width))
    };
    let along_x = |find: &dyn Fn(&GridDensity, DVec3, f64) -> f64| {
        CELLS.map(|count| {
            let density = GridDensity::new(sampled(count), Interpolation::Trilinear);
            let mut errors = Vec::new();
            for point in &points {
                errors.push(find(&density, *point, 1.0 / count as f64) - right(*point).x);
            }
            // Largest slope of the blob: peak/width · e^(−½).
            let all = norms(errors.into_iter(), 3.47);
            Norms { l2: all.max, ..all }
        })
    };
    let x = DVec3::X;
    let stored = CELLS.map(|count| {
        let gradients = gradients(&*sampled(count));
        let mut errors = Vec::new();
        for point in &points {
            let place = gradients.lattice().to_nodes(*point);
            let found = Cell::around(gradients.lattice(), place).trilinear(&gradients);
            errors.push(found.x - right(*point).x);
        }
        let all = norms(errors.into_iter(), 3.47);
        Norms { l2: all.max, ..all }
    });
    falls_as(
        "stored central differences",
        2.0,
        &spacings(),
        &stored,
        1e-9,
    );
    let central = along_x(&|density, point, h| {
        (density.density(point + x * h) - density.density(point - x * h)) / (2.0 * h)
    });
    falls_as(
        "central differences of the interpolant",
        2.0,
        &spacings(),
        &central,
        1e-9,
    );
    let forward =
        along_x(&|density, point, h| (density.density(point + x * h) - density.density(point)) / h);
    falls_as(
        "forward differences of the interpolant",
        1.0,
        &spacings(),
        &forward,
        1e-9,
    );
    let own = along_x(&|density, point, h| {
        // Between the nodes the interpolant is a straight line along x.
        let cell = (point.x / h).floor() * h;
        let at = |t: f64| density.density(DVec3::new(cell + t * h, point.y, point.z));
        (at(0.75) - at(0.25)) / (0.5 * h)
    });
    falls_as(
        "derivative of the interpolant",
        1.0,
        &spacings(),
        &own,
        1e-9,
    );
}
