//! Neither the unit of length nor the place in the world matters.

use super::symmetry::{Lighting, setup};
use super::{config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::volume::Lattice;

proptest! {
    #![proptest_config(config(64))]

    /// Every length times a power of two: an exponent changes in each operation, and no digit.
    #[test]
    fn another_unit_of_length_moves_no_bit(
        lattice in scenes::lattice(12), seed in any::<u64>(), settings in scenes::settings()
    ) {
        let scene = |exponent| {
            let factor = scenes::power_of_two(exponent);
            let lattice = Lattice::new(
                lattice.nodes(), lattice.spacing() * factor, lattice.first() * factor,
            ).unwrap();
            settings.scene(scenes::sparse_grid(lattice, seed, 0.4))
        };
        let (expected, work) = scenes::rendered(&scene(0), 4);
        for exponent in [-200, -40, -3, 3, 40, 200] {
            let (film, same) = scenes::rendered(&scene(exponent), 4);
            prop_assert_eq!(scenes::bits(&film), scenes::bits(&expected), "2^{}", exponent);
            prop_assert_eq!(same, work);
        }
    }

    /// Places that stay exact when moved, and no light: rays and lookups are relative to eye
    /// and grid, so nothing is lost however far away the scene is.
    #[test]
    fn far_from_the_origin_no_bit_moves(setup in setup()) {
        let expected = setup.layers(Lighting::None, DVec3::ZERO);
        for exponent in [20, 30, 40] {
            let offset = scenes::power_of_two(exponent) * DVec3::new(1.0, -1.0, 1.0);
            prop_assert_eq!(setup.layers(Lighting::None, offset), expected.clone());
        }
    }

    /// Light depends on the world position of a sample, which is rounded to the digits that
    /// coordinates have out there.
    #[test]
    fn far_from_the_origin_light_moves_by_the_rounding_of_coordinates(setup in setup()) {
        let offset = scenes::power_of_two(20) * DVec3::new(1.0, -1.0, 1.0);
        for lighting in [Lighting::Shading, Lighting::Shadow] {
            let near = setup.layers(lighting, DVec3::ZERO);
            let far = setup.layers(lighting, offset);
            let scene = setup.scene(lighting, offset);
            for ((near, far), ray) in near.iter().zip(&far).zip(scenes::rays(&scene, setup.size)) {
                let Some(bound) = setup.bound(&scene, &ray) else { continue };
                let apart = (near.colour - far.colour).abs().max_element();
                prop_assert!(apart <= bound.colour, "{near:?} {far:?} {bound:?}");
                prop_assert_eq!(near.opacity, far.opacity);
            }
        }
    }
}
