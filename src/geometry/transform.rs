//! Affine maps between object space and the world.

use super::{Aabb, Direction, InvalidParameter, Line, Ray, require};
use crate::math;
use glam::{DMat3, DVec3};

/// An invertible affine map `p ↦ M·p + o`, stored with its inverse.
///
/// Maps built from translations, rotations and scalings carry the inverse as the same factors
/// in reverse order, so that no matrix is ever inverted numerically for them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    linear: DMat3,
    offset: DVec3,
    inverse_linear: DMat3,
    inverse_offset: DVec3,
}

impl Transform {
    /// The identity map.
    pub const IDENTITY: Transform = Transform {
        linear: DMat3::IDENTITY,
        offset: DVec3::ZERO,
        inverse_linear: DMat3::IDENTITY,
        inverse_offset: DVec3::ZERO,
    };

    /// Translation of every point by `offset`, in world units.
    pub fn translation(offset: DVec3) -> Result<Transform, InvalidParameter> {
        finite("translate", [offset])?;
        Ok(Transform {
            offset,
            inverse_offset: -offset,
            ..Transform::IDENTITY
        })
    }

    /// Rotation around an axis through the origin by `degrees`, right-handed: anticlockwise seen
    /// with the axis pointing at the viewer. `axis` has any length but 0. Multiples of 90° about a
    /// coordinate axis are exact.
    pub fn rotation(axis: DVec3, degrees: f64) -> Result<Transform, InvalidParameter> {
        finite("axis", [axis, DVec3::splat(degrees)])?;
        let axis = Direction::of(axis).ok_or_else(|| {
            InvalidParameter::new(
                "axis",
                "a rotation needs an axis other than the zero vector",
            )
        })?;
        let (sine, cosine) = sine_and_cosine_of_degrees(degrees);
        // Rodrigues: R·v = v cos θ + (a × v) sin θ + a (a·v)(1 − cos θ).
        let rotated =
            |v: DVec3| v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine));
        let linear = DMat3::from_cols(rotated(DVec3::X), rotated(DVec3::Y), rotated(DVec3::Z));
        Ok(Transform {
            linear,
            inverse_linear: linear.transpose(),
            ..Transform::IDENTITY
        })
    }

    /// Scaling along the coordinate axes; negative factors mirror.
    pub fn scale(factors: DVec3) -> Result<Transform, InvalidParameter> {
        let message = format_args!(
            "scaling by {factors} flattens the object; give a factor other than 0 on every axis"
        );
        require(factors.cmpne(DVec3::ZERO).all(), "scale", message)?;
        finite("scale", [factors, factors.recip()])?;
        Ok(Transform {
            linear: DMat3::from_diagonal(factors),
            inverse_linear: DMat3::from_diagonal(factors.recip()),
            ..Transform::IDENTITY
        })
    }

    /// The map `p ↦ linear·p + offset`.
    pub fn from_matrix(linear: DMat3, offset: DVec3) -> Result<Transform, InvalidParameter> {
        let columns = [linear.x_axis, linear.y_axis, linear.z_axis];
        finite("transform", columns)?;
        finite("transform", [offset])?;
        let largest = columns.map(|column| column.abs().max_element());
        // Near 1, so that no product of three leaves the range of numbers; by a power of two nothing is rounded.
        let scale = math::power_of_two_below(largest.into_iter().fold(0.0, f64::max));
        let near_one = linear * scale.recip();
        let determinant = near_one.determinant();
        let [a, b, c] = [near_one.x_axis, near_one.y_axis, near_one.z_axis];
        // Six products of three factors, five roundings each: a determinant below this share of
        // the volume of the columns' box has no correct digit, not even its sign.
        let least = 32.0 * f64::EPSILON * (a.length() * b.length() * c.length());
        let message = format_args!(
            "the matrix maps space onto a plane (determinant {}): its columns are linearly dependent; correct one of them",
            linear.determinant()
        );
        let is_singular = scale == 0.0 || determinant.abs() <= least;
        require(!is_singular, "transform", message)?;
        let inverse_of_near_one = DMat3::from_cols(
            b.cross(c) / determinant,
            c.cross(a) / determinant,
            a.cross(b) / determinant,
        );
        let inverse_linear = inverse_of_near_one.transpose() * scale.recip();
        finite(
            "transform",
            [0, 1, 2].map(|column| inverse_linear.col(column)),
        )?;
        Ok(Transform {
            linear,
            offset,
            inverse_linear,
            inverse_offset: -(inverse_linear * offset),
        })
    }

    /// This map followed by `next`.
    pub fn then(&self, next: &Transform) -> Transform {
        Transform {
            linear: next.linear * self.linear,
            offset: next.point(self.offset),
            inverse_linear: self.inverse_linear * next.inverse_linear,
            inverse_offset: self.inverse().point(next.inverse_offset),
        }
    }

    /// This map about the point `centre` in place of the origin.
    pub fn about(&self, centre: DVec3) -> Result<Transform, InvalidParameter> {
        let (to_origin, back) = (
            Transform::translation(-centre)?,
            Transform::translation(centre)?,
        );
        Ok(to_origin.then(self).then(&back))
    }

    /// The inverse map.
    pub fn inverse(&self) -> Transform {
        Transform {
            linear: self.inverse_linear,
            offset: self.inverse_offset,
            inverse_linear: self.linear,
            inverse_offset: self.offset,
        }
    }

    /// A world ray in object space, its direction not renormalised: distances along it stay those of the
    /// world.
    // Never, as the next two: of the loops along rays they would take registers.
    #[inline(never)]
    pub(crate) fn line_to_object(&self, ray: &Ray) -> Line {
        Line {
            origin: self.point_to_object(ray.origin),
            direction: self.vector_to_object(*ray.direction),
        }
    }

    /// A difference of world points in object space.
    #[inline(never)]
    pub(crate) fn vector_to_object(&self, v: DVec3) -> DVec3 {
        self.inverse_linear * v
    }

    /// A world point in object space. Relative to the offset first, so that an object far from the
    /// world's origin loses no digits.
    #[inline(never)]
    pub(crate) fn point_to_object(&self, p: DVec3) -> DVec3 {
        self.inverse_linear * (p - self.offset)
    }

    /// The map of gradients of a field, which is the inverse transpose, over a power of two that makes
    /// no component of an image larger than that of its gradient: for directions.
    pub(crate) fn gradient_map(&self) -> DMat3 {
        let map = self.inverse_linear.transpose();
        map * (0.5 / math::power_of_two_below(norm(&map)))
    }

    /// The condition number of the linear part: how many times larger, as a share, the image of an
    /// error can be than the error; in the norm of the largest coordinate.
    pub fn condition(&self) -> f64 {
        norm(&self.linear) * norm(&self.inverse_linear)
    }

    /// The matrix of 3 × 4, row by row: the last column is the offset.
    pub fn rows(&self) -> [[f64; 4]; 3] {
        let linear = self.linear.transpose();
        [0, 1, 2].map(|row| {
            let [x, y, z] = linear.col(row).to_array();
            [x, y, z, self.offset[row]]
        })
    }

    /// The map with these [rows](Transform::rows).
    pub fn from_rows(rows: [[f64; 4]; 3]) -> Result<Transform, InvalidParameter> {
        let column = |column: usize| DVec3::from_array(rows.map(|row| row[column]));
        Transform::from_matrix(DMat3::from_cols(column(0), column(1), column(2)), column(3))
    }

    /// Image of the point `p`.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.offset
    }

    /// Image of the difference of two points; its length changes with the scale.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.linear * v
    }

    /// Image of the normal of a surface: by the inverse transpose, so that it stays perpendicular
    /// to the surface under non-uniform scaling. Mirroring keeps outward normals outward.
    pub fn normal(&self, normal: Direction) -> Direction {
        let turned = self.inverse_linear.transpose() * *normal;
        Direction::of(turned).expect("an invertible map keeps a normal from vanishing")
    }

    /// Whether the map changes right-handed frames into left-handed ones.
    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }

    /// A world ray in object space, and the object length of one world unit along it: a hit at
    /// object distance `t` lies at world distance `t / factor`.
    ///
    /// `None` if the direction leaves the range of numbers on the way.
    pub(crate) fn ray_to_object(&self, ray: &Ray) -> Option<(Ray, f64)> {
        let towards = self.inverse_linear * *ray.direction;
        // Relative to the ray's own length, 1 up to rounding: so a scaling by a power of two
        // gives back every digit of the direction.
        let factor = length(towards)? / length(*ray.direction)?;
        let object_ray = Ray {
            origin: self.inverse().point(ray.origin),
            direction: Direction::unit(towards / factor),
        };
        Some((object_ray, factor))
    }

    /// The smallest world box around the image of `bounds`, up to rounding.
    pub fn bounds(&self, bounds: &Aabb) -> Aabb {
        let corners = bounds.corners().map(|corner| self.point(corner));
        Aabb::around(corners).expect("a box has eight corners")
    }

    /// Centre and radius of a world sphere around the image of the sphere around `centre`.
    pub(super) fn bounding_sphere(&self, (centre, radius): (DVec3, f64)) -> (DVec3, f64) {
        (self.point(centre), radius * self.lengthening())
    }

    /// Bound on the distance, in world units, by which a world point near `world_reach` moves
    /// when it is mapped to object space and back.
    ///
    /// Each map is three products and three sums per coordinate: γ₆ < 8u of
    /// `|M|·|p| + |o|`. An error made in object space is stretched by at most `‖M‖` on the way
    /// back. All norms are of the largest coordinate.
    pub(super) fn round_trip_error(&self, world_reach: f64, object_reach: f64) -> f64 {
        let there = norm(&self.inverse_linear) * world_reach + largest(self.inverse_offset);
        let back = norm(&self.linear) * object_reach + largest(self.offset);
        8.0 * f64::EPSILON / 2.0 * (norm(&self.linear) * there + back)
    }

    /// Upper bound on the factor by which a length grows: the root of the largest row sum of `MᵀM`
    /// (Gershgorin). Exact for scales along the axes with a rotation after them.
    fn lengthening(&self) -> f64 {
        // Over a power of two, which is exact: no square leaves the range.
        let size = math::power_of_two_below(self.stretch());
        let linear = self.linear * (1.0 / size);
        norm(&(linear.transpose() * linear)).sqrt() * size
    }

    /// Upper bound on the factor by which the largest coordinate of a vector grows.
    pub(super) fn stretch(&self) -> f64 {
        norm(&self.linear)
    }
}

