//! D: data and grids.

use super::margin::Margin;
use super::scenes::*;
use super::test_ray::{LENGTH, SQUARED, TRANSMITTANCE, by_delta, by_last_number, by_ratio, smooth};
use crate::geometry::{Camera, Direction, Ray, Span};
use crate::math::quadrature::integrate;
use crate::math::rng::Stream;
use crate::math::{Moments, Sum, exp, exp_m1, log2};
use crate::optics::{Phong, optical_depth, transmittance};
use crate::render::classified::steps::Steps;
use crate::render::counters::Counters;
use crate::render::plan::RadiativeFeatures;
use crate::render::radiative::sampler::Sampler;
use crate::render::radiative::scene_context::SceneContext;
use crate::render::radiative::tracker::{Tracker, TrackerScratch};
use crate::render::radiative::visibility::Visibility;
use crate::render::{Effect, Event, Plan, Sampling, render};
use crate::scene::{Classified, Model};
use crate::volume::{
    Centring, DensityField, Grid, GridDensity, Interpolation, Lattice, LoadOptions, NonFinite,
    read_volume,
};
use glam::DVec3;
use std::sync::Arc;

const BOTH: [Interpolation; 2] = [Interpolation::Nearest, Interpolation::Trilinear];

/// `∫ density dt` along `ray`, and how long the ray is in the box.
fn depth(density: &GridDensity, ray: &Ray) -> (f64, f64) {
    let inside = density.bounds().span(ray).unwrap_or(Span::new(0.0, 0.0));
    let depth = density.integral(ray, inside, &mut 0);
    (depth, inside.length())
}

#[test]
fn d1_constant_grid() {
    let margin = &Margin;
    let constant = grid([5, 4, 3], DVec3::splat(0.3), |_| 0.7);
    for interpolation in BOTH {
        let density = GridDensity::new(constant.clone(), interpolation);
        for [u, v, w] in numbers(41, 500) {
            // From around the box to a point in it.
            let origin = DVec3::new(3.0 * u, 3.0 * v, 3.0 * w) - 1.0;
            let target = DVec3::new(1.2 * v, 0.9 * w, 0.6 * u);
            let Some(ray) = Ray::new(origin, target - origin) else {
                continue;
            };
            let (depth, length) = depth(&density, &ray);
            let right = f64::from(0.7_f32) * length;
            margin.relative(format_args!("{origin} to {target}"), depth, right, 1e-14);
        }
    }
}

#[test]
fn d2_trilinear_cell() {
    let margin = &Margin;
    let product = grid([2; 3], DVec3::ONE, |[i, j, k]| (i * j * k) as f32);
    let density = GridDensity::new(product, Interpolation::Trilinear);
    // ∫ (t/√3)³ dt from 0 to √3; one sample in the middle would find half of it.
    let (depth, _) = depth(&density, &ray([0.0; 3], [1.0; 3]));
    margin.roundings("xyz along the diagonal", depth, 3.0_f64.sqrt() / 4.0, 8.0);
}

#[test]
fn d3_one_voxel() {
    let margin = &Margin;
    let lattices = [
        ([1, 1, 1], 0),
        ([1, 16, 16], 0),
        ([16, 1, 16], 1),
        ([4, 4, 1], 2),
    ];
    for (nodes, axis) in lattices {
        for centring in [Centring::Nodes, Centring::Cells] {
            let lattice = Lattice::new(nodes, DVec3::splat(0.5), DVec3::ZERO)
                .and_then(|lattice| lattice.with_centring(centring))
                .expect("a lattice");
            let values = vec![2.0; lattice.node_count()];
            let grid = Arc::new(Grid::new(lattice, values).expect("a value for each node"));
            for interpolation in BOTH {
                let density = GridDensity::new(grid.clone(), interpolation);
                let mut origin = density.bounds().centre();
                origin[axis] = -10.0;
                let (depth, length) = depth(&density, &ray(origin, DVec3::AXES[axis]));
                let what = format!("{nodes:?}, {centring:?}, {interpolation:?}");
                margin.relative(format_args!("{what}: length"), length, 0.5, 1e-14);
                margin.relative(format_args!("{what}: depth"), depth, 1.0, 1e-14);
            }
        }
    }
}

