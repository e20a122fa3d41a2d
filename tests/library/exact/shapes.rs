//! Where rays are in boxes and spheres, and how well an `f64` can say so.
//!
//! Bounds are of first order: products of roundings are left out, since forty of them are below
//! 1e-14 of what they would be added to. [`SECOND_ORDER`] is more than that.

use super::{Big, U, big, rounded};
use dashu_float::ops::SquareRoot;
use volref::geometry::{Aabb, Ray, Sphere};

/// What a bound of first order is multiplied by.
pub const SECOND_ORDER: f64 = 1.0 + 1e-12;

/// Where the line of a ray, `t < 0` included, is in a box: `near` above `far` where it misses.
/// `None` where it runs beside the box, or in a face that belongs to a neighbour.
pub fn line_in_box(shape: &Aabb, ray: &Ray) -> Option<[Big; 2]> {
    let mut ends: Option<[Big; 2]> = None;
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let (low, high) = (shape.min[axis], shape.max[axis]);
        if direction == 0.0 {
            if !(low <= origin && origin < high) {
                return None;
            }
            continue;
        }
        let at = |face: f64| (big(face) - big(origin)) / big(direction);
        let [first, last] = if direction > 0.0 {
            [at(low), at(high)]
        } else {
            [at(high), at(low)]
        };
        ends = Some(match ends {
            None => [first, last],
            Some([near, far]) => [near.max(first), far.min(last)],
        });
    }
    ends
}

/// Rounding of a distance to a face, relative: a difference and a quotient.
pub const FACE: f64 = 2.0 * U * SECOND_ORDER;

/// The chord that a line cuts from a sphere, by distances along the ray.
pub struct ExactChord {
    pub near: Big,
    pub far: Big,
    /// Half its length.
    pub half: f64,
    /// Largest rounding of either end, in world units.
    pub error: f64,
}

/// The chord of `sphere` on the line of `ray`; `None` if the line misses.
///
/// # Error
///
/// With `c` the centre from the origin, `D` its length, `n` the exact direction of the ray, `a`
/// the distance of the foot of the perpendicular, `m` its distance from the centre, `h` half the
/// chord, in units of `u`:
///
/// - The ray's direction `d`, off from length 1 by three squares and two sums under a root, the
///   root and a quotient: 3.5. The foot is meant on `n`.
/// - `c`: D. `along = c·d`: D, three products and two sums 3D, and 3.5D for `d`: 7.5D.
/// - `foot = c − d·along`: D, `along` 7.5D, `d` 3.5D, product D, difference D: 14D.
///   Its length `m`: 14D, and 2.5 of itself: 17D.
/// - `h² = (r − m)(r + m)` moves by `2m·17D`, `h` by that over the sum of both `h`, computed and
///   exact. Where that is no more than a quarter of `h`, the computed one is at least ¾ of it:
///   `(34/1.75)·mD/h`. Two factors, their product and the root: 2.5h.
/// - `a ± h`: one more of `t`.
/// - The nearer root from the product of both, `P = (D − r)(D + r) = t·(a + h)`: D, a difference
///   and three squares under a root, is off by 3.5D, which moves P by 3.5D(D + r); the rest of P
///   is relative, 6.5; the divisor moves by what `a` and `h` do and rounds once, the quotient too.
///   Since `|t| = |a − h| ≤ a + h`, that is `3.5D(D + r)/(a + h) + 8.5|t| + 7.5D` beside the error
///   of `h`.
pub fn chord(sphere: &Sphere, ray: &Ray) -> Option<ExactChord> {
    let c: [Big; 3] =
        std::array::from_fn(|axis| big(sphere.centre()[axis]) - big(ray.origin[axis]));
    let d = ray.direction.to_array().map(big);
    let dot = |a: &[Big; 3], b: &[Big; 3]| &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2];
    let length = dot(&d, &d).sqrt();
    let along = dot(&c, &d) / &length;
    // Not from D² − a², which would cancel.
    let cross: [Big; 3] = std::array::from_fn(|axis| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        &c[i] * &d[j] - &c[j] * &d[i]
    });
    let miss = dot(&cross, &cross).sqrt() / length;
    let radius = big(sphere.radius());
    if miss > radius {
        return None;
    }
    let half = ((&radius - &miss) * (&radius + &miss)).sqrt();
    let (near, far) = (&along - &half, &along + &half);
    let distance = rounded(&dot(&c, &c).sqrt());
    let [a, m, h] = [&along, &miss, &half].map(rounded);
    let t = rounded(&near).abs().max(rounded(&far).abs());
    let of_half = 34.0 / 1.75 * m * distance / h + 2.5 * h;
    let of_product = 3.5 * distance * (distance + sphere.radius()) / (a.abs() + h);
    let error = U * SECOND_ORDER * (7.5 * distance + 8.5 * t + of_half + of_product);
    Some(ExactChord {
        near,
        far,
        half: h,
        error,
    })
}
