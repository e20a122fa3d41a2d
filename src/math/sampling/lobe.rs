//! Directions towards a light.

use super::{from_cosine, sphere};
use crate::math::{Direction, Frame};
use glam::DVec3;
use std::f64::consts::PI;

/// Directions out of a point, denser towards a light at the distance `r`: the density falls as one
/// over `√(c² + s²)`, where `c` is the distance from the light to the point of the ray at that same
/// distance `r`, `c = 2r sin(θ/2)`, and `s` the size of the light.
///
/// For a small light this is close to what a thin endless medium scatters once into the ray, which at
/// the angle θ to the light is proportional to `(π − θ)/sin θ`: normalised, their quotient
/// `4(π − θ)/(π² cos(θ/2))` lies between 8/π² and 4/π. From within a large light all directions are
/// alike.
///
/// Source: Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in participating
/// media", Computer Graphics Forum 31, 1519–1528, for the scattered light: its integral along the
/// ray is the angle that the ray subtends at the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lobe {
    /// From the point to the light.
    towards: DVec3,
    distance: f64,
    size: f64,
    /// `√(4r² + s²) + s`.
    sum: f64,
}

impl Lobe {
    /// The lobe towards the end of `towards`, for a light of the size `size > 0`; both in world units.
    /// `None` where a square is out of range.
    pub fn new(towards: DVec3, size: f64) -> Option<Lobe> {
        let squared = towards.length_squared();
        let sum = (4.0 * squared + size * size).sqrt() + size;
        sum.is_finite().then(|| Lobe {
            towards,
            distance: squared.sqrt(),
            size,
            sum,
        })
    }

    /// The direction for two numbers in [0, 1).
    pub fn sample(&self, [u, v]: [f64; 2]) -> Direction {
        let Some(axis) = Direction::of(self.towards) else {
            return sphere([u, v]);
        };
        // √(c² + s²) is uniform between s and √(4r² + s²), whose difference is 4r² over their sum.
        // Lengths are over r from here on.
        let (size, range) = (self.size / self.distance, 4.0 * self.distance / self.sum);
        let more = u * range;
        let one_minus_cos = (0.5 * more * (more + 2.0 * size)).min(2.0);
        let sine = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
        Frame::around(axis).to_world(from_cosine(1.0 - one_minus_cos, sine, v))
    }

    /// Density of [`Lobe::sample`] at `direction`, per steradian:
    /// `(√(4r² + s²) + s) / (8π √(c² + s²))`.
    pub fn pdf(&self, direction: Direction) -> f64 {
        let across = (self.towards - direction * self.distance).length_squared();
        self.sum / (8.0 * PI * (across + self.size * self.size).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sin;
    use std::f64::consts::TAU;

    const AXIS: DVec3 = DVec3::new(0.6, 0.0, 0.8);

    /// The part of the directions within the angle for `u` is `u`: by Simpson's rule over the height of
    /// a sphere, in which areas are uniform, on a scale of its root, in which the density is smooth.
    #[test]
    fn the_density_is_that_of_the_directions() {
        for size in [0.1, 2.0, 60.0] {
            let lobe = Lobe::new(2.0 * AXIS, size).unwrap();
            for u in [0.1, 0.5, 0.9] {
                let height = 1.0 - lobe.sample([u, 0.3]).dot(AXIS);
                let integrand = |root: f64| {
                    let cosine = 1.0 - root * root;
                    let across = DVec3::Y * (1.0 - cosine * cosine).max(0.0).sqrt();
                    let direction = Direction::unit(AXIS * cosine + across);
                    TAU * lobe.pdf(direction) * 2.0 * root
                };
                let (n, end) = (2000, height.sqrt());
                let weighted = (0..=n).map(|i| {
                    let ends = i == 0 || i == n;
                    let weight = if ends {
                        1.0
                    } else {
                        f64::from(2 + 2 * (i % 2))
                    };
                    weight * integrand(end * f64::from(i) / f64::from(n))
                });
                let part = weighted.sum::<f64>() * end / f64::from(n) / 3.0;
                assert!((part - u).abs() < 1e-6, "{size} {u}: {part}");
            }
        }
    }

    /// From the centre of a light all directions are alike; beside the light that a small one leaves
    /// in a thin medium, the density stays within its bounds.
    #[test]
    fn the_ends_of_the_sizes() {
        let within = Lobe::new(DVec3::ZERO, 0.7).unwrap();
        assert_eq!(within.sample([0.2, 0.4]), sphere([0.2, 0.4]));
        assert!((within.pdf(Direction::X) * 4.0 * PI - 1.0).abs() < 1e-15);
        let small = Lobe::new(DVec3::Z, 1e-9).unwrap();
        for angle in [0.01, 1.0, 2.0, 3.1] {
            let scattered = (PI - angle) / sin(angle) / (PI * PI * PI);
            let direction = from_cosine(crate::math::cos(angle), sin(angle), 0.1);
            let quotient = scattered / small.pdf(direction);
            assert!((8.0 / (PI * PI)..=4.0 / PI).contains(&quotient), "{angle}");
        }
        assert_eq!(Lobe::new(DVec3::X * 1e200, 1.0), None);
    }
}
