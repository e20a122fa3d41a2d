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

use super::box_test::{BoxTest, FourBoxes};
use super::{Aabb, Ray};
use arrayvec::ArrayVec;

/// Faces of a leaf at most, where another split costs more than it saves.
const LEAF: usize = 4;

/// Bins along an axis between which faces may be split.
const BINS: usize = 16;

/// Depth below which faces are halved by number, so that no arrangement of faces makes the tree
/// deeper than this and the logarithm of their number together.
const DEEPEST: usize = 32;

/// Boxes of a node.
const WIDTH: usize = FourBoxes::COUNT;

/// Boxes that may wait on the way through a tree: all but one of a node on each of its levels, with up
/// to 2^31 faces.
const WAITING: usize = (WIDTH - 1) * (DEEPEST + 32) + 1;

/// A bounding volume hierarchy: faces split where the surface area heuristic expects the fewest
/// tests of a ray. A node holds four boxes, which are tested together.
#[derive(Clone, Debug)]
pub(crate) struct Bvh {
    /// The box around all faces.
    bounds: Option<Aabb>,
    /// The root is the first.
    nodes: Vec<Node>,
    faces: Vec<usize>,
}

#[derive(Clone, Debug, Default)]
struct Node {
    boxes: FourBoxes,
    contents: [Content; WIDTH],
}

/// The content of a box: faces, or a node.
#[derive(Clone, Copy, Debug, Default)]
struct Content {
    /// Index of the node, or of the first face in [`Bvh::faces`].
    first: u32,
    /// Number of faces; 0 for a node.
    faces: u32,
}

/// A tree that halves its faces on each level.
struct Tree {
    bounds: Aabb,
    kind: TreeKind,
}

enum TreeKind {
    Leaf(Content),
    Inner(Box<[Tree; 2]>),
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
        let mut bvh = Bvh {
            bounds: None,
            nodes: Vec::new(),
            faces: Vec::with_capacity(boxes.len()),
        };
        let mut faces: Vec<usize> = (0..boxes.len()).collect();
        if !faces.is_empty() {
            let tree = bvh.split(&mut faces, boxes, 0);
            bvh.bounds = Some(tree.bounds);
            bvh.add(tree);
        }
        bvh
    }

    /// The tree over `faces`, which it lists in its order.
    fn split(&mut self, faces: &mut [usize], boxes: &[Aabb], depth: usize) -> Tree {
        let bounds = around(faces.iter().map(|&face| boxes[face]));
        let split = best_split(faces, boxes, &bounds).filter(|_| depth < DEEPEST);
        // Without a split, the faces of a leaf cost a test each.
        let is_leaf = split.is_none_or(|split| split.cost >= faces.len() as f64);
        if faces.len() <= LEAF && is_leaf {
            let leaf = Content {
                first: number(self.faces.len()),
                faces: number(faces.len()),
            };
            self.faces.extend_from_slice(faces);
            let kind = TreeKind::Leaf(leaf);
            return Tree { bounds, kind };
        }
        let middle = match split {
            Some(split) => {
                let bins = Bins::of(faces, boxes, split.axis);
                // Stable, so that the order is one and the same everywhere.
                faces.sort_by_key(|&face| bins.bin(&boxes[face]) >= split.bin);
                faces.partition_point(|&face| bins.bin(&boxes[face]) < split.bin)
            }
            None => {
                let axis = bounds.longest_axis();
                let centre = |face: usize| boxes[face].centre()[axis];
                faces.sort_unstable_by(|&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
                faces.len() / 2
            }
        };
        let (low, high) = faces.split_at_mut(middle);
        let halves = [low, high].map(|half| self.split(half, boxes, depth + 1));
        let kind = TreeKind::Inner(Box::new(halves));
        Tree { bounds, kind }
    }

    /// Adds the nodes of `tree`; the number of the first.
    fn add(&mut self, tree: Tree) -> u32 {
        let index = self.nodes.len();
        self.nodes.push(Node::default());
        for (place, tree) in widened(tree).into_iter().enumerate() {
            self.nodes[index].boxes.set(place, &tree.bounds);
            self.nodes[index].contents[place] = match tree.kind {
                TreeKind::Leaf(faces) => faces,
                TreeKind::Inner(_) => Content {
                    first: self.add(tree),
                    faces: 0,
                },
            };
        }
        number(index)
    }

    /// Calls `visit` with candidates for crossings `from ≤ t`, in no particular order: quicker than
    /// [`walk`](Bvh::walk), whose boxes wait in order.
    pub(crate) fn walk_all(&self, ray: &Ray, from: f64, mut visit: impl FnMut(usize)) {
        let Some(bounds) = &self.bounds else {
            return;
        };
        let test = BoxTest::new(ray, bounds);
        let mut waiting = [Content::default(); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let Content { first, faces } = waiting[count];
            let (first, faces) = (first as usize, faces as usize);
            if faces > 0 {
                let faces = self.faces[first..first + faces].iter();
                faces.for_each(|&face| visit(face));
                continue;
            }
            let node = &self.nodes[first];
            let entries = test.entries(&node.boxes, from, f64::INFINITY);
            // Written whether it is met or not: a branch on what is close to chance would be
            // mispredicted.
            for (entry, &content) in entries.into_iter().zip(&node.contents) {
                waiting[count] = content;
                count += usize::from(entry < f64::INFINITY);
            }
        }
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
        let Some(bounds) = &self.bounds else {
            return;
        };
        let test = BoxTest::new(ray, bounds);
        let mut waiting = ArrayVec::<(f64, Content), WAITING>::new();
        waiting.push((from, Content::default()));
        while let Some((entry, content)) = waiting.pop() {
            let is_behind = entry > limit;
            if is_behind {
                continue;
            }
            let (first, faces) = (content.first as usize, content.faces as usize);
            if faces > 0 {
                for &face in &self.faces[first..first + faces] {
                    limit = visit(face, limit);
                    if limit < from {
                        return;
                    }
                }
                continue;
            }
            let node = &self.nodes[first];
            let entries = test.entries(&node.boxes, from, limit);
            let bottom = waiting.len();
            for (entry, &content) in entries.into_iter().zip(&node.contents) {
                if entry == f64::INFINITY {
                    continue;
                }
                waiting.push((entry, content));
                // The nearest box comes on top.
                let pushed = &mut waiting[bottom..];
                let mut place = pushed.len() - 1;
                while place > 0 && pushed[place - 1].0 < entry {
                    pushed.swap(place - 1, place);
                    place -= 1;
                }
            }
        }
    }
}