#[test]
fn d4_upper_bound() {
    let margin = &Margin;
    let ramp = grid([4; 3], DVec3::ONE, |[i, _, _]| i as f32);
    let below = 3.0_f64.next_down();
    // The ramp itself is that much lower below; a nearest voxel is the last one.
    for (interpolation, right) in BOTH.into_iter().zip([3.0, below]) {
        let density = GridDensity::new(ramp.clone(), interpolation);
        let at = |x: f64| density.density(DVec3::new(x, 1.5, 1.5));
        margin.exact(format_args!("{interpolation:?}: at it"), at(3.0), 3.0);
        margin.exact(format_args!("{interpolation:?}: below"), at(below), right);
        let beyond = ray([3.0_f64.next_up(), 1.5, -1.0], DVec3::Z);
        margin.exact("beyond", density.bounds().span(&beyond), None);
    }
}

#[test]
fn d5_anisotropic_spacing() {
    let margin = &Margin;
    let sigma = 0.5;
    let constant = grid([5, 4, 3], [1.0, 2.0, 4.0], |_| 1.0);
    for interpolation in BOTH {
        let density = GridDensity::new(constant.clone(), interpolation);
        let scene = before_sky(vec![in_grid(&density, grey(sigma, 0.0, 0.0))]);
        for towards in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
            let ray = ray(density.bounds().centre() - 20.0 * towards, towards);
            let (depth, length) = depth(&density, &ray);
            let what = format_args!("{interpolation:?}, along {towards}");
            margin.relative(what, sigma * depth, sigma * length, 1e-14);
            let seen = straight(&scene, &ray).x;
            let right = transmittance(optical_depth(sigma, length));
            // An error of the depth is one of the transmittance, τ times as large.
            let share = 1e-14 * sigma * length;
            margin.relative(format_args!("seen along {towards}"), seen, right, share);
        }
    }
}

#[test]
fn d6_empty_space() {
    let margin = &Margin;
    // Whether only the sky is seen, and after how many lookups.
    let seen = |model: Model| {
        rendered(&scene_of(model, [8, 8])).map(|rendering| {
            let mut pixels = rendering.film.radiance().iter();
            let is_sky = pixels.all(|&pixel| pixel == [1.0; 3]);
            (is_sky, rendering.work[0][Event::DensityLookup])
        })
    };
    let empty = grid([33, 9, 9], DVec3::splat(1.0 / 16.0), |_| 0.0);
    // Something in the first blocks along x only, out of sight.
    let one_side = grid([65, 9, 9], DVec3::splat(1.0 / 16.0), |[i, _, _]| {
        if i < 5 { 1.0 } else { 0.0 }
    });
    for (name, grid, beside) in [("empty", empty, 0.0), ("beside some", one_side, 3.0)] {
        let middle = DVec3::new(beside, 0.25, 0.25);
        let camera = Camera::new(middle - DVec3::Z * 3.0, middle, DVec3::Y, 0.1).expect("a view");
        let density = GridDensity::new(grid.clone(), Interpolation::Trilinear);
        let mut scene = before_sky(vec![in_grid(&density, grey(5.0, 0.8, 0.0))]);
        scene.camera = camera;
        let volume = Classified {
            background: DVec3::ONE,
            camera,
            ..classified(grid, by_formula(0.1))
        };
        for (kind, model) in [("fog", Model::from(scene)), ("volume", volume.into())] {
            margin.exact(format_args!("{name}: {kind}"), seen(model), Ok((true, 0)));
        }
    }
}

#[test]
fn d7_bright_voxel_on_a_border() {
    let margin = &Margin;
    const SAMPLES: u32 = 40_000;
    let spacing = DVec3::new(2.0 / 32.0, 0.25, 0.25);
    let spike = grid([33, 9, 9], spacing, |node| {
        if node == [8, 4, 4] { 50.0 } else { 0.0 }
    });
    let density = GridDensity::new(spike, Interpolation::Trilinear);
    let bound = |block| density.blocks().range_in(block).high;
    for block in [[0, 0, 0], [1, 0, 0]] {
        let what = format_args!("the bound of block {block:?} covers the spike");
        margin.holds(what, bound(block) >= 50.0);
    }
    margin.exact("bound of a block beyond", bound([2, 0, 0]), 0.0);
    // Past the spike, by a third of a cell in x and a quarter of one in y: a triangle of that share
    // of its height over two cells of 0.25.
    let view = ray([spacing.x * (8.0 + 1.0 / 3.0), 0.25 * 4.25, -1.0], DVec3::Z);
    let right = exp(-(0.2 * 50.0 * (2.0 / 3.0) * 0.75 * 0.25));
    let body = |albedo| before_sky(vec![in_grid(&density, grey(0.2, albedo, 0.0))]);
    // The place on the ray is rounded in units of a cell of 1/16.
    margin.roundings("by integrals", straight(&body(0.0), &view).x, right, 64.0);
    let scene = body(1.0);
    let around = SceneContext::new(&scene, RadiativeFeatures::ALL);
    let mut scratch = TrackerScratch::default();
    let by_ratio = (0..SAMPLES).map(|sample| {
        let mut work = Counters::default();
        let sampler = Sampler::new(Stream::new(3, 0, sample));
        let mut tracker = Tracker::new(sampler, &mut scratch, &mut work);
        Visibility(&around)
            .along(&view, f64::INFINITY, &mut tracker)
            .x
    });
    margin.sampled("by ratio tracking", &Moments::from_iter(by_ratio), right);
    let [by_delta, ..] = sampled(&scene, Some(0), SAMPLES, view);
    margin.sampled("by delta tracking", &by_delta, right);
    margin.exact("violations of the bound", scratch.effort.violations, 0);
}

