//! Derivatives of images by the numbers of their scenes: against closed forms, quadrature and laws.

use crate::common::quadrature::integral;
use crate::common::suite::{film_of as image, film_with, scene_of};
use glam::DVec3;
use std::path::Path;
use volref::film::Film;
use volref::geometry::Transform;
use volref::math::{exp, ln};
use volref::render::Detail;
use volref::scene::{Model, Scene};
use volref::sensitivity::{Derivative, Differences, derivative, number, numbers};

fn scene(name: &str, [width, height]: [usize; 2]) -> Scene {
    let mut scene = scene_of(name);
    for panel in &mut scene.panels {
        (panel.width, panel.height) = (width, height);
    }
    scene
}

fn differences(samples: u32, step: Option<f64>) -> Differences {
    Differences {
        detail: Detail::Whole,
        samples,
        pairs: 16,
        seed: 5,
        step,
    }
}

fn derivative_by(scene: &Scene, name: &str, differences: &Differences) -> Derivative {
    let number = number(scene, name).unwrap();
    derivative(scene, &number, differences, &|| false)
        .unwrap()
        .unwrap()
}

/// Every channel of every pixel of `found` is what `expected` makes of that of the image, within
/// the error that it states; which itself is no more than `most` of the value.
fn assert_is(scene: &Scene, found: &Derivative, most: f64, expected: impl Fn(usize, f64) -> f64) {
    let image = image(scene);
    let variance = found.film.noise().unwrap().variance();
    for (at, pixel) in image.radiance().iter().enumerate() {
        for c in 0..3 {
            let expected = expected(c, f64::from(pixel[c]));
            let is = f64::from(found.film.radiance()[at][c]);
            let error = f64::from(variance[at][c]).sqrt();
            // The stated error is that of the last term of a series that falls sixteenfold; beside it
            // stands the rounding of the image that `expected` is made of, ten times: it is divided by a
            // difference of radiances, and multiplied by a logarithm.
            let size = f64::from(pixel[c]).abs().max(expected.abs());
            let rounding = 40.0 * f64::from(f32::EPSILON) * size;
            assert!(
                (is - expected).abs() <= 2.0 * error + rounding,
                "{at} {c}: {is} {expected} {error}"
            );
            assert!(
                error <= most * expected.abs() + rounding / 0.1,
                "{at} {c}: {error} of {expected}"
            );
        }
    }
}

/// `T = exp(−τ)` has the derivative `−τ·T` by a share of the density, with `τ = −ln T`.
#[test]
fn transmittance_of_a_grid() {
    let scene = scene("known-answers/absorbing-grid", [24, 24]);
    let found = derivative_by(&scene, "density", &differences(1, None));
    assert_eq!((found.is_central, found.unsettled), (true, 0));
    // Differences with steps of 0.1 and 0.05: τ⁴·10⁻⁴/48 of τ is left of the third term and beyond.
    assert_is(&scene, &found, 0.02, |_, pixel| pixel * ln(pixel));
}

/// A slab that glows by `j` and absorbs by `σ` before a sky of `E`: `j/σ + (E − j/σ)·T`. Density
/// scales both coefficients.
#[test]
fn emission_of_a_slab() {
    let scene = scene("known-answers/emitting-slab", [24, 24]);
    let Model::Radiative(model) = &scene.panels[0].model else {
        panic!("media")
    };
    let medium = model.media[0].medium;
    let glow: DVec3 = medium.emission / medium.coefficients.sigma_a();
    let beyond = model.environment - glow;
    let transmittance = |c: usize, pixel: f64| ((pixel - glow[c]) / beyond[c]).clamp(0.0, 1.0);
    let found = derivative_by(&scene, "density", &differences(1, None));
    assert_is(&scene, &found, 0.05, |c, pixel| {
        match transmittance(c, pixel) {
            0.0 => 0.0,
            left => beyond[c] * left * ln(left),
        }
    });
    // In proportion: the derivative is what the slab itself gives.
    let found = derivative_by(&scene, "emission", &differences(1, None));
    assert_is(&scene, &found, 1e-5, |c, pixel| {
        glow[c] * (1.0 - transmittance(c, pixel))
    });
}

