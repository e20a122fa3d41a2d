//! Opacity over lengths: it composes, and a homogeneous volume has the closed form.

use super::{U, config, scenes};
use crate::common::vector;
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::Ray;
use volref::math;
use volref::optics::Layer;
use volref::optics::over_length;
use volref::scene::{Classified, Compositing};
use volref::volume::{Interpolation, Lattice};

proptest! {
    #![proptest_config(config(1024))]

    #[test]
    fn crossing_two_lengths_is_crossing_their_sum(
        opacity in prop_oneof![0.0..=1.0_f64, (-300.0..0.0_f64).prop_map(|e| math::pow(10.0, e))],
        near in prop_oneof![Just(0.0), 0.0..10.0_f64],
        far in 0.0..10.0_f64,
    ) {
        let whole = over_length(opacity, near + far);
        let layers = [near, far].map(|ratio| over_length(opacity, ratio));
        let split = layers.into_iter().fold(Layer::EMPTY, |layers, opacity| {
            layers.over(Layer::sample(DVec3::ZERO, opacity))
        });
        // Each opacity: 2u for ln_1p, u for the product, 2u for exp_m1, which does not magnify
        // the relative error of a negative argument; the whole also u for near + far. Put
        // together, p + (1 − p)·q rounds three times. All relative to terms that add up to the
        // whole: 6u + 5u + 3u, and one for products of errors. Far below, subnormal numbers
        // round by half their unit instead.
        let bound = 15.0 * U * whole + 8.0 * f64::from_bits(1);
        prop_assert!((whole - split.opacity).abs() <= bound, "{whole:e} {split:?}");
    }
}

/// A constant grid crossed by any number of steps.
#[derive(Clone, Debug)]
struct Homogeneous {
    scene: Classified,
    ray: Ray,
    length: f64,
    density: f64,
}

impl Homogeneous {
    fn check(&self, steps: f64) -> Result<(), TestCaseError> {
        let mut scene = self.scene.clone();
        scene.step = self.length / steps;
        let a0 = scene.transfer_function.reference_opacity(self.density);
        let ratio = self.length / scene.transfer_function.reference_length;
        let closed = -math::exp_m1(ratio * math::ln_1p(-a0));
        let radiance = scene.transfer_function.colour(self.density)
            * scene.transfer_function.emission(self.density);
        let mut found = Vec::new();
        for interpolation in [Interpolation::Nearest, Interpolation::Trilinear] {
            for compositing in [Compositing::FrontToBack, Compositing::BackToFront] {
                scene.interpolation = interpolation;
                scene.compositing = compositing;
                let layers = scenes::layers(&scene, &[self.ray])[0];
                // A sample's opacity has 5u as above and u for length/h0, weighed with its
                // visibility at most 6u of the whole; the last step's length is off by 2u of the
                // ray's, which x·e^(−x) ≤ 1/e keeps below 2u; the closed form has 6u. One order
                // of compositing rounds at most 5u a step, see `order.rs`. A step more than
                // asked for may come of rounding.
                let bound = (14.0 + 5.0 * (steps.max(1.0) + 2.0)) * U;
                prop_assert!(
                    (layers.opacity - closed).abs() <= bound,
                    "{steps} steps: {} is not {closed}",
                    layers.opacity
                );
                // The radiance of a sample is the same everywhere: it has three roundings, and
                // its sum those of the opacity.
                let apart = (layers.colour - radiance * closed).abs();
                let bound = (bound + 3.0 * U) * radiance.max_element();
                prop_assert!(apart.max_element() <= bound, "{steps} steps: {layers:?}");
                found.push(layers);
            }
        }
        // Nearest and trilinear are one field, to the bit.
        prop_assert_eq!(found[0], found[2]);
        prop_assert_eq!(found[1], found[3]);
        Ok(())
    }
}

fn homogeneous() -> impl Strategy<Value = Homogeneous> {
    let inside = prop::array::uniform3(0.05..0.95_f64).prop_map(DVec3::from_array);
    (
        scenes::lattice(6),
        0.0..1.2_f32,
        0.01..100.0_f64,
        vector(-2.0..2.0),
        inside,
    )
        .prop_map(|(lattice, density, reference, eye, inside)| {
            let bounds = lattice.bounds();
            let mut scene = scenes::plain(scenes::sampled(lattice, |_| density));
            scene.transfer_function.reference_length = reference;
            let eye = bounds.centre() + eye * bounds.size();
            let ray = Ray::new(eye, bounds.min + inside * bounds.size() - eye).unwrap();
            Homogeneous {
                scene,
                ray,
                length: bounds.span(&ray).unwrap().length(),
                density: density.into(),
            }
        })
}

proptest! {
    #![proptest_config(config(128))]

    #[test]
    fn a_homogeneous_volume_has_the_closed_form_for_any_step(
        medium in homogeneous(), steps in 0.5..100.0_f64
    ) {
        // From a step longer than the box to a thousand.
        for steps in [1e-3, 0.999, 1.0, 2.0, 7.0, 1000.0, steps, 2.0 * steps, 4.0 * steps] {
            medium.check(steps)?;
        }
    }
}

#[test]
fn the_last_step_is_as_long_as_what_is_left() {
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    let mut scene = scenes::plain(scenes::sampled(lattice, |_| 0.5));
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z).unwrap();
    // Numbers for which lengths and ratios are exact: 1 = ¾ + ¼.
    scene.step = 0.75;
    let parts = [0.75, 0.25].map(|length| scene.transfer_function.opacity(0.5, length));
    let expected = parts[0] + parts[1] * (1.0 - parts[0]);
    assert_eq!(scenes::layers(&scene, &[ray])[0].opacity, expected);
}
