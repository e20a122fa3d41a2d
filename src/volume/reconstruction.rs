//! Reconstruction between the nodes: at one point, and at several.

use super::{Cell, Cells, Grid, Interpolation, Node};

/// A reconstruction of values between the nodes.
pub trait Reconstruction: Copy + Sync {
    /// The value of `grid` at the point of `cell`.
    fn read<T: Node>(self, grid: &Grid<T>, cell: &Cell) -> T::Value;

    /// The values of `grid` at the points of `cells`, each with the bits of [`Reconstruction::read`].
    #[inline(always)]
    fn read_several<const N: usize>(self, grid: &Grid<f32>, cells: &Cells<N>) -> [f64; N] {
        std::array::from_fn(|index| self.read(grid, &cells.cell(index)))
    }
}

impl Reconstruction for Interpolation {
    #[inline]
    fn read<T: Node>(self, grid: &Grid<T>, cell: &Cell) -> T::Value {
        match self {
            Interpolation::Nearest => cell.nearest(grid),
            Interpolation::Trilinear => cell.trilinear(grid),
        }
    }
}

/// Linear along each axis between the eight nodes around.
#[derive(Clone, Copy, Debug)]
pub struct Trilinear;

impl Reconstruction for Trilinear {
    #[inline(always)]
    fn read<T: Node>(self, grid: &Grid<T>, cell: &Cell) -> T::Value {
        cell.trilinear(grid)
    }

    #[inline(always)]
    fn read_several<const N: usize>(self, grid: &Grid<f32>, cells: &Cells<N>) -> [f64; N] {
        cells.trilinear(grid)
    }
}

/// The value of the nearest node.
#[derive(Clone, Copy, Debug)]
pub struct Nearest;

impl Reconstruction for Nearest {
    #[inline]
    fn read<T: Node>(self, grid: &Grid<T>, cell: &Cell) -> T::Value {
        cell.nearest(grid)
    }
}
