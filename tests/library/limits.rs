//! Integrals without samples: against closed forms, against quadrature by another method, and
//! against what the ray caster's samples converge to.

use crate::common::suite::{cases_of, root, scene_files, suite};
use glam::DVec3;
use std::path::{Path, PathBuf};
use volref::film::Film;
use volref::geometry::Ray;
use volref::judging::verify;
use volref::math::{exp, exp_m1, ln_1p, quadrature::integrate};
use volref::optics::Appearance;
use volref::render::classified::integral::{RayIntegral, RayIntegrator};
use volref::render::{Sampling, plans, render};
use volref::scene::{Classified, Model, Scene};
use volref::suite::Suite;

fn fixtures() -> PathBuf {
    root().join("fixtures")
}

/// An integral through `volume`, one of the hard cases, with this table and more keys.
fn scene(volume: &str, table: &str, more: &str) -> Classified {
    let text = format!(
        "[film]\nwidth = 4\nheight = 4\n[transfer_function]\nreference_length = 0.25\n\
         point = [{table}]\n[classified]\ncompositing = 'continuous'\n{more}\n\
         [classified.volume]\nfile = '../../volumes/hard/{volume}'\n"
    );
    let scene = Scene::parse(&text, &fixtures().join("scenes/hard/scene.toml")).unwrap();
    match &scene.panels[0].model {
        Model::Classified(scene) => (**scene).clone(),
        _ => unreachable!("a classified volume"),
    }
}

/// Along z, through the middle of a unit cube.
fn along_z(scene: &Classified) -> RayIntegral {
    let ray = Ray::new(DVec3::new(0.5, 0.5, -1.0), DVec3::Z).unwrap();
    RayIntegrator::new(scene).along(&ray)
}

/// A field of one value: `c (1 − e^(−σ s)) + B e^(−σ s)`, `σ = −ln(1 − a)/h0`.
#[test]
fn a_constant_field() {
    let table = "{ value = 0, colour = [0, 0, 0], opacity = 0 }, \
                 { value = 1, colour = [1, 0.5, 2], opacity = 0.4 }";
    let scene = scene("half.nrrd", table, "background = [3, 0, 1]");
    let found = along_z(&scene);
    let depth = -ln_1p(-0.2) / 0.25;
    let (own, through) = (-exp_m1(-depth), exp(-depth));
    let right = DVec3::new(0.5, 0.25, 1.0) * own + DVec3::new(3.0, 0.0, 1.0) * through;
    assert!((found.light.radiance - right).abs().max_element() < 1e-15);
    assert!((found.light.depth - depth).abs() < 1e-15);
    assert!(found.light.radiance_error < 1e-14);
    assert_eq!(found.cells, 0, "equal values are not looked up");
}

/// Depth up to `z` where opacity is `a + b z`: `∫ −ln(1 − a − b s)/h0 ds`.
fn depth_of_ramp([a, b]: [f64; 2], z: f64) -> f64 {
    // ∫ −ln(x) dx = x − x ln x, of what is let through.
    let part = |x: f64| if x > 0.0 { x - x * ln_1p(x - 1.0) } else { 0.0 };
    (part(1.0 - a) - part(1.0 - a - b * z)) / (b * 0.25)
}

