//! Scenes of surfaces, media and lights: what is read, and what is refused.

use glam::DVec3;
use std::path::Path;
use volref::geometry::{Boundary, Luminous, Shape};
use volref::optics::{Material, Sides};
use volref::scene::{Model, Radiative, Scattering, Scene, SceneError};

/// Reads a scene as if it were a file in `fixtures/scenes/smoke/`.
fn parse(text: &str) -> Result<Scene, Box<SceneError>> {
    Scene::parse(text, Path::new("fixtures/scenes/smoke/scene.toml"))
}

fn radiative(scene: &Scene, panel: usize) -> &Radiative {
    match &scene.panels[panel].model {
        Model::Radiative(radiative) => radiative,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_room_with_smoke() {
    let scene = Scene::load("fixtures/scenes/smoke/cornell.toml".as_ref()).unwrap();
    let room = radiative(&scene, 0);
    assert_eq!(room.scattering, Scattering::Multiple(None));
    assert_eq!((room.samples, room.seed), (64, 0));
    assert_eq!((room.objects.len(), room.area_lights.len()), (5, 1));
    assert!(matches!(room.objects[0].shape, Shape::Rectangle(_)));
    assert_eq!(
        room.objects[2].material,
        Material::Diffuse(DVec3::splat(0.73))
    );
    let light = &room.area_lights[0];
    assert!(matches!(light.shape, Luminous::Rectangle(_)));
    assert_eq!(
        (light.radiance, light.sides),
        (DVec3::splat(7.0), Sides::Both)
    );
    for (body, albedo) in room.media.iter().zip([0.0, 1.0]) {
        assert!(matches!(body.boundary, Some(Boundary::PlacedBox(_))));
        assert_eq!(body.medium.coefficients.albedo(), DVec3::splat(albedo));
        assert_eq!(body.medium.coefficients.sigma_t(), DVec3::splat(0.01));
    }
}
