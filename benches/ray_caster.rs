//! Figure 3 at 512 × 512 pixels from a grid of 128³ nodes, half-voxel steps.
//!
//! `cargo bench --bench ray_caster`. Items are *nominal* samples: every step of every ray inside
//! the grid, those in empty space included, so that renderers which skip them can be compared.
//! Read ratios between rows of one run, not absolute times: machines differ.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::sync::LazyLock;
use volref::render::classified::steps::Steps;
use volref::render::plan::Kernel;
use volref::render::{Plan, Sampling, render};
use volref::scene::{Model, Scene};
use volref::volume::{Cell, Grid, Lattice, NodePoint};

fn main() {
    println!("nominal samples a frame: {}", nominal_samples(&SCENE));
    divan::main();
}

/// The smoke of figure 3 in the middle of 128³ nodes, seen at 512 × 512 pixels by the source's
/// camera: before the centre of the volume by 2.5 times its depth.
static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let grid = smoke_128();
    let bounds = grid.lattice().bounds();
    let (centre, depth) = (bounds.centre(), bounds.size().z);
    let eye = centre - DVec3::new(0.0, 0.0, 2.5 * depth);
    let camera = format!("[camera]\neye = {eye}\n");
    let text = r#"
        [film]
        width = 512
        height = 512
        [transfer_function]
        reference_length = 0.02
        [classified]
        step = "0.5 voxels"
        [classified.phong]
        [classified.volume]
        file = "smoke-128.bin"
    "#;
    let folder = tempfile::tempdir().expect("a folder for the grid");
    let lattice = grid.lattice();
    let counts = lattice.nodes().map(|nodes| nodes as i32);
    let sizes = counts.map(|nodes| (lattice.spacing().x * f64::from(nodes - 1)) as f32);
    let numbers = sizes.iter().chain(grid.values());
    let bytes = counts.iter().flat_map(|count| count.to_le_bytes());
    let bytes: Vec<u8> = bytes
        .chain(numbers.flat_map(|it| it.to_le_bytes()))
        .collect();
    std::fs::write(folder.path().join("smoke-128.bin"), bytes).expect("room for 8 MB");
    Scene::parse(&(camera + text), &folder.path().join("scene.toml")).expect("a valid scene")
});

/// The smoke splatted to 128 nodes of height, centred in a cube of 128³ nodes.
fn smoke_128() -> Grid<f32> {
    let cloud = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/volumes/smoke.obj");
    let options = volref::volume::LoadOptions {
        splatting: volref::volume::Splatting {
            resolution: Some(128),
            padding: 2,
        },
        ..volref::volume::LoadOptions::default()
    };
    let plume = volref::volume::load(&cloud, &options).expect("the smoke of the suite");
    let nodes = plume.lattice().nodes();
    let lattice = Lattice::new([128; 3], plume.lattice().spacing(), DVec3::ZERO).expect("128³");
    let mut values = vec![0.0; lattice.node_count()];
    for (index, &value) in plume.values().iter().enumerate() {
        let node = plume.lattice().node(index);
        let centred = std::array::from_fn(|axis| node[axis] + (128 - nodes[axis]) / 2);
        values[lattice.index(centred)] = value;
    }
    Grid::new(lattice, values).expect("one value per node")
}

fn nominal_samples(scene: &Scene) -> usize {
    let panel = &scene.panels[0];
    let Model::Classified(classified) = &panel.model else {
        unreachable!("the scene above")
    };
    let bounds = classified.grid.lattice().bounds();
    let size = [panel.width, panel.height];
    let rays = (0..panel.width * panel.height).map(|index| {
        classified
            .camera
            .ray([index % panel.width, index / panel.width], size)
    });
    rays.filter_map(|ray| bounds.span(&ray))
        .map(|span| Steps::over(span, classified.step).count())
        .sum()
}

fn threads(count: usize) -> ThreadPool {
    ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .expect("a few threads")
}

/// As planned: leaps over empty space.
#[divan::bench(args = [1, 2], sample_count = 10)]
fn figure_3(bencher: Bencher, thread_count: usize) {
    let plans = [Plan::new(&SCENE.panels[0])];
    frames(bencher, thread_count, &plans);
}

/// Every sample taken: what the leaps save.
#[divan::bench(sample_count = 5)]
fn figure_3_every_sample(bencher: Bencher) {
    let mut plan = Plan::new(&SCENE.panels[0]);
    if let Kernel::RayCaster { features, .. } = &mut plan.kernel {
        features.skip_empty = false;
    }
    frames(bencher, 1, &[plan]);
}

/// Shading left out: what gradients and Phong cost.
#[divan::bench(args = [1, 2], sample_count = 10)]
fn figure_3_unshaded(bencher: Bencher, thread_count: usize) {
    let mut plan = Plan::new(&SCENE.panels[0]);
    if let Kernel::RayCaster { features, .. } = &mut plan.kernel {
        features.shading = false;
    }
    frames(bencher, thread_count, &[plan]);
}

fn frames(bencher: Bencher, thread_count: usize, plans: &[Plan<'_>]) {
    let pool = threads(thread_count);
    bencher
        .counter(ItemsCount::new(nominal_samples(&SCENE)))
        .bench_local(|| pool.install(|| render(plans, Sampling::default(), &|| {})));
}

/// Trilinear lookups alone, in a grid that fits the cache, along a line.
#[divan::bench(sample_count = 20)]
fn trilinear_lookups(bencher: Bencher) {
    let lattice = Lattice::new([32; 3], DVec3::ONE, DVec3::ZERO).expect("32³");
    let values = (0..lattice.node_count()).map(|i| (i % 97) as f32).collect();
    let grid = Grid::new(lattice, values).expect("one value per node");
    let count = 1_000_000_u32;
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        let step = DVec3::new(30.3, 29.7, 30.9) / f64::from(count);
        (0..count)
            .map(|i| Cell::around(&lattice, NodePoint(step * f64::from(i))).trilinear(&grid))
            .sum::<f64>()
    });
}
