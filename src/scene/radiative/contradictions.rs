//! Checks across keys: valid parts that cannot be rendered together.

use super::media::DEEPEST_TRACKED;
use super::shapes::FARTHEST;
use super::{Body, Object, Radiative, Scattering};
use crate::geometry::{Emitter, Luminous, Shape, Surface, length_of};
use crate::optics::{Coefficients, Field, Light, Material};
use crate::scene::SceneResult;
use crate::scene::reader::Reader;
use glam::DVec3;

/// A scene with the tables that it was read from.
pub(super) struct Contradictions<'r, 'd, 's> {
    pub scene: &'r Radiative,
    /// `[radiative]`.
    pub reader: &'r Reader<'d, 's>,
    pub media: Vec<(&'r Reader<'d, 's>, &'r Body)>,
    pub lights: Vec<(&'r Reader<'d, 's>, &'r Light)>,
}

const BOUND_IT: &str = "give the medium a boundary: a `sphere`, `box` or closed `mesh`";

impl Contradictions<'_, '_, '_> {
    /// Refuses scenes whose light is infinite, never arrives, or cannot be found.
    pub(super) fn check(&self) -> SceneResult<()> {
        self.check_far_away()?;
        self.check_places()?;
        self.check_collisions_without_end()?;
        self.check_lights_in_surfaces()?;
        self.check_light_that_no_path_meets()
    }

    /// Far away there are media without boundary alone, where they add up: light must neither grow without end there, nor
    /// come from there.
    fn check_far_away(&self) -> SceneResult<()> {
        let media = self.media.iter();
        let unbounded: Vec<_> = media.filter(|(_, body)| body.boundary.is_none()).collect();
        let coefficients = unbounded.iter().map(|(_, body)| &body.medium.coefficients);
        let sigma_a: DVec3 = coefficients.clone().map(Coefficients::sigma_a).sum();
        let sigma_t: DVec3 = coefficients.map(Coefficients::sigma_t).sum();
        let help = format!(
            "{BOUND_IT}; or give it some absorption in every channel that it emits or scatters in, or limit \
             `radiative.max_bounces`"
        );
        for (reader, body) in unbounded {
            let dark = body.medium.emission.cmple(DVec3::ZERO) | sigma_t.cmpgt(DVec3::ZERO);
            let is_endless = self.scene.scattering == Scattering::Multiple(None);
            let still = body.sigma_s().cmple(DVec3::ZERO);
            if !dark.all() || is_endless && !(still | sigma_a.cmpgt(DVec3::ZERO)).all() {
                let message = "a medium that fills all space and emits or scatters without absorbing is infinitely bright";
                return Err(reader.mistake_here(message, help));
            }
        }
        if sigma_t == DVec3::ZERO {
            return Ok(());
        }
        let is_far =
            |light: &Light| matches!(light, Light::Directional(it) if it.irradiance != DVec3::ZERO);
        let far = self.lights.iter().find(|(_, light)| is_far(light));
        let far = far.map(|(reader, _)| (*reader, "directional"));
        let sky = (self.reader, "environment");
        let far = far.or((self.scene.environment != DVec3::ZERO).then_some(sky));
        let Some((reader, key)) = far else {
            return Ok(());
        };
        let message = format!(
            "a medium fills all space, and no light arrives from infinitely far away, as of `{key}`"
        );
        let help = format!(
            "{BOUND_IT}; or light the scene from within, by emitting surfaces, points or spots"
        );
        Err(reader.mistake(key, message, help))
    }

    /// Refuses what stands too far away: squares of distances would leave the range of numbers.
    fn check_places(&self) -> SceneResult<()> {
        let farthest = |place: DVec3| place.abs().max_element();
        let camera = &self.scene.camera;
        let height = camera.orthographic_height().unwrap_or(0.0);
        let lights = self.scene.lights.iter().filter_map(Light::position);
        let densities = self.scene.media.iter().filter_map(|it| it.density.as_ref());
        let blobs = densities.map(|density| match density.field() {
            Field::Blob(blob) => farthest(blob.centre).max(blob.width),
            _ => 0.0,
        });
        let farthest = lights.map(farthest).chain(blobs);
        let farthest = farthest.fold(height.max(camera.eye.abs().max_element()), f64::max);
        if farthest <= FARTHEST {
            return Ok(());
        }
        let message = format!(
            "the camera, a light or a Gaussian ball is at coordinates of {farthest:.3e}: light is traced up to {FARTHEST:e}"
        );
        Err(self
            .reader
            .mistake_here(message, "choose another unit of length"))
    }

    /// In a medium that varies, light is tracked by tentative collisions, as dense as the densest channel of all media
    /// there: in the other channels they are null.
    fn check_collisions_without_end(&self) -> SceneResult<()> {
        let across = |body: &Body| {
            let boundary = body.boundary.as_ref();
            boundary.map_or(f64::INFINITY, |it| length_of(it.bounds().size()))
        };
        let varies = |body: &Body| body.homogeneous().is_none();
        let varying = self.scene.media.iter().filter(|body| varies(body));
        let widest = varying.map(across).fold(0.0, f64::max);
        for (reader, body) in self.media.iter().filter(|(_, body)| !varies(body)) {
            let sigma_t = body.medium.coefficients.sigma_t();
            let spread = sigma_t.max_element() - sigma_t.min_element();
            let depth = spread * across(body).min(widest);
            if depth > DEEPEST_TRACKED {
                let message = format!(
                    "channels of this medium differ by up to {depth:.4e} optical depths, beside another whose density \
                     varies: light is traced through at most {DEEPEST_TRACKED:.4e}"
                );
                let help = "give coefficients that differ less between the channels";
                return Err(reader.mistake_here(message, help));
            }
        }
        Ok(())
    }

    /// A light exactly in a flat surface lies on neither side of it: roundings would decide.
    fn check_lights_in_surfaces(&self) -> SceneResult<()> {
        let help = "move the light a little off the surface, to the side that it shines on";
        let rectangles = || {
            let objects = self.scene.objects.iter();
            objects.filter_map(|object| match &object.shape {
                Shape::Rectangle(rectangle) => Some(rectangle),
                _ => None,
            })
        };
        for (reader, light) in &self.lights {
            let inside = |position| rectangles().any(|rectangle| rectangle.holds(position));
            if light.position().is_some_and(inside) {
                let message = "the light stands exactly in a rectangle, on neither side of it";
                return Err(reader.mistake_here(message, help));
            }
        }
        // Nine places tell whether two rectangles in a plane overlap, but for slivers.
        let grid = [0.0, 0.5, 1.0];
        for light in &self.scene.area_lights {
            let Luminous::Rectangle(lamp) = &light.shape else {
                continue;
            };
            let positions = || grid.into_iter().flat_map(|u| grid.map(|v| [u, v]));
            let flush = rectangles().any(|wall| {
                let within = positions().any(|uv| wall.holds(lamp.sample(uv).position));
                within && lamp.normal().cosine_to(wall.normal()).abs() == 1.0
            });
            if flush {
                let message =
                    "an emitting rectangle lies exactly in another surface: either hides the other";
                return Err(self.reader.mistake("surface", message, help));
            }
        }
        Ok(())
    }

    fn check_light_that_no_path_meets(&self) -> SceneResult<()> {
        if !matches!(self.scene.scattering, Scattering::Multiple(_)) {
            return Ok(());
        }
        let mirrors = |object: &Object| !matches!(object.material, Material::Diffuse(_));
        let first = self.lights.first();
        let Some((reader, _)) = first.filter(|_| self.scene.objects.iter().any(mirrors)) else {
            return Ok(());
        };
        let message = "camera paths cannot sample light from a point, spot or directional light that arrives by way of a \
                       mirror or glass";
        let help = "use a small or far emitting surface, or the environment, in place of the light; or a diffuse surface";
        Err(reader.mistake_here(message, help))
    }
}
