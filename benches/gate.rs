//! The stochastic gate on a 256 × 256 pair, with and without the variance of the test image.
#![allow(missing_docs, reason = "a program, not a library")]

#[path = "../tests/library/common/simulated.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod simulated;

use divan::{Bencher, black_box};
use simulated::{Sampling, Shape, sampled, scene, silent};
use volref::compare::stochastic::judge;

fn main() {
    divan::main();
}

#[divan::bench(args = [true, false])]
fn gate(bencher: Bencher<'_, '_>, states_variance: bool) {
    let shapes = Shape::all();
    let image = |seed, samples| {
        let sampling = Sampling {
            side: 256,
            samples,
            seed,
            shapes: [&shapes[1]; 2],
            coloured: false,
            one_for_all: false,
        };
        sampled(sampling, |x, y| scene(x / 4.0, y / 4.0))
    };
    let (reference, test) = (image(1, 256), image(2, 16));
    let test = if states_variance { test } else { silent(&test) };
    bencher.bench_local(|| {
        judge(black_box(&reference), black_box(&test), 1000)
            .map(|j| j.passed)
            .ok()
    });
}
