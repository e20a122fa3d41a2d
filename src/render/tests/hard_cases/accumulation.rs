//! A: accumulation, order and reproducibility.

use super::margin::Margin;
use super::scenes::*;
use crate::film::Film;
use crate::geometry::{Aabb, Span};
use crate::math::rng::{Purpose, Stream};
use crate::math::{self, Moments, Sum};
use crate::optics::Layer;
use crate::optics::{Asymmetry, Field, opacity, source_factor};
use crate::render::classified::steps::Steps;
use crate::render::counters::Counters;
use crate::render::plan::RadiativeFeatures;
use crate::render::radiative::context::Scratch;
use crate::render::radiative::path_tracer::PathTracer;
use crate::render::radiative::sampler::Sampler;
use crate::render::{Effect, Plan, Sampling, State, render};
use crate::scene::{Classified, Model, Radiative, Scene};
use crate::volume::Blob;
use glam::DVec3;

#[test]
fn a1_a_million_thin_layers() {
    let margin = &Margin;
    let right = 0.632_120_742_768_355;
    let mut layers = Layer::EMPTY;
    let mut depth = Sum::default();
    for _ in 0..1_000_000 {
        layers = layers.over(Layer::sample(DVec3::ZERO, 1e-6));
        depth.add(-math::ln_1p(-1e-6));
    }
    margin.relative("product", layers.opacity, right, 1e-10);
    let held = 1.0 - layers.transparency;
    margin.relative("product of transparencies", held, right, 1e-10);
    margin.relative("sum of depths", opacity(depth.value()), right, 1e-15);
}

#[test]
fn a2_positions_do_not_drift() {
    let margin = &Margin;
    let steps = Steps::over(Span::new(0.0, 1e6), 0.1);
    margin.exact("steps", steps.count(), 10_000_000);
    let ulp = 1e6_f64.next_up() - 1e6;
    let ends = |index, right| {
        let (middle, length) = steps.sample(index);
        let what = format_args!("end of step {index}");
        margin.within(what, middle + 0.5 * length, right, ulp);
    };
    ends(steps.count() - 1, 1e6);
    for index in [0, 2, 12_345, 4_999_999, 9_999_998] {
        ends(index, (index + 1) as f64 * 0.1);
    }
}

#[test]
fn a3_compensated_sums_and_variances() {
    let margin = &Margin;
    let sum = Sum::from_iter([1.0, 1e100, 1.0, -1e100]).value();
    margin.exact("sum", sum, 2.0);
    for samples in [2, 10, 1000, 1_000_000] {
        let alternating = (0..samples).map(|i| 1e8 + f64::from(i % 2));
        let variance = Moments::from_iter(alternating).variance().unwrap();
        let right = 0.25 * f64::from(samples) / f64::from(samples - 1);
        margin.exact(format_args!("variance of {samples}"), variance, right);
    }
}

/// Fog of two kinds that overlap, coloured and forward, in the light of the sky.
fn fog() -> Radiative {
    let forward = Asymmetry::new(0.7).expect("within ±1");
    let forward = coloured(DVec3::splat(0.1), DVec3::new(0.3, 1.0, 2.0), forward);
    let blob = Field::Blob(Blob {
        centre: DVec3::ZERO,
        peak: 1.0,
        width: 0.5,
    });
    before_sky(vec![
        heterogeneous(cube(), blob, grey(3.0, 0.8, -0.3)),
        in_ball(ball(DVec3::X * 0.5, 0.75), forward),
    ])
}

/// From −1 to 1.
fn cube() -> Aabb {
    cuboid(DVec3::NEG_ONE, DVec3::ONE)
}

const SIZE: [usize; 2] = [12, 9];

fn picture(model: impl Into<Model>) -> Scene {
    scene_of(model, SIZE)
}

fn pictures() -> [(&'static str, Scene); 2] {
    [("fog", picture(fog())), ("plume", picture(plume(1.0)))]
}

#[test]
fn a4_threads() {
    let margin = &Margin;
    for (name, scene) in &pictures() {
        let with_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.ok().and_then(|pool| pool.install(|| bits(scene)))
        };
        for threads in [2, 3, 8] {
            let what = format_args!("{name} by {threads} threads");
            margin.same_picture(what, with_threads(threads), with_threads(1));
        }
    }
}

