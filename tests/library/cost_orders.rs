//! Orders of convergence and variances, against theory: what `volref cost` judges scenes by is
//! judged here, on rays and fields of which everything is known.
//!
//! A fitted order may be off by 0.1, by 0.2 in the largest error, as the tables of orders say:
//! what is left of the next term of an expansion in the steps that are fitted.

use crate::common::quadrature;
use crate::common::test_ray::{DEPTH, LENGTH, smooth};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use volref::cost::estimators::table;
use volref::cost::jitter::Jitter;
use volref::cost::marching::Scheme;
use volref::cost::norms::norms;
use volref::cost::order::{ExpectedOrder, order};
use volref::cost::profile::{BoundedSegment, Profile};
use volref::cost::results::{Norms, OrderVerdict};
use volref::cost::rules::StepRule;
use volref::cost::timing::Clock;
use volref::cost::{Options, cost};
use volref::geometry::{Ray, Span};
use volref::math::rng::{Purpose, Stream};
use volref::math::{cos, exp, sin};
use volref::optics::collocation::{Collocation, LocalProperties};
use volref::render::classified::steps::Steps;
use volref::scene::Scene;
use volref::volume::{
    Blob, Cell, DensityField, Grid, GridDensity, Interpolation, Lattice, gradients,
};

/// Steps of the smooth test ray, of length 2.
const STEPS: [f64; 7] = [
    0.25,
    0.125,
    0.0625,
    0.031_25,
    0.015_625,
    0.007_812_5,
    0.003_906_25,
];

const RADIANCE: f64 = 0.338_236_980_254_304_8;

fn here(t: f64) -> LocalProperties {
    LocalProperties {
        extinction: smooth(t),
        emission: DVec3::splat(0.7 + 0.5 * cos(5.1 * t + 0.3)),
    }
}

fn smooth_ray() -> Profile<'static> {
    Profile {
        segments: vec![BoundedSegment {
            span: Span::new(0.0, 2.0),
            // The smallest stands at 1.168, the largest at the end.
            low: 1.394,
            high: smooth(LENGTH),
        }],
        extinction: Box::new(|t, lookups| {
            *lookups += 1;
            smooth(t)
        }),
        kinks: vec![],
        densities: 1,
    }
}

