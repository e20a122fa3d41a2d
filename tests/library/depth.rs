//! Depth of classified volumes: closed forms, and the plain definition.

use crate::common::suite::scene_of;
use std::path::Path;
use volref::film::Depth;
use volref::math::{exp_m1, ln, ln_1p};
use volref::reference;
use volref::render::depth;
use volref::scene::Scene;

const MEAN: &str = "mean";
const HALF: &str = "half";

fn named(name: &str) -> Depth {
    name.parse().unwrap()
}

/// A grid of one value, 1, over [-1, 1]³, seen along z from a distance of 3 to its face; its opacity over a length
/// of 1, and a step.
fn constant(folder: &Path, opacity: f64, step: f64, more: &str) -> Scene {
    let mut nrrd = b"NRRD0004\ntype: float\ndimension: 3\nsizes: 3 3 3\nencoding: raw\nendian: little\nspace dimension: 3\n\
        space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (-1,-1,-1)\n\n"
        .to_vec();
    nrrd.extend((0..27).flat_map(|_| 1_f32.to_le_bytes()));
    std::fs::write(folder.join("one.nrrd"), nrrd).unwrap();
    let text = format!(
        "film = {{ width = 5, height = 5 }}\n\
         [camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\nvertical_fov = 20\n\
         [transfer_function]\nreference_length = 1\npoint = [\n\
         {{ value = 0, colour = [1, 1, 1], opacity = 0 }},\n{{ value = 1, colour = [1, 1, 1], opacity = {opacity} }},\n]\n\
         [classified]\nstep = {step}\n{more}\n[classified.volume]\nfile = \"one.nrrd\"\n"
    );
    Scene::parse(&text, &folder.join("scene.toml"))
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Depth of the middle pixel, which looks along z.
fn middle(scene: &Scene, name: &str) -> f64 {
    depth(scene, named(name)).unwrap()[12].into()
}

/// Through an extinction σ over a length of 2, from 3 on: the mean distance is 3 + 1/σ − 2/(e^(2σ) − 1), half of the
/// light is lost at 3 + ln 2/σ.
#[test]
fn a_constant_volume_has_the_depth_of_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    for opacity in [1e-6, 0.1, 0.5, 0.9, 0.999] {
        let extinction = -ln_1p(-opacity);
        for step in [0.5, 0.1, 0.3] {
            let scene = constant(folder.path(), opacity, step, "");
            let mean = 3.0 + 1.0 / extinction - 2.0 / exp_m1(2.0 * extinction);
            // Within a step the light is lost before its middle: by σ h²/12 at most, to first order in σ h, and never by
            // more than half a step. The number is kept in 32 bits; that of 1e-6 is the difference of two millions.
            let bound = (extinction * step * step / 12.0).min(0.5 * step) + 3e-7 * mean + 1e-9;
            let found = middle(&scene, MEAN);
            assert!(
                (found - mean).abs() <= bound,
                "{opacity} {step}: {found} {mean}"
            );
            let half = 3.0 + ln(2.0) / extinction;
            let found = middle(&scene, HALF);
            if half < 5.0 {
                assert!(
                    (found - half).abs() <= 3e-7 * half,
                    "{opacity} {step}: {found} {half}"
                );
            } else {
                assert_eq!(found, f64::INFINITY, "{opacity} {step}");
            }
        }
    }
}

/// The same without steps: to the rounding of 32 bits, and of the difference of two millions.
#[test]
fn the_integral_has_the_depth_of_its_closed_form() {
    let folder = tempfile::tempdir().unwrap();
    for opacity in [1e-6, 0.1, 0.5, 0.9, 0.999] {
        let extinction = -ln_1p(-opacity);
        let scene = constant(folder.path(), opacity, 0.5, "compositing = \"continuous\"");
        let mean = 3.0 + 1.0 / extinction - 2.0 / exp_m1(2.0 * extinction);
        let found = middle(&scene, MEAN);
        assert!(
            (found - mean).abs() <= 3e-7 * mean + 1e-9,
            "{opacity}: {found} {mean}"
        );
        let half = Some(3.0 + ln(2.0) / extinction).filter(|half| *half < 5.0);
        let half = half.unwrap_or(f64::INFINITY);
        let found = middle(&scene, HALF);
        assert!(
            found == half || (found - half).abs() <= 3e-7 * half,
            "{opacity}: {found} {half}"
        );
    }
    let opaque = constant(folder.path(), 1.0, 0.5, "compositing = \"continuous\"");
    assert_eq!([MEAN, HALF].map(|name| middle(&opaque, name)), [3.0; 2]);
}

