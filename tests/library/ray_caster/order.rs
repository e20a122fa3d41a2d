//! Front to back and back to front are the same sum.

use super::{U, config, scenes};
use proptest::prelude::*;
use volref::math;
use volref::optics::Layer;
use volref::scene::{Classified, Compositing};

fn both_orders(mut scene: Classified, size: usize) -> [Vec<Layer>; 2] {
    let rays = scenes::rays(&scene, size);
    [Compositing::FrontToBack, Compositing::BackToFront].map(|compositing| {
        scene.compositing = compositing;
        scenes::layers(&scene, &rays)
    })
}

/// How far apart the two orders may be for `samples` samples of radiance at most 1.
///
/// Back to front, each step rounds 1 − a, a product and a sum, none above 1, and passes the
/// error of what lies behind on times 1 − a: at most 3u a step.
/// Front to back, a step rounds 1 − a and its product with the transparency T: after n samples T is
/// off by 2u·n of itself. The parts a·T of all samples add up to 1 at most, so that this moves
/// colour and opacity by no more than 2u a step; the product and the sum of a step add 2u. Two more
/// u a step cover products of errors.
fn bound(samples: f64) -> f64 {
    9.0 * samples * U
}

proptest! {
    #![proptest_config(config(128))]

    #[test]
    fn both_orders_give_the_same_sum(scene in scenes::any_scene(9)) {
        let diagonal = scene.grid.lattice().bounds().size().length();
        let bound = bound((diagonal / scene.step).ceil() + 1.0);
        // Sums of Phong's weights, of which no cosine is above 1 by more than roundings.
        let weights = scene.phong.map_or(1.0, |p| p.ambient + p.diffuse + p.specular);
        let (_, most) = scene.grid.range();
        let brightest = scene.transfer_function.emission(most) * weights.max(1.0);
        let [front, back] = both_orders(scene, 3);
        for (front, back) in front.iter().zip(&back) {
            let apart = (front.colour - back.colour).abs().max_element();
            prop_assert!(apart <= bound * brightest, "{front:?} {back:?}");
            prop_assert!((front.opacity - back.opacity).abs() <= bound, "{front:?} {back:?}");
        }
    }
}

/// What is in front hides what is behind, in both orders.
#[test]
fn the_nearer_half_is_seen() {
    let lattice = volref::volume::Lattice::new([5, 5, 9], glam::DVec3::ONE, glam::DVec3::ZERO);
    let lattice = lattice.unwrap();
    // Red in front (density 1), blue behind (a density near 0 is blue).
    let mut scene = scenes::plain(scenes::sampled(
        lattice,
        |[_, _, k]| if k < 4 { 1.0 } else { 0.1 },
    ));
    scene.interpolation = volref::volume::Interpolation::Nearest;
    for layers in both_orders(scene, 1) {
        let red = layers[0].colour;
        // Three and a half voxels of transparency 0.0123 let 1e-6 of what is behind through.
        let through = math::pow(0.012_32, 3.5);
        assert!(
            red.x >= 1.0 - through && red.y <= through && red.z <= through,
            "{red}"
        );
    }
}
