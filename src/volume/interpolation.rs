//! Interpolation between the nodes: nearest and trilinear.
//!
//! A lookup has two halves: finding the [`Cell`] around a point, and reading a grid there.
//! Density and gradient at one point share the first half.

use super::{Grid, Lattice, NodePoint};
use glam::DVec3;
use std::ops::{Add, Mul, Sub};

/// Interpolation between the nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Value of the nearest node.
    Nearest,
    /// Linear along each axis between the eight nodes around.
    Trilinear,
}

impl Interpolation {
    /// The value of `grid` at the point of `cell`.
    #[inline]
    pub fn read<T: Node>(self, grid: &Grid<T>, cell: &Cell) -> T::Value {
        match self {
            Interpolation::Nearest => cell.nearest(grid),
            Interpolation::Trilinear => cell.trilinear(grid),
        }
    }
}

/// A type stored at nodes, and its type in arithmetic.
pub trait Node: Copy {
    /// `f64` for a scalar field, `DVec3` for a vector field.
    type Value: Lerp;

    /// The stored number in working precision.
    fn value(self) -> Self::Value;
}

/// A floating-point type for the storage of a grid.
pub trait Scalar: Node<Value = f64> + Into<f64> + Send + Sync {
    /// The nearest number of this type.
    fn rounded(value: f64) -> Self;
}

impl Node for f32 {
    type Value = f64;
    fn value(self) -> f64 {
        self.into()
    }
}

impl Scalar for f32 {
    fn rounded(value: f64) -> f32 {
        value as f32
    }
}

impl Node for f64 {
    type Value = f64;
    fn value(self) -> f64 {
        self
    }
}

impl Scalar for f64 {
    fn rounded(value: f64) -> f64 {
        value
    }
}

impl<T: Copy + Into<f64>> Node for [T; 3] {
    type Value = DVec3;
    fn value(self) -> DVec3 {
        DVec3::from_array(self.map(Into::into))
    }
}

/// Values with linear interpolation.
pub trait Lerp: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self> {
    /// `a + (b − a)·t`: exactly `a` at `t = 0`, and exactly `a` for every `t` where `a = b`, so
    /// a constant grid is a constant field to the last bit.
    fn lerp_between(a: Self, b: Self, t: f64) -> Self {
        a + (b - a) * t
    }
}

impl Lerp for f64 {}
impl Lerp for DVec3 {}

/// The eight nodes around a point, and its position between them.
///
/// Beyond the first and last node of an axis the index is clamped, not the position: there, and
/// on the last node itself, both neighbours are the same node and the value is exactly its own.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    /// Index of the node with the smallest coordinates.
    pub(super) low: usize,
    /// Distance in the array to the neighbour along each axis (0 where clamped).
    pub(super) step: [usize; 3],
    /// Position between the two nodes of each axis.
    pub(super) t: DVec3,
}

impl Cell {
    /// The cell of `lattice` around any finite `point`.
    // Always: a call hands the cell over in memory.
    #[inline(always)]
    pub fn around(lattice: &Lattice, NodePoint(point): NodePoint) -> Cell {
        let nodes = lattice.nodes();
        let strides = [1, nodes[0], nodes[0] * nodes[1]];
        // Between nodes along all axes, as most points are: the same, without the clamps.
        if point.cmpge(DVec3::ZERO).all() && point.cmplt(lattice.last_node()).all() {
            let [x, y, z] = point.to_array().map(|position| position as u32);
            let floor = DVec3::new(x.into(), y.into(), z.into());
            return Cell {
                low: x as usize + y as usize * strides[1] + z as usize * strides[2],
                step: strides,
                t: point - floor,
            };
        }
        let mut cell = Cell {
            low: 0,
            step: [0; 3],
            t: DVec3::ZERO,
        };
        for axis in 0..3 {
            let floor = floor(point[axis]);
            let last = nodes[axis] as i64 - 1;
            cell.low += floor.clamp(0, last) as usize * strides[axis];
            let between = floor >= 0 && floor < last;
            cell.step[axis] = if between { strides[axis] } else { 0 };
            cell.t[axis] = point[axis] - floor as f64;
        }
        cell
    }

