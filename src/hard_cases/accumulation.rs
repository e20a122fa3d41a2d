//! A: accumulation, order and reproducibility.

use super::Row;
use super::margin::Margin;
use super::scenes::*;
use crate::film::Film;
use crate::geometry::Span;
use crate::math::rng::{Purpose, Stream};
use crate::math::{self, Moments, Sum};
use crate::media::Field;
use crate::media::{
    Appearance, Asymmetry, TransferFunction, TransferPoint, TransferPoints, opacity, source_factor,
};
use crate::render::classified::compositing::{CompositingOrder, FrontToBack, Layers};
use crate::render::classified::steps::Steps;
use crate::render::counters::Uncounted;
use crate::render::radiative::context::Scratch;
use crate::render::radiative::effects::Everything;
use crate::render::radiative::path_tracer::PathTracer;
use crate::render::radiative::sampler::Sampler;
use crate::render::{Effect, Plan, Sampling, State, render};
use crate::scene::{Classified, Model, Radiative, Scene};
use crate::volume::{Blob, ConstantDensity};
use glam::DVec3;

pub const ROWS: &[Row] = &[
    Row {
        id: "A1",
        what: "a million thin layers",
        tolerance: "1e-10 by the product, 1e-15 by the sum of depths",
        remedy: "transparency beside opacity; sums of depths are compensated",
        file: "src/render/classified/compositing.rs",
        check: a1_a_million_thin_layers,
    },
    Row {
        id: "A2",
        what: "positions after ten million steps",
        tolerance: "1 unit in the last place",
        remedy: "positions follow from an index",
        file: "src/render/classified/steps.rs",
        check: a2_positions_do_not_drift,
    },
    Row {
        id: "A3",
        what: "sums and variances of numbers of very different size",
        tolerance: "exact",
        remedy: "Neumaier's sum, and deviations from a running mean",
        file: "src/math/moments.rs",
        check: a3_compensated_sums_and_variances,
    },
    Row {
        id: "A4",
        what: "1, 2, 3 and 8 threads, and four orders of the pixels",
        tolerance: "exact",
        remedy: "random numbers are a function of pixel, sample and use; sums are in a fixed order",
        file: "src/math/rng.rs",
        check: a4_threads_and_orders,
    },
    Row {
        id: "A5",
        what: "builds and platforms: functions and pictures have the bits written down here",
        tolerance: "exact",
        remedy: "one pinned implementation of every transcendental function, and no fused multiply-add",
        file: "src/math/elementary.rs",
        check: a5_builds_and_platforms,
    },
    Row {
        id: "A6",
        what: "effects that are simulated although null",
        tolerance: "exact",
        remedy: "random numbers have a purpose in their name: one effect more moves no other's",
        file: "src/math/rng.rs",
        check: a6_null_effects,
    },
    Row {
        id: "A7",
        what: "no pixel that is not finite, or negative",
        tolerance: "exact",
        remedy: "every film is looked through before it is given out, and the pixel is named",
        file: "src/render/pixels.rs",
        check: a7_no_bad_pixel,
    },
];

fn a1_a_million_thin_layers(margin: &mut Margin) {
    let right = 0.632_120_742_768_355;
    let mut layers = Layers::default();
    let mut depth = Sum::default();
    for _ in 0..1_000_000 {
        layers = FrontToBack::add(layers, DVec3::ZERO, 1e-6);
        depth.add(-math::ln_1p(-1e-6));
    }
    margin.within("product", layers.opacity, right, 1e-10 * right);
    margin.within(
        "product of transparencies",
        1.0 - layers.transparency,
        right,
        1e-10 * right,
    );
    margin.within(
        "sum of depths",
        opacity(depth.value()),
        right,
        1e-15 * right,
    );
}

fn a2_positions_do_not_drift(margin: &mut Margin) {
    let span = Span {
        near: 0.0,
        far: 1e6,
    };
    let steps = Steps::over(span, 0.1);
    let (middle, length) = steps.sample(steps.count() - 1);
    let ulp = 1e6_f64.next_up() - 1e6;
    margin.within("end of the last step", middle + 0.5 * length, 1e6, ulp);
    margin.exact("steps", steps.count(), 10_000_000);
    for index in [0, 2, 12_345, 4_999_999, 9_999_998] {
        let (middle, length) = steps.sample(index);
        let what = format_args!("end of step {index}");
        margin.within(what, middle + 0.5 * length, (index + 1) as f64 * 0.1, ulp);
    }
}

fn a3_compensated_sums_and_variances(margin: &mut Margin) {
    margin.exact(
        "sum",
        Sum::from_iter([1.0, 1e100, 1.0, -1e100]).value(),
        2.0,
    );
    for samples in [2, 10, 1000, 1_000_000] {
        let alternating = (0..samples).map(|i| 1e8 + f64::from(i % 2));
        let variance = Moments::from_iter(alternating).population_variance();
        margin.exact(format_args!("variance of {samples}"), variance, 0.25);
    }
}