#[test]
fn d8_discontinuous_density() {
    let margin = &Margin;
    // Depth by steps, against what follows from the place of the edge.
    let error = |count: u32, edge: f64| {
        let steps = Steps::over(Span::new(0.0, LENGTH), LENGTH / f64::from(count));
        let of_step = |index| {
            let (middle, length) = steps.sample(index);
            optical_depth(if middle > edge { 2.0 } else { 0.2 }, length)
        };
        let depth = Sum::from_iter((0..steps.count()).map(of_step)).value();
        depth - (0.2 * edge + 2.0 * (LENGTH - edge))
    };
    // Over many places of the edge, for at one of them the error is as it falls out. Along a
    // refinement by 64 the spread of the mean of 2000 is below 0.02 of an order.
    let mean_error = |count: u32| {
        let errors = numbers(48, 2000).map(|[u, ..]| error(count, LENGTH * u).abs());
        Sum::from_iter(errors).value() / 2000.0
    };
    let order = log2(mean_error(16) / mean_error(1024)) / 6.0;
    margin.within("order of marching", order, 1.0, 0.15);

    let edge = 0.731_415;
    let sigma = |t: f64| if t > edge { 2.0 } else { 0.2 };
    let right = exp(-(0.2 * edge + 2.0 * (LENGTH - edge)));
    for (name, found) in [
        ("delta tracking", by_delta(&sigma, 2.0, 100_000)),
        ("ratio tracking", by_ratio(&sigma, 2.0, 100_000)),
    ] {
        margin.sampled(name, &found.moments, right);
        margin.exact(format_args!("{name}: violations"), found.violations, 0);
    }
    // A grid of nearest voxels, cut at its faces: no steps, and no order.
    let voxels = grid([8, 1, 1], DVec3::splat(0.25), |[i, _, _]| {
        if i > 2 { 2.0 } else { 0.25 }
    });
    let density = GridDensity::new(voxels, Interpolation::Nearest);
    let (found, _) = depth(&density, &ray([-1.0, 0.0, 0.0], DVec3::X));
    // From the first node to the last, the face between nodes 2 and 3 lies at 0.625.
    margin.roundings("voxels", found, 0.25 * 0.625 + 2.0 * (1.75 - 0.625), 8.0);
}

/// Four voxels a side in the NRRD format, of which node 57, (1, 2, 3), is `odd`.
fn nrrd_with(odd: &str) -> String {
    let mut values = ["1"; 64];
    values[57] = odd;
    let head = "NRRD0004\ntype: float\ndimension: 3\nsizes: 4 4 4\nencoding: ascii";
    format!("{head}\n\n{}\n", values.join(" "))
}