/// Two constant volumes, from 3 to 4 and from 3.5 to 5, and a surface at 4.5: opacity, and its moment, in closed form
/// over each piece; sampled and without samples.
#[test]
fn several_volumes_and_a_surface_have_a_depth() {
    let folder = tempfile::tempdir().unwrap();
    let (first, second) = (0.8, 0.5);
    let text = |how: &str, surface: &str| {
        let look = |opacity: f64| {
            format!(
                "transfer_function = {{ reference_length = 1, point = [{{ value = 1, colour = 1, opacity = {} }}] }}",
                -exp_m1(-opacity)
            )
        };
        let (a, b) = (look(first), look(second));
        format!(
            "film = {{ width = 5, height = 5 }}\n\
             [camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\nvertical_fov = 20\n[classified]\n{how}\n\
             [[classified.volume]]\nfile = 'one.nrrd'\nscale = [1, 1, 0.5]\ntranslate = [0, 0, -0.5]\n{a}\n\
             [[classified.volume]]\nfile = 'one.nrrd'\nscale = [1, 1, 0.75]\ntranslate = [0, 0, 0.25]\n{b}\n{surface}"
        )
    };
    let surface = "[[classified.surface]]\ncolour = 1\n\
                   rectangle = { corner = [-3, -3, 0.5], edge_u = [0, 6, 0], edge_v = [6, 0, 0] }\n";
    constant(folder.path(), 1.0, 0.3, "");
    for (is_cut, surface) in [(false, ""), (true, surface)] {
        let (mut moment, mut passed, mut half) = (0.0, 1.0, None);
        let end = if is_cut { 4.5 } else { 5.0 };
        for (near, far, extinction) in [
            (3.0, 3.5, first),
            (3.5, 4.0, first + second),
            (4.0, end, second),
        ] {
            let length: f64 = far - near;
            let left = passed * volref::math::exp(-extinction * length);
            // ∫ t σ e^(−σ (t − near)) dt over the piece.
            moment += passed * (near + 1.0 / extinction) - left * (far + 1.0 / extinction);
            if left <= 0.5 && half.is_none() {
                half = Some(near + ln(passed / 0.5) / extinction);
            }
            passed = left;
        }
        let mean = if is_cut {
            moment + passed * end
        } else {
            moment / (1.0 - passed)
        };
        let half = half.expect("more than half of the light is lost");
        for step in [0.0, 0.1, 0.01] {
            let how = if step > 0.0 {
                format!("step = {step}")
            } else {
                "compositing = 'continuous'".to_owned()
            };
            let scene = Scene::parse(&text(&how, surface), &folder.path().join("scene.toml"));
            let scene = scene.unwrap_or_else(|error| panic!("{error}"));
            // Of constant steps by their middles: σ h²/12, as of one volume.
            let bound = (first + second) * step * step / 12.0 + 3e-7 * mean;
            let found = middle(&scene, MEAN);
            assert!(
                (found - mean).abs() <= bound,
                "{is_cut} {step}: {found} {mean}"
            );
            let found = middle(&scene, HALF);
            assert!(
                (found - half).abs() <= 3e-7 * half,
                "{is_cut} {step}: {found} {half}"
            );
        }
    }
}