/// The value is `z`, and so are opacity and colour: the depth has a closed form, and the rest is
/// integrated by Gauss and Kronrod's rule.
#[test]
fn a_linear_ramp() {
    for (first, last) in [(0.0, 0.6), (0.3, 0.999), (0.9, 0.1), (0.0, 1e-6)] {
        let table = format!(
            "{{ value = 0, colour = [1, 0.25, 0], opacity = {first} }}, \
             {{ value = 1, colour = [0, 2, 1], opacity = {last} }}"
        );
        let found = along_z(&scene("ramp.nrrd", &table, "background = [0, 0, 5]"));
        let line = [first, last - first];
        let depth = depth_of_ramp(line, 1.0);
        let emitted = |z: f64| {
            let extinction = -ln_1p(-(first + (last - first) * z)) / 0.25;
            let colour = DVec3::new(1.0 - z, 0.25 + 1.75 * z, z);
            colour * (extinction * exp(-depth_of_ramp(line, z)))
        };
        let right = integrate(emitted, 0.0, 1.0, 1e-14).value + DVec3::Z * (5.0 * exp(-depth));
        let off = (found.light.radiance - right).abs().max_element();
        // The closed form subtracts numbers of size 4/b to get a depth of size b: roundings.
        let rounding = 1e-15 / (last - first).abs();
        assert!(
            off <= found.light.radiance_error + 5.0 * rounding,
            "{first} {last}: {off:e}"
        );
        assert!((found.light.depth - depth).abs() <= found.light.depth_error + 4.0 * rounding);
        assert!(found.light.radiance_error < 5.0 * 1e-8, "{found:?}");
    }
}

/// So dense that all is seen within a millionth of the way: the front, and nothing behind it. The first
/// points of a coarse rule would all lie in the dark.
#[test]
fn a_dense_front() {
    let table = "{ value = 0, colour = [1, 0.25, 0], opacity = 0.5 }, \
                 { value = 1, colour = [0, 2, 1], opacity = 0.6 }";
    for (volume, right) in [
        ("ramp.nrrd", DVec3::new(1.0, 0.25, 0.0)),
        ("half.nrrd", DVec3::new(0.5, 1.125, 0.5)),
    ] {
        let mut scene = scene(volume, table, "background = [9, 9, 9]");
        for length in [1e-4, 1e-7, 1e-10, 1e-300] {
            scene.transfer_function.reference_length = length;
            let found = along_z(&scene);
            let off = (found.light.radiance - right).abs().max_element();
            // The colour changes over the mean way that is seen, 1.5 lengths.
            let bound = 9.0 * found.light.radiance_error + 3.0 * length + 1e-12;
            assert!(off <= bound, "{volume} {length}: {found:?}");
            assert!(
                found.light.radiance_error < 1e-6,
                "{volume} {length}: {found:?}"
            );
        }
    }
}

/// Opacity rises to 1, where the extinction is infinite: light still gets there, and no farther if
/// there is more of it.
#[test]
fn an_opacity_of_one() {
    let colour = "colour = [1, 1, 1]";
    let peak = format!(
        "{{ value = 0, {colour}, opacity = 0 }}, {{ value = 0.5, {colour}, opacity = 1 }}, \
         {{ value = 1, {colour}, opacity = 0 }}"
    );
    let found = along_z(&scene("ramp.nrrd", &peak, ""));
    let depth = 2.0 * depth_of_ramp([0.0, 2.0], 0.5);
    let right = -exp_m1(-depth);
    let off = (found.light.radiance.x - right).abs();
    assert!(
        off <= found.light.radiance_error.max(1e-12),
        "{off:e} {found:?}"
    );
    assert!(found.light.radiance_error < 1e-6);

    let wall = format!(
        "{{ value = 0, {colour}, opacity = 0 }}, {{ value = 0.5, {colour}, opacity = 1 }}, \
         {{ value = 1, colour = [7, 7, 7], opacity = 1 }}"
    );
    let found = along_z(&scene("ramp.nrrd", &wall, "background = [9, 9, 9]"));
    let before = depth_of_ramp([0.0, 2.0], 0.5);
    let right = -exp_m1(-before) + exp(-before);
    let off = (found.light.radiance.x - right).abs();
    assert!(
        off <= found.light.radiance_error.max(1e-6),
        "{off:e} {found:?}"
    );
    assert_eq!(found.light.depth, f64::INFINITY);
}

fn classified(scene: &mut Scene) -> &mut Classified {
    match &mut scene.panels[0].model {
        Model::Classified(scene) => scene,
        _ => unreachable!("a classified volume"),
    }
}

