//! A bounding volume hierarchy: candidates for a line among the faces of a mesh, or the surfaces of a
//! scene.
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
//!
//! Source: Wald 2007, "On fast construction of SAH-based bounding volume hierarchies", IEEE Symposium
//! on Interactive Ray Tracing, for the bins.

use super::box_test::BoxTest;
use super::{Aabb, Ray};
use arrayvec::ArrayVec;
use glam::DVec3;

/// Faces of a leaf at most, where another split costs more than it saves.
const LEAF: usize = 4;

/// Bins along an axis between which faces may be split.
const BINS: usize = 16;

/// Depth below which faces are halved by number, so that no arrangement of faces makes the tree
/// deeper than this and the logarithm of their number together.
const DEEPEST: usize = 32;

/// Nodes that may wait on the way through a tree of up to 2^31 faces: one on each of its levels, and two on the last.
const WAITING: usize = DEEPEST + 33;

/// The box around no face.
const NOTHING: Aabb = Aabb {
    min: DVec3::INFINITY,
    max: DVec3::NEG_INFINITY,
};

/// A bounding volume hierarchy: faces split in two where the surface area heuristic expects the fewest tests of a ray.
#[derive(Clone, Debug)]
pub(crate) struct Bvh {
    /// The root first; none without faces.
    nodes: Vec<Node>,
    /// Faces, with the faces of each leaf in a row.
    faces: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// The first face of a leaf, or the first of two nodes.
    first: usize,
    /// How many faces a leaf has; 0 for a node of nodes.
    faces: usize,
}

/// A way to split faces in two.
#[derive(Clone, Copy)]
struct Split {
    axis: usize,
    /// Faces in bins below this one go to the first child.
    bin: usize,
    /// Expected tests of a ray that meets the box around all of them.
    cost: f64,
}

impl Bvh {
    /// The hierarchy over faces `0..boxes.len()` with these boxes.
    pub fn new(boxes: &[Aabb]) -> Bvh {
        let mut nodes = Vec::new();
        let mut faces: Vec<usize> = (0..boxes.len()).collect();
        if !faces.is_empty() {
            nodes.push(Node::of(&faces, boxes, 0));
            divide(&mut nodes, 0, &mut faces, boxes, 0);
        }
        Bvh { nodes, faces }
    }

    /// Calls `visit` with candidates for crossings `from ≤ t ≤ limit`, nearer boxes first; it returns
    /// the new limit, which may be lower; one below `from` ends the walk.
    pub fn walk(
        &self,
        ray: &Ray,
        from: f64,
        mut limit: f64,
        mut visit: impl FnMut(usize, f64) -> f64,
    ) {
        let Some(root) = self.nodes.first() else {
            return;
        };
        let test = BoxTest::new(ray, &root.bounds);
        let mut waiting = ArrayVec::<(f64, &Node), WAITING>::new();
        waiting.push((from, root));
        while let Some((entry, &Node { first, faces, .. })) = waiting.pop() {
            let is_behind = entry > limit;
            if is_behind {
                continue;
            }
            if faces > 0 {
                for &face in &self.faces[first..first + faces] {
                    limit = visit(face, limit);
                    if limit < from {
                        return;
                    }
                }
                continue;
            }
            let mut halves = [first, first + 1].map(|half| {
                let half = &self.nodes[half];
                (test.entry(&half.bounds, from, limit), half)
            });
            if halves[0].0 < halves[1].0 {
                halves.swap(0, 1);
            }
            waiting.extend(halves.into_iter().filter(|half| half.0 < f64::INFINITY));
        }
    }
}

impl Node {
    /// A leaf of faces that begin at `first`.
    fn of(faces: &[usize], boxes: &[Aabb], first: usize) -> Node {
        Node {
            bounds: around(faces, boxes),
            first,
            faces: faces.len(),
        }
    }
}

/// Splits the node `at`, which holds `faces` as a leaf, as far as that spares tests.
fn divide(nodes: &mut Vec<Node>, at: usize, faces: &mut [usize], boxes: &[Aabb], depth: usize) {
    let Node { bounds, first, .. } = nodes[at];
    let Some(middle) = middle(faces, boxes, &bounds, depth) else {
        return;
    };
    let (low, high) = faces.split_at_mut(middle);
    let half = nodes.len();
    nodes.push(Node::of(low, boxes, first));
    nodes.push(Node::of(high, boxes, first + middle));
    (nodes[at].first, nodes[at].faces) = (half, 0);
    divide(nodes, half, low, boxes, depth + 1);
    divide(nodes, half + 1, high, boxes, depth + 1);
}

