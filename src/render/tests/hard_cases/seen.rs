//! Rows known as radiance along a ray through a scene, as the catalogue holds them.

use super::margin::{Margin, U};
use super::scenes::{line_of_sight, ray, sampled};
use crate::render::radiative::line_of_sight::TOLERANCE;
use crate::scene::{Model, Scattering, Scene};
use serde::Deserialize;
use std::path::Path;

/// Radiance along a ray through a scene, the same in all channels.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seen {
    /// What stands under `[radiative]` in a scene file.
    scene: toml::Table,
    from: [f64; 3],
    along: [f64; 3],
    radiance: f64,
    /// Roundings by which an integral may be off.
    #[serde(default)]
    roundings: f64,
    /// Relative error by which an integral may be off.
    #[serde(default)]
    relative: f64,
    /// Tolerance to which an integral is taken; that of images if not given.
    quadrature: Option<f64>,
    /// Number of paths; without any other tolerance, there are paths alone.
    paths: Option<u32>,
}

/// A scene file is a film and a camera besides, which rays of their own do not ask for.
const FILM_AND_CAMERA: &str = "
film = { width = 1, height = 1 }
camera = { eye = [0, 0, -3], target = [0, 0, 0], up = [0, 1, 0], vertical_fov = 40 }
";

impl Seen {
    /// Compares the radiance with that of the code that renders.
    pub fn compare(&self, margin: &Margin) {
        let root = toml::Table::from_iter([("radiative".to_owned(), self.scene.clone().into())]);
        let text = format!("{FILM_AND_CAMERA}{root}");
        let scene = Scene::parse(&text, Path::new("catalogue.toml"));
        let panel = scene.ok().and_then(|scene| scene.panels.into_iter().next());
        let Some(Model::Radiative(scene)) = panel.map(|panel| panel.model) else {
            return margin.holds(format_args!("a scene of media: {text}"), false);
        };
        let ray = ray(self.from, self.along);
        let what = format_args!("from {:?} along {:?} in {root}", self.from, self.along);
        let share = self.relative + self.roundings * U;
        if self.paths.is_none() || share > 0.0 {
            let scattered = scene.scattering == Scattering::Single;
            let tolerance = self.quadrature.unwrap_or(TOLERANCE);
            let found = line_of_sight(&scene, &ray, scattered, tolerance);
            for channel in found.to_array() {
                margin.relative(what, channel, self.radiance, share);
            }
        }
        if let Some(paths) = self.paths {
            let limit = match scene.scattering {
                Scattering::None => Some(0),
                Scattering::Single => Some(1),
                Scattering::Multiple(limit) => limit,
            };
            for channel in sampled(&scene, limit, paths, ray) {
                margin.sampled(what, &channel, self.radiance);
            }
        }
    }
}