fn one(error: f64) -> Norms {
    norms([error].into_iter(), 1.0)
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

#[test]
fn rules_for_the_depth_of_a_smooth_ray() {
    let ray = smooth_ray();
    for rule in StepRule::all() {
        let errors = STEPS.map(|step| one((rule.depth(&ray, step).0 - DEPTH) / DEPTH));
        falls_as(rule.name(), rule.order(), &STEPS, &errors, 1e-15);
        let errors = STEPS.map(|step| one(exp(DEPTH - rule.depth(&ray, step).0) - 1.0));
        falls_as(rule.name(), rule.order(), &STEPS, &errors, 1e-14);
    }
}

/// Variances and lookups of the estimators are those of theory, to the digits that are published,
/// and what they do agrees: means and variances within four standard errors, lookups within 5 %.
#[test]
fn estimators_keep_what_is_predicted_of_them() {
    let ray = smooth_ray();
    let table = table(
        "the smooth test ray".to_owned(),
        &ray,
        DEPTH,
        11,
        &Clock::NONE,
    );
    let predicted: Vec<_> = table.rows[..3]
        .iter()
        .map(|row| {
            (
                row.predicted_variance.unwrap(),
                row.predicted_lookups.unwrap(),
            )
        })
        .collect();
    let transmittance = exp(-DEPTH);
    let published = [
        (transmittance * (1.0 - transmittance), 2.2254),
        (9.83e-4, 9.597),
        (1.26e-4, 6.809),
    ];
    for ((variance, lookups), (published_variance, published_lookups)) in
        predicted.iter().zip(published)
    {
        // Published to three and to four or five digits.
        assert!(
            (variance / published_variance - 1.0).abs() < 5e-3,
            "{variance}"
        );
        assert!((lookups - published_lookups).abs() < 2e-3, "{lookups}");
    }
    for row in &table.rows {
        println!("{row:?}");
        assert!(row.agrees, "{row:?}");
    }
}

/// In matter of one density unbiased ray marching has no noise at all.
#[test]
fn a_constant_extinction_is_marched_without_noise() {
    let ray = Profile {
        segments: vec![BoundedSegment {
            span: Span::new(0.0, 2.0),
            low: 1.5,
            high: 1.5,
        }],
        extinction: Box::new(|_, lookups| {
            *lookups += 1;
            1.5
        }),
        kinks: vec![],
        densities: 1,
    };
    let table = table("one density".to_owned(), &ray, 3.0, 11, &Clock::NONE);
    let row = &table.rows[3];
    assert_eq!((row.variance, row.predicted_variance), (0.0, Some(0.0)));
    assert!(table.rows.iter().all(|row| row.agrees), "{table:?}");
}

/// The error of the trapezoid is minus twice that of the midpoint rule, to leading order.
#[test]
fn trapezoid_and_midpoint_err_to_opposite_sides() {
    let ray = smooth_ray();
    let error = |rule: StepRule| rule.depth(&ray, 1.0 / 256.0).0 - DEPTH;
    let ratio = error(StepRule::Trapezoid) / error(StepRule::Midpoint);
    // The next term is h² smaller: some 1e-5 of it.
    assert!((ratio + 2.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn rules_look_where_they_say() {
    let ray = smooth_ray();
    let lookups = |rule: StepRule| rule.depth(&ray, 0.25).1;
    assert_eq!(StepRule::all().map(lookups), [8, 8, 9, 17, 16]);
}

#[test]
fn schemes_of_emission_and_absorption() {
    for scheme in Scheme::all() {
        // A single ray has no standard deviation.
        if matches!(scheme, Scheme::Stratified | Scheme::Comb) {
            continue;
        }
        let errors = STEPS.map(|step| {
            let span = Span::new(0.0, 2.0);
            let (radiance, _) = scheme.march(&Steps::over(span, step), here, |_| 0.5);
            one((radiance.x - RADIANCE) / RADIANCE)
        });
        falls_as(scheme.name(), scheme.order(), &STEPS, &errors, 1e-14);
    }
}

/// Jitter measured on many rays: the standard deviation of what comes back.
#[test]
fn jittered_schemes() {
    for scheme in [Scheme::Stratified, Scheme::Comb] {
        let errors = STEPS.map(|step| {
            let mut errors = Vec::new();
            for number in 0..4000 {
                let stream = Stream::new(1, 0, number);
                let uniform = |index: usize| stream.uniform(0, Purpose::Tracking, index as u32);
                let span = Span::new(0.0, 2.0);
                let (radiance, _) = scheme.march(&Steps::over(span, step), here, uniform);
                errors.push((radiance.x - RADIANCE) / RADIANCE);
            }
            norms(errors.into_iter(), 1.0)
        });
        falls_as(scheme.name(), scheme.order(), &STEPS, &errors, 1e-14);
    }
}

#[test]
fn bias_and_variance_of_jittered_marching() {
    let ray = smooth_ray();
    for jitter in [Jitter::Comb, Jitter::Stratified] {
        let curve = jitter.curve(&ray, &STEPS, false);
        assert_eq!(
            curve.deviation_order.verdict,
            OrderVerdict::AsExpected,
            "{curve:?}"
        );
        assert_eq!(
            curve.bias_order.verdict,
            OrderVerdict::AsExpected,
            "{curve:?}"
        );
        for point in &curve.points[2..] {
            // Always too bright; ½ Var τ̂ is the leading term, the next is of third order in the
            // deviation.
            assert!(point.bias > 0.0);
            let left = (point.bias / point.predicted_bias - 1.0).abs();
            assert!(left < point.depth_deviation, "{point:?}");
        }
    }
}

/// A discontinuity at a place that no step knows: order 1 of every rule.
#[test]
fn across_a_jump_every_rule_has_order_one() {
    // By chance of where the jump lies a single ray errs by anything: many places tell.
    let places: Vec<f64> = (0..4000)
        .map(|i| 0.3 + 1.4 * f64::from(i) / 4000.0 + 1e-5)
        .collect();
    for rule in StepRule::all() {
        let errors = STEPS.map(|step| {
            let mut errors = Vec::new();
            for &place in &places {
                let jump = Profile {
                    extinction: Box::new(move |t, _| if t < place { 2.0 } else { 0.2 }),
                    ..smooth_ray()
                };
                errors.push(rule.depth(&jump, step).0 / (0.2 * 2.0 + 1.8 * place) - 1.0);
            }
            norms(errors.into_iter(), 1.0)
        });
        falls_as(rule.name(), 1.0, &STEPS, &errors, 1e-15);
    }
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

/// Extinction of a grid along a ray.
fn through(grid: &Arc<Grid<f32>>, interpolation: Interpolation, ray: Ray) -> Profile<'static> {
    let density = GridDensity::new(grid.clone(), interpolation);
    let span = density.bounds().span(&ray).unwrap();
    Profile {
        segments: vec![BoundedSegment {
            span,
            low: 0.0,
            high: 2.0,
        }],
        extinction: Box::new(move |t, lookups| {
            *lookups += 1;
            density.density(ray.at(t))
        }),
        kinks: vec![],
        densities: 1,
    }
}

/// Steps from a quarter of a cell on: of coarser ones that fit the cells as well as these do, the
/// errors are those of cells, and fall faster, then slower than their order.
const STEPS_IN_CELLS: [f64; 6] = [
    0.015_625,
    0.007_812_5,
    0.003_906_25,
    0.001_953_125,
    0.000_976_562_5,
    0.000_488_281_25,
];

/// On a fixed grid, against the integral of that grid: kinks between cells leave order 2, jumps
/// order 1; Gauss's rule cell by cell leaves nothing.
#[test]
fn rules_on_a_grid() {
    let grid = sampled(16);
    let rays = rays();
    for interpolation in [Interpolation::Trilinear, Interpolation::Nearest] {
        let density = GridDensity::new(grid.clone(), interpolation);
        let exact: Vec<f64> = rays
            .iter()
            .map(|ray| {
                let span = density.bounds().span(ray).unwrap();
                density.integral(ray.origin, *ray.direction, span, &mut 0)
            })
            .collect();
        let collocation = Collocation::new();
        for (ray, exact) in rays.iter().zip(&exact) {
            let span = density.bounds().span(ray).unwrap();
            let mut cuts = vec![span.near];
            let pieces = density.smooth_segments(ray.origin, *ray.direction, span);
            cuts.extend(pieces.map(|piece| piece.far));
            let light = collocation.light(&cuts, 1e-14, |t| LocalProperties {
                extinction: density.density(ray.at(t)),
                emission: DVec3::ZERO,
            });
            // Two ways to the same number, of some fifty cells each.
            assert!(
                (light.depth - exact).abs() < 1e-13,
                "{} {exact}",
                light.depth
            );
        }
        for rule in StepRule::all() {
            let errors = STEPS_IN_CELLS.map(|step| {
                let mut errors = Vec::new();
                for (ray, exact) in rays.iter().zip(&exact) {
                    let profile = through(&grid, interpolation, *ray);
                    errors.push((rule.depth(&profile, step).0 - exact) / exact);
                }
                norms(errors.into_iter(), 1.0)
            });
            let jumps = interpolation == Interpolation::Nearest;
            let name = format!("{} on {interpolation:?}", rule.name());
            falls_as(
                &name,
                rule.order_with_kinks(jumps),
                &STEPS_IN_CELLS,
                &errors,
                1e-15,
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

/// The centre of a pixel for its area: order 2 in a smooth image. Across a silhouette order 1 in
/// the mean, 1/2 in the root mean square, and none in the largest error: no gate on that can ever
/// pass, and silhouettes are left out.
#[test]
fn finer_pixels() {
    const SIDES: [usize; 6] = [8, 16, 32, 64, 128, 256];
    let sizes = SIDES.map(|side| 1.0 / side as f64);
    let errors = |image: &dyn Fn(f64, f64) -> f64| {
        SIDES.map(|side| {
            let mut errors = Vec::new();
            let at = |x: f64, y: f64| image(x / side as f64, y / side as f64);
            for index in 0..side * side {
                let (x, y) = ((index % side) as f64, (index / side) as f64);
                // Eight by eight points: 64 times nearer to the area than the centre is.
                let mut area = 0.0;
                for point in 0..64 {
                    let (right, down) = (f64::from(point % 8), f64::from(point / 8));
                    area += at(x + (right + 0.5) / 8.0, y + (down + 0.5) / 8.0) / 64.0;
                }
                errors.push(at(x + 0.5, y + 0.5) - area);
            }
            norms(errors.into_iter(), 1.0)
        })
    };
    let smooth = errors(&|x, y| 0.5 + 0.4 * sin(5.0 * x + 1.0) * cos(7.0 * y * x));
    falls_as("smooth image", 2.0, &sizes, &smooth, 1e-12);
    let disc = |x: f64, y: f64| {
        let (x, y) = (x - 0.512, y - 0.487);
        if x * x + y * y < 0.31 * 0.31 {
            1.0
        } else {
            0.0
        }
    };
    let silhouette = errors(&disc);
    let by = |norm: fn(&Norms) -> f64, expected: f64| {
        let errors: Vec<Norms> = silhouette
            .iter()
            .map(|error| Norms {
                l2: norm(error),
                ..*error
            })
            .collect();
        // Errors of half a pixel are no small ones; order wants those below a tenth.
        let small: Vec<Norms> = errors
            .iter()
            .map(|error| Norms {
                l2: 1e-3 * error.l2,
                ..*error
            })
            .collect();
        order(&sizes, &small, ExpectedOrder::of_step(expected), 1e-12)
            .fitted
            .unwrap()
    };
    let found = [by(|e| e.l1, 1.0), by(|e| e.l2, 0.5), by(|e| e.max, 0.0)];
    println!("silhouette: orders {found:?}");
    // Where the edge happens to cut pixels is chance: some hundred to a thousand of them.
    assert!((found[0] - 1.0).abs() < 0.1 && (found[1] - 0.5).abs() < 0.1);
    assert!(found[2].abs() < 0.1);
}

/// A whole scene: marching through its grid, tracking, and the estimators on one of its rays.
#[test]
fn orders_in_a_scene_with_a_grid() {
    let scene = Scene::load(Path::new("fixtures/scenes/procedural/absorbing-grid.toml")).unwrap();
    let options = Options {
        clock: Clock::NONE,
        seed: 0,
    };
    let costs = cost(&scene, "scene", &options, &|_| ()).unwrap();
    let study = &costs[0].studies[0];
    assert_eq!(study.name, "transmittance");
    for sweep in &study.sweeps {
        println!("{}: {:?}", sweep.estimator, sweep.order);
        let allowed = [
            OrderVerdict::AsExpected,
            OrderVerdict::TooFewRays,
            OrderVerdict::NothingExpected,
        ];
        assert!(allowed.contains(&sweep.order.verdict), "{sweep:?}");
    }
    let exact = study.sweeps.last().unwrap();
    assert_eq!(
        exact.levels[0].error.max, 0.0,
        "cell by cell is the reference"
    );
    let estimators = costs[0].estimators.as_ref().unwrap();
    for row in &estimators.rows {
        assert!(row.agrees, "{row:?}");
    }
    // Coarser data are worse, and the nearest node is worse than what lies between nodes.
    let data = &costs[0].studies[1];
    let error = |sweep: usize, level: usize| data.sweeps[sweep].levels[level].error.l2;
    assert!(error(0, 0) > error(0, 5) && error(1, 0) > error(1, 6));
    assert!(error(0, 5) < error(1, 5));
}
