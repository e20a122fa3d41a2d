//! Spheres.

use super::hit::RELATIVE_CLEARANCE;
use super::ray::ahead;
use super::{
    Aabb, Crossing, Direction, Emitter, EmitterExtent, Hit, InvalidParameter, Ray, Side, Solid,
    Span, Surface, SurfacePoint, require, require_finite,
};
use crate::math;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A sphere, a closed shape with its normals outward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    centre: DVec3,
    radius: f64,
}

/// The chord of a line in a sphere, and the position of the ray's origin relative to it.
struct Chord {
    near: f64,
    far: f64,
    /// Whether the ray's origin lies outside the sphere.
    outside: bool,
}

/// More than one by more than the rounding of a chord's ends.
const CLEARLY: f64 = 1.0 + 1e-12;

impl Sphere {
    /// A sphere around `centre` with a positive `radius`, in world units.
    pub fn new(centre: DVec3, radius: f64) -> Result<Sphere, InvalidParameter> {
        require_finite("centre", "the centre of the sphere", centre)?;
        let sphere = Sphere { centre, radius };
        let message = format_args!(
            "the radius of a sphere must be positive, finite, and not vanish beside its coordinates, got {radius} at {centre}"
        );
        let is_seen = radius.is_finite() && sphere.clearance() < radius;
        require(is_seen, "radius", message)?;
        Ok(sphere)
    }

    /// Centre, in world units.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Radius, in world units.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The chord by the perpendicular foot: with `b` the distance of the centre from the line,
    /// half the chord is √((r − b)(r + b)). The textbook's discriminant subtracts squares of the
    /// distance to the centre and loses a small far sphere, and every grazing ray.
    ///
    /// With `D` the distance of the centre from the origin and `h` half the chord, an end is off by
    /// some 2^-53 times `D` and, for a ray that grazes, `bD/h`. The bound with its factors stands in
    /// `tests/library/exact/shapes.rs`; measured on 100 000 rays: 0.22 of it, and 3.1 ulp for the far end of
    /// a chord longer than the radius from no farther than eight radii.
    ///
    /// Source: Haines et al. 2019, "Precision improvements for ray/sphere intersection", Ray
    /// Tracing Gems, ch. 7.
    fn chord(&self, ray: &Ray) -> Option<Chord> {
        let to_centre = self.centre - ray.origin;
        let along = to_centre.dot(*ray.direction);
        let foot = to_centre - ray.direction * along;
        let squared = foot.length_squared();
        // Most rays miss clearly, and most spheres that they miss are behind them: no root is needed.
        let is_behind = along < -CLEARLY * self.radius;
        if is_behind || squared > CLEARLY * (self.radius * self.radius) {
            return None;
        }
        let miss = squared.sqrt();
        if miss > self.radius {
            return None;
        }
        let half = ((self.radius - miss) * (self.radius + miss)).sqrt();
        let distance = to_centre.length();
        // The root nearer to the origin, where `along ∓ half` would cancel, from the product of
        // both roots; the sign of (distance − r) decides on which side of the surface we are.
        let product = (distance - self.radius) * (distance + self.radius);
        let (near, far) = if along.abs() >= 2.0 * half {
            (along - half, along + half)
        } else if along > 0.0 {
            (product / (along + half), along + half)
        } else if half == 0.0 {
            (along, along)
        } else {
            (along - half, product / (along - half))
        };
        Some(Chord {
            near,
            far,
            outside: distance > self.radius,
        })
    }

    /// Bound on all roundings, see [`super::hit`].
    ///
    /// A point `centre + r·n`: normal within 4u of unit length, product and sum one rounding
    /// each, so within 6u of the reach. A ray that starts near the surface: `to_centre`, `along`,
    /// `foot` and `miss` are off by at most 1u, 4u, 7u and 10u of the reach, `distance` by 3u, so
    /// the signs of `distance − r` and `miss − r` are right outside 128u.
    fn clearance(&self) -> f64 {
        RELATIVE_CLEARANCE * (self.centre.abs().max_element() + self.radius)
    }

    fn point(&self, normal: Direction) -> SurfacePoint {
        SurfacePoint {
            position: self.centre + normal * self.radius,
            normal,
            clearance: self.clearance(),
        }
    }
}

impl Surface for Sphere {
    fn bounds(&self) -> Aabb {
        Aabb {
            min: self.centre - self.radius,
            max: self.centre + self.radius,
        }
    }

