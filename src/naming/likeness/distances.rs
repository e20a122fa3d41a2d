//! Distances of surfaces from the eye.

use crate::geometry::{Ray, Surface};
use crate::scene::{Model, Panel, Radiative, Scene};

/// Distance from the eye of the surface in the middle of each pixel, world units, row by row;
/// infinite where there is none. Nothing for a scene without surfaces.
pub(super) fn distances(scene: &Scene) -> Option<Vec<f64>> {
    let panels: Vec<(&Panel, Option<&Radiative>)> = scene
        .panels
        .iter()
        .map(|panel| match &panel.model {
            Model::Radiative(radiative) => (panel, Some(&**radiative)),
            Model::Classified(_) | Model::Curve(_) => (panel, None),
        })
        .collect();
    let has_surfaces = |of: &Radiative| !of.objects.is_empty() || !of.area_lights.is_empty();
    if !panels.iter().any(|(_, of)| of.is_some_and(has_surfaces)) {
        return None;
    }
    let rows = (0..scene.height()).flat_map(|row| {
        panels.iter().flat_map(move |&(panel, of)| {
            (0..panel.width).map(move |column| {
                let size = [panel.width, panel.height];
                of.map_or(f64::INFINITY, |of| {
                    nearest(of, &of.camera.ray([column, row], size))
                })
            })
        })
    });
    Some(rows.collect())
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
}
