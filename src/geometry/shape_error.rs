//! Errors in the numbers of a shape.

use glam::DVec3;
use thiserror::Error;

/// Reason for refusing a sphere, box or rectangle.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ShapeError {
    /// A coordinate is NaN or infinite.
    #[error("{what} must be finite, got {value}")]
    NotFinite {
        /// The quantity, as in "the centre of the sphere".
        what: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// The radius is zero, negative or not finite.
    #[error("the radius of a sphere must be positive and finite, got {0}")]
    Radius(f64),
    /// The sphere is so small, compared with its distance from the origin, that its points
    /// coincide.
    #[error(
        "a sphere of radius {radius} vanishes at {centre}: coordinates there are too coarse; move the scene nearer to the origin"
    )]
    TooSmall {
        /// Radius, in world units.
        radius: f64,
        /// Centre, in world units.
        centre: DVec3,
    },
    /// Lower corner above upper corner.
    #[error(
        "the box's min {min} must not exceed its max {max} on any axis; swap them where it does"
    )]
    Inverted {
        /// The `min` given.
        min: DVec3,
        /// The `max` given.
        max: DVec3,
    },
    /// The edges of a rectangle are zero or parallel.
    #[error("a rectangle with edges {0} and {1} has no area; give two edges that are not parallel")]
    NoArea(DVec3, DVec3),
}

/// `value`, if it is finite.
pub(super) fn finite(what: &'static str, value: DVec3) -> Result<DVec3, ShapeError> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(ShapeError::NotFinite { what, value })
    }
}
