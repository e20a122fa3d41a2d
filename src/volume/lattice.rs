//! Positions of the nodes of a grid in the world.

use crate::geometry::{Aabb, InvalidParameter, require, require_finite};
use glam::DVec3;
use serde::Deserialize;

/// A point in node coordinates of a lattice: node (i, j, k) lies at (i, j, k). World points are plain
/// vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodePoint(pub DVec3);

/// A box of regularly spaced nodes, x fastest.
///
/// [Node-centred](Centring::Nodes) by default: the first and last node of an axis lie on the faces
/// of the box. An axis with a single node is a slab one spacing thick, centred on it, along which
/// the field is constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    nodes: [usize; 3],
    spacing: DVec3,
    first: DVec3,
    centring: Centring,
    /// Position of the last node, in nodes.
    last: DVec3,
}

/// Position of the faces of the box.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Centring {
    /// On the first and last node of an axis: values are samples at points.
    #[default]
    Nodes,
    /// Half a spacing beyond them: each value is at the centre of its own cell. Between the
    /// outermost nodes and the faces the field is constant along the normal.
    Cells,
}

impl Lattice {
    /// Largest number of nodes accepted: 2³¹, 8 GiB as `f32`.
    pub const MOST_NODES: usize = 1 << 31;

    /// A lattice of `nodes` (x, y, z), `spacing` apart in world units, the first at `first`.
    pub fn new(
        nodes: [usize; 3],
        spacing: DVec3,
        first: DVec3,
    ) -> Result<Lattice, InvalidParameter> {
        Lattice::check_count(nodes.map(|count| count as u64))?;
        Lattice::check_spacing(spacing)?;
        require_finite("origin", "the position of the first node", first)?;
        let lattice = Lattice {
            nodes,
            spacing,
            first,
            centring: Centring::Nodes,
            last: DVec3::from_array(nodes.map(|count| (count - 1) as f64)),
        };
        lattice.with_centring(Centring::Nodes)
    }

    /// Checks that a lattice may have this many nodes (x, y, z), given in files by numbers that may
    /// exceed those of this machine.
    pub(super) fn check_count(nodes: [u64; 3]) -> Result<(), InvalidParameter> {
        const MOST: u64 = Lattice::MOST_NODES as u64;
        let [nx, ny, nz] = nodes;
        let what = match nx.checked_mul(ny).and_then(|plane| plane.checked_mul(nz)) {
            Some(1..=MOST) => return Ok(()),
            Some(0) => "has no node",
            _ => "is too large: at most 2³¹ nodes are accepted",
        };
        let message = format!("a grid of {nx} × {ny} × {nz} nodes {what}");
        Err(InvalidParameter::new("nodes", message))
    }

    /// Refuses a spacing that is zero, negative, not finite, or so small that its inverse is not.
    pub(crate) fn check_spacing(spacing: DVec3) -> Result<(), InvalidParameter> {
        let usable = |spacing: f64| spacing.is_normal() && spacing > 0.0;
        let message = format_args!(
            "the node spacing must be positive and finite on every axis, and not below 2.3e-308, got {spacing}"
        );
        require(
            spacing.to_array().into_iter().all(usable),
            "spacing",
            message,
        )
    }

    /// The same nodes, with the faces of the box by `centring`.
    pub fn with_centring(self, centring: Centring) -> Result<Lattice, InvalidParameter> {
        let lattice = Lattice { centring, ..self };
        let bounds = lattice.bounds();
        let [nx, ny, nz] = self.nodes;
        let message = format_args!(
            "a grid of {nx} × {ny} × {nz} nodes with this spacing and first node reaches beyond the \
             largest number: scale it down"
        );
        let fits = bounds.min.is_finite() && bounds.size().is_finite();
        require(fits, "spacing", message)?;
        Ok(lattice)
    }

    /// Position of the faces of the box.
    pub fn centring(&self) -> Centring {
        self.centring
    }

    /// Number of nodes along x, y and z, each at least 1.
    #[inline]
    pub fn nodes(&self) -> [usize; 3] {
        self.nodes
    }

