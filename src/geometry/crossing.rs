//! Watertight intersection of a line with a triangle: meshes have no cracks.
//!
//! The line is laid along the third axis by a shear, which leaves the question whether the
//! projected triangle winds around the origin of a plane. Each edge answers a part of it on its
//! own: it counts +1 or −1 if it crosses the positive first axis upward or downward. *Upward*
//! means from `y < 0` to `y ≥ 0`, and where it crosses is computed from the lower vertex to the
//! upper, whichever triangle asks. Three things follow, whatever was rounded on the way:
//!
//! - The two triangles at an edge count it with opposite signs, so over a closed, consistently
//!   oriented mesh all counts cancel: a line enters as often as it leaves. Always, through
//!   vertices and along edges too. There is no tolerance in the argument.
//! - A line through a shared edge or vertex crosses exactly as many faces as one beside it.
//! - The two triangles at an edge compute the same point on it.
//!
//! The shear and its use of the ray's dominant axis are from Woop, Benthin & Wald 2013,
//! "Watertight ray/triangle intersection", JCGT 2(1). Their edge functions settle ties by
//! computing again in higher precision and count a line through an edge for both faces, which
//! is watertight but not a parity; the half-open winding rule is.
//!
//! # Error
//!
//! With `S` the largest coordinate of `vertex − origin` and `u` half an ulp of 1: differences
//! are off by uS; the sheared `x` and `y` by 5uS (difference, slope, product, each with |slope| ≤
//! 1, and the last subtraction, of size ≤ 2S); `t` times the dominant component of the direction
//! by 2uS. The point where an edge crosses is a mean of the edge's ends with weights in [0, 1],
//! off by another 6u of values up to 2S; the mean of two such points likewise. So the computed
//! crossing is the exact one of a triangle whose vertices moved by at most 30uS along each axis,
//! that is 52uS in all; from an origin within the shape's reach `R`, `S ≤ 2R` gives 104uR.

use super::{Ray, Side};
use glam::DVec3;

/// A ray, ready to be laid along the third axis.
pub(super) struct RayFrame {
    origin: DVec3,
    /// Right-handed, the third along the direction's largest component.
    axes: [usize; 3],
    slope: [f64; 2],
    dominant: f64,
}

/// Where a whole line, `t < 0` included, crosses a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TriangleCrossing {
    /// Distance from the ray's origin, in world units.
    pub t: f64,
    /// `Front` where the line goes in.
    pub side: Side,
    /// Weights of the three vertices, none negative, summing to 1 up to rounding.
    pub weights: [f64; 3],
}

/// A vertex seen along the ray.
#[derive(Clone, Copy)]
struct Projected {
    x: f64,
    y: f64,
    /// Distance along the dominant axis.
    ahead: f64,
}

/// Where an edge crosses the first axis.
#[derive(Clone, Copy)]
struct EdgeCrossing {
    low: usize,
    high: usize,
    /// Weight of the upper vertex.
    part: f64,
    x: f64,
    /// +1 for an edge that runs upward in the triangle's order, −1 downward.
    count: i32,
}

impl RayFrame {
    pub fn new(ray: &Ray) -> RayFrame {
        let third = ray.direction.abs().max_position();
        let dominant = ray.direction[third];
        let (mut first, mut second) = ((third + 1) % 3, (third + 2) % 3);
        if dominant < 0.0 {
            // Looking the other way along an axis mirrors the plane; swapping undoes it.
            (first, second) = (second, first);
        }
        RayFrame {
            origin: ray.origin,
            axes: [first, second, third],
            slope: [
                ray.direction[first] / dominant,
                ray.direction[second] / dominant,
            ],
            dominant,
        }
    }

    /// Where the line crosses the triangle, if it does.
    pub fn crossing(&self, triangle: [DVec3; 3]) -> Option<TriangleCrossing> {
        let seen = triangle.map(|vertex| self.project(vertex));
        // No edge crosses beyond 0 where no vertex lies there: also as computed, since the sum of two
        // products of one sign has that sign.
        if seen.iter().all(|vertex| vertex.x <= 0.0) {
            return None;
        }
        // A triangle has two edges across the axis, or none.
        let mut edges = [(0, 1), (1, 2), (2, 0)]
            .into_iter()
            .filter_map(|(from, to)| edge_crossing(&seen, from, to));
        let (one, other) = (edges.next()?, edges.next()?);
        let (inner, outer) = match (one.x > 0.0, other.x > 0.0) {
            (false, true) => (one, other),
            (true, false) => (other, one),
            _ => return None,
        };
        let [at_inner, at_outer] = [inner, outer].map(|edge| self.distance(&seen, &edge));
        // inner.x ≤ 0 < outer.x, so this divides by something positive.
        let part = -inner.x / (outer.x - inner.x);
        let mut weights = [0.0; 3];
        for (edge, share) in [(inner, 1.0 - part), (outer, part)] {
            weights[edge.low] += share * (1.0 - edge.part);
            weights[edge.high] += share * edge.part;
        }
        Some(TriangleCrossing {
            t: at_inner + (at_outer - at_inner) * part,
            // Anticlockwise as seen along the ray: the normal points along it.
            side: if outer.count > 0 {
                Side::Back
            } else {
                Side::Front
            },
            weights,
        })
    }

    fn project(&self, vertex: DVec3) -> Projected {
        let relative = vertex - self.origin;
        let [first, second, third] = self.axes.map(|axis| relative[axis]);
        Projected {
            x: first - self.slope[0] * third,
            y: second - self.slope[1] * third,
            ahead: third,
        }
    }

    /// Distance from the ray's origin at which an edge crosses.
    fn distance(&self, seen: &[Projected; 3], edge: &EdgeCrossing) -> f64 {
        let [low, high] = [edge.low, edge.high].map(|vertex| seen[vertex].ahead / self.dominant);
        low + (high - low) * edge.part
    }
}

fn edge_crossing(seen: &[Projected; 3], from: usize, to: usize) -> Option<EdgeCrossing> {
    let (low, high, count) = match (seen[from].y >= 0.0, seen[to].y >= 0.0) {
        (false, true) => (from, to, 1),
        (true, false) => (to, from, -1),
        _ => return None,
    };
    let (a, b) = (seen[low], seen[high]);
    let rise = b.y - a.y;
    Some(EdgeCrossing {
        low,
        high,
        part: -a.y / rise,
        x: (a.x * b.y - b.x * a.y) / rise,
        count,
    })
}
