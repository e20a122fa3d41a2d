//! Heterogeneous media: what a lookup costs, what a picture of 256 × 256 pixels costs, and
//! how that grows with the grid.
//!
//! `cargo bench --bench heterogeneous_media`. One thread throughout. Read ratios between rows of one
//! run, not absolute times: machines differ. First it prints pictures of the same field on grids
//! of 64³ to 512³ nodes, the largest half a gigabyte, as ratios to the smallest.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use volref::optics::{Density, Field};
use volref::render::{Plan, Sampling, render};
use volref::scene::{Model, Scene};
use volref::volume::{
    DensityField, FractalDensity, FractalParameters, Grid, GridDensity, Interpolation, Lattice,
};

const SIZE: usize = 256;
const SAMPLES: u32 = 2;
const SIZES: [usize; 4] = [64, 128, 256, 512];

/// Lookups a second and thread that we want of a grid in the cache.
const WANTED: f64 = 40e6;

fn main() {
    // cargo test --benches runs this without timing anything.
    if std::env::args().any(|argument| argument == "--bench") {
        print_lookups();
        print_sizes();
    }
    divan::main();
}

/// Noise of ten octaves, in a cube of edge 4.
const NOISE: FractalParameters = FractalParameters {
    octaves: 10,
    lacunarity: 4.0,
    gain: 0.5,
    scale: DVec3::new(0.5, 1.0, 1.0),
    offset: DVec3::ZERO,
    max_density: 4.0,
    threshold: 1.25,
};

/// The same noise without the detail that the coarsest grid cannot show, so that all grids show
/// the same picture.
const SMOOTH: FractalParameters = FractalParameters {
    octaves: 2,
    threshold: 0.0,
    ..NOISE
};

/// The cube on a grid of `size`³ nodes.
fn sampled(size: usize) -> Grid<f32> {
    let field = FractalDensity::new(SMOOTH).expect("a valid field");
    let spacing = DVec3::splat(4.0 / (size - 1) as f64);
    let lattice = Lattice::new([size; 3], spacing, DVec3::splat(-2.0)).expect("a cube");
    let value = |index| field.density(lattice.position(lattice.node(index))) as f32;
    let values = (0..lattice.node_count()).map(value).collect();
    Grid::new(lattice, values).expect("one value per node")
}

/// The cube before a sky and under a sun, filled by a field of albedo 0.8: noise, or this grid.
fn scene(grid: Option<GridDensity>) -> Scene {
    let text = r#"
        [camera]
        eye = [6.2, 4.3, 8.4]
        target = [0, 0, 0]
        vertical_fov = 35
        [radiative]
        scattering = "multiple"
        environment = [0.22, 0.28, 0.4]
        [[radiative.light]]
        directional = { direction = [0.55, -1, -0.8], irradiance = [5.2, 4.6, 3.8] }
        [[radiative.medium]]
        box = { min = [-2, -2, -2], max = [2, 2, 2] }
        sigma_a = 0.5
        sigma_s = 2
        noise = { octaves = 10, lacunarity = 4, gain = 0.5, scale = [0.5, 1, 1], max_density = 4, threshold = 1.25 }
    "#;
    let mut scene = Scene::parse(text, Path::new("scene.toml")).expect("a valid scene");
    let panel = &mut scene.panels[0];
    (panel.width, panel.height) = (SIZE, SIZE);
    if let Some(grid) = grid {
        let Model::Radiative(radiative) = &mut panel.model else {
            unreachable!("a scene of media")
        };
        let bounds = grid.bounds();
        radiative.media[0].density = Some(Density::new(Field::Grid(grid), bounds, None));
    }
    scene
}

fn trilinear(grid: Grid<f32>) -> GridDensity {
    GridDensity::new(Arc::new(grid), Interpolation::Trilinear)
}

fn one_thread() -> ThreadPool {
    ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread")
}

/// The least of `rounds` times, in seconds: what it takes when nothing disturbs.
fn least_seconds<R>(rounds: usize, work: impl Fn() -> R) -> f64 {
    let time = |_| {
        let start = Instant::now();
        divan::black_box(work());
        start.elapsed().as_secs_f64()
    };
    (0..rounds).map(time).fold(f64::INFINITY, f64::min)
}

