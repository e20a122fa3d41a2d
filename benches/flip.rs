//! FLIP of a 1920×1080 pair: ours on one thread and two, and with `--cfg flip_oracle`
//! NVIDIA's, which uses one.
#![allow(missing_docs, reason = "a program, not a library")]

use divan::{Bencher, black_box};
use volref::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};

const WIDTH: usize = 1920;
const HEIGHT: usize = 1080;

fn main() {
    divan::main();
}

/// Waves and texture, and the same slightly brighter with other texture: no two pixels equal,
/// so no short cut applies.
fn pair() -> (SrgbImage, SrgbImage) {
    let image = |brightness: usize, texture: usize| {
        let pixels = (0..WIDTH * HEIGHT).map(|i| {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let grain = i.wrapping_mul(texture) >> 7 & 15;
            [x / 9, y / 6, (x + y) / 14].map(|base| (base + grain + brightness).min(255) as u8)
        });
        SrgbImage::new(WIDTH, HEIGHT, pixels.collect()).expect("as many pixels as the size says")
    };
    (image(0, 2_654_435_761), image(6, 40_503))
}

#[divan::bench(args = [1, 2], sample_count = 5)]
fn ours(bencher: Bencher<'_, '_>, threads: usize) {
    let (reference, test) = pair();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool");
    bencher.bench_local(|| {
        pool.install(|| flip(black_box(&reference), &test, DEFAULT_PIXELS_PER_DEGREE))
    });
}

#[cfg(flip_oracle)]
#[divan::bench(sample_count = 5)]
fn nvidia(bencher: Bencher<'_, '_>) {
    let image = |image: &SrgbImage| {
        let (width, height) = (WIDTH as u32, HEIGHT as u32);
        nv_flip::FlipImageRgb8::with_data(width, height, image.pixels().as_flattened())
    };
    let (reference, test) = pair();
    // The oracle takes its images for itself and changes them.
    bencher
        .with_inputs(|| (image(&reference), image(&test)))
        .bench_local_values(|(reference, test)| {
            nv_flip::flip(reference, test, DEFAULT_PIXELS_PER_DEGREE as f32)
        });
}