    fn bounding_sphere(&self) -> (DVec3, f64) {
        (self.centre, self.radius)
    }

    fn crossing(&self, ray: &Ray, limit: f64) -> Option<Crossing> {
        let chord = self.chord(ray)?;
        let (t, side) = if chord.outside {
            (chord.near, Side::Front)
        } else {
            (chord.far, Side::Back)
        };
        (t > 0.0 && t < limit).then_some(Crossing::new(t, side, 0, [0.0; 2]))
    }

    fn hit_at(&self, ray: &Ray, crossing: &Crossing) -> Hit {
        let from_centre = (ray.origin - self.centre) + ray.direction * crossing.t;
        // The sphere is smaller than the rounding of so far a distance: its near side is seen.
        let normal = Direction::of(from_centre).unwrap_or(-ray.direction);
        Hit::new(crossing, self.point(normal))
    }
}

impl Solid for Sphere {
    fn append_spans(&self, ray: &Ray, spans: &mut Vec<Span>) {
        let chord = self.chord(ray);
        spans.extend(chord.and_then(|chord| ahead(chord.near, chord.far)));
    }
}

impl Emitter for Sphere {
    fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    fn extent(&self) -> EmitterExtent {
        EmitterExtent {
            centre: self.centre,
            spread: self.radius * self.radius,
            normal: None,
        }
    }

    /// Height uniform in [−1, 1], angle uniform: Archimedes' hat box.
    fn sample(&self, [u, v]: [f64; 2]) -> SurfacePoint {
        let height = 1.0 - 2.0 * u;
        // (1 − z)(1 + z), not 1 − z²: keeps its digits at the poles.
        let ring = (2.0 * u * (2.0 - 2.0 * u)).sqrt();
        let angle = TAU * v;
        self.point(Direction::unit(DVec3::new(
            ring * math::cos(angle),
            ring * math::sin(angle),
            height,
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Sphere {
        Sphere::new(DVec3::ZERO, 1.0).unwrap()
    }

    #[test]
    fn g10_far_away() {
        let ray = Ray::new(DVec3::new(0.3, 0.0, -1e8), DVec3::Z).unwrap();
        let hit = unit().hit(&ray, f64::INFINITY).unwrap();
        let ulp = 1.490_116_119_384_765_6e-8;
        assert!((hit.t - (1e8 - 0.91_f64.sqrt())).abs() <= 2.0 * ulp);
    }

    #[test]
    fn g10_grazed() {
        let offset = 1.0 - f64::EPSILON * 4.0; // 1 − 2^−50
        let ray = Ray::new(DVec3::new(offset, 0.0, -1.0), DVec3::Z).unwrap();
        let spans = unit().spans(&ray);
        let chord = 8.429_369_702_178_8e-8;
        // The two ends are distances near 1, with errors of one rounding each.
        assert!(
            (spans[0].length() - chord).abs() <= 2.0 * f64::EPSILON,
            "{spans:?}"
        );
        let ray = Ray::new(DVec3::new(offset, 0.0, 0.0), DVec3::Z).unwrap();
        let half = unit().spans(&ray)[0].length();
        assert!((2.0 * half - chord).abs() <= 1e-9 * chord, "{half:e}");
        assert!(
            unit()
                .spans(&Ray::new(DVec3::new(1.0 + f64::EPSILON, 0.0, 0.0), DVec3::Z).unwrap())
                .is_empty()
        );
    }

    #[test]
    fn origin_inside_on_the_surface_and_behind() {
        let spans = |z: f64, towards: f64| {
            let ray = Ray::new(DVec3::Z * z, DVec3::Z * towards).unwrap();
            unit().spans(&ray).first().map(|s| (s.near, s.far))
        };
        assert_eq!(spans(0.5, 1.0), Some((0.0, 0.5)));
        assert_eq!(spans(-1.0, 1.0), Some((0.0, 2.0)));
        assert_eq!(spans(1.0, 1.0), Some((0.0, 0.0)));
        assert_eq!(spans(2.0, 1.0), None);
        assert_eq!(spans(2.0, -1.0), Some((1.0, 3.0)));
    }

    #[test]
    fn impossible_spheres_are_refused() {
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Sphere::new(DVec3::ZERO, radius).is_err());
        }
        let nan = DVec3::new(0.0, f64::NAN, 0.0);
        assert!(Sphere::new(nan, 1.0).is_err());
        assert!(Sphere::new(DVec3::X, 1e-20).is_err());
    }
}
