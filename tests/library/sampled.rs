//! The family `sampled`: what each of its cases promises, and goldens against closed forms.

use crate::common::suite::{cases_of, golden_of, root};
use glam::{DVec3, dvec3};
use std::path::{Path, PathBuf};
use volref::exchange::{Format, export};
use volref::math::{pow, tan};

pub fn table_of(scene: &Path) -> toml::Table {
    std::fs::read_to_string(scene).unwrap().parse().unwrap()
}

fn scene(name: &str) -> toml::Table {
    table_of(&root().join(format!("fixtures/scenes/sampled/{name}.toml")))
}

pub fn number(value: &toml::Value) -> f64 {
    let whole = value.as_integer().map(|whole| whole as f64);
    value.as_float().or(whole).unwrap()
}

pub fn vector(value: &toml::Value) -> DVec3 {
    let numbers: Vec<f64> = value.as_array().unwrap().iter().map(number).collect();
    DVec3::from_slice(&numbers)
}

/// A point of a transfer function: value, colour and opacity.
type Point = (f64, DVec3, f64);

/// The points of the transfer function; none if it is the formula.
fn points(scene: &toml::Table) -> Vec<Point> {
    let Some(points) = scene["transfer_function"].get("point") else {
        return Vec::new();
    };
    let point = |of: &toml::Value| {
        let [value, opacity] = ["value", "opacity"].map(|key| number(&of[key]));
        (value, vector(&of["colour"]), opacity)
    };
    points.as_array().unwrap().iter().map(point).collect()
}

/// Colour and opacity of a value: straight lines between points.
fn classified(points: &[Point], value: f64) -> (DVec3, f64) {
    let next = points.iter().position(|point| point.0 > value);
    let next = next.unwrap_or(points.len() - 1).max(1);
    let ((low, c0, a0), (high, c1, a1)) = (points[next - 1], points[next]);
    let part = ((value - low) / (high - low)).clamp(0.0, 1.0);
    (c0 + (c1 - c0) * part, a0 + (a1 - a0) * part)
}

/// Every case is one that ray casters can meet: unshaded, with a step, exported as a bundle, shown by
/// 8 bits, and its table exact in 256 entries of 8 bits.
#[test]
fn every_case_can_be_met() {
    let cases = cases_of("sampled");
    assert!(cases.len() >= 12);
    let mut formulas = 0;
    for case in &cases {
        let name = &case.name;
        assert_eq!(case.class(), "deterministic", "{name}");
        assert!(case.mistakes.len() >= 2 && case.exposure == 0.0, "{name}");
        let loaded = case.load_scene().unwrap();
        for panel in &loaded.panels {
            let scene = panel.classified().unwrap();
            assert!(
                scene.phong.is_none() && scene.shadow.is_none() && !scene.continuous,
                "{name}"
            );
        }
        export(&loaded, Format::Bundle, "scene", None)
            .unwrap_or_else(|refusal| panic!("{name}: {refusal:?}"));
        let film = golden_of(name);
        assert!([film.width(), film.height()].iter().all(|&side| side <= 96));
        let mut values = film.radiance().as_flattened().iter();
        assert!(values.all(|value| (0.0..=1.0).contains(value)), "{name}");

        let text = table_of(&PathBuf::from(&case.scene));
        assert!(text["classified"].get("step").is_some(), "{name}");
        let points = points(&text);
        formulas += usize::from(points.is_empty());
        let ends = points.first().zip(points.last());
        for entry in 0..ends.map_or(0, |_| 256) {
            let (first, last) = ends.unwrap();
            let value = first.0 + (last.0 - first.0) * entry as f64 / 255.0;
            let (colour, opacity) = classified(&points, value);
            for channel in [colour.x, colour.y, colour.z, opacity] {
                let code = 255.0 * channel;
                assert!((code - code.round()).abs() < 1e-9, "{name}: entry {entry}");
            }
        }
    }
    assert_eq!(formulas, 1);
}

/// A ray of a camera through the centre of each pixel: origin and unit direction.
pub fn rays(scene: &toml::Table) -> Vec<(DVec3, DVec3)> {
    let (film, camera) = (&scene["film"], &scene["camera"]);
    let [width, height] = ["width", "height"].map(|key| number(&film[key]));
    let eye = vector(&camera["eye"]);
    let ahead = (vector(&camera["target"]) - eye).normalize();
    let up = camera.get("up").map_or(DVec3::Y, vector);
    let right = ahead.cross(up).normalize();
    let up = right.cross(ahead);
    let pixels = (0..height as u32).flat_map(|y| (0..width as u32).map(move |x| (x, y)));
    let ray = |(x, y): (u32, u32)| {
        let aside = right * ((2.0 * f64::from(x) + 1.0 - width) / height)
            - up * ((2.0 * f64::from(y) + 1.0 - height) / height);
        match (
            camera.get("orthographic_height"),
            camera.get("vertical_fov"),
        ) {
            (Some(size), _) => (eye + aside * (0.5 * number(size)), ahead),
            (None, angle) => {
                let half = tan((0.5 * number(angle.unwrap())).to_radians());
                (eye, (ahead + aside * half).normalize())
            }
        }
    };
    pixels.map(ray).collect()
}

