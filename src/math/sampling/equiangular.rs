//! Distances along a ray past a point light.

use crate::math::{atan2, cos, sin};
use thiserror::Error;

/// Places on a stretch of a ray, chosen so that equal angles seen from a point light are equally
/// likely. Their density is in proportion to one over the squared distance to the light: what is
/// left of the integrand is smooth, and constant in a thin isotropic medium.
///
/// `t` is measured along the ray from the foot of the perpendicular from the light.
///
/// Source: Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in
/// participating media", Computer Graphics Forum 31, 1519–1528.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equiangular {
    distance: f64,
    near: f64,
    far: f64,
    angle: f64,
}

/// The light lies on the ray: the integral of one over the squared distance diverges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the light lies on the ray, where its single scattering is infinite")]
pub struct LightOnRay;

impl Equiangular {
    /// For a light at `distance ≥ 0` from the ray and the stretch from `near`, finite, to
    /// `far > near`, which may be infinite; in world units.
    ///
    /// # Errors
    ///
    /// [`LightOnRay`] at distance 0. No distance is too small otherwise.
    pub fn new(distance: f64, near: f64, far: f64) -> Result<Equiangular, LightOnRay> {
        if distance == 0.0 {
            return Err(LightOnRay);
        }
        // The angle between the directions (near, D) and (far, D), from cross and dot product.
        // The difference of two arc tangents would cancel where both ends lie on one side.
        let angle = if far.is_infinite() {
            atan2(distance, near)
        } else {
            atan2(distance * (far - near), distance * distance + near * far)
        };
        Ok(Equiangular {
            distance,
            near,
            far,
            angle,
        })
    }

    /// The place that a share `u` of the angle lies before, in [near, far].
    pub fn place(&self, u: f64) -> f64 {
        let place = if self.far.is_infinite() {
            // Turned back from the far end, where the angle to the ray is the small one.
            let to_far = (1.0 - u) * self.angle;
            self.distance * cos(to_far) / sin(to_far)
        } else {
            // (near, D) turned by the angle; the first coordinate where it meets the ray again.
            let (sine, cosine) = (sin(u * self.angle), cos(u * self.angle));
            let slope = self.near / self.distance;
            (self.near * cosine + self.distance * sine) / (cosine - slope * sine)
        };
        place.clamp(self.near, self.far)
    }

    /// Density of [`Equiangular::place`] at `t` in [near, far], per length:
    /// `D / (θ (D² + t²))`, with θ the angle of the whole stretch.
    pub fn pdf(&self, t: f64) -> f64 {
        self.distance / (self.angle * (self.distance * self.distance + t * t))
    }

    /// The angle under which the light sees the stretch, radians, in (0, π].
    pub fn angle(&self) -> f64 {
        self.angle
    }
}