/// Points of the cube where lookups are made: few, so that the least time is an undisturbed one.
const PLACES: usize = 1 << 12;

/// Points on lines through the cube, half a voxel of a 32³ grid apart, as on rays.
fn on_rays() -> Vec<DVec3> {
    let steps = 64;
    let line = |k: usize| {
        let start = scattered(2 * k).with_z(-2.0);
        let end = scattered(2 * k + 1).with_z(2.0);
        (0..steps).map(move |i| start.lerp(end, (i as f64 + 0.5) / f64::from(steps)))
    };
    (0..PLACES / steps as usize).flat_map(line).collect()
}

/// Points of the cube in no order.
fn at_random() -> Vec<DVec3> {
    (0..PLACES).map(scattered).collect()
}

/// A place of the cube: a multiple of irrational steps.
fn scattered(k: usize) -> DVec3 {
    let step = DVec3::new(0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_901);
    (k as f64 * step).fract() * 4.0 - 2.0
}

fn sum_of(field: &GridDensity, places: &[DVec3]) -> f64 {
    places.iter().map(|&place| field.density(place)).sum()
}

/// Lookups a second in a grid that fits the cache.
fn print_lookups() {
    println!("nodes   lookups a second in millions: on rays   at random");
    let field = trilinear(sampled(32));
    let rates = [on_rays(), at_random()].map(|places| {
        let seconds = least_seconds(2000, || sum_of(&field, &places));
        PLACES as f64 / seconds
    });
    println!(
        "  32³                                {:>8.1}   {:>9.1}   ({} wanted)",
        rates[0] / 1e6,
        rates[1] / 1e6,
        WANTED / 1e6
    );
}

/// Seconds of a picture on each grid, as ratios to the smallest.
fn print_sizes() {
    println!("nodes    MiB   thousand paths a second   cost of a path / that of 64³");
    let mut first = None;
    for size in SIZES {
        let scene = scene(Some(trilinear(sampled(size))));
        let plans = [Plan::new(&scene.panels[0])];
        let pool = one_thread();
        let picture = || pool.install(|| render(&plans, Sampling::of_samples(SAMPLES), &|| {}));
        let seconds = least_seconds(3, picture);
        let first = *first.get_or_insert(seconds);
        let paths = (SIZE * SIZE) as f64 * f64::from(SAMPLES);
        println!(
            "{size:>4}³  {:>5}   {:>23.0}   {:>28.2}",
            4 * size.pow(3) / (1 << 20),
            paths / seconds / 1e3,
            seconds / first
        );
    }
}

fn lookups(bencher: Bencher, size: usize, places: &[DVec3]) {
    let field = trilinear(sampled(size));
    bencher
        .counter(ItemsCount::new(places.len()))
        .bench_local(|| sum_of(&field, places));
}

/// A grid of 128 KiB, and one of 8 MiB.
#[divan::bench(args = [32, 128])]
fn lookups_on_rays(bencher: Bencher, size: usize) {
    lookups(bencher, size, &on_rays());
}

#[divan::bench(args = [32, 128])]
fn lookups_at_random(bencher: Bencher, size: usize) {
    lookups(bencher, size, &at_random());
}

fn paths(bencher: Bencher, scene: &Scene) {
    let plans = [Plan::new(&scene.panels[0])];
    let pool = one_thread();
    bencher
        .counter(ItemsCount::new(SIZE * SIZE * SAMPLES as usize))
        .bench_local(|| pool.install(|| render(&plans, Sampling::of_samples(SAMPLES), &|| {})));
}

/// Noise of ten octaves, looked up where it is needed.
#[divan::bench(sample_count = 5)]
fn picture_of_noise(bencher: Bencher) {
    paths(bencher, &scene(None));
}

#[divan::bench(sample_count = 5)]
fn picture_of_grid_128(bencher: Bencher) {
    paths(bencher, &scene(Some(trilinear(sampled(128)))));
}