/// Distances at which a ray enters and leaves the box of this half size around the origin; equal where
/// it misses.
pub fn span(half: DVec3, (origin, direction): (DVec3, DVec3)) -> [f64; 2] {
    let mut span = [0.0, f64::INFINITY];
    for axis in 0..3 {
        let ends = [-half[axis], half[axis]].map(|at| (at - origin[axis]) / direction[axis]);
        if direction[axis] == 0.0 {
            if origin[axis].abs() > half[axis] {
                return [0.0; 2];
            }
            continue;
        }
        span = [
            span[0].max(ends[0].min(ends[1])),
            span[1].min(ends[0].max(ends[1])),
        ];
    }
    [span[0], span[1].max(span[0])]
}

/// Samples, value and length of step, from front to back, in front of the background.
pub fn composited(scene: &toml::Table, samples: &[(f64, f64)]) -> DVec3 {
    let background = scene["classified"].get("background");
    let reference = number(&scene["transfer_function"]["reference_length"]);
    let points = points(scene);
    let (mut radiance, mut passed) = (DVec3::ZERO, 1.0);
    for &(value, length) in samples {
        let (colour, opacity) = classified(&points, value);
        let opacity = 1.0 - pow(1.0 - opacity, length / reference);
        radiance += passed * opacity * colour;
        passed *= 1.0 - opacity;
    }
    radiance + passed * background.map_or(DVec3::ZERO, vector)
}

/// The golden has the radiance of the samples of each ray, to the rounding of its 32 bits; a share of
/// the pixels, at least, shows the volume.
fn has_pixels(name: &str, shown: f64, samples: impl Fn((DVec3, DVec3)) -> Vec<(f64, f64)>) {
    let (scene, film) = (scene(name), golden_of(&format!("sampled/{name}")));
    let rays = rays(&scene);
    assert_eq!(rays.len(), film.radiance().len());
    let mut seen = 0;
    for (index, (&ray, found)) in rays.iter().zip(film.radiance()).enumerate() {
        let samples = samples(ray);
        seen += usize::from(samples.iter().any(|sample| sample.0 > 0.0));
        let right = composited(&scene, &samples);
        let error = (right - DVec3::from(found.map(f64::from)))
            .abs()
            .max_element();
        assert!(error < 1e-6, "{name}, pixel {index}: {right} and {found:?}");
    }
    assert!(
        seen as f64 > shown * rays.len() as f64,
        "{name}: {seen} pixels"
    );
}

/// One value: a ray is a single step, as long as it is in the box, whatever the steps.
#[test]
fn a_constant() {
    has_pixels("constant", 0.4, |ray| {
        let [near, far] = span(dvec3(0.5, 0.75, 0.5), ray);
        vec![(153.0, far - near)]
    });
}

/// Rays at right angles to a column keep their value: linear between the layers.
#[test]
fn a_column() {
    const LAYERS: [u8; 24] = [
        1, 1, 5, 5, 0, 0, 3, 3, 4, 1, 5, 0, 2, 4, 0, 5, 5, 2, 2, 3, 1, 0, 4, 5,
    ];
    has_pixels("column", 0.3, |ray| {
        let [near, far] = span(dvec3(0.25, 0.25, 1.4375), ray);
        let at = ((ray.0.z + 1.4375) / 0.125).clamp(0.0, 22.999_999);
        let [low, high] = [0, 1].map(|next| f64::from(LAYERS[at as usize + next]));
        vec![(51.0 * (low + (high - low) * at.fract()), far - near)]
    });
}

/// A single voxel: a tent along each axis, met half-way up by two samples.
#[test]
fn an_impulse() {
    has_pixels("impulse", 0.1, |(origin, _)| {
        let tent = |at: f64| (1.0 - at.abs() / 0.25).max(0.0);
        let value = 127.5 * tent(origin.x + 0.25) * tent(origin.y);
        vec![(value, 0.25); 2]
    });
}

/// A slope: four samples of a linear function, the last of a step cut short.
#[test]
fn a_slope() {
    const SAMPLES: [(f64, f64); 4] = [
        (-0.4375, 0.375),
        (-0.0625, 0.375),
        (0.3125, 0.375),
        (0.5625, 0.125),
    ];
    has_pixels("slope", 0.5, |(origin, _)| {
        let is_within = origin.y.abs() <= 0.5 && origin.z.abs() <= 1.0;
        let value = |x: f64| 135.0 + (12.0 * x + 15.0 * origin.y + 15.0 * origin.z) / 0.25;
        let samples = SAMPLES.iter().filter(|_| is_within);
        samples.map(|&(x, length)| (value(x), length)).collect()
    });
}

/// Blocks by the nearest node, a case for a second, plain ray caster: its samples are those of the rule.
#[test]
fn blocks() {
    let block = |at: DVec3| {
        let [i, j, k] = (at / 0.25 + dvec3(2.0, 2.5, 3.0))
            .to_array()
            .map(|u| u.round() as u32);
        let number = i * 53 + j * 97 + k * 151 + i * j * 29 + j * k * 61 + k * i * 43;
        f64::from(51 * (number % 11).saturating_sub(5))
    };
    has_pixels("nearest-blocks", 0.3, |ray| {
        let [near, far] = span(dvec3(0.5, 0.625, 0.75), ray);
        let count = ((far - near) / 0.125).ceil() as u32;
        let step = |index: u32| {
            let begin = near + 0.125 * f64::from(index);
            let end = (begin + 0.125).min(far);
            (block(ray.0 + ray.1 * (0.5 * (begin + end))), end - begin)
        };
        (0..count).map(step).collect()
    });
}
