//! Leaps over empty space change no bit.

use super::{config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::Camera;
use volref::render::plan::Kernel;
use volref::render::{Counters, Event, Plan};
use volref::scene::Classified;
use volref::volume::Lattice;

fn with_leaps(scene: &Classified, leap: bool, size: usize) -> (Vec<[u32; 4]>, Counters) {
    let panel = scenes::panel(scene, size);
    let mut plan = Plan::new(&panel);
    if let Kernel::RayCaster { features, .. } = &mut plan.kernel {
        features.skip_empty = leap;
    }
    let (film, work) = scenes::render_by(plan);
    (scenes::bits(&film), work)
}

proptest! {
    #![proptest_config(config(256))]

    #[test]
    fn leaping_changes_no_bit(scene in scenes::any_scene(24)) {
        let (bits, leaping) = with_leaps(&scene, true, 5);
        let (same, walking) = with_leaps(&scene, false, 5);
        prop_assert_eq!(bits, same);
        prop_assert!(leaping[Event::DensityLookup] <= walking[Event::DensityLookup]);
        // Only what is seen is shaded and lit, and leaps pass over nothing that is seen.
        prop_assert_eq!(leaping[Event::GradientLookup], walking[Event::GradientLookup]);
        prop_assert_eq!(leaping[Event::ShadowRay], walking[Event::ShadowRay]);
        prop_assert_eq!(walking[Event::CellWalked], 0);
    }
}

#[test]
fn a_lone_voxel_is_found_and_the_rest_is_leapt_over() {
    let lattice = Lattice::new([65, 65, 65], DVec3::ONE, DVec3::ZERO).unwrap();
    let at = [33, 31, 60];
    let lone = |node: [usize; 3]| f32::from(u8::from(node == at));
    let mut scene = scenes::plain(scenes::sampled(lattice, lone));
    // The pixel in the middle looks straight at it.
    let eye = DVec3::new(20.0, 40.0, -100.0);
    scene.camera = Camera::new(eye, lattice.position(at), DVec3::Y, 0.5).unwrap();
    let (bits, leaping) = with_leaps(&scene, true, 65);
    let (same, walking) = with_leaps(&scene, false, 65);
    assert_eq!(bits, same);
    assert_ne!(bits[65 * 32 + 32][3], 0);
    // Samples near the voxel alone: two blocks each way out of sixteen, along a few rays.
    assert!(leaping[Event::DensityLookup] * 100 < walking[Event::DensityLookup]);
}