/// A number of faces or nodes; more than 2^32 are in no memory.
fn number(count: usize) -> u32 {
    u32::try_from(count).expect("fewer than 2^32 faces")
}

/// Up to four parts of `tree`. The largest box, which rays meet most often, is the first to be
/// replaced by its halves.
fn widened(tree: Tree) -> ArrayVec<Tree, WIDTH> {
    let mut parts = ArrayVec::from_iter([tree]);
    while !parts.is_full() {
        let inner = (0..parts.len()).filter(|&it| matches!(parts[it].kind, TreeKind::Inner(_)));
        let area = |&it: &usize| half_area(&parts[it].bounds);
        let largest = inner.max_by(|a, b| area(a).total_cmp(&area(b)));
        let Some(TreeKind::Inner(halves)) = largest.map(|it| parts.remove(it).kind) else {
            break;
        };
        parts.extend(*halves);
    }
    parts
}

/// The split of `faces`, within `bounds`, that the surface area heuristic likes best; `None` if their
/// centres have no extent, or none that can be computed with.
fn best_split(faces: &[usize], boxes: &[Aabb], bounds: &Aabb) -> Option<Split> {
    let whole = half_area(bounds);
    let mut best: Option<Split> = None;
    for axis in 0..3 {
        let bins = Bins::of(faces, boxes, axis);
        let mut held: [Option<Aabb>; BINS] = [None; BINS];
        let mut counts = [0; BINS];
        for &face in faces {
            let bin = bins.bin(&boxes[face]);
            held[bin] = join(held[bin], Some(boxes[face]));
            counts[bin] += 1;
        }
        // Expected tests of the faces in the bins from each on.
        let mut above = [0.0; BINS];
        let (mut bounds, mut count) = (None, 0);
        for bin in (1..BINS).rev() {
            bounds = join(bounds, held[bin]);
            count += counts[bin];
            above[bin] = tests(bounds, count);
        }
        let (mut bounds, mut count) = (None, 0);
        for bin in 1..BINS {
            bounds = join(bounds, held[bin - 1]);
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
fn tests(bounds: Option<Aabb>, count: usize) -> f64 {
    bounds.map_or(0.0, |bounds| half_area(&bounds) * count as f64)
}

fn half_area(bounds: &Aabb) -> f64 {
    let size = bounds.size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

fn join(a: Option<Aabb>, b: Option<Aabb>) -> Option<Aabb> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        _ => a.or(b),
    }
}

fn around(boxes: impl Iterator<Item = Aabb>) -> Aabb {
    boxes.reduce(Aabb::union).expect("a node has faces")
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

    /// The bin of a box; what is no number, where all centres are the same, in bin 0.
    fn bin(&self, bounds: &Aabb) -> usize {
        let bin = (bounds.centre()[self.axis] - self.low) * self.scale;
        (bin as usize).min(BINS - 1)
    }
}
