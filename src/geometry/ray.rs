//! Rays and the spans of them that matter.

use glam::DVec3;

/// A half-line `origin + t·direction`, `t ≥ 0`, with a direction of length 1, so that `t` is a
/// distance in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// World point at `t = 0`.
    pub origin: DVec3,
    /// Direction of travel, length 1.
    pub direction: DVec3,
}

impl Ray {
    /// The ray from `origin` towards `towards` (any length but 0; `None` for the zero vector).
    pub fn new(origin: DVec3, towards: DVec3) -> Option<Ray> {
        direction_of(towards).map(|direction| Ray { origin, direction })
    }

    /// World point at distance `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
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
    /// `far − near`, in world units.
    pub fn length(&self) -> f64 {
        self.far - self.near
    }
}

/// `v / |v|`, or `None` for the zero vector and for one that is not finite: they have no
/// direction.
///
/// Works over the whole range of finite vectors: where `|v|²` would leave the range of normal
/// numbers, `v` is first brought near 1 by a power of two, which changes no digit of it.
pub fn direction_of(v: DVec3) -> Option<DVec3> {
    let length_squared = v.length_squared();
    if (1e-290..1e290).contains(&length_squared) {
        return Some(v / length_squared.sqrt());
    }
    let largest = v.abs().max_element();
    // Component by component: the largest of some numbers and a NaN may be a number.
    if largest == 0.0 || !v.is_finite() {
        return None;
    }
    // 2^±300 in up to three steps reaches every finite number, subnormal ones included.
    let up = 2.0_f64.to_bits() + (299 << 52);
    let down = 0.5_f64.to_bits() - (299 << 52);
    let factor = f64::from_bits(if largest < 1.0 { up } else { down });
    let mut scaled = v * factor;
    while !(1e-290..1e290).contains(&scaled.length_squared()) {
        scaled *= factor;
    }
    Some(scaled / scaled.length())
}

/// `|v|` of a finite vector, over its whole range: where `|v|²` would leave the range of normal
/// numbers, it is taken of `v` brought near 1 by a power of two.
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

/// The part of a segment of line from `near` to `far` with `t ≥ 0`, if there is one.
pub(super) fn ahead(near: f64, far: f64) -> Option<Span> {
    // Not `max`, which may return a zero of either sign where both are zeros.
    let near = if near > 0.0 { near } else { 0.0 };
    (near <= far).then_some(Span { near, far })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_have_length_one_over_the_whole_range() {
        for exponent in [-1074, -1060, -600, -300, -1, 0, 1, 300, 600, 1020] {
            let size = libm::exp2(f64::from(exponent));
            let direction = direction_of(DVec3::new(size, -size, 0.0)).unwrap();
            // One rounding each in the sum, the root and the quotient.
            assert!(
                (direction.length() - 1.0).abs() <= 4.0 * f64::EPSILON,
                "2^{exponent}"
            );
            assert_eq!(direction.x, -direction.y);
        }
    }

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

    #[test]
    fn the_zero_vector_has_no_direction() {
        assert_eq!(direction_of(DVec3::ZERO), None);
        assert_eq!(direction_of(DVec3::new(-0.0, 0.0, 0.0)), None);
        assert_eq!(direction_of(DVec3::splat(f64::INFINITY)), None);
        assert_eq!(direction_of(DVec3::splat(f64::NAN)), None);
        for axis in 0..3 {
            for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut vector = DVec3::ONE;
                vector[axis] = odd;
                assert_eq!(direction_of(vector), None, "{vector}");
            }
        }
    }
}
