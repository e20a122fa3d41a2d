//! Local shading of a sample by its gradient.

use crate::geometry::Direction;
use crate::math;
use glam::DVec3;

/// Phong's reflection model with one white light: the colour of the material times
/// `ambient + diffuse·max(n·l, 0)`, plus a white highlight
/// `specular·max(r·v, 0)^shininess`, where `r` is the direction to the light mirrored at the
/// normal. The side facing away from the light has no highlight.
///
/// Source: Phong 1975, Communications of the ACM 18, 311–317.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phong {
    /// Share of the light that reaches every side, `≥ 0`.
    pub ambient: f64,
    /// Weight of the cosine between normal and light, `≥ 0`.
    pub diffuse: f64,
    /// Weight of the white highlight, `≥ 0`.
    pub specular: f64,
    /// Exponent of the highlight.
    pub shininess: u32,
}

impl Phong {
    /// The shaded `colour` of a sample with the given density gradient (any unit). Both directions
    /// point away from the sample; without one to the light, at the sample itself, only ambient
    /// light is left.
    ///
    /// The normal is `−∇d/|∇d|`, out of the dense part. A zero gradient has no normal: such a
    /// sample keeps its unshaded colour.
    // Always: a call would hand all of it over in memory.
    #[inline(always)]
    pub fn shade(
        &self,
        colour: DVec3,
        gradient: DVec3,
        to_light: Option<Direction>,
        to_eye: Direction,
    ) -> DVec3 {
        let Some(normal) = Direction::of(-gradient) else {
            return colour;
        };
        let ambient = colour * self.ambient;
        let Some(to_light) = to_light else {
            return ambient;
        };
        let cosine = normal.cosine_to(to_light);
        if cosine <= 0.0 {
            return ambient;
        }
        let mirrored = normal * (2.0 * cosine) - *to_light;
        let highlight = math::powu(mirrored.dot(*to_eye).max(0.0), self.shininess);
        colour * (self.ambient + self.diffuse * cosine) + DVec3::splat(self.specular * highlight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PHONG: Phong = Phong {
        ambient: 0.1,
        diffuse: 1.0,
        specular: 0.5,
        shininess: 32,
    };
    const RED: DVec3 = DVec3::new(1.0, 0.0, 0.0);

    #[test]
    fn lit_head_on_the_three_terms_add_up() {
        // Density falls towards the viewer: its gradient points away from them.
        let shaded = PHONG.shade(RED, DVec3::NEG_Z, Some(Direction::Z), Direction::Z);
        assert_eq!(shaded, DVec3::new(1.6, 0.5, 0.5));
    }

    #[test]
    fn lit_from_the_side_the_highlight_falls_by_its_exponent() {
        // n = v = z, l at the angle of the triangle 3, 4, 5: n·l = r·v = 0.8.
        let to_light = Direction::unit(DVec3::new(0.6, 0.0, 0.8));
        let shaded = PHONG.shade(RED, DVec3::NEG_Z, Some(to_light), Direction::Z);
        // 0.8^32, half of it for the weight; Blinn's half vector would give 0.90^32 = 0.034.
        let highlight = 0.5 * 7.922_816_251_426_434e-4;
        let expected = DVec3::new(0.1 + 0.8 + highlight, highlight, highlight);
        // 32 roundings of the power and a few of sums of size 1.
        assert!((shaded - expected).abs().max_element() <= 4.0 * f64::EPSILON);
    }

    #[test]
    fn the_far_side_gets_ambient_light_only() {
        assert_eq!(
            PHONG.shade(RED, DVec3::Z, Some(Direction::Z), Direction::Z),
            RED * 0.1
        );
    }

    #[test]
    fn without_a_direction_to_the_light_there_is_ambient_light_only() {
        let shaded = PHONG.shade(RED, DVec3::NEG_Z, None, Direction::Z);
        assert_eq!(shaded, RED * 0.1);
    }

    #[test]
    fn without_a_gradient_there_is_no_normal_and_the_colour_stays() {
        assert_eq!(
            PHONG.shade(RED, DVec3::ZERO, Some(Direction::Z), Direction::Z),
            RED
        );
        assert_eq!(
            PHONG.shade(RED, DVec3::splat(-0.0), Some(Direction::Z), Direction::Z),
            RED
        );
    }

    #[test]
    fn the_length_of_the_gradient_does_not_matter() {
        let steep = DVec3::new(-3.0, 1.0, -2.0);
        let to_light = Direction::unit(DVec3::new(0.6, 0.0, 0.8));
        // A power of two changes no digit of the normal, however small or large.
        for exponent in [-500, -40, 40, 500] {
            let scaled = steep * libm::exp2(f64::from(exponent));
            let (a, b) = (
                PHONG.shade(RED, steep, Some(to_light), Direction::Z),
                PHONG.shade(RED, scaled, Some(to_light), Direction::Z),
            );
            assert_eq!(a, b, "2^{exponent}");
        }
    }
}