/// A renderer with a table of 256 entries holds the tables of the family exactly, and none of them
/// is ever opaque.
#[test]
fn tables_of_the_family_fit_256_entries() {
    let files = scene_files().into_iter();
    for (name, path) in files.filter(|(name, _)| name.starts_with("limit/")) {
        let mut scene = Scene::load(&path).unwrap();
        let Appearance::Points(points) = &classified(&mut scene).transfer_function.appearance
        else {
            panic!("{name}: no table of points");
        };
        let points = points.points();
        let (least, most) = (points[0].value, points[points.len() - 1].value);
        assert!(points.len() >= 2 && least < most, "{name}");
        for point in points {
            let entry = 255.0 * (point.value - least) / (most - least);
            // Values of at most five digits, and a few roundings.
            assert!((entry - entry.round()).abs() < 1e-9, "{name}: {entry}");
            assert!(point.opacity < 1.0, "{name}: {point:?}");
        }
        assert!(
            points.windows(2).all(|pair| pair[0].value < pair[1].value),
            "{name}"
        );
    }
}

fn rendered(scene: &Scene) -> (Film, Option<f64>) {
    let rendering = render(&plans(scene), Sampling::default(), &|| ()).unwrap();
    (rendering.film, rendering.error_bound)
}

/// The goldens of the family state how well they are known.
#[test]
fn goldens_of_the_family_are_known_to_a_millionth() {
    let cases = cases_of("limit");
    assert!(cases.len() >= 14);
    for case in cases {
        assert_eq!(case.class(), "limit", "{}", case.name);
        let path = suite().golden_folder().join(format!("{}.toml", case.name));
        let text = std::fs::read_to_string(path).unwrap();
        let record: toml::Table = text.parse().unwrap();
        let error = record["error_estimate"].as_float().unwrap();
        assert!(error < 1e-6, "{}: {error:e}", case.name);
    }
}

/// The class of a case is that of its scene.
#[test]
fn a_class_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let cases = folder.path().join("fixtures/cases/own");
    std::fs::create_dir_all(&cases).unwrap();
    let scenes = fixtures().join("scenes");
    for (name, class, scene) in [
        ("a", "deterministic", "limit/linear-ramp.toml"),
        ("b", "limit", "hard/d2-a-cell.toml"),
    ] {
        let manifest = format!(
            "scene = {:?}\nsource = 'a test'\nshows = 'it'\ncomputes = 'it'\nclass = '{class}'\n",
            scenes.join(scene)
        );
        std::fs::write(cases.join(format!("{name}.toml")), manifest).unwrap();
    }
    let suite = Suite::open(folder.path()).unwrap();
    let reasons = suite
        .cases()
        .iter()
        .map(|case| verify(case, &suite.store(), &|| ()).result.reason);
    let reasons: Vec<String> = reasons.collect();
    assert!(
        reasons[0].contains("is rendered as class = \"limit\""),
        "{reasons:?}"
    );
    assert!(
        reasons[1].contains("compositing = \"continuous\""),
        "{reasons:?}"
    );
}

/// Along parallel rays a ball of uniform absorption lets `e^(−2σ√(r² − d²))` through.
#[test]
fn parallel_rays_through_a_ball() {
    let text = "[film]\nwidth = 9\nheight = 6\n\
                [camera]\neye = [0, 0, -5]\ntarget = [0, 0, 0]\northographic_height = 2.4\n\
                [radiative]\nenvironment = 1\nscattering = 'none'\n\
                [[radiative.medium]]\nsphere = { centre = [0, 0, 0], radius = 1 }\nsigma_a = 0.7\n";
    let scene = Scene::parse(text, Path::new("scene.toml")).unwrap();
    let (film, bound) = rendered(&scene);
    assert_eq!(bound, None);
    for (index, pixel) in film.radiance().iter().enumerate() {
        let (column, row) = ((index % 9) as f64, (index / 9) as f64);
        let (x, y) = ((column - 4.0) * 0.4, (row - 2.5) * 0.4);
        let half = (1.0 - x * x - y * y).max(0.0).sqrt();
        let right = exp(-1.4 * half);
        assert!(
            (f64::from(pixel[0]) - right).abs() < 1e-6,
            "{index}: {pixel:?}, {right}"
        );
    }
}