/// Single scattering: the derivative of the integrand, by quadrature.
#[test]
fn single_scattering_of_a_point_light() {
    let scene = scene("known-answers/airlight", [7, 7]);
    let Model::Radiative(model) = &scene.panels[0].model else {
        panic!("media")
    };
    let coefficients = model.media[0].medium.coefficients;
    let [sigma_t, sigma_s] = [coefficients.sigma_t().x, coefficients.sigma_s().x];
    let light = model.lights[0];
    let position = light.position().unwrap();
    let found = derivative_by(&scene, "density", &differences(1, None));
    let variance = found.film.noise().unwrap().variance();
    for (at, variance) in variance.iter().enumerate() {
        let ray = model.camera.ray([at % 7, at / 7], [7, 7]);
        // About the point that is nearest to the light the tangent rule makes the integrand smooth.
        let nearest = (position - ray.origin).dot(*ray.direction);
        let distance = (position - ray.origin - *ray.direction * nearest).length();
        let [from, to] = [0.0, 150.0].map(|t: f64| volref::math::atan2(t - nearest, distance));
        let expected = integral(from, to, 200, |angle| {
            let (sine, cosine) = (volref::math::sin(angle), volref::math::cos(angle));
            let (t, r) = (nearest + distance * sine / cosine, distance / cosine);
            let path = sigma_t * (t + r);
            let jacobian = distance / (cosine * cosine);
            let lit = light.strength().x / (r * r) / (4.0 * std::f64::consts::PI);
            jacobian * sigma_s * lit * exp(-path) * (1.0 - path)
        });
        let is = f64::from(found.film.radiance()[at][0]);
        let error = f64::from(variance[0]).sqrt();
        // The medium ends at 150, beyond an optical depth of 30: e⁻³⁰ is nothing beside a rounding.
        let rounding = 1e-6 * f64::from(image(&scene).radiance()[at][0]);
        assert!(
            (is - expected).abs() <= 2.0 * error + 40.0 * rounding,
            "{at}: {is} {expected} {error}"
        );
        assert!(
            error <= 0.02 * expected.abs() + 40.0 * rounding,
            "{at}: {error}"
        );
    }
}

/// Matter that only scatters, in light from everywhere, is not seen: nothing of it changes the
/// image. The light itself does, in proportion.
#[test]
fn nothing_of_a_furnace_is_seen() {
    let scene = scene("hard/s4-white-furnace", [8, 8]);
    for name in ["density", "g", "environment"] {
        let found = derivative_by(&scene, name, &differences(256, None));
        let expected = if name == "environment" { 1.0 } else { 0.0 };
        let variance = found.film.noise().unwrap().variance().as_flattened();
        let count = variance.len() as f64;
        let values = found.film.radiance().as_flattened().iter();
        let mean = values.map(|&value| f64::from(value)).sum::<f64>() / count;
        // The three channels share their noise: a third as many are independent.
        let sum: f64 = variance.iter().map(|&value| f64::from(value)).sum();
        let error = (3.0 * sum).sqrt() / count;
        assert!(
            (mean - expected).abs() <= 4.0 * error + 1e-6,
            "{name}: {mean} ± {error}"
        );
    }
}

