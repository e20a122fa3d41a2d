//! Numbers of lights: area lights (`lamp`), point, spot and directional lights (`light`), and the
//! environment.

use super::{Number, Places, Quantity, Unit};
use crate::geometry::{Luminous, Sphere, Surface, Transform};
use crate::math::{Direction, Frame};
use crate::optics::{Light, Spot};
use crate::scene::{AreaLight, Model, Radiative, Scene};
use crate::sensitivity::number::Dependence::{Linear, Smooth};
use glam::DVec3;
use std::sync::Arc;

static LAMP: Quantity = Quantity {
    name: "lamp",
    words: "radiance of the area light",
    of: "area light",
    unit: Unit::Share,
};
static LAMP_SIZE: Quantity = Quantity {
    name: "lamp.size",
    words: "edge of the area light",
    of: "area light",
    unit: Unit::Share,
};
static LAMP_PLACES: Places = Places([
    Quantity {
        name: "lamp.x",
        words: "x of the area light",
        of: "area light",
        unit: Unit::Absolute("world units"),
    },
    Quantity {
        name: "lamp.y",
        words: "y of the area light",
        of: "area light",
        unit: Unit::Absolute("world units"),
    },
    Quantity {
        name: "lamp.z",
        words: "z of the area light",
        of: "area light",
        unit: Unit::Absolute("world units"),
    },
]);
static LIGHT: Quantity = Quantity {
    name: "light",
    words: "strength of the light",
    of: "light",
    unit: Unit::Share,
};
static LIGHT_PLACES: Places = Places([
    Quantity {
        name: "light.x",
        words: "x of the light",
        of: "light",
        unit: Unit::Absolute("world units"),
    },
    Quantity {
        name: "light.y",
        words: "y of the light",
        of: "light",
        unit: Unit::Absolute("world units"),
    },
    Quantity {
        name: "light.z",
        words: "z of the light",
        of: "light",
        unit: Unit::Absolute("world units"),
    },
]);
static TILTS: [Quantity; 2] = [
    Quantity {
        name: "light.tilt",
        words: "tilt of the light",
        of: "light",
        unit: Unit::Absolute("degrees"),
    },
    Quantity {
        name: "light.tilt2",
        words: "tilt across the first of the light",
        of: "light",
        unit: Unit::Absolute("degrees"),
    },
];
static CONE: Quantity = Quantity {
    name: "light.cone",
    words: "half angle of the cone of the light",
    of: "light",
    unit: Unit::Absolute("degrees"),
};
static ENVIRONMENT: Quantity = Quantity {
    name: "environment",
    words: "radiance of the environment",
    of: "light",
    unit: Unit::Share,
};

/// A place moves by this part of its distance from the eye.
const PART_OF_DISTANCE: f64 = 0.01;

/// Of every light.
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
        for axis in 0..3 {
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
            numbers.push(Number::new(&LAMP_PLACES.0[axis], step, Smooth, edit).numbered(index));
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
            for axis in 0..3 {
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
                numbers
                    .push(Number::new(&LIGHT_PLACES.0[axis], step, Smooth, edit).numbered(index));
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
            for panel in &mut scene.panels {
                if let Model::Radiative(radiative) = &mut panel.model {
                    radiative.environment *= 1.0 + change;
                }
            }
            Some(())
        }));
    }
    numbers
}

fn lamps(scene: &mut Scene, at: usize, edit: impl Fn(&mut AreaLight) -> Option<()>) -> Option<()> {
    for panel in &mut scene.panels {
        if let Model::Radiative(radiative) = &mut panel.model {
            edit(radiative.area_lights.get_mut(at)?)?;
        }
    }
    Some(())
}

fn lights(scene: &mut Scene, at: usize, edit: impl Fn(&mut Light) -> Option<()>) -> Option<()> {
    for panel in &mut scene.panels {
        if let Model::Radiative(radiative) = &mut panel.model {
            edit(radiative.lights.get_mut(at)?)?;
        }
    }
    Some(())
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