#[test]
fn d9_voxels_that_are_no_densities() {
    let margin = &Margin;
    for text in ["nan", "inf", "-inf"] {
        let file = nrrd_with(text);
        let refused = read_volume("grid.nrrd", file.as_bytes(), None, &LoadOptions::default());
        let message = refused.map_or_else(|error| error.to_string(), |_| String::new());
        let is_named = message.contains("(1, 2, 3)") && message.to_lowercase().contains(text);
        let what = format_args!("{text} is refused by node and value: {message}");
        margin.holds(what, is_named);
        let options = LoadOptions {
            non_finite: NonFinite::Replaced(0.0),
            ..LoadOptions::default()
        };
        match read_volume("grid.nrrd", file.as_bytes(), None, &options) {
            Ok(grid) => {
                margin.exact(format_args!("{text}, replaced"), grid.values()[57], 0.0);
                let volume = classified(Arc::new(grid), by_formula(1.0));
                let picture = rendered(&scene_of(volume, [8, 8]));
                let bad = picture.map(|rendering| rendering.film.first_without_radiance());
                margin.exact(format_args!("picture, {text} replaced"), bad, Ok(None));
            }
            Err(error) => margin.holds(format_args!("{text} can be replaced: {error}"), false),
        }
    }
    for wrong in [-1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let grid = grid([4; 3], DVec3::ONE, |node| {
            if node == [1, 2, 3] { wrong } else { 1.0 }
        });
        let refused = grid.check_densities().map_err(|error| error.message);
        let right = format!("voxel (1, 2, 3) holds {wrong}: ");
        let named = refused.is_err_and(|message| message.starts_with(&right));
        margin.holds(format_args!("a density of {wrong}"), named);
    }
}

#[test]
fn d10_subnormal_and_huge_voxels() {
    let margin = &Margin;
    for (value, right) in [(1e-45_f32, 1.0), (f32::MAX, 0.0)] {
        let voxels = grid([3; 3], DVec3::ONE, |_| value);
        let density = GridDensity::new(voxels, Interpolation::Trilinear);
        let view = ray([-1.0, 0.7, 0.7], [1.0, 0.1, 0.1]);
        let (depth, _) = depth(&density, &view);
        let what = format_args!("voxels of {value:e}");
        margin.exact(what, transmittance(depth), right);
        // Voxels of 1e-310 and 1e300 are these with a coefficient: what overflows lets nothing
        // through, what underflows all.
        for sigma in [1e-272, 1e262] {
            let scene = before_sky(vec![in_grid(&density, grey(sigma, 0.0, 0.0))]);
            let is_dense = f64::from(value) * sigma > 1.0;
            let right = if is_dense { 0.0 } else { 1.0 };
            let what = format_args!("voxels of {value:e}, sigma {sigma:e}");
            margin.exact(what, straight(&scene, &view).x, right);
        }
    }
}

#[test]
fn d11_bound_too_small() {
    let margin = &Margin;
    let bound = 2.0;
    let ratio = by_ratio(&smooth, bound, 400_000);
    margin.holds("violations are counted", ratio.violations > 0);
    margin.sampled("ratio tracking, forced", &ratio.moments, TRANSMITTANCE);
    // Of 400 000 samples whose fourth moment is that of these, the variance is known to 1 %.
    // T² (exp(∫ σ²/σ̄ dt) − 1): Novák, Selle & Jarosz 2014, ACM TOG 33(6), 179.
    let right = TRANSMITTANCE * TRANSMITTANCE * exp_m1(SQUARED / bound);
    let found = ratio.moments.variance().unwrap_or(f64::NAN);
    margin.relative("its variance", found, right, 0.04);
    // Delta tracking never sees more than the bound: almost three times the answer.
    let delta = by_delta(&smooth, bound, 100_000);
    margin.holds("those of delta tracking, too", delta.violations > 0);
    let seen = integrate(|t| DVec3::splat(smooth(t).min(bound)), 0.0, LENGTH, 1e-12);
    let biased = exp(-seen.value.x);
    margin.sampled("delta tracking, forced", &delta.moments, biased);
    margin.within("what it was known to find", biased, 0.0245, 5e-4);
    let honest = by_delta(&smooth, smooth(LENGTH), 100_000);
    margin.exact("violations of the right bound", honest.violations, 0);
    margin.sampled("delta tracking", &honest.moments, TRANSMITTANCE);
}

