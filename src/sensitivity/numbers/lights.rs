//! Parameters of lights: area lights (`lamp`), point, spot and directional lights (`light`), and the
//! environment.

use super::{Number, along, of_each};
use crate::geometry::{Luminous, Sphere, Surface, Transform};
use crate::math::{Direction, Frame};
use crate::optics::{Light, Spot};
use crate::scene::Radiative;
use glam::DVec3;
use std::sync::Arc;

/// Turns of a light about two axes across its own.
const TILTS: [[&str; 3]; 2] = [
    ["light.tilt", "tilt of the light", "light"],
    ["light.tilt2", "tilt across the first of the light", "light"],
];

/// A place moves by this part of its distance from the eye.
const PART_OF_DISTANCE: f64 = 0.01;

/// Parameters of every light.
pub(super) fn numbers(scene: &Radiative) -> Vec<Number> {
    let lamps = of_each(scene.area_lights.len(), |at| of_area_light(scene, at));
    let lights = of_each(scene.lights.len(), |at| of_light(scene, at));
    let mut numbers: Vec<Number> = lamps.chain(lights).collect();
    if scene.environment != DVec3::ZERO {
        let names = ["environment", "radiance of the environment", "light"];
        let number = Number::radiative(names, 0.5, |scene, change| {
            scene.environment *= 1.0 + change;
            Some(())
        });
        numbers.push(number.linear());
    }
    numbers
}

/// Parameters of the area light `at`.
fn of_area_light(scene: &Radiative, at: usize) -> Vec<Number> {
    let bounds = scene.area_lights[at].shape.bounds();
    let step = PART_OF_DISTANCE * (bounds.centre() - scene.camera.eye).length();
    let strength = ["lamp", "radiance of the area light", "area light"];
    let strength = Number::radiative(strength, 0.5, move |scene, change| {
        scene.area_lights.get_mut(at)?.radiance *= 1.0 + change;
        Some(())
    });
    let size = ["lamp.size", "edge of the area light", "area light"];
    let size = Number::radiative(size, 0.05, move |scene, change| {
        let shape = &mut scene.area_lights.get_mut(at)?.shape;
        *shape = scaled(shape, 1.0 + change)?;
        Some(())
    });
    let mut numbers = vec![strength.linear(), size];
    // Along its normal a flat lamp soon passes through the ceiling that it hangs from, and no
    // step is short enough for that and long enough for the noise.
    let extended = (0..3).filter(|&axis| bounds.size()[axis] != 0.0);
    numbers.extend(extended.map(|axis| {
        let names = along(["lamp", "of the area light", "area light"], axis);
        let number = Number::radiative(names, step, move |scene, change| {
            let by = Transform::translation(DVec3::AXES[axis] * change).ok()?;
            let shape = &mut scene.area_lights.get_mut(at)?.shape;
            *shape = moved(shape, &by)?;
            Some(())
        });
        number.per("world units")
    }));
    numbers
}

/// Parameters of the light `at`, which has no extent.
fn of_light(scene: &Radiative, at: usize) -> Vec<Number> {
    let light = &scene.lights[at];
    let strength = ["light", "strength of the light", "light"];
    let strength = Number::radiative(strength, 0.5, move |scene, change| {
        *scene.lights.get_mut(at)?.strength_mut() *= 1.0 + change;
        Some(())
    });
    let mut numbers = vec![strength.linear()];
    if let Some(position) = light.position() {
        let step = PART_OF_DISTANCE * (position - scene.camera.eye).length();
        numbers.extend((0..3).map(|axis| {
            let names = along(["light", "of the light", "light"], axis);
            let number = Number::radiative(names, step, move |scene, change| {
                shifted(scene.lights.get_mut(at)?, DVec3::AXES[axis] * change)
            });
            number.per("world units")
        }));
    }
    if !matches!(light, Light::Point(_)) {
        numbers.extend(TILTS.iter().enumerate().map(|(about, names)| {
            let number = Number::radiative(*names, 1.0, move |scene, change| {
                turned(scene.lights.get_mut(at)?, about, change)
            });
            number.per("degrees")
        }));
    }
    if matches!(light, Light::Spot(_)) {
        let cone = ["light.cone", "half angle of the cone of the light", "light"];
        let cone = Number::radiative(cone, 1.0, move |scene, change| {
            widened(scene.lights.get_mut(at)?, change)
        });
        numbers.push(cone.per("degrees"));
    }
    numbers
}

fn shifted(light: &mut Light, by: DVec3) -> Option<()> {
    match light {
        Light::Point(light) => light.position += by,
        Light::Spot(light) => light.position += by,
        Light::Directional(_) => return None,
    }
    Some(())
}

fn turned(light: &mut Light, about: usize, degrees: f64) -> Option<()> {
    match light {
        Light::Directional(light) => light.direction = tilted(light.direction, about, degrees)?,
        Light::Spot(spot) => {
            let axis = tilted(spot.axis(), about, degrees)?;
            *spot = with_cone(spot, axis, [spot.inner(), spot.outer()])?;
        }
        Light::Point(_) => return None,
    }
    Some(())
}

fn widened(light: &mut Light, degrees: f64) -> Option<()> {
    if let Light::Spot(spot) = light {
        let wider = degrees.to_radians();
        let angles = [spot.inner() + wider, spot.outer() + wider];
        *spot = with_cone(spot, spot.axis(), angles)?;
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
    let by = Transform::scale(DVec3::splat(factor)).ok()?;
    moved(shape, &by.about(shape.bounds().centre()).ok()?)
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
