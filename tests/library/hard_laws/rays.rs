//! Whole rays through the ray caster: shading, shadow and all.

use super::config;
use super::scenes::{any_scene, lattice, layers, power_of_two, rays, settings, sparse_grid};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::{Direction, Ray};
use volref::optics::Layer;
use volref::volume::Lattice;

/// The bits of what a ray sees.
fn bits(layers: &Layer) -> [u64; 4] {
    let DVec3 { x, y, z } = layers.colour;
    [x, y, z, layers.opacity].map(f64::to_bits)
}

proptest! {
    #![proptest_config(config())]

    /// Every length times `2^k`: an exponent changes in each operation, and no digit.
    #[test]
    fn g8_another_unit_of_length_moves_no_bit(
        lattice in lattice(5), seed in any::<u64>(), settings in settings(), exponent in -200..=200,
    ) {
        let seen = |exponent| {
            let factor = power_of_two(exponent);
            let lattice = Lattice::new(
                lattice.nodes(), lattice.spacing() * factor, lattice.first() * factor,
            ).unwrap();
            let scene = settings.scene(sparse_grid(lattice, seed, 0.6));
            layers(&scene, &rays(&scene, 2)).iter().map(bits).collect::<Vec<_>>()
        };
        prop_assert_eq!(seen(exponent), seen(0));
    }

    /// Along an axis, in planes of nodes too.
    #[test]
    fn g1_the_sign_of_a_zero_changes_no_bit(
        scene in any_scene(5), axis in 0..3_usize, place in prop::array::uniform3(0.0..1.0_f64),
        snapped: bool,
    ) {
        let grid_lattice = *scene.grid.lattice();
        let bounds = grid_lattice.bounds();
        let mut origin = bounds.min + bounds.size() * DVec3::from_array(place);
        if snapped {
            let node = grid_lattice.to_nodes(origin).0.round();
            origin = grid_lattice.first() + node * grid_lattice.spacing();
        }
        origin[axis] = bounds.min[axis] - bounds.size()[axis];
        let seen = |zeros: [f64; 3]| {
            let mut direction = DVec3::from_array(zeros);
            direction[axis] = 1.0;
            let direction = Direction::unit(direction);
            bits(&layers(&scene, &[Ray { origin, direction }])[0])
        };
        let expected = seen([0.0; 3]);
        for zeros in [[-0.0; 3], [0.0, -0.0, 0.0], [-0.0, 0.0, -0.0]] {
            prop_assert_eq!(seen(zeros), expected);
        }
    }

    /// Opacity is one, and light is finite and not negative.
    #[test]
    fn a7_no_ray_leaves_the_numbers(scene in any_scene(5)) {
        for seen in layers(&scene, &rays(&scene, 2)) {
            prop_assert!((0.0..=1.0).contains(&seen.opacity), "{seen:?}");
            prop_assert!(seen.colour.is_finite() && seen.colour.min_element() >= 0.0, "{seen:?}");
        }
    }
}
