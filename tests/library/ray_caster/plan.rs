//! What a plan leaves out would have changed nothing, and what it leaves out costs nothing.

use super::{config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::Camera;
use volref::render::Counters;
use volref::render::counters::Event;
use volref::scene::Shadow;
use volref::volume::Lattice;

proptest! {
    #![proptest_config(config(512))]

    /// A ray along z through a grid without empty space: every number is known.
    #[test]
    fn the_work_of_a_lone_ray_is_known(
        nodes in 3..12_usize, steps in 1..60_u32, shading in any::<bool>(), shadow in any::<bool>()
    ) {
        let lattice = Lattice::new([3, 3, nodes], DVec3::ONE, DVec3::ZERO).unwrap();
        let mut scene =
            scenes::plain(scenes::sampled(lattice, |[i, j, k]| 0.01 * (1 + i + j + k) as f32));
        let depth = (nodes - 1) as f64;
        // Half a step short of a whole number, so that rounding decides nothing.
        scene.step = depth / (f64::from(steps) - 0.5);
        scene.phong = shading.then_some(scenes::PHONG);
        // The light stands in the middle of the front face, the eye before it: the way of each
        // sample to the light is its way to the face. No fraction of the depth by a number below
        // 120 is a whole number of these shadow steps, so here too rounding decides nothing.
        let shadow_step = 0.739_085_1;
        let front = DVec3::new(1.0, 1.0, 0.0);
        scene.light = front;
        scene.shadow = shadow.then_some(Shadow { step: shadow_step, reference_step: 0.1 });
        scene.camera = Camera::new(front - DVec3::Z, front, DVec3::Y, 1.0).unwrap();
        let (_, work) = scenes::rendered(&scene, 1);
        let samples = u64::from(steps);
        let mut towards_light = 0;
        if shadow {
            for index in 0..steps {
                let begin = f64::from(index) * scene.step;
                let middle = 0.5 * (begin + (begin + scene.step).min(depth));
                towards_light += (middle / shadow_step).ceil() as u64;
            }
        }
        prop_assert_eq!(work, Counters::from([
            (Event::DensityLookup, samples + towards_light),
            (Event::GradientLookup, if shading { samples } else { 0 }),
            (Event::GradientComputed, if shading { 9 * nodes as u64 } else { 0 }),
            (Event::ShadowRay, if shadow { samples } else { 0 }),
            (Event::Attenuation, samples),
            (Event::EmissionTerm, samples),
        ]));
    }
}