/// Pixel by pixel in other orders: each is what it is, whatever came before it.
#[test]
fn a4_orders_of_pixels() {
    let margin = &Margin;
    let (scene, [width, height]) = (fog(), SIZE);
    let tracer = PathTracer::new(&scene, None, RadiativeFeatures::ALL);
    let mut scratch = Scratch::default();
    let mut pixel = |index: usize| {
        let samples = (0..scene.samples).map(|sample| {
            let mut sampler = Sampler::new(Stream::new(scene.seed, index as u32, sample));
            let [x, y] = sampler.pair(Purpose::Camera, 0);
            let film_point = [(index % width) as f64 + x, (index / width) as f64 + y];
            let ray = scene.camera.ray_through(film_point, SIZE);
            let radiance = tracer.radiance(ray, sampler, &mut scratch, &mut Counters::default());
            radiance.unwrap_or(DVec3::NAN)
        });
        by_channel(samples).map(|moments| moments.mean() as f32)
    };
    let count = width * height;
    let rendered = film(&picture(scene.clone()));
    let rendered = rendered.map_or(vec![], |film| film.radiance().to_vec());
    let by_columns = |index: usize| index % height * width + index / height;
    // 29 and the number of pixels, 108, have no factor in common.
    let orders: [(&str, &dyn Fn(usize) -> usize); 4] = [
        ("by rows", &|index| index),
        ("backwards", &|index| count - 1 - index),
        ("by columns", &by_columns),
        ("in leaps", &|index| index * 29 % count),
    ];
    for (name, order) in orders {
        let mut found = vec![[f32::NAN; 3]; count];
        for index in (0..count).map(order) {
            found[index] = pixel(index);
        }
        margin.holds(format_args!("pixels {name}"), found == rendered);
    }
}

