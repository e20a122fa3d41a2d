//! Neither the unit of length nor the place in the world matters.

use super::{config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::Camera;
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
    fn far_from_the_origin_no_bit_moves(
        nodes in prop::array::uniform3(3..8_usize), seed in any::<u64>(), eye in prop::array::uniform3(-400..400_i32)
    ) {
        let lattice = |first| Lattice::new(nodes, DVec3::new(0.5, 0.375, 1.25), first).unwrap();
        let layers = |offset: DVec3| {
            let mut scene = scenes::plain(scenes::sparse_grid(lattice(offset), seed, 0.4));
            let eye = offset + DVec3::from_array(eye.map(|n| f64::from(n) / 8.0)) - DVec3::Z * 64.0;
            scene.camera = Camera::new(eye, offset + DVec3::ONE, DVec3::Y, 0.2).unwrap();
            scenes::layers(&scene, &scenes::rays(&scene, 4))
        };
        let expected = layers(DVec3::ZERO);
        for exponent in [20, 30, 40] {
            let offset = scenes::power_of_two(exponent) * DVec3::new(1.0, -1.0, 1.0);
            prop_assert_eq!(layers(offset), expected.clone());
        }
    }
}
