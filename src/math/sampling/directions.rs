//! Directions, around +z where one is distinguished. Lengths are 1 to 8 roundings.

use crate::math::{Direction, cos, sin};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A direction from anywhere. `1 − z` and `1 + z` are uniform, and their product is `sin²`.
pub fn sphere([u, v]: [f64; 2]) -> Direction {
    from_cosine(1.0 - 2.0 * u, 2.0 * (u * (1.0 - u)).sqrt(), v)
}

/// Density of [`sphere`], per steradian, everywhere.
pub fn sphere_pdf() -> f64 {
    1.0 / (4.0 * PI)
}

/// A direction with `z > 0`, with a density in proportion to its cosine `z`.
///
/// The smallest cosine is `√(1 − u)`, 1e-8 at the end of the random range: never 0, so that the
/// density is positive at every direction there is.
pub fn cosine_hemisphere([u, v]: [f64; 2]) -> Direction {
    from_cosine((1.0 - u).sqrt(), u.sqrt(), v)
}

/// Density of [`cosine_hemisphere`], per steradian, at a direction with cosine `cos` to +z;
/// 0 below the plane.
pub fn cosine_hemisphere_pdf(cos: f64) -> f64 {
    cos.max(0.0) / PI
}

/// The directions within a half-angle about +z: the light of a spotlight, or of a distant sphere.
///
/// Held as `1 − cos` of the half-angle, in which a cone of any width keeps its digits:
/// `sin²(θ/2)` times 2. The cosine alone takes every cone below 1e-8 rad for none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    one_minus_cos: f64,
}

impl Cone {
    /// The cone of half-angle θ, radians, in (0, π]; `None` outside.
    pub fn of_half_angle(angle: f64) -> Option<Cone> {
        let half_sine = sin(angle / 2.0);
        (angle > 0.0 && angle <= PI).then_some(Cone {
            one_minus_cos: 2.0 * half_sine * half_sine,
        })
    }

    /// Cosine of the half-angle. A direction belongs to the cone if its cosine is larger:
    /// the edge itself lies outside.
    pub fn cos(&self) -> f64 {
        1.0 - self.one_minus_cos
    }

    /// A direction inside, all equally likely.
    pub fn direction(&self, [u, v]: [f64; 2]) -> Direction {
        let one_minus_cos = u * self.one_minus_cos;
        let sine_squared = one_minus_cos * (2.0 - one_minus_cos);
        from_cosine(1.0 - one_minus_cos, sine_squared.sqrt(), v)
    }

    /// Density of [`Cone::direction`], per steradian, inside: one over the solid angle.
    pub fn pdf(&self) -> f64 {
        1.0 / (TAU * self.one_minus_cos)
    }
}

/// The direction of the given cosine and sine to +z, at the share `v` of a turn about it.
#[inline]
pub fn from_cosine(cosine: f64, sine: f64, v: f64) -> Direction {
    let azimuth = TAU * v;
    Direction::unit(DVec3::new(sine * cos(azimuth), sine * sin(azimuth), cosine))
}