/// Fog of two kinds that overlap, coloured and forward, in the light of the sky.
fn fog() -> Radiative {
    let forward = coloured(
        DVec3::splat(0.1),
        DVec3::new(0.3, 1.0, 2.0),
        Asymmetry::new(0.7).expect("within ±1"),
    );
    let blob = Field::Blob(Blob {
        centre: DVec3::ZERO,
        peak: 1.0,
        width: 0.5,
    });
    let bounds = cuboid(DVec3::NEG_ONE, DVec3::ONE);
    before_sky(vec![
        heterogeneous(bounds, blob, grey(3.0, 0.8, -0.3)),
        in_ball(ball(DVec3::X * 0.5, 0.75), forward),
    ])
}

const SIZE: [usize; 2] = [12, 9];

fn picture(model: Model) -> Scene {
    scene_of(model, SIZE)
}

fn pictures() -> [(&'static str, Scene); 2] {
    [
        ("fog", picture(Model::Radiative(Box::new(fog())))),
        ("plume", picture(Model::Classified(Box::new(plume(1.0))))),
    ]
}

/// The film of `scene`, or nothing where it has none.
fn film(scene: &Scene) -> Option<Film> {
    rendered(scene).ok().map(|rendering| rendering.film)
}

fn a4_threads_and_orders(margin: &mut Margin) {
    for (name, scene) in &pictures() {
        let with_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.ok().and_then(|pool| pool.install(|| film(scene)))
        };
        let one = with_threads(1).map(|film| film.pixel_hash());
        margin.holds(format_args!("{name} has a picture"), one.is_some());
        for threads in [2, 3, 8] {
            let many = with_threads(threads).map(|film| film.pixel_hash());
            margin.exact(
                format_args!("{name} by {threads} threads"),
                many,
                one.clone(),
            );
        }
    }
    // Pixel by pixel in other orders: each is what it is, whatever came before it.
    let (scene, [width, height]) = (fog(), SIZE);
    let tracer = PathTracer::<Everything>::new(&scene, None, false);
    let mut scratch = Scratch::default();
    let mut pixel = |index: usize| {
        let mut moments = [Moments::default(); 3];
        for sample in 0..scene.samples {
            let mut sampler = Sampler::new(Stream::new(scene.seed, index as u32, sample));
            let [x, y] = sampler.pair(Purpose::Camera, 0);
            let film_point = [(index % width) as f64 + x, (index / width) as f64 + y];
            let ray = scene.camera.ray_through(film_point, SIZE);
            let radiance = tracer.radiance(ray, sampler, &mut scratch, &mut Uncounted);
            let channels = radiance.unwrap_or(DVec3::NAN).to_array();
            moments
                .iter_mut()
                .zip(channels)
                .for_each(|(m, channel)| m.add(channel));
        }
        moments.map(|moments| moments.mean() as f32)
    };
    let count = width * height;
    let rendered = film(&picture(Model::Radiative(Box::new(scene.clone()))));
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
        (0..count)
            .map(order)
            .for_each(|index| found[index] = pixel(index));
        margin.exact(format_args!("pixels {name}"), found == rendered, true);
    }
}

