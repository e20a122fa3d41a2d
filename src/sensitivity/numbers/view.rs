//! Parameters of the camera.

use super::{Number, along};
use crate::geometry::Camera;
use crate::math;
use crate::scene::Scene;
use glam::DVec3;

/// Step of a shift: what half a pixel moves over an edge is as much as a pixel shows of it.
const PIXELS: f64 = 0.5;

/// Parameters of the first camera; the cameras of other panels are changed alike.
pub(super) fn numbers(scene: &Scene) -> Vec<Number> {
    let mut cameras = scene.panels.iter().filter_map(|panel| panel.model.camera());
    let Some(camera) = cameras.next() else {
        return Vec::new();
    };
    let height = scene.panels.iter().map(|panel| panel.height).max();
    let pixel = 1.0 / height.unwrap_or(1) as f64;
    let view = |name, words, step, edit: fn(&Camera, f64, f64) -> Camera| {
        Number::new([name, words, "camera"], step, move |panel, change| {
            panel.edit_view(|camera, pixel| edit(camera, pixel, change));
            Some(())
        })
    };
    let right = "shift of the image to the right";
    let right = view("camera.right", right, PIXELS, |camera, pixel, change| {
        camera.with_image_moved([change * pixel, 0.0])
    });
    let down = "shift of the image downwards";
    let down = view("camera.down", down, PIXELS, |camera, pixel, change| {
        camera.with_image_moved([0.0, change * pixel])
    });
    // The edge of the image moves by a pixel.
    let (height, step) = ("height of the image plane", 2.0 * pixel);
    let height = view("camera.view", height, step, |camera, _, change| {
        camera.with_image_scaled(math::exp(math::ln_1p(change)))
    });
    // Things as far away as the image plane move by a pixel.
    let distance = camera.eye.length().max(camera.half_up.length());
    let eye = (0..3).map(|axis| {
        let names = along(["camera", "of the eye", "camera"], axis);
        let number = Number::new(names, pixel * distance, move |panel, change| {
            panel.edit_view(|camera, _| camera.with_eye_moved(DVec3::AXES[axis] * change));
            Some(())
        });
        number.per("world units")
    });
    let shifts = [right, down].map(|shift| shift.per("pixels"));
    [height].into_iter().chain(shifts).chain(eye).collect()
}
