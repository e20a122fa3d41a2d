//! Refining the step converges, at order 2 for a smooth field.

use super::{U, config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::Ray;
use volref::math;
use volref::scene::Classified;
use volref::volume::Lattice;

/// One cell with the given densities at its corners. With floor 0 the extinction is `d²` per
/// reference length: here a polynomial along every ray.
fn cell(corner: impl Fn([usize; 3]) -> f32) -> Classified {
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    let mut scene = scenes::plain(scenes::sampled(lattice, corner));
    scene.transfer_function.appearance = scenes::formula(0.0, "white");
    scene
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn halving_the_step_quarters_the_error(
        corners in prop::array::uniform8(0.05..0.9_f32),
        from in prop::array::uniform2(0.1..0.9_f64),
        to in prop::array::uniform2(0.1..0.9_f64),
    ) {
        let mut scene = cell(|[i, j, k]| corners[i + 2 * (j + 2 * k)]);
        let [a, b] = [DVec3::new(from[0], from[1], -1.0), DVec3::new(to[0], to[1], 1.0)];
        let ray = Ray::new(a, b - a).unwrap();
        let length = scene.grid.lattice().bounds().span(&ray).unwrap().length();
        let mut depth = |steps: f64| {
            scene.step = length / steps;
            -math::ln_1p(-scenes::layers(&scene, &[ray])[0].opacity)
        };
        let [coarse, middle, fine] = [depth(16.0), depth(32.0), depth(64.0)];
        // Along a direction (x, y, z) of length 1, with corners within 0.85 of each other:
        // |d'| ≤ 0.85·(|x| + |y| + |z|) ≤ 1.48, |d''| ≤ 2·1.7·(|xy| + |yz| + |zx|) ≤ 3.4,
        // |d'''| ≤ 6·3.4·|xyz| ≤ 4. So σ = d² has σ'' = 2d'² + 2dd'' ≤ 10.5 and
        // σ'''' = 6d''² + 8d'd''' ≤ 117.
        // The midpoint rule errs by at most L·h²/24·max|σ''|.
        let h = length / 16.0;
        let rounding = 500.0 * U;
        let first_order = 10.5 / 24.0 * 1.25 * length * h * h + rounding;
        prop_assert!((coarse - middle).abs() <= first_order);
        // By Euler and Maclaurin the error is c·h², and at most twice 7/5760·L·h⁴·max|σ''''|:
        // c·h² goes from the difference below, and the rest has the weights 1, 5/16, 4/256.
        let rest = 2.0 * 7.0 / 5760.0 * 117.0 * 1.33 * length * h * h * h * h;
        // Opacities round 5u a step for up to 64 steps, more where little light comes through:
        // T ≥ e^(−0.81·1.3); 500u holds ten times that for the three depths.
        let residual = (coarse - middle) - 4.0 * (middle - fine);
        prop_assert!(residual.abs() <= rest + 10.0 * rounding, "{residual:e} {rest:e}");
    }
}

/// The law above allows a small difference anything: here the order itself, of a field known to
/// curve, for opacity and colour.
#[test]
fn the_order_is_two() {
    // The product xyz along a diagonal is a cubic.
    let mut scene = cell(|node| f32::from(u8::from(node == [1; 3])));
    let ray = Ray::new(DVec3::splat(-1.0), DVec3::ONE).unwrap();
    let length = scene.grid.lattice().bounds().span(&ray).unwrap().length();
    let mut at = |steps: f64| {
        scene.step = length / steps;
        let layers = scenes::layers(&scene, &[ray])[0];
        [layers.opacity, layers.colour.x]
    };
    let [coarse, middle, fine] = [at(64.0), at(128.0), at(256.0)];
    for quantity in 0..2 {
        let first = coarse[quantity] - middle[quantity];
        let ratio = first / (middle[quantity] - fine[quantity]);
        // The next term is h² smaller, (√3/64)² = 1/1400, times a constant of order ten.
        assert!((ratio - 4.0).abs() <= 0.05, "{ratio}");
    }
}
