//! Reflection and refraction at a jump of the refractive index.

use crate::math::Direction;

/// Light at the smooth boundary between two clear media, split into its reflected and refracted
/// parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// The reflected fraction, in [0, 1]; the rest is refracted.
    pub reflectance: f64,
    /// Direction of the refracted light; `None` for total reflection.
    pub refracted: Option<Direction>,
}

/// Splits unpolarised light that travels along `direction` at a boundary whose `normal` points to
/// the side of the incoming light. `ratio` is the refractive index on that side over the one on the
/// other side; positive.
///
/// Fresnel's equations and Snell's law, for real indices. At `ratio` 1 there is exactly no
/// reflection and no change of direction.
///
/// Source: Born & Wolf 1999, *Principles of Optics*, 7th ed., §1.5.
pub fn split(direction: Direction, normal: Direction, ratio: f64) -> Split {
    if ratio == 1.0 {
        return Split {
            reflectance: 0.0,
            refracted: Some(direction),
        };
    }
    let cos_in = (-direction.cosine_to(normal)).clamp(0.0, 1.0);
    // sin² = (1 − cos)(1 + cos): no cancellation at grazing or at normal incidence.
    let sin2_out = ratio * ratio * ((1.0 - cos_in) * (1.0 + cos_in));
    if sin2_out >= 1.0 {
        return Split {
            reflectance: 1.0,
            refracted: None,
        };
    }
    let cos_out = (1.0 - sin2_out).sqrt();
    let reflected_share = |a: f64, b: f64| {
        let quotient = (a - b) / (a + b);
        quotient * quotient
    };
    let reflectance =
        0.5 * (reflected_share(ratio * cos_in, cos_out) + reflected_share(cos_in, ratio * cos_out));
    let refracted = direction * ratio + normal * (ratio * cos_in - cos_out);
    Split {
        reflectance,
        refracted: Some(Direction::unit(refracted)),
    }
}

/// The direction of light that travelled along `direction` after reflection by a mirror with the
/// normal `normal`.
pub fn reflected(direction: Direction, normal: Direction) -> Direction {
    Direction::unit(*direction - normal * (2.0 * direction.cosine_to(normal)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{cos, sin};
    use glam::DVec3;

    fn slanted(degrees: f64) -> Direction {
        let angle = degrees.to_radians();
        Direction::unit(DVec3::new(sin(angle), -cos(angle), 0.0))
    }

    #[test]
    fn normal_incidence_on_glass_reflects_four_percent() {
        let split = split(Direction::NEG_Y, Direction::Y, 1.0 / 1.5);
        // ((1.5 − 1)/(1.5 + 1))², a few roundings.
        assert!((split.reflectance - 0.04).abs() < 1e-16);
        assert_eq!(split.refracted, Some(Direction::NEG_Y));
    }

    #[test]
    fn snell_and_lengths() {
        for degrees in [0.0, 10.0, 45.0, 80.0, 89.9] {
            let direction = slanted(degrees);
            let out = split(direction, Direction::Y, 1.0 / 1.5).refracted.unwrap();
            assert!((out.length() - 1.0).abs() < 1e-15);
            assert!((out.x * 1.5 - direction.x).abs() < 1e-15);
        }
    }

    /// At Brewster's angle, tan θ = n, only one polarisation is reflected.
    #[test]
    fn brewster() {
        let angle = crate::math::atan2(1.5, 1.0).to_degrees();
        let reflectance = split(slanted(angle), Direction::Y, 1.0 / 1.5).reflectance;
        let s = (1.0 - 2.25_f64) / (1.0 + 2.25);
        assert!((reflectance - 0.5 * s * s).abs() < 1e-15);
    }

    /// The same share is reflected on the way back.
    #[test]
    fn both_ways_reflect_alike_and_beyond_the_critical_angle_all() {
        let inwards = split(slanted(50.0), Direction::Y, 1.0 / 1.5);
        let back = -inwards.refracted.unwrap();
        let outwards = split(back, Direction::NEG_Y, 1.5);
        assert!((inwards.reflectance - outwards.reflectance).abs() < 1e-15);
        assert!((*outwards.refracted.unwrap() + *slanted(50.0)).length() < 1e-15);
        let total = split(slanted(45.0), Direction::Y, 1.5);
        assert_eq!((total.reflectance, total.refracted), (1.0, None));
    }

    #[test]
    fn equal_indices_are_no_boundary_and_mirrors_mirror() {
        let through = split(slanted(89.0), Direction::Y, 1.0);
        assert_eq!(
            (through.reflectance, through.refracted),
            (0.0, Some(slanted(89.0)))
        );
        assert_eq!(
            reflected(Direction::unit(DVec3::new(0.6, -0.8, 0.0)), Direction::Y),
            Direction::unit(DVec3::new(0.6, 0.8, 0.0))
        );
    }
}
