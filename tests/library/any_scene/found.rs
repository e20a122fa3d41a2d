//! What random scenes brought to light, each as small as it could be made, and what is said of it
//! now.

use std::path::Path;
use volref::render::{RenderError, Sampling, plans, render};
use volref::scene::Scene;

fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("scene.toml")).unwrap()
}

/// What is said of a scene that cannot be read.
fn refusal(text: &str) -> String {
    let error = Scene::parse(text, Path::new("scene.toml")).unwrap_err();
    format!("{error}\n{}", error.help_text().unwrap())
}

/// What is said of a scene that cannot be shown.
fn unshown(text: &str) -> RenderError {
    let scene = scene(text);
    render(&plans(&scene), Sampling::default(), &|| {}).unwrap_err()
}

const CAMERA: &str = "film = { width = 8, height = 8 }\n\
                      camera = { eye = [0, 0, 4], target = [0, 0, 0] }\n\
                      sampling = { samples = 2 }\n";

fn seen(text: &str) -> String {
    format!("{CAMERA}{text}")
}

/// The squares of such noise are no 32-bit numbers. The renderer took the blame for it.
#[test]
fn noise_beyond_the_film() {
    let lit = "[[radiative.surface]]\n\
               rectangle = { corner = [-9, -9, -1], edge_u = [18, 0, 0], edge_v = [0, 18, 0] }\n\
               diffuse = { reflectance = 0.5 }\n\
               [[radiative.surface]]\n\
               sphere = { centre = [0, 0, 1], radius = 0.5 }\n\
               emitter = { radiance = 2e30 }\n";
    let error = unshown(&seen(lit));
    assert!(matches!(error, RenderError::TooBright(_)), "{error}");
}

