//! Distances of what is seen from the eye.

use crate::geometry::{Ray, Surface};
use crate::math::exp_m1;
use crate::scene::{Classified, Mode, Model, Panel, Radiative, Scene};
use crate::volume::{Cell, NodeLine, Reconstruction as _};

/// Samples along a ray through a classified volume: enough to tell near from far.
const SAMPLES: usize = 64;

/// Opacity of a ray that shows nothing.
const FAINTEST: f64 = 1e-3;

/// Distance from the eye of the surface in the middle of each pixel, or of where a ray has half of its
/// opacity, world units, row by row; infinite where nothing is seen. Nothing for a scene with neither
/// surfaces nor a classified volume.
pub(super) fn distances(scene: &Scene) -> Option<Vec<f64>> {
    let is_known = |panel: &Panel| match &panel.model {
        Model::Radiative(of) => !of.objects.is_empty() || !of.area_lights.is_empty(),
        Model::Classified(of) => of.mode == Mode::Composited,
        Model::Curve(_) => false,
    };
    if !scene.panels.iter().any(is_known) {
        return None;
    }
    let distance = |panel: &Panel, at: [usize; 2]| {
        let size = [panel.width, panel.height];
        match &panel.model {
            Model::Radiative(of) => nearest(of, &of.camera.ray(at, size)),
            Model::Classified(of) if of.mode != Mode::Composited => f64::INFINITY,
            Model::Classified(of) => nearest_seen(of, &of.camera.ray(at, size)),
            Model::Curve(_) => f64::INFINITY,
        }
    };
    let rows = (0..scene.height()).flat_map(|row| {
        scene.panels.iter().flat_map(move |panel| {
            (0..panel.width).map(move |column| distance(panel, [column, row]))
        })
    });
    Some(rows.collect())
}

/// Distance of the nearest of all volumes, as if each were alone, and surfaces.
fn nearest_seen(scene: &Classified, ray: &Ray) -> f64 {
    if !scene.has_objects() {
        return half_seen(scene, ray);
    }
    let surfaces = scene.objects.surfaces.iter();
    let hits = surfaces.filter_map(|surface| Some(surface.shape.hit(ray, f64::INFINITY)?.t));
    let volumes = scene.each_alone().map(|alone| half_seen(&alone, ray));
    volumes.chain(hits).fold(f64::INFINITY, f64::min)
}

/// Distance at which a ray has half of the opacity that it has in the end.
fn half_seen(volume: &Classified, ray: &Ray) -> f64 {
    let lattice = volume.grid.lattice();
    let Some(span) = volume.extent().span(ray) else {
        return f64::INFINITY;
    };
    let line = NodeLine::new(volume.extent().line(ray), lattice);
    let step = span.length() / SAMPLES as f64;
    let mut depth = 0.0;
    let samples: Vec<(f64, f64)> = (0..SAMPLES)
        .map(|sample| {
            let t = span.near + (sample as f64 + 0.5) * step;
            let cell = Cell::around(lattice, line.at(t));
            let value = volume.interpolation.read(&volume.grid, &cell);
            depth += volume.transfer_function.extinction(value) * step;
            (t, -exp_m1(-depth))
        })
        .collect();
    let opacity = samples.last().map_or(0.0, |(_, opacity)| *opacity);
    let half = samples
        .iter()
        .find(|(_, reached)| *reached >= 0.5 * opacity);
    half.filter(|_| opacity > FAINTEST)
        .map_or(f64::INFINITY, |(t, _)| *t)
}

fn nearest(scene: &Radiative, ray: &Ray) -> f64 {
    let objects = scene
        .objects
        .iter()
        .map(|object| &object.shape as &dyn Surface);
    let lights = scene
        .area_lights
        .iter()
        .map(|light| &light.shape as &dyn Surface);
    objects.chain(lights).fold(f64::INFINITY, |nearest, shape| {
        shape.hit(ray, nearest).map_or(nearest, |hit| hit.t)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_ball_before_nothing() {
        let scene = |surfaces: &str| {
            let text = format!(
                "[film]\nwidth = 3\nheight = 3\n\
                 [camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\nvertical_fov = 80\n\
                 [radiative]\nscattering = 'none'\nenvironment = 1\n{surfaces}"
            );
            Scene::parse(&text, "scene.toml".as_ref()).unwrap()
        };
        let ball = "[[radiative.surface]]\nsphere = { centre = [0, 0, 0], radius = 1 }\n\
                    diffuse = { reflectance = 0.5 }\n";
        let found = distances(&scene(ball)).unwrap();
        assert_eq!(found.len(), 9);
        assert!((found[4] - 3.0).abs() < 1e-12);
        assert_eq!(found[0], f64::INFINITY);
        assert_eq!(distances(&scene("")), None);
    }

    /// A ball in a box, seen from outside: its front, and nothing beside it.
    #[test]
    fn a_volume_is_as_far_as_what_is_seen_of_it() {
        let file = "fixtures/scenes/limit/smooth-blob.toml";
        let scene = Scene::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
        let found = distances(&scene).unwrap();
        let Model::Classified(volume) = &scene.panels[0].model else {
            panic!("a classified volume");
        };
        let to_centre = (volume.camera.eye() - volume.extent().world_bounds().centre()).length();
        let (width, height) = (scene.panels[0].width, scene.height());
        let middle = found[width * (height / 2) + width / 2];
        assert!(
            middle > 0.5 * to_centre && middle < 1.2 * to_centre,
            "{middle} {to_centre}"
        );
        assert_eq!(found[0], f64::INFINITY);
    }
}