/// `|v|`, by projection: no square that could leave the range. `None` for the zero vector.
fn length(v: DVec3) -> Option<f64> {
    Direction::of(v).map(|direction| v.dot(*direction))
}

/// Largest row sum of magnitudes: the norm that belongs to the largest coordinate.
fn norm(m: &DMat3) -> f64 {
    (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()).max_element()
}

fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

fn finite<const N: usize>(name: &'static str, all: [DVec3; N]) -> Result<(), InvalidParameter> {
    all.into_iter().try_for_each(|v| {
        let message = format_args!(
            "a transform needs finite numbers with finite inverses, got {v}; check the scene's units"
        );
        require(v.is_finite(), name, message)
    })
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90°, where π/180 is not.
fn sine_and_cosine_of_degrees(degrees: f64) -> (f64, f64) {
    // Both steps are exact: the remainder by definition, the difference because it is small.
    let turn = degrees % 360.0;
    let quarters = (turn / 90.0).round();
    let rest = (turn - quarters * 90.0).to_radians();
    let (sine, cosine) = (math::sin(rest), math::cos(rest));
    match (quarters as i64).rem_euclid(4) {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let turn = |axis, degrees| Transform::rotation(axis, degrees).unwrap();
        assert_eq!(turn(DVec3::Y, 90.0).point(DVec3::Z), DVec3::X);
        assert_eq!(turn(DVec3::Z, 90.0).point(DVec3::X), DVec3::Y);
        assert_eq!(turn(DVec3::X, -270.0).point(DVec3::Y), DVec3::Z);
        assert_eq!(turn(DVec3::Z, 180.0).point(DVec3::X), -DVec3::X);
        let far = DVec3::new(1.0, 2.0, 3.0);
        assert_eq!(turn(DVec3::ONE, 720.0).point(far), far);
    }

    #[test]
    fn the_first_map_of_then_happens_first() {
        let turn = Transform::rotation(DVec3::Y, 90.0).unwrap();
        let shift = Transform::translation(DVec3::X).unwrap();
        assert_eq!(turn.then(&shift).point(DVec3::Z), DVec3::new(2.0, 0.0, 0.0));
        assert_eq!(
            shift.then(&turn).point(DVec3::X),
            DVec3::new(0.0, 0.0, -2.0)
        );
    }

    #[test]
    fn normals_stay_perpendicular_under_unequal_scaling() {
        let squash = Transform::scale(DVec3::new(1.0, 0.25, 1.0)).unwrap();
        let normal = Direction::of(DVec3::new(1.0, 1.0, 0.0)).unwrap();
        let tangent = DVec3::new(1.0, -1.0, 0.0);
        assert_eq!(squash.normal(normal).dot(squash.vector(tangent)), 0.0);
    }

    /// The square of such a scale leaves the range.
    #[test]
    fn lengths_grow_by_no_more_than_their_bound_at_any_scale() {
        for scale in [1e-200, 1e-160, 1.0, 1e160] {
            let stretch = Transform::scale(DVec3::new(1.0, 0.5, 0.25) * scale).unwrap();
            assert_eq!(stretch.lengthening(), scale);
        }
    }

    #[test]
    fn maps_without_an_inverse_are_refused() {
        let flat = DVec3::new(1.0, 0.0, 1.0);
        assert!(Transform::scale(flat).is_err());
        assert!(Transform::rotation(DVec3::ZERO, 1.0).is_err());
        for bad in [f64::NAN, f64::INFINITY, 1e-310] {
            assert!(Transform::scale(DVec3::splat(bad)).is_err(), "{bad}");
        }
        assert!(Transform::rotation(DVec3::X, f64::NAN).is_err());
        assert!(Transform::translation(DVec3::splat(f64::INFINITY)).is_err());
        // However far its numbers are from 1: no product of three leaves their range.
        for size in [1e-150, 1e200] {
            let map = Transform::from_matrix(DMat3::IDENTITY * size, DVec3::ZERO).unwrap();
            assert_eq!(map.point(DVec3::ONE), DVec3::splat(size));
            let back = map.point_to_object(DVec3::splat(size));
            assert!((back - DVec3::ONE).length() < 1e-15, "{back}");
        }
        assert!(Transform::from_matrix(DMat3::ZERO, DVec3::ZERO).is_err());
        // Rank 2, with a determinant that is not zero but rounding.
        let (a, b) = (DVec3::new(0.1, 0.7, 0.3), DVec3::new(0.9, 0.2, 0.4));
        let matrix = DMat3::from_cols(a, b, a * 0.3 + b * 0.7);
        assert!(Transform::from_matrix(matrix, DVec3::ZERO).is_err());
    }
}