/// Squared distances to such a light were infinite, and its part of a pixel was NaN.
#[test]
fn a_light_beyond_all_squares() {
    let far = "[[radiative.medium]]\n\
               box = { min = [-1, -1, -1], max = [1, 1, 1] }\n\
               sigma_s = 1\n\
               [[radiative.light]]\n\
               point = { position = [0, -1.7976931348623157e308, 0], intensity = 1 }\n";
    insta::assert_snapshot!(refusal(&seen(far)), @"
    scene.toml:4:3: the camera, a light or a Gaussian ball is at coordinates of 1.798e308: light is traced up to 1e100
    choose another unit of length
    ");
    scene(&seen(&far.replace("-1.7976931348623157e308", "1e100")));
}

/// Its inverse is infinite, and infinity times a height of 0 was NaN.
#[test]
fn a_layer_thinner_than_its_inverse() {
    let thin = "[[radiative.medium]]\n\
                box = { min = [-1, -1, -1], max = [1, 1, 1] }\n\
                exponential = { base = [0, -1, 0], scale_height = 5e-324 }\n\
                sigma_a = 1\n";
    insta::assert_snapshot!(refusal(&seen(thin)), @"
    scene.toml:6:51: scale height must be positive and finite, and not below 2.3e-308, got 5e-324
    `radiative.medium[0].exponential.scale_height`: Height over which the density falls by a factor of e, world units.
    ");
    scene(&seen(&thin.replace("5e-324", "2.3e-308")));
}

/// Tentative collisions came as often as red says, and were null for green: 1e308 of them.
#[test]
fn colours_too_far_apart_to_be_tracked() {
    let red = "[[radiative.medium]]\n\
               box = { min = [-1, -1, -1], max = [1, 1, 1] }\n\
               noise = {}\n\
               sigma_s = 1\n\
               [[radiative.medium]]\n\
               sphere = { centre = [0, 0, 0], radius = 0.5 }\n\
               sigma_a = [1e308, 0, 0]\n\
               sigma_s = 1\n";
    insta::assert_snapshot!(refusal(&seen(red)), @"
    scene.toml:8:1: channels of this medium differ by up to 1.7321e308 optical depths, beside another whose density varies: light is traced through at most 1.6777e7
    give coefficients that differ less between the channels
    ");
    // The same in all channels, there is nothing to wait for.
    scene(&seen(&red.replace("[1e308, 0, 0]", "1e300")));
}

/// A folder that holds `cloud.obj`, a cloud of three points.
fn beside_a_cloud() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let points = "v 0 0 0\nv 1 0 0\nv 0 1 1\n";
    std::fs::write(folder.path().join("cloud.obj"), points).unwrap();
    folder
}

/// So far away the length of a ray's way through the volume is the rounding of its ends: 1e292,
/// taken in steps of half a voxel.
#[test]
fn an_eye_that_cannot_tell_a_step() {
    let folder = beside_a_cloud();
    let path = folder.path().join("scene.toml");
    let text = "[camera]\n\
                eye = [0, 0, 1.7976931348623155e308]\n\
                vertical_fov = 1e-300\n\
                [classified]\n\
                step = 0.5\n\
                volume = { file = \"cloud.obj\" }\n";
    let error = Scene::parse(text, &path).unwrap_err();
    insta::assert_snapshot!(error.message(), @"the eye is 1.798e308 world units away, where distances are rounded by more than a step of 5e-1");
    // 2^-52 of it is 0.44.
    Scene::parse(&text.replace("1.7976931348623155e308", "2e15"), &path).unwrap();
}

/// Either step alone is accepted: together they ask for 7.5e15 samples of each ray.
#[test]
fn shadows_of_too_many_samples() {
    let folder = beside_a_cloud();
    let path = folder.path().join("scene.toml");
    let text = "[classified]\n\
                step = 1e-7\n\
                volume = { file = \"cloud.obj\" }\n\
                shadow = { step = 1e-7, reference_step = 1 }\n";
    let error = Scene::parse(text, &path).unwrap_err();
    insta::assert_snapshot!(error.message(), @"steps of 1e-7 world units, with shadow steps of 1e-7, mean up to 7.5e15 samples on a ray; at most 1e10 are accepted");
    Scene::parse(&text.replacen("1e-7", "1e-1", 1), &path).unwrap();
}

/// Squared distances in such a scene are 0, or have lost their digits: light was 0 times infinity.
#[test]
fn a_scene_too_small_for_its_squares() {
    let small = "[[radiative.surface]]\n\
                 sphere = { centre = [0, 0, 0], radius = 1e-160 }\n\
                 diffuse = { reflectance = 0.5 }\n";
    insta::assert_snapshot!(refusal(&seen(small)), @"
    scene.toml:5:10: the sphere is 3.464e-160 across and reaches to coordinates of 1.000e-160: light is traced between shapes at least 1e-100 across, in coordinates up to 1e100
    choose another unit of length
    ");
    scene(&seen(&small.replace("1e-160", "1e-100")));
}

/// Everything that has a place is asked whether it lies too far away.
#[test]
fn what_lies_beyond_all_cubes() {
    let eye = "camera = { eye = [0, 0, 1e101], target = [0, 0, 0] }\n[radiative]\n";
    let medium = "[[radiative.medium]]\n\
                  box = { min = [0, 0, 0], max = [1, 1, 1e101] }\n\
                  sigma_a = 1\n";
    let lamp = "[[radiative.surface]]\n\
                sphere = { centre = [0, 0, 0], radius = 1e99 }\n\
                translate = [0, 2e100, 0]\n\
                emitter = { radiance = 1 }\n";
    let ball = "[[radiative.medium]]\n\
                box = { min = [0, 0, 0], max = [1, 1, 1] }\n\
                sigma_a = 1\n\
                blob = { centre = [0, 0, 1e308], width = 1 }\n";
    for (text, said) in [
        (
            seen(ball),
            "4:3: the camera, a light or a Gaussian ball is at coordinates of 1.000e308",
        ),
        (
            seen(
                &ball
                    .replace("width = 1", "width = 1e101")
                    .replace("1e308", "0"),
            ),
            "4:3: the camera, a light or a Gaussian ball is at coordinates of 1.000e101",
        ),
        (
            eye.to_owned(),
            "2:1: the camera, a light or a Gaussian ball",
        ),
        (seen(medium), "5:7: the box is 1.000e101 across"),
        (seen(lamp), "5:10: the sphere is"),
    ] {
        let refusal = refusal(&text);
        assert!(
            refusal.starts_with(&format!("scene.toml:{said}")),
            "{refusal}"
        );
    }
}

/// Scattering so weak that its mean over the density vanished: the collisions of what absorbs there
/// found nothing that could have turned them, and that was a panic.
#[test]
fn scattering_that_all_but_vanishes() {
    let faint = "[radiative]\n\
                 environment = 1\n\
                 [[radiative.medium]]\n\
                 box = { min = [-1, -1, -1], max = [1, 1, 1] }\n\
                 blob = { centre = [0, 0, 0], width = 0.5 }\n\
                 sigma_a = 4\n\
                 sigma_s = 5e-324\n";
    let scene = scene(&seen(faint));
    render(&plans(&scene), Sampling::default(), &|| {}).unwrap();
}

/// Over a stretch of 5e-324 tentative collisions came infinitely often, and none of them any
/// farther than the one before: the last of them never came.
#[test]
fn an_emission_that_is_next_to_nothing_long() {
    let flat = "[[radiative.medium]]\n\
                box = { min = [-1, -1, -5e-324], max = [1, 1, 1] }\n\
                noise = {}\n\
                sigma_a = 1\n\
                emission = 1\n";
    let scene = scene(&seen(flat).replace("eye = [0, 0, 4], target = [0, 0, 0]", INSIDE));
    render(&plans(&scene), Sampling::default(), &|| {}).unwrap();
}

const INSIDE: &str = "eye = [0, 0, 0], target = [0, 0, -1]";
