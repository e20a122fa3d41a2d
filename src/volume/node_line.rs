//! A line through a lattice.

use super::{Lattice, NodePoint};
use crate::geometry::Line;
use glam::DVec3;

/// A line in node coordinates, parametrised by distance in world units.
///
/// The origin is taken relative to the first node before anything is scaled, so that a volume
/// far from the world's origin loses no digits along the line.
#[derive(Clone, Copy, Debug)]
pub struct NodeLine {
    /// The point at distance 0.
    pub origin: NodePoint,
    /// Change of the node coordinates per world unit.
    pub direction: DVec3,
}

impl NodeLine {
    /// The line of a ray over `lattice`.
    #[inline]
    pub fn new(line: impl Into<Line>, lattice: &Lattice) -> NodeLine {
        let line = line.into();
        NodeLine::from(lattice.to_nodes(line.origin), line.direction, lattice)
    }

    /// The line from `origin` along `direction`, a vector of the space in which the nodes lie, such as the world.
    #[inline]
    pub fn from(origin: NodePoint, direction: DVec3, lattice: &Lattice) -> NodeLine {
        NodeLine {
            origin,
            direction: direction / lattice.spacing(),
        }
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f64) -> NodePoint {
        NodePoint(self.origin.0 + self.direction * t)
    }

    /// Largest change of a coordinate over `length` world units.
    #[inline]
    pub fn reach(&self, length: f64) -> f64 {
        self.direction.abs().max_element() * length
    }
}