    /// Position of the last node, in node units; the first is at 0.
    #[inline]
    pub(crate) fn last_node(&self) -> DVec3 {
        self.last
    }

    /// Number of nodes in all.
    pub fn node_count(&self) -> usize {
        self.nodes.iter().product()
    }

    /// Distance between neighbouring nodes along x, y and z, world units.
    pub fn spacing(&self) -> DVec3 {
        self.spacing
    }

    /// The length called *one voxel*: the smallest of the three spacings, world units.
    pub fn voxel(&self) -> f64 {
        self.spacing.min_element()
    }

    /// World position of the first node.
    pub fn first(&self) -> DVec3 {
        self.first
    }

    /// World position of node (i, j, k).
    pub fn position(&self, [i, j, k]: [usize; 3]) -> DVec3 {
        self.first + DVec3::new(i as f64, j as f64, k as f64) * self.spacing
    }

    /// Index of node (i, j, k) in x-fastest order.
    pub fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.nodes[1] + j) * self.nodes[0] + i
    }

    /// The node (i, j, k) behind an index in x-fastest order.
    pub fn node(&self, index: usize) -> [usize; 3] {
        let [nx, ny, _] = self.nodes;
        [index % nx, index / nx % ny, index / (nx * ny)]
    }

    /// Node coordinates of a world point.
    #[inline]
    pub fn to_nodes(&self, point: DVec3) -> NodePoint {
        NodePoint((point - self.first) / self.spacing)
    }

    /// The world box the field fills.
    pub fn bounds(&self) -> Aabb {
        let last = self.position(self.nodes.map(|n| n - 1));
        let mut bounds = Aabb {
            min: self.first,
            max: last,
        };
        for axis in 0..3 {
            if self.nodes[axis] == 1 || self.centring == Centring::Cells {
                bounds.min[axis] -= 0.5 * self.spacing[axis];
                bounds.max[axis] += 0.5 * self.spacing[axis];
            }
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_lattices_are_refused() {
        let refused = |nodes, spacing, first| {
            Lattice::new(nodes, DVec3::splat(spacing), DVec3::splat(first)).unwrap_err()
        };
        for nodes in [
            [0, 2, 2],
            [1 << (usize::BITS - 4), 1 << 20, 1],
            [usize::MAX, 3, 3],
        ] {
            assert_eq!(refused(nodes, 1.0, 0.0).name, "nodes");
        }
        for spacing in [0.0, -1.0, 1e-310, f64::NAN, f64::INFINITY] {
            assert_eq!(refused([2, 2, 2], spacing, 0.0).name, "spacing");
        }
        for first in [0.0, -1e308, 1e308] {
            let error = refused([3, 1, 1], 1e308, first);
            assert!(error.message.contains("beyond the largest number"));
        }
    }

    #[test]
    fn index_and_node_are_inverse() {
        let lattice = Lattice::new([3, 4, 5], DVec3::ONE, DVec3::ZERO).unwrap();
        for index in 0..lattice.node_count() {
            assert_eq!(lattice.index(lattice.node(index)), index);
        }
        assert_eq!(lattice.index([1, 0, 0]), 1);
    }

    #[test]
    fn cells_reach_half_a_spacing_beyond_their_nodes() {
        let spacing = DVec3::new(1.0, 2.0, 4.0);
        let lattice = Lattice::new([3, 2, 1], spacing, DVec3::ZERO).unwrap();
        let cells = lattice.with_centring(Centring::Cells).unwrap();
        assert_eq!(cells.bounds().min, DVec3::new(-0.5, -1.0, -2.0));
        assert_eq!(cells.bounds().max, DVec3::new(2.5, 3.0, 2.0));
        assert_eq!(cells.with_centring(Centring::Nodes), Ok(lattice));
    }

    #[test]
    fn one_node_is_a_slab_one_spacing_thick() {
        let lattice = Lattice::new([3, 1, 2], DVec3::new(1.0, 2.0, 4.0), DVec3::ZERO).unwrap();
        assert_eq!(lattice.bounds().min, DVec3::new(0.0, -1.0, 0.0));
        assert_eq!(lattice.bounds().max, DVec3::new(2.0, 1.0, 4.0));
    }
}