/// A number that stands for all bits of `values`: FNV-1a over their bytes, least first.
fn digest(values: impl Iterator<Item = f64>) -> String {
    let bytes = values.flat_map(|value| value.to_bits().to_le_bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

#[test]
fn a5_builds_and_platforms() {
    let margin = &Margin;
    type Function = fn(f64) -> f64;
    let functions: [(&str, Function, &str); 10] = [
        ("exp", |x| math::exp(40.0 * x - 20.0), "e284202e3008e380"),
        ("expm1", |x| math::exp_m1(2.0 * x - 1.0), "136f3e41c4e8ed19"),
        ("ln", |x| math::ln(x + 1e-9), "a88d85b6125f8cb2"),
        ("ln1p", |x| math::ln_1p(x - 0.5), "c9e0dba941cd6159"),
        ("sin", |x| math::sin(100.0 * x), "db8d9fcc091d8fc0"),
        ("cos", |x| math::cos(100.0 * x), "c8e573f02d990a8a"),
        ("tan", |x| math::tan(3.0 * x), "c021e8fb94d89bdd"),
        ("atan2", |x| math::atan2(x - 0.5, 0.3), "7d3d354f62878c2a"),
        ("pow", |x| math::pow(x, 2.4), "5d5fdc002e66394d"),
        ("source", |x| source_factor(30.0 * x), "17a5ff7cb0e97c6c"),
    ];
    for (name, function, right) in functions {
        let found = digest(numbers(51, 10_000).map(|[u, ..]| function(u)));
        let what = format_args!("{name} of 10 000 numbers");
        margin.exact(what, found.as_str(), right);
    }
    let right = ["73d23353a8dc4d3b", "1feaa3afd06709b0"];
    for ((name, scene), right) in pictures().into_iter().zip(right) {
        let pixels = film(&scene).map_or(vec![], |film| film.radiance().to_vec());
        let found = digest(pixels.iter().flatten().map(|&channel| channel.into()));
        margin.exact(format_args!("picture of {name}"), found.as_str(), right);
    }
}

#[test]
fn a6_null_effects() {
    let margin = &Margin;
    let plain = before_sky(vec![in_box(cube(), grey(1.0, 1.0, 0.0))]);
    let mut beside_nothing = plain.clone();
    let nothing = in_ball(ball(DVec3::X, 0.9), grey(0.0, 0.0, 0.0));
    beside_nothing.media.push(nothing);
    let mut of_no_density = plain.clone();
    let empty = Field::Blob(Blob {
        centre: DVec3::ZERO,
        peak: 0.0,
        width: 1.0,
    });
    let empty = heterogeneous(cube(), empty, grey(1.0, 1.0, 0.0));
    of_no_density.media.insert(0, empty);
    let transparent = Classified {
        phong: plume(1.0).phong,
        shadow: plume(1.0).shadow,
        ..classified(grid([5, 4, 3], DVec3::splat(0.3), |_| 0.0), by_formula(0.1))
    };
    let models: [(&str, Model); 4] = [
        ("fog", plain.into()),
        ("fog beside a medium of nothing", beside_nothing.into()),
        ("fog and a density of nothing", of_no_density.into()),
        ("a transparent volume", transparent.into()),
    ];
    let hash = |plan: Plan<'_>| {
        let rendering = render(&[plan], Sampling::default(), &|| ());
        rendering.map(|rendering| rendering.film.pixel_hash()).ok()
    };
    let hashes = models.map(|(name, model)| {
        let scene = picture(model);
        let panel = &scene.panels[0];
        let plan = Plan::new(panel);
        let can_be_forced = |effect: &Effect| {
            plan.state(*effect) == State::Elided && Plan::forcing(panel, &[*effect]).is_ok()
        };
        let null: Vec<Effect> = Effect::ALL.into_iter().filter(can_be_forced).collect();
        margin.holds(format_args!("{name}: something is null"), !null.is_empty());
        let bare = hash(plan);
        let alone = null.iter().map(std::slice::from_ref);
        for forced in alone.chain([&null[..]]) {
            let found = Plan::forcing(panel, forced).ok().and_then(hash);
            let what = format_args!("{name}, {forced:?} forced");
            margin.same_picture(what, found, bare.clone());
        }
        bare
    });
    // A medium of nothing is no medium.
    let [plain, beside_nothing, of_no_density, _] = hashes;
    margin.same_picture("beside a medium of nothing", beside_nothing, plain.clone());
    margin.same_picture("and a density of nothing", of_no_density, plain);
}

#[test]
fn a7_no_bad_pixel() {
    let margin = &Margin;
    // A film that holds one is found out, with its place.
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-30] {
        let mut pixels = vec![[0.5_f32; 3]; 12];
        pixels[7][1] = bad;
        let found = Film::new(4, 3, pixels).first_without_radiance();
        let place = found.map(|(film_point, _)| film_point);
        margin.exact(format_args!("{bad}"), place, Some([3, 1]));
    }
    // Nothing that is rendered here is one: densities from the least to the largest, a medium that
    // lets nothing through, and light that is all but scattered back.
    let dense = |sigma, g| before_sky(vec![in_box(cube(), grey(sigma, 0.5, g))]);
    let voxels = |value: f32| Classified {
        phong: plume(1.0).phong,
        ..classified(
            grid([3; 3], DVec3::splat(0.5), |[i, ..]| value * i as f32 / 2.0),
            table(vec![point(1.0, 0.5, DVec3::ONE)], 1e-3),
        )
    };
    let models: [Model; 9] = [
        dense(1e-300, 0.0).into(),
        dense(1e9, 0.9).into(),
        dense(3.0, LAST).into(),
        dense(3.0, -LAST).into(),
        fog().into(),
        plume(1.0).into(),
        voxels(1e-45).into(),
        voxels(1.0).into(),
        voxels(f32::MAX).into(),
    ];
    for (index, model) in models.into_iter().enumerate() {
        let film = film(&picture(model));
        let bad = film.map(|film| film.first_without_radiance());
        margin.exact(format_args!("picture {index}"), bad, Some(None));
    }
}
