//! Transfer functions by points: closed forms, order, steps, peaks, negative values, leaps and
//! shadow.

use super::{U, config, scenes};
use glam::DVec3;
use proptest::prelude::*;
use volref::geometry::{Camera, Ray};
use volref::math;
use volref::optics::{Appearance, TransferPoint, TransferPoints, over_length};
use volref::render::plan::Kernel;
use volref::render::{Event, Plan};
use volref::scene::{Classified, Shadow};
use volref::volume::{Interpolation, Lattice};

fn point((value, opacity): (f64, f64)) -> TransferPoint {
    TransferPoint {
        value,
        colour: DVec3::new(0.25, 1.0, 2.0),
        opacity,
    }
}

fn table(points: &[(f64, f64)]) -> Appearance {
    let points = points.iter().copied().map(point).collect();
    Appearance::Points(TransferPoints::new(points).unwrap())
}

/// A field that rises along z from `from` to `to` over the length 1, seen through `points`,
/// and a ray along it.
fn ramp(from: f32, to: f32, points: &[(f64, f64)], reference_length: f64) -> (Classified, Ray) {
    let lattice = Lattice::new([2, 2, 2], DVec3::ONE, DVec3::ZERO).unwrap();
    let rising = |[_, _, k]: [usize; 3]| if k == 0 { from } else { to };
    let mut scene = scenes::plain(scenes::sampled(lattice, rising));
    scene.transfer_function.appearance = table(points);
    scene.transfer_function.reference_length = reference_length;
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z).unwrap();
    (scene, ray)
}

/// Optical depth that `scene` shows along `ray` in steps of `step`.
fn depth(scene: &mut Classified, ray: Ray, step: f64) -> f64 {
    scene.step = step;
    -math::ln_1p(-scenes::layers(scene, &[ray])[0].opacity)
}

/// `∫₀^a −ln(1 − o) do`.
fn depth_up_to(a: f64) -> f64 {
    (1.0 - a) * math::ln_1p(-a) + a
}

/// The colours of a table are radiances as they stand, without the formula's `d²`: what a ray
/// sees of one colour is that colour times its opacity.
#[test]
fn one_colour_is_seen_as_it_stands() {
    let (scene, ray) = ramp(-3.0, 9.0, &[(-2.0, 0.0), (8.0, 1.0)], 1.0);
    let layers = scenes::layers(&scene, &[ray])[0];
    assert!(layers.opacity > 0.5);
    let expected = DVec3::new(0.25, 1.0, 2.0) * layers.opacity;
    assert!((layers.colour - expected).abs().max_element() <= 20.0 * U);
}

/// A step where a sample never lies is exact; its place is known to half a sample.
#[test]
fn a_step_divides_the_volume() {
    let points = [(0.25, 0.0), (0.25, 0.5)];
    let (mut scene, ray) = ramp(0.0, 1.0, &points, 1.0);
    for steps in [4, 64] {
        let expected = -0.75 * math::ln_1p(-0.5);
        let depth = depth(&mut scene, ray, 1.0 / f64::from(steps));
        assert!((depth - expected).abs() <= 10.0 * f64::from(steps) * U);
    }
    // Two steps in three lie beyond the place, three quarters of the length.
    let depth = depth(&mut scene, ray, 1.0 / 3.0);
    assert!((depth + 2.0 / 3.0 * math::ln_1p(-0.5)).abs() <= 30.0 * U);
    // At the value itself the later point holds.
    scene.interpolation = Interpolation::Nearest;
    let whole = |scene: &Classified| scenes::layers(scene, &[ray])[0].opacity;
    scene.grid = scenes::sampled(*scene.grid.lattice(), |_| 0.25);
    assert!(whole(&scene) > 0.0);
    scene.grid = scenes::sampled(*scene.grid.lattice(), |_| 0.249_999_98);
    assert_eq!(whole(&scene), 0.0);
}

/// Hard case D13: opaque only between 0.49 and 0.51, the field linear. Samples 0.1 apart, at
/// 0.45 and 0.55, miss it altogether: all of an optical depth of 2. Steps below the width of the
/// peak converge to it.
#[test]
fn a_narrow_peak_needs_steps_narrower_than_itself() {
    let a = 0.9;
    let points = [(0.49, 0.0), (0.5, a), (0.51, 0.0)];
    // Chosen so that the depth is 2.
    let reference_length = 0.02 * depth_up_to(a) / a / 2.0;
    let (mut scene, ray) = ramp(0.0, 1.0, &points, reference_length);
    assert_eq!(depth(&mut scene, ray, 0.1), 0.0);
    for steps in [1000_u32, 4000, 16_000] {
        let h = 1.0 / f64::from(steps);
        let error = (depth(&mut scene, ray, h) - 2.0).abs();
        // Per distance, σ = −ln(1 − o)/h0 has o' = a/0.01; a step around one of the three
        // kinks is off by no more than h²/8 times the bend, and the smooth parts by
        // h²/24·|Δσ'|, of which the steepest slope, 10·a/0.01/h0, is the larger.
        let slope = a / 0.01 / reference_length;
        let bends = slope + 20.0 * slope + slope;
        let smooth = 2.0 * 9.0 * slope / 24.0 * 2.0;
        let bound = h * h * (bends / 8.0 + smooth) + f64::from(steps) * 30.0 * U;
        assert!(error <= bound, "{steps}: {error:e} {bound:e}");
    }
    assert!((depth(&mut scene, ray, 1.0 / 16_000.0) - 2.0).abs() < 2e-3);
}

