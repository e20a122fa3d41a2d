//! No valid scene makes a pixel that is no radiance.

use super::{config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::math;
use volref::optics::Phong;
use volref::render::{Plan, Sampling, render};
use volref::scene::Shadow;
use volref::volume::Lattice;

proptest! {
    #![proptest_config(config(192))]

    #[test]
    fn extreme_scenes_have_radiance(
        (nodes, spacing, octave) in (
            prop::array::uniform3(1..4_usize), scenes::vector(0.2..5.0),
            prop_oneof![Just(-900), -40..=40_i32, Just(900)],
        ),
        (seed, magnitude) in (any::<u64>(), -45.0..38.53_f64),
        (settings, step, shadow) in (scenes::settings(), -3.0..3.0_f64, -0.3..3.0_f64),
        (reference, shadow_reference) in (-300.0..300.0_f64, -300.0..300.0_f64),
        floor in prop_oneof![Just(0.0), 0.0..1.0_f64, Just(1.0 - f64::EPSILON / 2.0)],
        (weights, shininess) in (prop::array::uniform3(0.0..10.0_f64), 1..=1_u32 << 20),
        choices in prop::array::uniform3(any::<bool>()),
    ) {
        let unit = scenes::power_of_two(octave);
        let lattice = Lattice::new(nodes, spacing * unit, DVec3::splat(unit)).unwrap();
        let largest = math::pow(10.0, magnitude);
        let grid = scenes::sampled(lattice, |node| {
            // The largest, something below it, the smallest of all, and nothing.
            let index = lattice.index(node);
            match (4.0 * scenes::hash(seed, 2 * index)) as u32 {
                0 => largest as f32,
                1 => (largest * scenes::hash(seed, 2 * index + 1)) as f32,
                2 => f32::from_bits(1),
                _ => 0.0,
            }
        });
        prop_assert!(grid.check_densities().is_ok());
        let mut scene = settings.scene(grid);
        let voxel = lattice.voxel();
        scene.step = math::pow(10.0, step) * voxel;
        scene.transfer_function.appearance = scenes::formula(floor, "heat");
        // The unit times up to 10^±300 stays in range for the unit near 1; else near it.
        let length = |exponent: f64| {
            let near = if octave.abs() > 100 { exponent / 100.0 } else { 0.9 * exponent };
            math::pow(10.0, near) * voxel
        };
        scene.transfer_function.reference_length = length(reference);
        let [ambient, diffuse, specular] = weights;
        let [light_in_eye, shaded, shadowed] = choices;
        if shaded {
            scene.phong = Some(Phong { ambient, diffuse, specular, shininess });
        }
        if shadowed {
            let step = math::pow(10.0, shadow) * voxel;
            scene.shadow = Some(Shadow { step, reference_step: length(shadow_reference) });
        }
        if light_in_eye {
            scene.light = scene.camera.ray([0, 0], [1, 1]).origin;
        }
        let panel = scenes::panel(&scene, 4);
        let plan = Plan::new(&panel);
        let result = render(&[plan], Sampling::default(), &|| ());
        // A scene too bright for f32 is refused when it is read; the renderer must not panic.
        if let Err(reason) = scene.check_brightness() {
            prop_assert!(largest > 1e15, "{reason}");
        } else {
            prop_assert!(result.is_ok(), "{:?}", result.err());
        }
    }
}

/// The brightest density whose square fits, and one beyond.
#[test]
fn radiance_beyond_the_film_is_refused() {
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    let check =
        |density: f32| scenes::plain(scenes::sampled(lattice, |_| density)).check_brightness();
    // √(f32::MAX / 2) = 1.304e19.
    assert!(check(1.30e19).is_ok());
    assert!(check(1.31e19).is_err());
}
