//! Threads leave no trace.

use super::{config, scenes};
use proptest::prelude::*;
use volref::scene::Shadow;

proptest! {
    #![proptest_config(config(24))]

    #[test]
    fn any_number_of_threads_gives_the_same_bits(scene in scenes::any_scene(9)) {
        let mut scene = scene;
        scene.phong = Some(scenes::PHONG);
        let voxel = scene.grid.lattice().voxel();
        scene.shadow = Some(Shadow { step: voxel, reference_step: 0.05 * voxel });
        let results = [1, 2, 3, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (film, work) = pool.install(|| scenes::rendered(&scene, 9));
            (scenes::bits(&film), work)
        });
        for result in &results[1..] {
            prop_assert_eq!(result, &results[0]);
        }
    }
}
