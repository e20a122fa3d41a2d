//! Directions, relative to +z. Lengths are 1 to within 8 roundings.

use crate::math::{Direction, cos, sin};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A uniform direction. `1 − z` and `1 + z` are uniform, and their product is `sin²`.
pub fn sphere([u, v]: [f64; 2]) -> Direction {
    from_cosine(1.0 - 2.0 * u, 2.0 * (u * (1.0 - u)).sqrt(), v)
}

/// Density of [`sphere`], per steradian, everywhere.
pub fn sphere_pdf() -> f64 {
    1.0 / (4.0 * PI)
}

/// A direction with `z > 0` and a density proportional to its cosine `z`.
///
/// The smallest cosine is `√(1 − u)`, 1e-8 at the end of the random range: never 0, so that the
/// density of every sampled direction is positive.
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
/// Stored as `1 − cos` of the half-angle, which keeps its digits for a cone of any width:
/// `sin²(θ/2)` times 2. The cosine alone would be 1 for every cone below 1e-8 rad.
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

    /// The cone of all lines from a point to a sphere of `radius`, whose centre is at a `distance` that
    /// is larger; both in the same unit. `None` from inside, and where the cone has no width.
    pub(crate) fn around_sphere(radius: f64, distance: f64) -> Option<Cone> {
        let sine = radius / distance;
        let one_minus_cos = sine * sine / (1.0 + ((1.0 - sine) * (1.0 + sine)).sqrt());
        (sine < 1.0 && one_minus_cos > 0.0).then_some(Cone { one_minus_cos })
    }

    /// Cosine of the half-angle. A direction belongs to the cone if its cosine is larger:
    /// the edge itself lies outside.
    pub fn cos(&self) -> f64 {
        1.0 - self.one_minus_cos
    }

    /// A uniform direction inside the cone.
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

/// The direction with the given cosine and sine to +z, at the fraction `v` of a turn around it.
#[inline]
pub(crate) fn from_cosine(cosine: f64, sine: f64, v: f64) -> Direction {
    let azimuth = TAU * v;
    Direction::unit(DVec3::new(sine * cos(azimuth), sine * sin(azimuth), cosine))
}
