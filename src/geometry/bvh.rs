//! Candidate faces of a mesh for a line.
//!
//! Our own, for these reasons:
//! - `bvh` (0.12) takes f64, but its ray test calls every ray that lies in the plane of a box's
//!   face a miss. Rays along an axis do that wherever they pass a vertex: of sixteen flat boxes
//!   in a row, a ray that runs straight into the edge two of them share finds none. Its builder
//!   alone would be of use, but it changes its splitting rule at an absolute size, and brings
//!   `nalgebra`.
//! - `obvhs` (0.4) is f32 throughout: boxes would have to be moved near the origin and rounded
//!   outward before they bound f64 triangles.
//!
//! With boxes and ray test of our own, only the sorting of faces below remains.

use super::{Aabb, Ray};

/// Faces per leaf: testing a few costs about as much as another box.
const LEAF: usize = 4;

/// Rounding of a computed crossing relative to the farthest coordinate, as seen from the ray's
/// origin: 52u by the derivation in [`super::crossing`], and 4u for the slabs here. 2^−46 is
/// 128u; boxes are widened by it, so that no face is skipped that the triangle test would find
/// and the hierarchy changes no bit of any answer.
const WIDENING: f64 = 1.0 / (1_u64 << 46) as f64;

/// A bounding volume hierarchy: faces sorted into halves by the middle of their boxes along the
/// longest axis. The tree is stored in the order of its traversal.
#[derive(Clone, Debug)]
pub(super) struct Bvh {
    nodes: Vec<BvhNode>,
    faces: Vec<usize>,
}

#[derive(Clone, Debug)]
struct BvhNode {
    bounds: Aabb,
    /// The next node after this one and all below it.
    next: usize,
    /// Faces of a leaf; empty for an inner node.
    faces: std::ops::Range<usize>,
}

impl Bvh {
    /// The hierarchy over faces `0..bounds.len()` with these boxes.
    pub fn new(bounds: &[Aabb]) -> Bvh {
        let mut bvh = Bvh {
            nodes: Vec::new(),
            faces: Vec::with_capacity(bounds.len()),
        };
        let mut faces: Vec<usize> = (0..bounds.len()).collect();
        bvh.add(&mut faces, bounds);
        bvh
    }

    /// The depth of this recursion is the logarithm of the number of faces.
    fn add(&mut self, faces: &mut [usize], boxes: &[Aabb]) {
        let Some(bounds) = faces.iter().map(|&face| boxes[face]).reduce(Aabb::union) else {
            return;
        };
        let index = self.nodes.len();
        let first = self.faces.len();
        self.nodes.push(BvhNode {
            bounds,
            next: 0,
            faces: first..first,
        });
        if faces.len() <= LEAF {
            self.faces.extend_from_slice(faces);
            self.nodes[index].faces = first..self.faces.len();
        } else {
            let axis = bounds.longest_axis();
            // Ties by number, so that the order is one and the same everywhere.
            faces.sort_unstable_by(|&a, &b| {
                let middle = |face: usize| boxes[face].centre()[axis];
                middle(a).total_cmp(&middle(b)).then(a.cmp(&b))
            });
            let (left, right) = faces.split_at_mut(faces.len() / 2);
            self.add(left, boxes);
            self.add(right, boxes);
        }
        self.nodes[index].next = self.nodes.len();
    }

    /// Calls `visit` with every face that the line may cross at distances from `from` to a limit;
    /// each call returns the limit from then on.
    pub fn walk(
        &self,
        ray: &Ray,
        from: f64,
        mut limit: f64,
        mut visit: impl FnMut(usize, f64) -> f64,
    ) {
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            if !meets(&node.bounds, ray, from, limit) {
                index = node.next;
                continue;
            }
            for &face in &self.faces[node.faces.clone()] {
                limit = visit(face, limit);
            }
            index += 1;
        }
    }
}

/// Whether the ray may enter the widened box between two distances.
fn meets(bounds: &Aabb, ray: &Ray, from: f64, limit: f64) -> bool {
    let (low, high) = (bounds.min - ray.origin, bounds.max - ray.origin);
    let wider = WIDENING * low.abs().max(high.abs()).max_element();
    let (mut near, mut far) = (from, limit);
    for axis in 0..3 {
        let (low, high) = (low[axis] - wider, high[axis] + wider);
        let direction = ray.direction[axis];
        if direction == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let (first, last) = if direction > 0.0 {
            (low, high)
        } else {
            (high, low)
        };
        near = near.max(first / direction);
        far = far.min(last / direction);
    }
    near <= far
}
