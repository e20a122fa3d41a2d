//! Surfaces and smoke: the Cornell box with and without its smoke, and a spotlight in fog, at
//! 256 × 256 pixels.
//!
//! `cargo bench --bench path_tracer`. Items are paths; all rows use one thread unless they say
//! otherwise. Read ratios between rows of one run, not absolute times: machines differ. First it
//! prints, for each scene, the error squared times the time, which is what a better way of
//! sampling lowers, however many samples are taken.

use divan::Bencher;
use divan::counter::ItemsCount;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::time::Instant;
use volref::optics::Coefficients;
use volref::render::{Effect, Plan, Sampling, render};
use volref::scene::{Model, Scene};

const SIZE: usize = 256;
const SAMPLES: u32 = 2;
/// Radiance below which errors count as those of this radiance.
const DARK: f64 = 0.01;

const CORNELL: &str = "smoke/cornell";
/// The same with smoke of no matter: what it costs to know that there is none.
const NO_SMOKE: &str = "smoke/cornell without smoke";
const SPOTLIGHT: &str = "fog/spotlight";
const SCENES: [&str; 3] = [CORNELL, NO_SMOKE, SPOTLIGHT];

fn main() {
    for name in [CORNELL, SPOTLIGHT] {
        print_cost(name);
    }
    divan::main();
}

fn scene(name: &str) -> Scene {
    let file = name.split(' ').next().expect("a name");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/scenes");
    let mut scene = Scene::load(&folder.join(format!("{file}.toml"))).expect("a valid scene");
    let panel = &mut scene.panels[0];
    (panel.width, panel.height) = (SIZE, SIZE);
    if name == NO_SMOKE {
        let Model::Radiative(radiative) = &mut panel.model else {
            unreachable!("a scene of surfaces and media")
        };
        for body in &mut radiative.media {
            let none = glam::DVec3::ZERO;
            body.medium.coefficients = Coefficients::new(none, none).expect("no matter");
        }
    }
    scene
}

fn threads(count: usize) -> ThreadPool {
    ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .expect("a few threads")
}

/// Relative squared error, as the image itself estimates it, times seconds on one thread.
fn print_cost(name: &str) {
    let scene = scene(name);
    let plans = [Plan::new(&scene.panels[0])];
    let start = Instant::now();
    let image = threads(1).install(|| render(&plans, Sampling::of_samples(16), &|| {}));
    let seconds = start.elapsed().as_secs_f64();
    let film = image.expect("a picture").film;
    let variance = film.noise().expect("more than one sample").variance();
    let pairs = film.radiance().as_flattened().iter();
    let pairs = pairs.zip(variance.as_flattened());
    let relative = |(&mean, &variance): (&f32, &f32)| {
        let mean = f64::from(mean);
        f64::from(variance) / (mean * mean + DARK * DARK)
    };
    let error = pairs.map(relative).sum::<f64>() / (3 * SIZE * SIZE) as f64;
    println!(
        "{name}: error {error:.5}, {seconds:.2} s, product {:.5}",
        error * seconds
    );
}

fn paths(bencher: Bencher, thread_count: usize, name: &str, plan: impl Fn(&Scene) -> Plan<'_>) {
    let scene = scene(name);
    let sampling = Sampling::of_samples(SAMPLES);
    let plans = [plan(&scene)];
    let pool = threads(thread_count);
    bencher
        .counter(ItemsCount::new(SIZE * SIZE * SAMPLES as usize))
        .bench_local(|| pool.install(|| render(&plans, sampling, &|| {})));
}

/// As planned: code without the effects that are null in the scene.
#[divan::bench(args = SCENES, sample_count = 5)]
fn planned(bencher: Bencher, name: &str) {
    paths(bencher, 1, name, |scene| Plan::new(&scene.panels[0]));
}

/// As planned, on two threads.
#[divan::bench(args = [CORNELL, SPOTLIGHT], sample_count = 5)]
fn planned_on_two_threads(bencher: Bencher, name: &str) {
    paths(bencher, 2, name, |scene| Plan::new(&scene.panels[0]));
}

/// All effects that can be: the same bits, for more work.
#[divan::bench(args = SCENES, sample_count = 5)]
fn forced(bencher: Bencher, name: &str) {
    paths(bencher, 1, name, |scene| {
        let panel = &scene.panels[0];
        let can_be = |effect: &Effect| Plan::forcing(panel, &[*effect]).is_ok();
        let effects: Vec<_> = Effect::ALL.into_iter().filter(can_be).collect();
        Plan::forcing(panel, &effects).expect("each of them can be")
    });
}