/// Sorts `faces` into two parts, and returns the number of faces in the first; none if they make a leaf.
fn middle(faces: &mut [usize], boxes: &[Aabb], bounds: &Aabb, depth: usize) -> Option<usize> {
    let split = best_split(faces, boxes, bounds).filter(|_| depth < DEEPEST);
    // Without a split, the faces of a leaf cost a test each.
    let is_leaf = split.is_none_or(|split| split.cost >= faces.len() as f64);
    if faces.len() <= LEAF && is_leaf {
        return None;
    }
    let Some(split) = split else {
        let axis = bounds.size().max_position();
        let centre = |face: usize| boxes[face].centre()[axis];
        faces.sort_unstable_by(|&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
        return Some(faces.len() / 2);
    };
    let bins = Bins::of(faces, boxes, split.axis);
    // Stable, so that the order is one and the same everywhere.
    faces.sort_by_key(|&face| bins.bin(&boxes[face]) >= split.bin);
    Some(faces.partition_point(|&face| bins.bin(&boxes[face]) < split.bin))
}

fn around(faces: &[usize], boxes: &[Aabb]) -> Aabb {
    let boxes = faces.iter().map(|&face| boxes[face]);
    boxes.fold(NOTHING, Aabb::union)
}

/// The split of `faces`, within `bounds`, that the surface area heuristic likes best; `None` if their
/// centres have no extent, or none that can be computed with.
fn best_split(faces: &[usize], boxes: &[Aabb], bounds: &Aabb) -> Option<Split> {
    let whole = half_area(bounds);
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        let bins = Bins::of(faces, boxes, axis);
        let mut held = [NOTHING; BINS];
        let mut counts = [0; BINS];
        for &face in faces {
            let bin = bins.bin(&boxes[face]);
            held[bin] = held[bin].union(boxes[face]);
            counts[bin] += 1;
        }
        // Expected tests of the faces in the bins from each on.
        let mut above = [0.0; BINS];
        let (mut bounds, mut count) = (NOTHING, 0);
        for bin in (1..BINS).rev() {
            bounds = bounds.union(held[bin]);
            count += counts[bin];
            above[bin] = tests(bounds, count);
        }
        let (mut bounds, mut count) = (NOTHING, 0);
        for bin in 1..BINS {
            bounds = bounds.union(held[bin - 1]);
            count += counts[bin - 1];
            // Two boxes are tested for a split, half of a node.
            let cost = 0.5 + (tests(bounds, count) + above[bin]) / whole;
            let divides = count > 0 && count < faces.len();
            if divides && cost < best.map_or(f64::INFINITY, |best| best.cost) {
                best = Some(Split { axis, bin, cost });
            }
        }
    }
    best
}

/// Half the area of the box around `count` faces, times their number.
fn tests(bounds: Aabb, count: usize) -> f64 {
    match count {
        0 => 0.0,
        _ => half_area(&bounds) * count as f64,
    }
}

fn half_area(bounds: &Aabb) -> f64 {
    let size = bounds.size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Equal intervals along an axis, by the centres of boxes.
struct Bins {
    axis: usize,
    low: f64,
    /// Bins per length.
    scale: f64,
}

impl Bins {
    fn of(faces: &[usize], boxes: &[Aabb], axis: usize) -> Bins {
        let centres = faces.iter().map(|&face| boxes[face].centre()[axis]);
        let (low, high) = centres
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), centre| {
                (low.min(centre), high.max(centre))
            });
        Bins {
            axis,
            low,
            scale: BINS as f64 / (high - low),
        }
    }

    /// The bin of a box. Where all centres are the same, 0 · ∞ is no number, and the bin is 0.
    fn bin(&self, bounds: &Aabb) -> usize {
        let bin = (bounds.centre()[self.axis] - self.low) * self.scale;
        (bin as usize).min(BINS - 1)
    }
}
