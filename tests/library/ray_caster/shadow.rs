//! The volume shadow is `min(1, exp(−S/100))`, `S` the sum of what lies in the way.

use super::{U, config, scenes};
use crate::common::vector;
use glam::DVec3;
use proptest::prelude::*;
use std::sync::Arc;
use volref::math;
use volref::render::classified::ray_caster::RayCaster;
use volref::render::{Counters, Event};
use volref::scene::{Classified, Shadow};
use volref::volume::{Cell, Grid, Lattice};

fn visibility(grid: &Arc<Grid<f32>>, shadow: Shadow, light: DVec3, at: DVec3) -> (f64, Counters) {
    let nodes = grid.lattice().to_nodes(at);
    let scene = Classified {
        shadow: Some(shadow),
        light,
        ..scenes::plain(grid.clone())
    };
    let mut work = Counters::default();
    let visible = RayCaster::plain(&scene).visibility(at, nodes, &mut work);
    (visible, work)
}

proptest! {
    #![proptest_config(config(256))]

    /// At the reference step, `S` is the plain sum of the course: densities in the middle of
    /// whole steps. Beyond the light and beyond the volume nothing is met.
    #[test]
    fn at_the_reference_step_the_sum_is_plain(
        nodes in prop::array::uniform3(3..9_usize), seed in any::<u64>(),
        axis in 0..3_usize, within in 0.0..1.0_f64, steps in 1..9_u32, beyond in 0..20_u32,
    ) {
        let lattice = Lattice::new(nodes, DVec3::splat(0.5), DVec3::ZERO).unwrap();
        let grid = scenes::sparse_grid(lattice, seed, 0.7);
        let size = lattice.bounds().size();
        // Lengths in eighths: every place is exact.
        let step = 0.125;
        let mut at = (size * within * 8.0).floor() / 8.0;
        at[axis] = size[axis] - (f64::from(steps) * step).min(size[axis]);
        let off_faces = (0..3).all(|other| other == axis || at[other] < size[other]);
        prop_assume!(off_faces);
        // Outside, or as far inside as the sample.
        let mut light = at;
        light[axis] = size[axis] + f64::from(beyond) * step - 4.0 * step;
        prop_assume!(light[axis] > at[axis]);
        let end = light[axis].min(size[axis]);
        let mut sum = 0.0;
        let mut count = 0;
        let mut next = at[axis] + 0.5 * step;
        while next < end {
            let mut point = at;
            point[axis] = next;
            sum += Cell::around(&lattice, lattice.to_nodes(point)).trilinear(&grid);
            count += 1;
            next += step;
        }
        let shadow = Shadow { step, reference_step: step };
        let (visible, work) = visibility(&grid, shadow, light, at);
        // The eighth is a power of two, so both sums round alike; then a quotient and exp.
        let expected = math::exp(-sum / 100.0).min(1.0);
        prop_assert!((visible - expected).abs() <= 4.0 * U, "{visible} {expected}");
        prop_assert_eq!(work[Event::ShadowRay], 1);
        prop_assert_eq!(work[Event::DensityLookup], count);
    }

    #[test]
    fn finer_steps_approach_the_integral(seed in any::<u64>(), at in vector(0.3..3.7)) {
        let lattice = Lattice::new([5, 5, 5], DVec3::ONE, DVec3::ZERO).unwrap();
        let grid = scenes::sparse_grid(lattice, seed, 1.0);
        let light = DVec3::new(2.0, 9.0, 1.0);
        let sum = |step: f64| {
            let shadow = Shadow { step, reference_step: 0.01 };
            -100.0 * math::ln(visibility(&grid, shadow, light, at).0)
        };
        // Midpoint rule over a length below 4√3 = 7 of a field with slope below 1.3 per axis
        // (2.3 in all): in a step h no density is off by more than 2.3·h/2, on average half
        // that. In units of 0.01, and 1e-10 for rounding.
        for step in [0.4, 0.1, 0.02] {
            let bound = 7.0 * 0.25 * 2.3 * (step + 0.5 * step) / 0.01 + 1e-10;
            prop_assert!((sum(step) - sum(0.5 * step)).abs() <= bound);
        }
    }

    #[test]
    fn the_shadow_of_nothing_is_exactly_one(at in vector(0.0..4.0), light in vector(-9.0..9.0)) {
        let lattice = Lattice::new([5, 5, 5], DVec3::ONE, DVec3::ZERO).unwrap();
        let shadow = Shadow { step: 0.3, reference_step: 1e-300 };
        let empty = scenes::sampled(lattice, |_| 0.0);
        prop_assert_eq!(visibility(&empty, shadow, light, at).0, 1.0);
        // A light at the sample: no way, no ray.
        let full = scenes::sampled(lattice, |_| 1.0);
        prop_assert_eq!(visibility(&full, shadow, at, at), (1.0, Counters::default()));
    }
}
