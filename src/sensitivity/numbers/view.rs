//! Numbers of the camera.

use super::{Number, Quantity, of_axes};
use crate::geometry::Camera;
use crate::math;
use crate::scene::Scene;
use glam::DVec3;

static FIELD_OF_VIEW: Quantity =
    Quantity::share("camera.view", "height of the image plane", "camera");
static EYE: [Quantity; 3] = of_axes!("camera", "of the eye", "camera", "world units");
static SHIFTS: [Quantity; 2] = [
    Quantity::absolute(
        "camera.right",
        "shift of the image to the right",
        "camera",
        "pixels",
    ),
    Quantity::absolute(
        "camera.down",
        "shift of the image downwards",
        "camera",
        "pixels",
    ),
];

/// Step of a shift: what half a pixel moves over an edge is as much as a pixel shows of it.
const PIXELS: f64 = 0.5;

/// Numbers of the first camera; the cameras of other panels are changed alike.
pub(super) fn numbers(scene: &Scene) -> Vec<Number> {
    let mut cameras = scene.panels.iter().filter_map(|panel| panel.model.camera());
    let Some(camera) = cameras.next() else {
        return Vec::new();
    };
    let height = scene.panels.iter().map(|panel| panel.height).max();
    let pixel = 1.0 / height.unwrap_or(1) as f64;
    let view = |quantity, step, edit: fn(&Camera, f64, f64) -> Camera| {
        Number::new(quantity, step, move |panel, change| {
            panel.edit_view(|camera, pixel| edit(camera, pixel, change));
            Some(())
        })
    };
    let mut numbers = vec![
        // The edge of the image moves by a pixel.
        view(&FIELD_OF_VIEW, 2.0 * pixel, |camera, _, change| {
            camera.with_image_scaled(math::exp(math::ln_1p(change)))
        }),
        view(&SHIFTS[0], PIXELS, |camera, pixel, change| {
            camera.with_image_moved([change * pixel, 0.0])
        }),
        view(&SHIFTS[1], PIXELS, |camera, pixel, change| {
            camera.with_image_moved([0.0, change * pixel])
        }),
    ];
    // Things as far away as the image plane move by a pixel.
    let distance = camera.eye().length().max(camera.half_up().length());
    numbers.extend(EYE.iter().enumerate().map(|(axis, quantity)| {
        Number::new(quantity, pixel * distance, move |panel, change| {
            panel.edit_view(|camera, _| camera.with_eye_moved(DVec3::AXES[axis] * change));
            Some(())
        })
    }));
    numbers
}
