//! Mistakes about lights, and about the camera.

use super::{Edit, Mistake, set};
use crate::optics::{Light, Sides, Spot};
use crate::scene::Radiative;
use glam::DVec3;
use std::f64::consts::PI;

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "point-lights-over-4pi" => Light(|light| intensity(light, 1.0 / (4.0 * PI))),
        "point and spot lights are too dark by a factor of 4 pi: their intensity is power per steradian, not power; do not divide it by 4 pi";
    "point-lights-times-4pi" => Light(|light| intensity(light, 4.0 * PI)),
        "point and spot lights are too bright by a factor of 4 pi: is the phase function missing its 1/(4 pi), or was intensity converted to power?";
    "point-lights-left-out" => Light(|light| intensity(light, 0.0)),
        "point and spot lights are missing: rays do not hit them by chance, so each vertex of a path needs a shadow ray to them";
    "lights-after-the-first-left-out" => Radiative(|scene| {
        let occurs = scene.lights.len() > 1;
        scene.lights.truncate(1);
        occurs
    }),
        "only the first light shines: each vertex of a path is connected to all of them, or to one chosen at random, divided by its probability";
    "sun-over-pi" => Light(|light| irradiance(light, 1.0 / PI)),
        "directional light is too dark by a factor of pi: irradiance is measured on a plane perpendicular to it; do not divide it by anything";
    "sun-left-out" => Light(|light| irradiance(light, 0.0)),
        "directional light is missing: rays do not hit it by chance, so each vertex of a path needs a shadow ray towards it";
    "sun-reversed" => Light(|light| {
        if let Light::Directional(sun) = light {
            sun.direction = -sun.direction;
        }
    }),
        "directional light comes from the opposite side: `direction` is the direction the light travels";
    "spot-angles-halved" => Light(|light| cone(light, |[inner, outer]| [inner / 2.0, outer / 2.0])),
        "spotlight cones are half as wide as they should be: measure angles from the axis to the edge, not from edge to edge";
    "spot-angles-doubled" => Light(|light| cone(light, |[inner, outer]| [inner * 2.0, (outer * 2.0).min(180.0)])),
        "spotlight cones are twice as wide as they should be: measure angles from the axis to the edge";
    "spot-without-fall-off" => Light(|light| cone(light, |[_, outer]| [outer, outer])),
        "spotlights end with a hard edge: their intensity should fall linearly in the angle from inner_angle to outer_angle";
    "environment-left-out" => Radiative(|scene| set(&mut scene.environment, DVec3::ZERO)),
        "the environment is missing: rays that leave the scene should bring its radiance back";
    "environment-doubled" => Radiative(|scene| {
        let doubled = 2.0 * scene.environment;
        set(&mut scene.environment, doubled)
    }),
        "the environment is twice as bright as it should be: is it both hit by rays and sampled as a light, without weights?";
    "emitter-sides-exchanged" => Radiative(|scene| {
        for lamp in &mut scene.area_lights {
            lamp.sides = match lamp.sides {
                Sides::Front => Sides::Both,
                Sides::Both => Sides::Front,
            };
        }
        !scene.area_lights.is_empty()
    }),
        "emitters emit from both sides instead of one, or the reverse: the front of a rectangle is where edge_u x edge_v points";
    "emitter-over-pi" => Radiative(|scene| lamps(scene, 1.0 / PI)),
        "emitters are too dark by a factor of pi: the scene gives their radiance, not the power that leaves a unit of area";
    "emitter-times-pi" => Radiative(|scene| lamps(scene, PI)),
        "emitters are too bright by a factor of pi: the scene gives their radiance; is the 1/pi of Lambert's reflection missing?";
    "field-of-view-doubled" => Radiative(|scene| {
        // The angle whose half is the full one; wider than that there is no image.
        let angle = (2.0 * scene.camera.vertical_fov()).min(0.9 * PI);
        scene.camera = scene.camera.with_vertical_fov(angle);
        !scene.camera.is_orthographic
    }),
        "the field of view is about twice as wide as it should be: vertical_fov is the full angle from the top to the bottom edge, so the image plane ends at tan(fov / 2)";
    "field-of-view-halved" => Radiative(|scene| {
        let angle = 0.5 * scene.camera.vertical_fov();
        scene.camera = scene.camera.with_vertical_fov(angle);
        !scene.camera.is_orthographic
    }),
        "the field of view is about half of what it should be: vertical_fov is in degrees, the full angle from the top to the bottom edge";
    "half-a-pixel-right" => View([0.5, 0.0]),
        "the image is half a pixel too far to the right, along x alone: rays go through the centres of pixels, (x + 1/2), on both axes; is a centre left out on this one, or the aspect ratio taken of one pixel fewer?";
    "half-a-pixel-left" => View([-0.5, 0.0]),
        "the image is half a pixel too far to the left, along x alone: rays go through the centres of pixels, (x + 1/2), on both axes; is a centre left out on this one, or the aspect ratio taken of one pixel fewer?";
    "half-a-pixel-down" => View([0.0, 0.5]),
        "the image is half a pixel too far down, along y alone: rays go through the centres of pixels, (y + 1/2), on both axes; is a centre left out on this one, or the aspect ratio taken of one pixel fewer?";
    "half-a-pixel-up" => View([0.0, -0.5]),
        "the image is half a pixel too far up, along y alone: rays go through the centres of pixels, (y + 1/2), on both axes; is a centre left out on this one, or the aspect ratio taken of one pixel fewer?";
};

fn intensity(light: &mut Light, factor: f64) {
    if light.position().is_some() {
        *light.strength_mut() *= factor;
    }
}

fn irradiance(light: &mut Light, factor: f64) {
    if let Light::Directional(sun) = light {
        sun.irradiance *= factor;
    }
}

/// Edits the inner and the outer angle of a spotlight, degrees.
fn cone(light: &mut Light, edit: fn([f64; 2]) -> [f64; 2]) {
    if let Light::Spot(spot) = light {
        let angles = edit([spot.inner().to_degrees(), spot.outer().to_degrees()]);
        let edited = Spot::new(spot.position, *spot.axis(), spot.intensity, angles);
        *spot = edited.unwrap_or(*spot);
    }
}

fn lamps(scene: &mut Radiative, factor: f64) -> bool {
    for lamp in &mut scene.area_lights {
        lamp.radiance *= factor;
    }
    !scene.area_lights.is_empty()
}
