//! Numbers of lights: area lights (`lamp`), point, spot and directional lights (`light`), and the
//! environment.

use super::{Number, Quantity, in_radiative};
use crate::geometry::{Luminous, Sphere, Surface, Transform};
use crate::math::{Direction, Frame};
use crate::optics::{Light, Spot};
use crate::scene::{AreaLight, Radiative, Scene};
use crate::sensitivity::number::Dependence::{Linear, Smooth};
use glam::DVec3;
use std::sync::Arc;

static LAMP: Quantity = Quantity::share("lamp", "radiance of the area light", "area light");
static LAMP_SIZE: Quantity = Quantity::share("lamp.size", "edge of the area light", "area light");
static LAMP_PLACES: [Quantity; 3] = Quantity::place(
    ["lamp.x", "lamp.y", "lamp.z"],
    [
        "x of the area light",
        "y of the area light",
        "z of the area light",
    ],
    "area light",
    "world units",
);
static LIGHT: Quantity = Quantity::share("light", "strength of the light", "light");
static LIGHT_PLACES: [Quantity; 3] = Quantity::place(
    ["light.x", "light.y", "light.z"],
    ["x of the light", "y of the light", "z of the light"],
    "light",
    "world units",
);
static TILTS: [Quantity; 2] = [
    Quantity::absolute("light.tilt", "tilt of the light", "light", "degrees"),
    Quantity::absolute(
        "light.tilt2",
        "tilt across the first of the light",
        "light",
        "degrees",
    ),
];
static CONE: Quantity = Quantity::absolute(
    "light.cone",
    "half angle of the cone of the light",
    "light",
    "degrees",
);
static ENVIRONMENT: Quantity =
    Quantity::share("environment", "radiance of the environment", "light");

/// A place moves by this part of its distance from the eye.
const PART_OF_DISTANCE: f64 = 0.01;

/// Numbers of every light.
pub(super) fn numbers(scene: &Radiative) -> Vec<Number> {
    let mut numbers = Vec::new();
    let eye = scene.camera.eye();
    let count = scene.area_lights.len();
    for at in 0..count {
        let index = (count > 1).then_some(at + 1);
        let lamp = &scene.area_lights[at].shape;
        let step = PART_OF_DISTANCE * (lamp.bounds().centre() - eye).length();
        numbers.push(
            Number::new(&LAMP, 0.5, Linear, move |scene, change| {
                lamps(scene, at, |lamp| {
                    lamp.radiance *= 1.0 + change;
                    Some(())
                })
            })
            .numbered(index),
        );
        numbers.push(
            Number::new(&LAMP_SIZE, 0.05, Smooth, move |scene, change| {
                lamps(scene, at, |lamp| {
                    lamp.shape = scaled(&lamp.shape, 1.0 + change)?;
                    Some(())
                })
            })
            .numbered(index),
        );
        let size = lamp.bounds().size();
        for (axis, quantity) in LAMP_PLACES.iter().enumerate() {
            // Along its normal a flat lamp soon passes through the ceiling that it hangs from, and no
            // step is short enough for that and long enough for the noise.
            if size[axis] == 0.0 {
                continue;
            }
            let edit = move |scene: &mut Scene, change: f64| {
                let by = Transform::translation(DVec3::AXES[axis] * change).ok()?;
                lamps(scene, at, |lamp| {
                    lamp.shape = moved(&lamp.shape, &by)?;
                    Some(())
                })
            };
            numbers.push(Number::new(quantity, step, Smooth, edit).numbered(index));
        }
    }
    let count = scene.lights.len();
    for at in 0..count {
        let index = (count > 1).then_some(at + 1);
        numbers.push(
            Number::new(&LIGHT, 0.5, Linear, move |scene, change| {
                lights(scene, at, |light| {
                    match light {
                        Light::Point(light) => light.intensity *= 1.0 + change,
                        Light::Spot(light) => light.intensity *= 1.0 + change,
                        Light::Directional(light) => light.irradiance *= 1.0 + change,
                    }
                    Some(())
                })
            })
            .numbered(index),
        );
        if let Some(position) = scene.lights[at].position() {
            let step = PART_OF_DISTANCE * (position - eye).length();
            for (axis, quantity) in LIGHT_PLACES.iter().enumerate() {
                let edit = move |scene: &mut Scene, change: f64| {
                    let by = DVec3::AXES[axis] * change;
                    lights(scene, at, |light| {
                        match light {
                            Light::Point(light) => light.position += by,
                            Light::Spot(light) => light.position += by,
                            Light::Directional(_) => return None,
                        }
                        Some(())
                    })
                };
                numbers.push(Number::new(quantity, step, Smooth, edit).numbered(index));
            }
        }
        if !matches!(scene.lights[at], Light::Point(_)) {
            for (tilt, quantity) in TILTS.iter().enumerate() {
                let edit = move |scene: &mut Scene, change: f64| {
                    lights(scene, at, |light| {
                        match light {
                            Light::Directional(light) => {
                                light.direction = tilted(light.direction, tilt, change)?;
                            }
                            Light::Spot(spot) => {
                                let axis = tilted(spot.axis(), tilt, change)?;
                                *spot = with_cone(spot, axis, [spot.inner(), spot.outer()])?;
                            }
                            Light::Point(_) => return None,
                        }
                        Some(())
                    })
                };
                numbers.push(Number::new(quantity, 1.0, Smooth, edit).numbered(index));
            }
        }
        if matches!(scene.lights[at], Light::Spot(_)) {
            let edit = move |scene: &mut Scene, change: f64| {
                lights(scene, at, |light| {
                    if let Light::Spot(spot) = light {
                        let wider = change.to_radians();
                        let angles = [spot.inner() + wider, spot.outer() + wider];
                        *spot = with_cone(spot, spot.axis(), angles)?;
                    }
                    Some(())
                })
            };
            numbers.push(Number::new(&CONE, 1.0, Smooth, edit).numbered(index));
        }
    }
    if scene.environment != DVec3::ZERO {
        numbers.push(Number::new(&ENVIRONMENT, 0.5, Linear, |scene, change| {
            in_radiative(scene, |radiative| {
                radiative.environment *= 1.0 + change;
                Some(())
            })
        }));
    }
    numbers
}