/// A field that is z is 0.5 on a plane, 4.5 before the eye; a pane of a quarter of the light before it moves the mean.
#[test]
fn isosurfaces_are_as_far_as_the_roots_of_the_field() {
    let folder = tempfile::tempdir().unwrap();
    for sampled in ["step = 0.3", "compositing = \"continuous\""] {
        constant(folder.path(), 1.0, 0.3, "");
        let mut nrrd = std::fs::read(folder.path().join("one.nrrd")).unwrap();
        let header = nrrd.len() - 27 * 4;
        nrrd.truncate(header);
        nrrd.extend((0..27).flat_map(|index| ((index / 9) as f32 - 1.0).to_le_bytes()));
        std::fs::write(folder.path().join("one.nrrd"), nrrd).unwrap();
        let read = |surfaces: &str| {
            let text = format!(
                "film = {{ width = 5, height = 5 }}\n\
                 [camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\nvertical_fov = 20\n\
                 [transfer_function]\n\
                 [classified]\n{sampled}\nmode = \"isosurface\"\nisosurface = [{surfaces}]\n\
                 [classified.volume]\nfile = \"one.nrrd\"\n"
            );
            Scene::parse(&text, &folder.path().join("scene.toml"))
                .unwrap_or_else(|error| panic!("{error}\n{text}"))
        };
        let scene = read("{ value = 0.5, colour = 1 }");
        for name in [MEAN, HALF] {
            let found = middle(&scene, name);
            assert!((found - 4.5).abs() < 1e-6 * 4.5, "{sampled} {name} {found}");
        }
        let scene =
            read("{ value = 0.5, colour = 1 }, { value = -0.5, colour = 1, opacity = 0.25 }");
        assert!((middle(&scene, MEAN) - (0.25 * 3.5 + 0.75 * 4.5)).abs() < 1e-5);
        assert!((middle(&scene, HALF) - 4.5).abs() < 1e-5);
    }
}

/// Where nothing is seen there is no depth, and what an early end leaves out has no part in it.
#[test]
fn what_is_not_seen_has_no_depth() {
    let folder = tempfile::tempdir().unwrap();
    let clear = constant(folder.path(), 0.0, 0.5, "");
    assert_eq!(middle(&clear, MEAN), f64::INFINITY);
    assert_eq!(middle(&clear, HALF), f64::INFINITY);
    let whole = middle(&constant(folder.path(), 0.5, 0.125, ""), MEAN);
    let ended = middle(
        &constant(folder.path(), 0.5, 0.125, "early_termination = 0.8"),
        MEAN,
    );
    assert!(ended < whole - 0.5, "{ended} {whole}");
    let opaque = middle(&constant(folder.path(), 1.0, 0.125, ""), HALF);
    assert_eq!(opaque, 3.0);
}

/// The plain definition adds samples up by compositing, the other by optical depth: of the same numbers, in another order
/// and with other functions, to some ten roundings of a step each. 32 bits are coarser.
#[test]
fn the_plain_definition_agrees() {
    let mut compared = 0;
    for name in [
        "figures/figure-1",
        "figures/figure-4",
        "sampled/opaque",
        "sampled/nearest-blocks",
        "sampled/thin",
        "scenes/sheared",
        "scenes/mirrored",
        "scenes/mean-depth",
        "scenes/isosurfaces",
        "scenes/two-fogs",
        "scenes/clipped-head",
        "scenes/three-in-shadow",
    ] {
        let scene = scene_of(name);
        for (kind, wanted) in Depth::ALL {
            let found = depth(&scene, wanted).unwrap();
            let panel = &scene.panels[0];
            let size = [panel.width, panel.height];
            let plain = reference::depth::render(panel.classified().unwrap(), size, wanted);
            for (row, columns) in plain.chunks(panel.width).enumerate() {
                for (column, &plain) in columns.iter().enumerate() {
                    let found =
                        found[row * scene.panels.iter().map(|of| of.width).sum::<usize>() + column];
                    let agrees = plain == found || (plain - found).abs() <= 1e-6 * plain;
                    assert!(agrees, "{name} {kind} {column} {row}: {plain} {found}");
                    compared += usize::from(plain.is_finite());
                }
            }
        }
    }
    assert!(compared > 20_000, "{compared}");
}
