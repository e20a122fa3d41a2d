//! Phong's model for a sample of a volume.

use crate::geometry::Direction;
use crate::math::powu;
use crate::optics::Phong;
use crate::scene::{Conventions, LightColour};
use glam::DVec3;

/// A sample, with the directions to the light and to the eye.
pub struct ShadedSample {
    /// Colour of the material.
    pub colour: DVec3,
    /// Gradient of the field, in any unit.
    pub gradient: DVec3,
    /// Direction to the light; `None` at the light itself.
    pub to_light: Option<Direction>,
    /// Direction to the eye.
    pub to_eye: Direction,
}

/// Light that a sample sends to the eye.
pub struct Shaded {
    /// Ambient and diffuse part.
    pub base: DVec3,
    /// The ambient part of it.
    pub ambient: DVec3,
    /// Highlight.
    pub highlight: DVec3,
}

impl ShadedSample {
    /// The sample lit by one white light. Its normal points against the gradient.
    pub fn lit_by(&self, phong: &Phong, conventions: &Conventions) -> Shaded {
        let ambient = self.tint(conventions.ambient_colour) * phong.ambient;
        let ambient_alone = Shaded {
            base: ambient,
            ambient,
            highlight: DVec3::ZERO,
        };
        let Some(mut normal) = Direction::of(-self.gradient) else {
            if conventions.flat_samples_ambient {
                return ambient_alone;
            }
            return Shaded {
                base: self.colour,
                ambient: DVec3::ZERO,
                highlight: DVec3::ZERO,
            };
        };
        let Some(to_light) = self.to_light else {
            return ambient_alone;
        };
        if conventions.normals_to_eye && normal.cosine_to(self.to_eye) < 0.0 {
            normal = -normal;
        }
        if conventions.two_sided && normal.cosine_to(to_light) < 0.0 {
            normal = -normal;
        }
        let cosine = normal.cosine_to(to_light);
        if cosine <= 0.0 {
            return ambient_alone;
        }
        let base = match conventions.ambient_colour {
            LightColour::Material => self.colour * (phong.ambient + phong.diffuse * cosine),
            _ => ambient + self.colour * (phong.diffuse * cosine),
        };
        let highlight_cosine = if conventions.half_vector {
            let half = Direction::of(*to_light + *self.to_eye);
            half.map_or(0.0, |half| normal.cosine_to(half))
        } else {
            let reflected = normal * (2.0 * cosine) - *to_light;
            reflected.dot(*self.to_eye)
        };
        let highlight = phong.specular * powu(highlight_cosine.max(0.0), phong.shininess);
        Shaded {
            base,
            ambient,
            highlight: self.tint(conventions.highlight_colour) * highlight,
        }
    }

    fn tint(&self, colour: LightColour) -> DVec3 {
        match colour {
            LightColour::Material => self.colour,
            LightColour::White => DVec3::ONE,
            LightColour::Black => DVec3::ZERO,
        }
    }
}