fn lamps(scene: &mut Scene, at: usize, edit: impl Fn(&mut AreaLight) -> Option<()>) -> Option<()> {
    in_radiative(scene, |radiative| edit(radiative.area_lights.get_mut(at)?))
}

fn lights(scene: &mut Scene, at: usize, edit: impl Fn(&mut Light) -> Option<()>) -> Option<()> {
    in_radiative(scene, |radiative| edit(radiative.lights.get_mut(at)?))
}

fn moved(shape: &Luminous, by: &Transform) -> Option<Luminous> {
    Some(match shape {
        Luminous::Sphere(sphere) => {
            Luminous::Sphere(Sphere::new(by.point(sphere.centre()), sphere.radius()).ok()?)
        }
        Luminous::Rectangle(rectangle) => Luminous::Rectangle(rectangle.transformed(by).ok()?),
        Luminous::Mesh(mesh) => Luminous::Mesh(Arc::new(mesh.transformed(by).ok()?)),
    })
}

/// About its centre.
fn scaled(shape: &Luminous, factor: f64) -> Option<Luminous> {
    if let Luminous::Sphere(sphere) = shape {
        let sphere = Sphere::new(sphere.centre(), sphere.radius() * factor).ok()?;
        return Some(Luminous::Sphere(sphere));
    }
    let centre = shape.bounds().centre();
    let by = Transform::translation(-centre).ok()?;
    let by = by.then(&Transform::scale(DVec3::splat(factor)).ok()?);
    moved(shape, &by.then(&Transform::translation(centre).ok()?))
}

fn tilted(direction: Direction, about: usize, degrees: f64) -> Option<Direction> {
    let frame = Frame::around(direction);
    let axis = [frame.x, frame.y][about];
    let turn = Transform::rotation(*axis, degrees).ok()?;
    Direction::of(turn.vector(*direction))
}

/// Angles in radians.
fn with_cone(spot: &Spot, axis: Direction, angles: [f64; 2]) -> Option<Spot> {
    let angles = angles.map(f64::to_degrees);
    Spot::new(spot.position, *axis, spot.intensity, angles).ok()
}
