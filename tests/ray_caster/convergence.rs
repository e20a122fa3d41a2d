//! Refining the step converges, at order 2 for a smooth field.

use super::{config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::Ray;
use volref::volume::Lattice;

proptest! {
    #![proptest_config(config(128))]

    /// Inside one cell the density is a polynomial along the ray, so the error of the midpoint
    /// rule is c₂h² + c₄h⁴ + …, and halving the step divides it by 4.
    #[test]
    fn halving_the_step_quarters_the_error(
        corners in prop::array::uniform8(0.05..0.9_f32),
        from in prop::array::uniform2(0.1..0.9_f64),
        to in prop::array::uniform2(0.1..0.9_f64),
    ) {
        let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
        let mut scene = scenes::plain(scenes::sampled(lattice, |node| corners[lattice.index(node)]));
        scene.transfer_function.colormap = volref::media::Colormap::named("white").unwrap();
        let [a, b] = [DVec3::new(from[0], from[1], -1.0), DVec3::new(to[0], to[1], 1.0)];
        let ray = Ray::new(a, b - a).unwrap();
        // The ray may leave by a side face: then its span is shorter, which changes nothing.
        let Some(span) = lattice.bounds().span(&ray) else { return Ok(()) };
        prop_assume!(span.length() > 0.2);
        let mut at = |steps: f64| {
            scene.step = span.length() / steps;
            let layers = scenes::layers(&scene, &[ray])[0];
            [layers.opacity, layers.colour.x]
        };
        let [coarse, middle, fine] = [at(128.0), at(256.0), at(512.0)];
        for quantity in 0..2 {
            let (first, second) =
                (coarse[quantity] - middle[quantity], middle[quantity] - fine[quantity]);
            // With f the integrand, |c₂| is at most max|f''|/24 and |c₄| 7·max|f''''|/5760.
            // Densities in [0.05, 0.9] over a length of one, through opacities that no more
            // than double them, keep derivatives of order n below 20ⁿ; so the first difference
            // is c₂h²·¾ to within 20⁴·h⁴/100, which is 6e-6 at h = 1/128, and the ratio is
            // known where the difference is well above that.
            let next = 1600.0 * scene_step_to_the_fourth(span.length() / 128.0);
            let slack = 8.0 * next;
            prop_assert!(
                (first - 4.0 * second).abs() <= slack,
                "{first:e} is not 4 · {second:e}, to within {slack:e}"
            );
        }
    }
}

fn scene_step_to_the_fourth(step: f64) -> f64 {
    step * step * step * step
}

/// The law above allows a small difference anything: here the order itself, of a field known to
/// curve.
#[test]
fn the_order_is_two() {
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    // The product xyz along a diagonal is a cubic.
    let mut scene = scenes::plain(scenes::sampled(lattice, |node| {
        f32::from(u8::from(node == [1; 3]))
    }));
    let ray = Ray::new(DVec3::splat(-1.0), DVec3::ONE).unwrap();
    let length = lattice.bounds().span(&ray).unwrap().length();
    let mut at = |steps: f64| {
        scene.step = length / steps;
        // Half of the volume's reference opacity, to stay away from where T meets 0.
        scene.transfer_function.opacity.floor = 0.1;
        scenes::layers(&scene, &[ray])[0].opacity
    };
    let [coarse, middle, fine] = [at(64.0), at(128.0), at(256.0)];
    let ratio = (coarse - middle) / (middle - fine);
    // The next term is h² smaller: (1/64)² times a constant of order ten.
    assert!((ratio - 4.0).abs() <= 0.05, "{ratio}");
}
