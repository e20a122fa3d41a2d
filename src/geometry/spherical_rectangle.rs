//! The solid angle of a rectangle, and points sampled uniformly in it.
//!
//! A point sampled by area has a density per steradian that varies as the squared distance over the
//! cosine: near a rectangle over many orders of magnitude. Uniform directions into the rectangle
//! have none of that.
//!
//! Source: Ureña, Fajardo & King 2013, "An area-preserving parametrization for spherical
//! rectangles", Computer Graphics Forum 32, 59–66.

use crate::math::{atan2, cos, sin};
use std::f64::consts::TAU;

/// A rectangle as seen from the origin, in units of its diagonal: it lies in a plane of constant z, its
/// edges along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRectangle {
    /// First and last x.
    x: [f64; 2],
    /// First and last y.
    y: [f64; 2],
    /// Distance of the plane.
    height: f64,
    solid_angle: f64,
    /// Cosine and sine, times a common factor, of the sum of the two inner angles at the first x.
    first_angles: [f64; 2],
}

impl SphericalRectangle {
    /// The rectangle with its first corner at `corner`, edges of the lengths `edges > 0`, and its plane
    /// at `height`. `None` if that plane, up to rounding, goes through the origin.
    pub fn new(corner: [f64; 2], edges: [f64; 2], height: f64) -> Option<SphericalRectangle> {
        let unit = 1.0 / (edges[0] * edges[0] + edges[1] * edges[1]).sqrt();
        let ends = |i: usize| [corner[i] * unit, (corner[i] + edges[i]) * unit];
        let (x, y, height) = (ends(0), ends(1), height.abs() * unit);
        if height <= f64::EPSILON {
            return None;
        }
        // An inner angle has the cosine ∓ x·y and the sine height·distance, times a common factor.
        let angle = |i: usize, j: usize| {
            let product = if i == j { -x[i] * y[j] } else { x[i] * y[j] };
            let distance = (x[i] * x[i] + y[j] * y[j] + height * height).sqrt();
            [product, height * distance]
        };
        // Angles add up as complex numbers multiply.
        let sum = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
        let first = sum(angle(0, 0), angle(0, 1));
        let [cosine, sine] = sum(first, sum(angle(1, 0), angle(1, 1)));
        let excess = atan2(sine, cosine);
        Some(SphericalRectangle {
            x,
            y,
            height,
            // The sum of the inner angles less four right ones.
            solid_angle: if excess > 0.0 { excess } else { excess + TAU },
            first_angles: first,
        })
    }

