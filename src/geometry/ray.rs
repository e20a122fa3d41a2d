//! Rays and spans of rays.

use super::Direction;
use glam::DVec3;

/// A half-line `origin + t·direction`, `t ≥ 0`; `t` is a distance in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// World position at `t = 0`.
    pub origin: DVec3,
    /// Direction of travel.
    pub direction: Direction,
}

impl Ray {
    /// The ray from `origin` towards `towards` (any length but 0; `None` for the zero vector).
    pub fn new(origin: DVec3, towards: DVec3) -> Option<Ray> {
        Direction::of(towards).map(|direction| Ray { origin, direction })
    }

    /// World position at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A straight line `origin + t·direction`, the direction of any length: a ray in the coordinates of an
/// object, with `t` still a distance in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Position at `t = 0`.
    pub origin: DVec3,
    /// Change of the position by `t`.
    pub direction: DVec3,
}

impl Line {
    /// Position at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// The same line, with its origin at `t`.
    pub(crate) fn starting_at(&self, t: f64) -> Line {
        Line {
            origin: self.at(t),
            direction: self.direction,
        }
    }
}

impl From<&Ray> for Line {
    #[inline]
    fn from(ray: &Ray) -> Line {
        Line {
            origin: ray.origin,
            direction: *ray.direction,
        }
    }
}

/// A segment of a ray, from `near` to `far ≥ near`, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Distance at which the segment begins.
    pub near: f64,
    /// Distance at which it ends.
    pub far: f64,
}

impl Span {
    /// From `near` to `far ≥ near`.
    pub const fn new(near: f64, far: f64) -> Span {
        Span { near, far }
    }

    /// `far − near`, in world units.
    pub fn length(&self) -> f64 {
        self.far - self.near
    }

    /// The part of it in `other`; where they have none in common, it ends before it begins.
    pub fn within(self, other: Span) -> Span {
        Span {
            near: self.near.max(other.near),
            far: self.far.min(other.far),
        }
    }
}

/// `|v|` of a finite vector, over the whole range: where `|v|²` would leave the range of normal
/// numbers, `v` is scaled to near 1 by a power of two.
pub fn length_of(v: DVec3) -> f64 {
    let length_squared = v.length_squared();
    if (1e-290..1e290).contains(&length_squared) {
        return length_squared.sqrt();
    }
    // 2^±600 brings the squares of the smallest and of the largest numbers into range.
    let exponent = if v.abs().max_element() < 1.0 {
        1023 + 600
    } else {
        1023 - 600
    };
    let factor = f64::from_bits(exponent << 52);
    (v * factor).length() / factor
}

/// The part with `t ≥ 0` of the line segment from `near` to `far`, if any.
pub(super) fn ahead(near: f64, far: f64) -> Option<Span> {
    // Not `max`, which may return a zero of either sign where both are zeros.
    let near = if near > 0.0 { near } else { 0.0 };
    (near <= far).then_some(Span { near, far })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_over_the_whole_range() {
        for exponent in [-1074, -1060, -600, -300, -1, 0, 1, 300, 600, 1020] {
            let size = libm::exp2(f64::from(exponent));
            assert_eq!(length_of(DVec3::new(0.0, -size, 0.0)), size, "2^{exponent}");
            if exponent > -1070 {
                assert_eq!(
                    length_of(DVec3::new(3.0, 0.0, 4.0) * size),
                    5.0 * size,
                    "2^{exponent}"
                );
            }
        }
        assert_eq!(length_of(DVec3::ZERO), 0.0);
    }
}
