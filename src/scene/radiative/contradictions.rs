//! Checks across keys: valid parts that cannot be rendered together.

use super::media::DEEPEST_TRACKED;
use super::{Body, Object, Radiative, Scattering};
use crate::geometry::{Aabb, Emitter, Luminous, Shape, Surface, length_of};
use crate::optics::{Light, Material};
use crate::scene::SceneResult;
use crate::scene::reader::Reader;
use glam::DVec3;

/// A scene with the tables that it was read from.
pub(super) struct Contradictions<'r, 'd, 's> {
    pub scene: &'r Radiative,
    /// `[radiative]`.
    pub reader: &'r Reader<'d, 's>,
    pub media: &'r [Reader<'d, 's>],
    pub lights: &'r [Reader<'d, 's>],
}

const BOUND_IT: &str = "give the medium a boundary: a `sphere`, `box` or closed `mesh`";

impl<'d, 's> Contradictions<'_, 'd, 's> {
    /// Refuses scenes whose light is infinite, never arrives, or cannot be found.
    pub(super) fn check(&self) -> SceneResult<()> {
        self.check_light_that_diverges()?;
        self.check_light_that_never_arrives()?;
        self.check_collisions_without_end()?;
        self.check_lights_in_surfaces()?;
        self.check_light_that_no_path_meets()
    }

    fn media(&self) -> impl Iterator<Item = (&Reader<'d, 's>, &Body)> {
        self.media.iter().zip(&self.scene.media)
    }

    fn lights(&self) -> impl Iterator<Item = (&Reader<'d, 's>, &Light)> {
        self.lights.iter().zip(&self.scene.lights)
    }

    /// Media without boundary, where they are all that there is far away: they add up.
    fn unbounded(&self) -> impl Iterator<Item = (&Reader<'d, 's>, &Body)> {
        self.media().filter(|(_, body)| body.boundary.is_none())
    }

    fn far_away(&self, quantity: impl Fn(&Body) -> DVec3) -> DVec3 {
        self.unbounded().map(|(_, body)| quantity(body)).sum()
    }

    fn check_light_that_diverges(&self) -> SceneResult<()> {
        let sigma_a = self.far_away(|body| body.medium.coefficients.sigma_a());
        let sigma_t = self.far_away(|body| body.medium.coefficients.sigma_t());
        for (reader, body) in self.unbounded() {
            let emits = body.medium.emission.cmpgt(DVec3::ZERO);
            if (emits & sigma_t.cmpeq(DVec3::ZERO)).any() {
                return Err(reader.mistake(
                    "emission",
                    "a medium that fills all space and emits without absorbing is infinitely bright",
                    format!("{BOUND_IT}; or give it absorption in every channel that it emits in"),
                ));
            }
            let scatters = body.medium.coefficients.sigma_s().cmpgt(DVec3::ZERO);
            let for_ever = (scatters & sigma_a.cmpeq(DVec3::ZERO)).any();
            if for_ever && self.scene.scattering == Scattering::Multiple(None) {
                return Err(reader.mistake(
                    reader.first_of(&["albedo"]).unwrap_or("sigma_s"),
                    "a medium that fills all space and scatters without absorbing scatters \
                     light for ever",
                    format!(
                        "{BOUND_IT}; or give it some absorption in every channel that it \
                         scatters in; or limit `radiative.max_bounces`"
                    ),
                ));
            }
        }
        Ok(())
    }

    fn check_light_that_never_arrives(&self) -> SceneResult<()> {
        let sigma_t = self.far_away(|body| body.medium.coefficients.sigma_t());
        if sigma_t == DVec3::ZERO {
            return Ok(());
        }
        let help = format!(
            "{BOUND_IT}; or light the scene from within, by emitting surfaces, points or spots"
        );
        if self.scene.environment != DVec3::ZERO {
            let message = "`environment` is infinitely far away, and a medium fills all space: \
            none of its light arrives";
            return Err(self.reader.mistake("environment", message, help));
        }
        for (reader, light) in self.lights() {
            if matches!(light, Light::Directional(light) if light.irradiance != DVec3::ZERO) {
                let message = "a directional light is infinitely far away, and a medium fills all \
                space: none of its light arrives";
                return Err(reader.mistake("directional", message, help));
            }
        }
        Ok(())
    }

    /// In a heterogeneous medium light is tracked from one tentative collision to the next, of the
    /// density of the densest channel of all media that overlap there. Collisions in a homogeneous medium are never
    /// null in a channel as dense as that; in its other channels they are.
    fn check_collisions_without_end(&self) -> SceneResult<()> {
        let bounds = |body: &Body| body.boundary.as_ref().map(Surface::bounds);
        let varying = self
            .scene
            .media
            .iter()
            .filter(|it| it.homogeneous().is_none());
        for space in varying.filter_map(bounds) {
            for (reader, other) in self.media() {
                let Some(medium) = other.homogeneous() else {
                    continue;
                };
                let shared = bounds(other).map_or(space, |bounds| Aabb {
                    min: space.min.max(bounds.min),
                    max: space.max.min(bounds.max),
                });
                if shared.min.cmpgt(shared.max).any() {
                    continue;
                }
                let sigma_t = medium.coefficients.sigma_t();
                let spread = sigma_t.max_element() - sigma_t.min_element();
                let depth = spread * length_of(shared.size());
                if depth > DEEPEST_TRACKED {
                    let keys = ["sigma_t", "sigma_a", "sigma_s"];
                    let key = reader.first_of(&keys);
                    let message = format!(
                        "channels of this medium differ by up to {depth:.4e} optical depths \
                         within another whose density varies: light is traced through at most \
                         {DEEPEST_TRACKED:.4e}"
                    );
                    let help = "give coefficients that differ less between the channels, or \
                                move the media apart";
                    return Err(reader.mistake(key.unwrap_or("sigma_a"), message, help));
                }
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
        for (reader, light) in self.lights() {
            let inside = |position| rectangles().any(|rectangle| rectangle.holds(position));
            if light.position().is_some_and(inside) {
                let key = match light {
                    Light::Spot(_) => "spot",
                    _ => "point",
                };
                let message = "the light stands exactly in a rectangle, on neither side of it";
                return Err(reader.mistake(key, message, help.to_owned()));
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
                let message = "an emitting rectangle lies exactly in another surface: either hides \
                               the other";
                return Err(self.reader.mistake("surface", message, help.to_owned()));
            }
        }
        Ok(())
    }

    fn check_light_that_no_path_meets(&self) -> SceneResult<()> {
        if !matches!(self.scene.scattering, Scattering::Multiple(_)) {
            return Ok(());
        }
        let named = |object: &Object| match object.material {
            Material::Diffuse(_) => None,
            Material::Mirror(_) => Some("mirror"),
            Material::Glass(_) => Some("glass"),
        };
        let (Some((reader, light)), Some(material)) = (
            self.lights().next(),
            self.scene.objects.iter().find_map(named),
        ) else {
            return Ok(());
        };
        let (key, instead) = match light {
            Light::Point(_) => ("point", "a small emitting sphere"),
            Light::Spot(_) => ("spot", "a small emitting sphere or rectangle"),
            Light::Directional(_) => ("directional", "a far emitting sphere or the environment"),
        };
        let message = format!(
            "camera paths cannot sample light from a {key} light that arrives by way of a \
             {material} surface"
        );
        let help = format!(
            "use {instead} in place of the light, or a diffuse surface in place of the {material}"
        );
        Err(reader.mistake(key, message, help))
    }
}
