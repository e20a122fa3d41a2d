//! Points on flat shapes.

use crate::math::{cos, sin};
use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// A point of the disc of radius 1 about the origin, uniform by area. Scaled by a radius, it is
/// a point of that disc.
pub fn disc([u, v]: [f64; 2]) -> DVec2 {
    let azimuth = TAU * v;
    DVec2::new(cos(azimuth), sin(azimuth)) * u.sqrt()
}

/// Density of a uniform point on a disc of `radius > 0`, per area.
pub fn disc_pdf(radius: f64) -> f64 {
    1.0 / (PI * radius * radius)
}

/// A point of a triangle, uniform by area, as the weights of its corners: not negative, with a
/// sum of 1 up to rounding. The density is one over the area.
///
/// Source: Turk 1990, "Generating random points in triangles", Graphics Gems, 24–28.
pub fn triangle([u, v]: [f64; 2]) -> [f64; 3] {
    let from_first = u.sqrt();
    let third = from_first * v;
    [1.0 - from_first, from_first - third, third]
}