    /// The trilinear interpolant of the eight nodes: along x, then y, then z.
    // Always, here and below: as a call it took a fifth of the time of a volume shadow.
    #[inline(always)]
    pub fn trilinear<T: Node>(&self, grid: &Grid<T>) -> T::Value {
        let near = self.bilinear(grid, self.low);
        let far = self.bilinear(grid, self.low + self.step[2]);
        T::Value::lerp_between(near, far, self.t.z)
    }

    /// The interpolant of the four nodes from `low` along x, then y.
    #[inline(always)]
    fn bilinear<T: Node>(&self, grid: &Grid<T>, low: usize) -> T::Value {
        let near = self.linear(grid, low);
        let far = self.linear(grid, low + self.step[1]);
        T::Value::lerp_between(near, far, self.t.y)
    }

    /// The interpolant of the two nodes from `low` along x.
    #[inline(always)]
    fn linear<T: Node>(&self, grid: &Grid<T>, low: usize) -> T::Value {
        let nodes = grid.values();
        let (near, far) = (nodes[low].value(), nodes[low + self.step[0]].value());
        T::Value::lerp_between(near, far, self.t.x)
    }

    /// The trilinear interpolant on a line through the point of this cell: the coefficients of 1, u,
    /// u² and u³ at `u · change` from it, in node coordinates.
    pub fn cubic(&self, grid: &Grid<f32>, change: DVec3) -> [f64; 4] {
        // `a + (b − a)·t` of two polynomials, where `t` is linear, too.
        let between = |a: [f64; 4], b: [f64; 4], axis: usize| {
            let difference = [0, 1, 2, 3].map(|power| b[power] - a[power]);
            let mut result = [0.0; 4];
            for power in 0..4 {
                result[power] = a[power] + difference[power] * self.t[axis];
                if power > 0 {
                    result[power] += difference[power - 1] * change[axis];
                }
            }
            result
        };
        let [dx, dy, dz] = self.step;
        let node = |index: usize| [grid.values()[index].value(), 0.0, 0.0, 0.0];
        let along_x = |row: usize| between(node(row), node(row + dx), 0);
        let along_y = |plane: usize| between(along_x(plane), along_x(plane + dy), 1);
        between(along_y(self.low), along_y(self.low + dz), 2)
    }

    /// The value of the nearest node; halfway between two, the one with the larger index.
    #[inline]
    pub fn nearest<T: Node>(&self, grid: &Grid<T>) -> T::Value {
        let mut index = self.low;
        for axis in 0..3 {
            if self.t[axis] >= 0.5 {
                index += self.step[axis];
            }
        }
        grid.values()[index].value()
    }
}

/// `⌊x⌋`, saturating far outside any grid. A cast and a comparison: `f64::floor` is a function
/// call on processors whose baseline lacks the instruction.
#[inline]
fn floor(x: f64) -> i64 {
    let truncated = x as i64;
    truncated.saturating_sub(i64::from(x < truncated as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_far_outside_take_the_nearest_node() {
        let lattice = Lattice::new([2, 3, 1], DVec3::ONE, DVec3::ZERO).unwrap();
        let grid = Grid::new(lattice, vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
        for far in [2.0, 1e10, 1e19, 1e300, f64::MAX] {
            for (point, value) in [
                (DVec3::new(-far, -far, -far), 1.0),
                (DVec3::new(far, -far, far), 2.0),
                (DVec3::new(-far, far, -far), 5.0),
                (DVec3::new(far, far, far), 6.0),
            ] {
                let cell = Cell::around(&lattice, NodePoint(point));
                assert_eq!(cell.trilinear(&grid), value, "{point}");
                assert_eq!(cell.nearest(&grid), value, "{point}");
            }
        }
    }
}