#[test]
fn d12_extinction_at_its_bound() {
    let margin = &Margin;
    // With the last of all random numbers a collision is real where the extinction is the bound, and
    // leaves numbers where it is not, in every channel.
    for bound in [1.5_f64, 2.0_f64.next_down(), 1.0] {
        let (collided, survived) = by_last_number(DVec3::splat(bound), bound);
        margin.holds(format_args!("the last number is real at {bound}"), collided);
        margin.exact(format_args!("weight at {bound}"), survived, DVec3::ONE);
        let odd = DVec3::new(bound.next_down(), bound, 0.0);
        let (_, survived) = by_last_number(odd, bound);
        let numbers = survived.is_finite() && survived.min_element() >= 0.0;
        let what = format_args!("weights {survived} at an ulp below {bound}");
        margin.holds(what, numbers);
        for sigma in [bound, bound.next_down()] {
            let right = exp(-sigma * LENGTH);
            for (name, found) in [
                ("delta", by_delta(&|_| sigma, bound, 40_000)),
                ("ratio", by_ratio(&|_| sigma, bound, 40_000)),
            ] {
                let what = format_args!("{name}, {sigma} of {bound}");
                margin.sampled(what, &found.moments, right);
            }
        }
    }
    // A grid of two values that differ by an ulp, tracked by the renderer; nothing scatters in what
    // it is held against, an integral.
    let below = 1.0_f32.next_down();
    let nearly = grid([5; 3], DVec3::splat(0.5), |[i, j, k]| {
        if (i + j + k) % 2 == 0 { 1.0 } else { below }
    });
    let nearly = GridDensity::new(nearly, Interpolation::Trilinear);
    let scene = |albedo| before_sky(vec![in_grid(&nearly, grey(0.8, albedo, 0.0))]);
    let view = ray([0.7, 0.9, -3.0], DVec3::Z);
    let right = straight(&scene(0.0), &view).x;
    let [found, ..] = sampled(&scene(0.875), Some(0), 40_000, view);
    margin.sampled("a grid an ulp below its bound", &found, right);
}

#[test]
fn d14_zero_gradient() {
    let margin = &Margin;
    let phong = Phong {
        ambient: 0.1,
        diffuse: 1.0,
        specular: 1.0,
        shininess: 32,
    };
    let colour = DVec3::new(0.2, 0.5, 0.9);
    let shaded = phong.shade(colour, DVec3::ZERO, Some(Direction::Y), Direction::Z);
    margin.exact("no gradient: the colour as it is", shaded, colour);
    // A constant volume, shaded, is the same volume unshaded; what is null is forced, so that
    // gradients are asked for.
    let constant = classified(grid([4; 3], DVec3::splat(0.25), |_| 0.5), by_formula(0.5));
    let picture = |phong, forced: &[Effect]| {
        let volume = Classified {
            phong,
            ..constant.clone()
        };
        let scene = scene_of(volume, [8, 8]);
        let plan = Plan::forcing(&scene.panels[0], forced).ok()?;
        let rendering = render(&[plan], Sampling::default(), &|| ()).ok()?;
        let asked = rendering.work[0][Event::GradientLookup] > 0;
        Some((rendering.film.pixel_hash(), asked))
    };
    let (shaded, asked) = picture(
        Some(phong),
        &[Effect::GradientShading, Effect::Heterogeneity],
    )
    .unzip();
    margin.exact("gradients are asked for", asked, Some(true));
    let (plain, _) = picture(None, &[]).unzip();
    margin.same_picture("a constant volume, shaded", shaded, plain);
}

#[test]
fn d14_touched_surfaces() {
    let margin = &Margin;
    // A surface: opaque from 1 on, and nothing below. The field is 1 at one node only, so that the
    // surface is a point of it, and a ray through that node touches it without crossing.
    let ends = [0.0, 1.0].map(|opacity| point(1.0, opacity, DVec3::Y));
    let surface = table(ends.into(), 1.0);
    let touched = grid(
        [5; 3],
        DVec3::ONE,
        |node| if node == [2; 3] { 1.0 } else { 0.25 },
    );
    // On a plane of nodes, two layers thick, the value is exactly that of the surface.
    let exact = grid([5; 3], DVec3::ONE, |[.., k]| if k >= 2 { 1.0 } else { 0.0 });
    for (name, grid, x, hit) in [
        ("touched", &touched, 2.0, true),
        ("beside", &touched, 2.0_f64.next_up(), false),
        ("equal to a voxel", &exact, 1.3, true),
    ] {
        let eye = DVec3::new(x, 2.0, -1.0);
        let volume = Classified {
            // From z = 0 on: the third sample lies at 2 exactly.
            step: 0.8,
            camera: Camera::new(eye, eye + DVec3::Z, DVec3::Y, 0.7).expect("a view"),
            ..classified(grid.clone(), surface.clone())
        };
        let film = film(&scene_of(volume, [1, 1])).expect("a picture");
        // A second hit would add to it, none would leave it black.
        let right = if hit {
            ([0.0, 1.0, 0.0], 1.0)
        } else {
            ([0.0; 3], 0.0)
        };
        let found = (film.radiance()[0], film.opacity().expect("opacity")[0]);
        margin.exact(format_args!("{name}: colour and opacity"), found, right);
    }
}
