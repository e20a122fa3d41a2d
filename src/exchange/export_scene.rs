//! A radiative scene, prepared for export.

use super::forms::{self, Form};
use super::nested_media::{ExportSurface, NestedMedia, SurfaceKind};
use super::refusal::Faults;
use super::view::{ExportView, is_parallel};
use crate::geometry::{Aabb, Emitter, Ray, Shape, Side, Surface};
use crate::optics::{Light, Material};
use crate::scene::{Object, Panel, Radiative};
use glam::DVec3;
use std::ops::Range;

/// Everything of a scene, by its coordinates, with the names that messages use.
pub(super) struct ExportScene<'s> {
    /// Surfaces: those that reflect or refract, then those that emit light.
    pub surfaces: Vec<ExportSurface<'s>>,
    /// Media.
    pub nested_media: NestedMedia<'s>,
    /// The eye.
    pub view: ExportView,
    /// The largest coordinate of anything, in magnitude.
    pub reach: f64,
    /// The distance that boundaries of media keep from each other and from surfaces.
    pub gap: f64,
}

impl<'s> ExportScene<'s> {
    /// The export of `scene`, which is the model of `panel`. `gap` is the distance that boundaries keep in
    /// a scene of a given reach: more than the renderer moves the starts of rays off a surface; `reaches` are those with
    /// which it can calculate. What neither format can say goes to `faults`.
    pub(super) fn of(
        panel: &Panel,
        scene: &'s Radiative,
        gap: fn(f64) -> f64,
        reaches: Range<f64>,
        faults: &mut Faults,
    ) -> ExportScene<'s> {
        let size = [panel.width, panel.height];
        let view = ExportView::of(&scene.camera, size);
        let [width, height] = size.map(|pixels| pixels as f64);
        // Between its corners a picture holds no other directions than theirs, mixed.
        let sight = [
            [0.0, 0.0],
            [width, 0.0],
            [0.0, height],
            [width, height],
            [0.5 * width, 0.5 * height],
        ]
        .map(|key| scene.camera.ray_through(key, size));
        let [objects, lights] = names(panel, scene);
        for (key, object) in objects.iter().zip(&scene.objects) {
            if let Err(what) = check_glass(object, scene, &sight) {
                faults.add(key, what);
            }
        }
        let objects = scene.objects.iter().zip(objects);
        let objects = objects.map(|(object, key)| ExportSurface {
            key,
            form: Form::of(forms::shape(&object.shape)),
            kind: SurfaceKind::Material(object.material),
        });
        let lights = scene.area_lights.iter().zip(lights);
        let lights = lights.map(|(light, key)| ExportSurface {
            key,
            form: Form::of(forms::luminous(&light.shape)),
            kind: SurfaceKind::Light(light),
        });
        let surfaces: Vec<ExportSurface<'s>> = objects.chain(lights).collect();
        let bodies = scene.media.iter().filter_map(|body| body.boundary.as_ref());
        let positions = scene.lights.iter().filter_map(Light::position);
        let forms = surfaces.iter().map(|surface| surface.form.reach());
        let reach = forms
            .chain(bodies.map(|boundary| boundary.bounds().reach()))
            .chain(positions.map(|position| position.abs().max_element()))
            .fold(view.eye.abs().max_element(), f64::max)
            .max(view.orthographic_height.unwrap_or(0.0));
        if !reaches.contains(&reach) {
            let what = format!(
                "coordinates up to {reach:e}, too large or too small for the numbers of this renderer; choose another \
                 unit of length"
            );
            faults.add("radiative", what);
        }
        let nested_media = NestedMedia::of(scene, &surfaces, &sight, reach, gap(reach), faults);
        ExportScene {
            surfaces,
            nested_media,
            view,
            reach,
            gap: gap(reach),
        }
    }
}

/// The names of objects and of lights, which the scene file lists together.
fn names(panel: &Panel, scene: &Radiative) -> [Vec<String>; 2] {
    let count = scene.objects.len() + scene.area_lights.len();
    let mut names = [Vec::new(), Vec::new()];
    for index in 0..count {
        let key = format!("radiative.surface[{index}]");
        let emitter = format!("{key}.emitter.");
        let is_light = |key: &str| key.starts_with(&emitter);
        let kind = usize::from(panel.readings.iter().any(|reading| is_light(&reading.key)));
        names[kind].push(key);
    }
    names
}

/// Other renderers let radiance grow by the square of the index where light goes into glass;
/// volref does not. That cancels where light leaves again, so what begins or ends in glass is
/// refused.
fn check_glass(object: &Object, scene: &Radiative, sight: &[Ray]) -> Result<(), String> {
    if !matches!(object.material, Material::Glass(_)) {
        return Ok(());
    }
    if let Shape::Rectangle(_) = &object.shape {
        let what = "glass without an inside: the radiance behind it has another scale there";
        return Err(what.to_owned());
    }
    let lights = scene.lights.iter().filter_map(Light::position);
    let lamps = scene.area_lights.iter();
    let lamps = lamps.map(|light| light.shape.sample([0.25, 0.25]).position);
    let eyes = sight.iter().map(|ray| ray.origin);
    // Parallel rays begin anywhere between those of the corners.
    let is_cut = is_parallel(sight)
        && Aabb::around(eyes.clone()).is_some_and(|plane| plane.touches(&object.shape.bounds()));
    let mut points = eyes.chain(lights).chain(lamps);
    if is_cut || points.any(|point| is_inside(&object.shape, point)) {
        let what = "glass with the eye or a light in it: the radiance there has another scale";
        return Err(what.to_owned());
    }
    Ok(())
}

/// Whether the first thing seen of a closed shape is its back.
fn is_inside(shape: &Shape, point: DVec3) -> bool {
    // No direction of symmetry, so that no edge is met.
    let direction = DVec3::new(0.613, 0.371, 0.697);
    let hit = Ray::new(point, direction).and_then(|ray| shape.hit(&ray, f64::INFINITY));
    hit.is_some_and(|hit| hit.side == Side::Back)
}
