//! What a lookup in a density field costs, and what bounds over a box cost.
//!
//! `cargo bench --bench fields`. Read ratios between rows of one run: machines differ.

use divan::Bencher;
use divan::counter::ItemsCount;
use glam::DVec3;
use volref::geometry::Aabb;
use volref::volume::{DensityField, FractalDensity, FractalParameters, perlin_noise};

fn main() {
    divan::main();
}

/// The field of the source's XML block, with this many octaves.
fn source_field(octaves: u32) -> FractalDensity {
    FractalDensity::new(FractalParameters {
        octaves,
        lacunarity: 4.0,
        gain: 0.5,
        scale: DVec3::new(0.5, 1.0, 1.0),
        offset: DVec3::ZERO,
        max_density: 4.0,
        threshold: 1.25,
    })
    .expect("a valid field")
}

/// Places in a cube of edge 4 in no order: multiples of irrational steps.
fn places() -> Vec<DVec3> {
    let step = DVec3::new(0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_901);
    let place = |k: u32| (f64::from(k) * step).fract() * 4.0 - 2.0;
    (0..4096).map(place).collect()
}

#[divan::bench]
fn noise(bencher: Bencher) {
    let places = places();
    bencher
        .counter(ItemsCount::new(places.len()))
        .bench(|| places.iter().map(|&place| perlin_noise(place)).sum::<f64>());
}

#[divan::bench(args = [1, 4, 10])]
fn fractal_density(bencher: Bencher, octaves: u32) {
    let (places, field) = (places(), source_field(octaves));
    bencher.counter(ItemsCount::new(places.len())).bench(|| {
        places
            .iter()
            .map(|&place| field.density(place))
            .sum::<f64>()
    });
}

#[divan::bench(args = [0.05, 0.1, 0.25])]
fn fractal_range(bencher: Bencher, edge: f64) {
    let field = source_field(10);
    let boxes: Vec<_> = places()
        .into_iter()
        .map(|place| Aabb::new(place, place + edge).expect("a box"))
        .collect();
    bencher.counter(ItemsCount::new(boxes.len())).bench(|| {
        let range = |bounds| field.range_over(bounds).high;
        boxes.iter().map(range).sum::<f64>()
    });
}