/// Tables whose transparent parts lie anywhere, over values from −2 to 2.
fn any_table() -> impl Strategy<Value = Appearance> {
    let opacity = prop_oneof![3 => Just(0.0), 2 => 0.0..1.0_f64, 1 => Just(1.0)];
    // Quarters, so that nodes fall on points and points on each other.
    let values = prop::collection::vec((-8..=8_i32, opacity), 1..7);
    values.prop_map(|mut points| {
        points.sort_by_key(|(value, _)| *value);
        let mut kept: Vec<(f64, f64)> = Vec::new();
        for (value, opacity) in points {
            let value = f64::from(value) / 4.0;
            if kept.len() < 2 || kept[kept.len() - 2].0 < value {
                kept.push((value, opacity));
            }
        }
        table(&kept)
    })
}

/// Any scene with a table; the values of the volume go from −1.5 to about 1, or are quarters.
fn any_scene() -> impl Strategy<Value = Classified> {
    (scenes::any_scene(16), any_table(), any::<bool>()).prop_map(|(mut scene, table, quarters)| {
        let old = scene.grid.clone();
        let lattice = *old.lattice();
        scene.grid = scenes::sampled(lattice, |node| {
            let value = 2.0 * old.values()[lattice.index(node)] - 1.5;
            if quarters {
                (4.0 * value).round() / 4.0
            } else {
                value
            }
        });
        scene.transfer_function.appearance = table;
        scene
    })
}

proptest! {
    #![proptest_config(config(256))]

    /// Pictures are finite and not negative.
    #[test]
    fn no_table_makes_a_pixel_that_is_no_number(scene in any_scene()) {
        let (film, _) = scenes::rendered(&scene, 4);
        let opacity = film.opacity().unwrap();
        prop_assert!(opacity.iter().all(|a| (0.0..=1.0).contains(a)));
        let channels = film.radiance().iter().flatten();
        prop_assert!(channels.into_iter().all(|c| c.is_finite() && *c >= 0.0));
    }
}

/// Air around a ball: most of the samples are leapt over though no value is 0.
#[test]
fn air_of_any_value_is_leapt_over() {
    let lattice = Lattice::new([65, 65, 65], DVec3::ONE, DVec3::ZERO).unwrap();
    let centre = DVec3::splat(32.0);
    let mut scene = scenes::plain(scenes::sampled(lattice, |node| {
        let distance = (lattice.position(node) - centre).length();
        if distance < 6.0 { 300.0 } else { -1000.0 }
    }));
    scene.transfer_function.appearance = table(&[(-500.0, 0.0), (300.0, 1.0)]);
    scene.camera = Camera::new(DVec3::new(20.0, 40.0, -100.0), centre, DVec3::Y, 0.5).unwrap();
    let (_, work) = scenes::rendered(&scene, 33);
    let panel = scenes::panel(&scene, 33);
    let mut plan = Plan::new(&panel);
    let Kernel::RayCaster { features, .. } = &mut plan.kernel else {
        panic!("not rendered by the ray caster")
    };
    assert!(features.skip_empty);
    features.skip_empty = false;
    let (_, walking) = scenes::render_by(plan);
    assert!(work[Event::DensityLookup] * 10 < walking[Event::DensityLookup]);
}

/// What lies in the way of the light lets through what it would let through towards the eye.
#[test]
fn the_shadow_is_what_opacities_let_through() {
    // The sample at the near face, lit from behind the volume: all of it lies in the way.
    let a = 0.5;
    let (mut scene, ray) = ramp(-1.0, -1.0, &[(-2.0, 0.0), (-1.0, a)], 1.0);
    scene.step = 1.0 / 64.0;
    scene.light = DVec3::new(0.5, 0.5, 9.0);
    let seen = |scene: &Classified| scenes::layers(scene, &[ray])[0];
    let lit = seen(&scene);
    for reference_step in [1.0, 4.0] {
        scene.shadow = Some(Shadow {
            step: 1.0 / 256.0,
            reference_step,
        });
        let shaded = seen(&scene);
        assert_eq!(shaded.opacity, lit.opacity);
        // Σ over samples of a_i·T_i·(light through what is left).
        let (mut through, mut expected) = (1.0, 0.0);
        for i in 0..64 {
            let t = (f64::from(i) + 0.5) / 64.0;
            let opacity = over_length(a, 1.0 / 64.0);
            let light = 1.0 - over_length(a, (1.0 - t) / reference_step);
            expected += through * opacity * light;
            through *= 1.0 - opacity;
        }
        assert!((shaded.colour.y - expected).abs() <= 2000.0 * U);
        assert!(shaded.colour.y < lit.colour.y);
    }
    // Nothing comes through what is opaque.
    let (mut scene, ray) = ramp(5.0, 5.0, &[(5.0, 1.0)], 1.0);
    scene.light = DVec3::new(0.5, 0.5, 9.0);
    scene.shadow = Some(Shadow {
        step: 0.01,
        reference_step: 1.0,
    });
    assert_eq!(scenes::layers(&scene, &[ray])[0].colour, DVec3::ZERO);
}