/// A number that stands for all bits of `values`: FNV-1a over their bytes, least first.
fn digest(values: impl IntoIterator<Item = f64>) -> u64 {
    let bytes = values
        .into_iter()
        .flat_map(|value| value.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn a5_builds_and_platforms(margin: &mut Margin) {
    type Function = fn(f64) -> f64;
    let functions: [(&str, Function, u64); 10] = [
        ("exp", |x| math::exp(40.0 * x - 20.0), 0xe284_202e_3008_e380),
        (
            "expm1",
            |x| math::exp_m1(2.0 * x - 1.0),
            0x136f_3e41_c4e8_ed19,
        ),
        ("ln", |x| math::ln(x + 1e-9), 0xa88d_85b6_125f_8cb2),
        ("ln1p", |x| math::ln_1p(x - 0.5), 0xc9e0_dba9_41cd_6159),
        ("sin", |x| math::sin(100.0 * x), 0xdb8d_9fcc_091d_8fc0),
        ("cos", |x| math::cos(100.0 * x), 0xc8e5_73f0_2d99_0a8a),
        ("tan", |x| math::tan(3.0 * x), 0xc021_e8fb_94d8_9bdd),
        (
            "atan2",
            |x| math::atan2(x - 0.5, 0.3),
            0x7d3d_354f_6287_8c2a,
        ),
        ("pow", |x| math::pow(x, 2.4), 0x5d5f_dc00_2e66_394d),
        (
            "source factor",
            |x| source_factor(30.0 * x),
            0x17a5_ff7c_b0e9_7c6c,
        ),
    ];
    for (name, function, right) in functions {
        let found = digest(numbers(51, 10_000).map(|[u, ..]| function(u)));
        margin.exact(
            format_args!("{name} of 10 000 numbers"),
            format!("{found:016x}"),
            format!("{right:016x}"),
        );
    }
    for ((name, scene), right) in pictures()
        .into_iter()
        .zip([0x73d2_3353_a8dc_4d3b_u64, 0x1fea_a3af_d067_09b0])
    {
        let pixels = film(&scene).map_or(vec![], |film| film.radiance().to_vec());
        let found = digest(pixels.iter().flatten().map(|&channel| channel.into()));
        margin.exact(
            format_args!("picture of {name}"),
            format!("{found:016x}"),
            format!("{right:016x}"),
        );
    }
}

fn a6_null_effects(margin: &mut Margin) {
    let plain = before_sky(vec![in_box(
        cuboid(DVec3::NEG_ONE, DVec3::ONE),
        grey(1.0, 1.0, 0.0),
    )]);
    let nothing = grey(0.0, 0.0, 0.0);
    let mut beside_nothing = plain.clone();
    beside_nothing
        .media
        .push(in_ball(ball(DVec3::X, 0.9), nothing));
    let mut of_no_density = plain.clone();
    let empty = ConstantDensity::new(0.0).expect("a density");
    let bounds = cuboid(DVec3::NEG_ONE, DVec3::ONE);
    let empty = heterogeneous(bounds, Field::Constant(empty), grey(1.0, 1.0, 0.0));
    of_no_density.media.insert(0, empty);
    let transparent = classified(grid([5, 4, 3], DVec3::splat(0.3), |_| 0.0), by_formula(0.1));
    let unshaded = Classified {
        phong: plume(1.0).phong,
        shadow: plume(1.0).shadow,
        ..transparent
    };
    let models = [
        ("fog", Model::Radiative(Box::new(plain))),
        (
            "fog beside a medium of nothing",
            Model::Radiative(Box::new(beside_nothing)),
        ),
        (
            "fog and a density of nothing",
            Model::Radiative(Box::new(of_no_density)),
        ),
        (
            "a transparent volume",
            Model::Classified(Box::new(unshaded)),
        ),
    ];
    let mut bits = Vec::new();
    for (name, model) in models {
        let scene = picture(model);
        let panel = &scene.panels[0];
        let by = |plan: Plan<'_>| {
            render(&[plan], Sampling::default(), &|| ())
                .map(|rendering| rendering.film.pixel_hash())
        };
        let plan = Plan::new(panel);
        let bare = by(plan.clone());
        margin.holds(format_args!("{name}: there is a picture"), bare.is_ok());
        bits.push(bare.clone());
        let null: Vec<Effect> = Effect::ALL
            .into_iter()
            .filter(|&effect| {
                plan.state(effect) == State::Elided && Plan::forcing(panel, &[effect]).is_ok()
            })
            .collect();
        margin.holds(format_args!("{name}: something is null"), !null.is_empty());
        let alone = null.iter().map(std::slice::from_ref);
        for forced in alone.chain([&null[..]]) {
            let found = Plan::forcing(panel, forced).map(by);
            margin.exact(
                format_args!("{name}, {forced:?} forced"),
                found,
                Ok(bare.clone()),
            );
        }
    }
    // A medium of nothing is no medium.
    margin.exact("beside a medium of nothing", &bits[1], &bits[0]);
    margin.exact("and a density of nothing", &bits[2], &bits[0]);
}

fn a7_no_bad_pixel(margin: &mut Margin) {
    // A film that holds one is found out, with its place.
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1e-30] {
        let mut pixels = vec![[0.5_f32; 3]; 12];
        pixels[7][1] = bad;
        let found = Film::new(4, 3, pixels).first_without_radiance();
        margin.exact(
            format_args!("{bad}"),
            found.map(|(film_point, _)| film_point),
            Some([3, 1]),
        );
    }
    // Nothing that is rendered here is one: densities from the least to the largest, a medium that
    // lets nothing through, and light that is all but scattered back.
    let dense = |sigma, g| in_box(cuboid(DVec3::NEG_ONE, DVec3::ONE), grey(sigma, 0.5, g));
    let white = TransferPoint {
        value: 1.0,
        colour: DVec3::ONE,
        opacity: 0.5,
    };
    let table = TransferFunction {
        appearance: Appearance::Points(TransferPoints::new(vec![white]).expect("a table")),
        reference_length: 1e-3,
    };
    let voxels = |value: f32| {
        let ramp = grid([3; 3], DVec3::splat(0.5), |[i, ..]| value * i as f32 / 2.0);
        Classified {
            phong: plume(1.0).phong,
            ..classified(ramp, table.clone())
        }
    };
    let mut models: Vec<Model> = [(1e-300, 0.0), (1e9, 0.9), (3.0, LAST), (3.0, -LAST)]
        .map(|(sigma, g)| Model::Radiative(Box::new(before_sky(vec![dense(sigma, g)]))))
        .into();
    models.push(Model::Radiative(Box::new(fog())));
    models.push(Model::Classified(Box::new(plume(1.0))));
    models.extend([1e-45, 1.0, f32::MAX].map(|value| Model::Classified(Box::new(voxels(value)))));
    for (index, model) in models.into_iter().enumerate() {
        let film = film(&picture(model));
        let bad = film.map(|film| film.first_without_radiance());
        margin.exact(format_args!("picture {index}"), bad, Some(None));
    }
}