/// Derivatives by the place of a volume are the differences of images whose map is another one.
#[test]
fn a_placed_volume_is_moved_turned_and_stretched() {
    let scene = scene("scenes/turned", [16, 16]);
    let volume = scene.panels[0].classified().unwrap();
    let (map, extent) = (volume.to_world.unwrap(), volume.extent());
    let (centre, edges) = (extent.bounds.centre(), volume.cell_edges());
    let about = |map: Transform, centre: DVec3| map.about(centre).unwrap();
    type Placed<'p> = &'p dyn Fn(f64) -> Transform;
    let moved: Placed<'_> = &|by| map.then(&Transform::translation(edges[1] * by).unwrap());
    let turned: Placed<'_> = &|by| {
        let turn = Transform::rotation(DVec3::Z, by).unwrap();
        map.then(&about(turn, map.point(centre)))
    };
    let stretched: Placed<'_> = &|by| {
        let scale = Transform::scale(DVec3::new(1.0 + by, 1.0, 1.0)).unwrap();
        about(scale, centre).then(&map)
    };
    for (name, placed, step) in [
        ("grid.y", moved, 0.02),
        ("turn.z", turned, 0.05),
        ("size.x", stretched, 2e-3),
    ] {
        let at = |by: f64| {
            let found = image(&number(&scene, name).unwrap().changed(&scene, by).unwrap());
            let moved = scene.with_volumes(|volume| volume.to_world = Some(placed(by)));
            let values = |film: Film| film.radiance().as_flattened().to_vec();
            let (found, moved) = (values(found), values(image(&moved)));
            let off = found.iter().zip(&moved).map(|(a, b)| (a - b).abs());
            let worst = off.fold(0.0, f32::max);
            assert!(worst < 1e-5, "{name} by {by}: {worst}");
            moved
        };
        let (more, less) = (at(step), at(-step));
        let found = derivative_by(&scene, name, &differences(1, Some(step)));
        let variance = found.film.noise().unwrap().variance().as_flattened();
        let found = found.film.radiance().as_flattened();
        let largest = found
            .iter()
            .fold(0.0, |most: f32, value| most.max(value.abs()));
        // Rays gain and lose a last step, which moves the others: few, and their error says so.
        let off = (0..found.len()).filter(|&i| {
            let expected = (more[i] - less[i]) / (2.0 * step as f32);
            (found[i] - expected).abs() > 2.0 * variance[i].sqrt() + 0.02 * largest
        });
        let off = off.count();
        assert!(largest > 0.0 && off * 100 < found.len(), "{name}: {off}");
    }
}

/// An edge moves over pixels: these have no derivative, and it is said how many.
#[test]
fn pixels_at_edges_are_counted() {
    let text = r#"
        film = { width = 32, height = 32 }
        camera = { eye = [0, 0, -3], target = [0, 0, 0], up = [0, 1, 0], vertical_fov = 50 }
        [radiative]
        scattering = "none"
        environment = 0.5
        [[radiative.surface]]
        sphere = { centre = [0, 0, 0], radius = 0.75 }
        emitter = { radiance = 2 }
    "#;
    let scene = Scene::parse(text, Path::new("edge.toml")).unwrap();
    let found = derivative_by(&scene, "camera.right", &differences(1, Some(0.5)));
    // The sphere is about seventeen pixels across: its outline has as many on either side, and they
    // jump where it crosses their centre.
    assert!((8..=40).contains(&found.unsettled), "{}", found.unsettled);
    let smooth = derivative_by(&scene, "environment", &differences(1, None));
    assert_eq!(smooth.unsettled, 0);
}

#[test]
fn numbers_have_names_and_change_something() {
    for name in [
        "figures/figure-3",
        "fog/rate-0.1",
        "fog/forward",
        "smoke/cornell",
        "procedural/coloured",
    ] {
        let scene = scene(name, [8, 8]);
        let found = numbers(&scene);
        let names: std::collections::BTreeSet<String> =
            found.iter().map(|number| number.name()).collect();
        assert_eq!(names.len(), found.len(), "{name}: a name twice");
        for number in &found {
            let sides = [-number.step, number.step].map(|step| number.changed(&scene, step));
            let changed = sides.iter().flatten().next().expect("a side");
            let image = |scene: &Scene| film_with(scene, 64, 0).radiance().to_vec();
            assert_ne!(image(changed), image(&scene), "{name}: {number:?}");
        }
    }
    let scene = scene("fog/rate-0.1", [8, 8]);
    let error = number(&scene, "densty").unwrap_err();
    assert!(error.contains("did you mean \"density\""), "{error}");
    assert!(
        number(&scene, "opacity of all")
            .unwrap_err()
            .contains("camera.view")
    );
    // An index of refraction of 1 and less is none of glass.
    let index = number(&scene, "index").unwrap();
    assert!(index.changed(&scene, -0.5).is_none() && index.changed(&scene, -0.4).is_some());
}