    /// Solid angle, steradians, in (0, 2π].
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// The point for two numbers in [0, 1), as fractions of the edges. Uniform numbers give uniform
    /// directions.
    pub fn sample(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let SphericalRectangle { x, y, height, .. } = *self;
        let within = |at: f64, [first, last]: [f64; 2]| {
            let fraction = (at - first) / (last - first);
            // No number at an end of the range of random numbers, where it is 0/0.
            if fraction > 0.0 {
                fraction.min(1.0)
            } else {
                0.0
            }
        };
        let squared = height * height;
        // The x up to which the rectangle has the share u of its solid angle: at the angle
        // u·S − (sum of inner angles), of which cosine and sine are needed up to a factor.
        let (cosine, sine) = (cos(u * self.solid_angle), sin(u * self.solid_angle));
        let [a, b] = self.first_angles;
        let (cosine, sine) = (cosine * a + sine * b, sine * a - cosine * b);
        let [lower, upper] = y.map(|y| (squared + y * y).sqrt());
        let slope = -cosine * y[0] - (a * a + b * b).sqrt() * lower * y[1] / upper;
        let rest = (slope * slope - squared * (sine * sine)).max(0.0).sqrt();
        let across = (height * lower * sine.abs()).copysign(slope * sine) / rest;
        let fraction = within(across, x);
        let across = x[0] + fraction * (x[1] - x[0]);
        // On the line there, the sine of the elevation is uniform.
        let distance_squared = across * across + squared;
        let elevation = |y: f64| y / (distance_squared + y * y).sqrt();
        let [first, last] = y.map(elevation);
        let sine = first + v * (last - first);
        let along = sine * (distance_squared / ((1.0 - sine) * (1.0 + sine))).sqrt();
        [fraction, within(along, y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::{Purpose, Stream};

    /// `Σ ± atan(xy/(hr))` over the corners, another formula for the solid angle.
    fn by_corners(x: [f64; 2], y: [f64; 2], h: f64) -> f64 {
        let corner = |x: f64, y: f64| atan2(x * y, h * (x * x + y * y + h * h).sqrt());
        corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0])
    }

    fn between(x: [f64; 2], y: [f64; 2], height: f64) -> SphericalRectangle {
        SphericalRectangle::new([x[0], y[0]], [x[1] - x[0], y[1] - y[0]], height).unwrap()
    }

    const EXAMPLES: [([f64; 2], [f64; 2], f64); 5] = [
        ([-1.0, 1.0], [-1.0, 1.0], 1.0),
        ([-2.0, 1.0], [-0.5, 3.0], 0.01),
        ([3.0, 4.0], [-6.0, -1.0], 2.0),
        ([-1.0, 5.0], [0.0, 0.1], 0.2),
        ([0.5, 2.0], [0.25, 1.0], 1e-9),
    ];

    #[test]
    fn solid_angles_by_two_formulas() {
        for (x, y, h) in EXAMPLES {
            let rectangle = between(x, y, h);
            // Either is a difference of angles up to 2π, each off by a few roundings.
            let difference = rectangle.solid_angle() - by_corners(x, y, h);
            assert!(
                difference.abs() < 32.0 * f64::EPSILON,
                "{x:?} {y:?} {h}: {difference}"
            );
        }
        // A face of a cube seen from its centre.
        let face = between([-1.0, 1.0], [-1.0, 1.0], 1.0);
        assert!((face.solid_angle() - 4.0 * std::f64::consts::PI / 6.0).abs() < 8.0 * f64::EPSILON);
    }

    /// The share of points in each of nine parts is the share of its solid angle: a point is in the
    /// part with probability p, so the count is binomial, and four standard deviations of it are
    /// exceeded by less than one in 15 000; here are 36 parts, and the numbers are fixed.
    #[test]
    fn directions_are_uniform() {
        let count = 20_000;
        for (x, y, h) in &EXAMPLES[..4] {
            let rectangle = between(*x, *y, *h);
            let third = |[a, b]: [f64; 2], i: usize| a + (b - a) * i as f64 / 3.0;
            let mut counts = [[0; 3]; 3];
            for sample in 0..count {
                let uv = Stream::new(1, 0, sample).pair(0, Purpose::LightPoint, 0);
                let point = rectangle.sample(uv);
                let [i, j] = point.map(|fraction| ((3.0 * fraction) as usize).min(2));
                counts[i][j] += 1;
            }
            for (i, row) in counts.iter().enumerate() {
                for (j, &found) in row.iter().enumerate() {
                    let [x, y] =
                        [(x, i), (y, j)].map(|(ends, i)| [third(*ends, i), third(*ends, i + 1)]);
                    let p = by_corners(x, y, *h) / rectangle.solid_angle();
                    let expected = p * f64::from(count);
                    let deviation = (expected * (1.0 - p)).sqrt();
                    assert!(
                        (f64::from(found) - expected).abs() <= 4.0 * deviation,
                        "{x:?} {y:?}: {found} of {expected}"
                    );
                }
            }
        }
    }

    /// Also where the origin all but lies in the rectangle or very far away, and at both ends of the
    /// numbers.
    #[test]
    fn points_lie_on_the_rectangle() {
        let end = 1.0 - f64::EPSILON / 2.0;
        for height in [1e-15, 1e-12, 1.0, 1e12] {
            for x in [[-1.0, 1.0], [0.0, 1.0], [1.0, 2.0], [-3.0, -2.0]] {
                let rectangle = between(x, [-1.0, 2.0], height);
                for uv in [[0.0, 0.0], [end, end], [0.5, 0.5], [0.0, end]] {
                    let point = rectangle.sample(uv);
                    assert!(point.into_iter().all(|part| (0.0..=1.0).contains(&part)));
                }
            }
        }
        assert_eq!(SphericalRectangle::new([-1.0; 2], [2.0; 2], 0.0), None);
    }
}
