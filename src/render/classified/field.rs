//! The scalar field along a ray, and its reconstruction between nodes.

use crate::render::counters::{Event, Work};
use crate::volume::{Cell, Cells, Grid, Lattice, NodePoint, NodePoints, Reconstruction};
use glam::DVec3;

/// A scalar field with gradients, reconstructed from a lattice.
pub trait ScalarField: Sync {
    /// The same density everywhere.
    const IS_CONSTANT: bool = false;

    /// Location of a point in the lattice.
    type Location;

    /// Locations of several points: found once, used for densities and gradients.
    type Locations<const N: usize>;

    /// The lattice below the field.
    fn lattice(&self) -> &Lattice;

    /// The location of `point`.
    fn locate(&self, point: NodePoint) -> Self::Location;

    /// Density at a location.
    fn density<W: Work>(&self, location: &Self::Location, work: &mut W) -> f64;

    /// The locations of several points.
    fn locate_several<const N: usize>(&self, points: &NodePoints<N>) -> Self::Locations<N>;

    /// Densities at several locations, each with the bits of [`ScalarField::density`]; `count` of them
    /// are looked up for a sample.
    fn densities<const N: usize, W: Work>(
        &self,
        locations: &Self::Locations<N>,
        count: usize,
        work: &mut W,
    ) -> [f64; N];

    /// Stored gradient at one of several locations, reconstructed like the density, in the unit it is stored in.
    fn gradient<const N: usize, W: Work>(
        &self,
        gradients: &Grid<[f32; 3]>,
        locations: &Self::Locations<N>,
        index: usize,
        work: &mut W,
    ) -> DVec3;
}

/// A grid, reconstructed between its nodes.
#[derive(Clone, Copy, Debug)]
pub struct GridField<'g, R> {
    grid: &'g Grid<f32>,
    reconstruction: R,
}

impl<'g, R: Reconstruction> GridField<'g, R> {
    /// `grid`, by `reconstruction`.
    pub fn new(grid: &'g Grid<f32>, reconstruction: R) -> GridField<'g, R> {
        GridField {
            grid,
            reconstruction,
        }
    }
}

impl<R: Reconstruction> ScalarField for GridField<'_, R> {
    type Location = Cell;

    type Locations<const N: usize> = Cells<N>;

    fn lattice(&self) -> &Lattice {
        self.grid.lattice()
    }

    // Always, here and below: as calls, with a cell handed over in memory, these took a tenth of the
    // ray caster's instructions (scripts/instructions.sh).
    #[inline(always)]
    fn locate(&self, point: NodePoint) -> Cell {
        Cell::around(self.grid.lattice(), point)
    }

    #[inline(always)]
    fn density<W: Work>(&self, location: &Cell, work: &mut W) -> f64 {
        work.count(Event::DensityLookup);
        self.reconstruction.read(self.grid, location)
    }

    #[inline(always)]
    fn locate_several<const N: usize>(&self, points: &NodePoints<N>) -> Cells<N> {
        Cells::around(self.grid.lattice(), points)
    }

    #[inline(always)]
    fn densities<const N: usize, W: Work>(
        &self,
        cells: &Cells<N>,
        count: usize,
        work: &mut W,
    ) -> [f64; N] {
        work.count_times(Event::DensityLookup, count as u64);
        self.reconstruction.read_several(self.grid, cells)
    }

    // Never: compiled into the loop it takes registers from it, and shaded volumes 0.07 more time. So is the
    // cell of the sample.
    #[inline(never)]
    fn gradient<const N: usize, W: Work>(
        &self,
        gradients: &Grid<[f32; 3]>,
        cells: &Cells<N>,
        index: usize,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::GradientLookup);
        self.reconstruction.read(gradients, &cells.cell(index))
    }
}

/// A grid with the same density at every node, without lookups. Interpolation of equal numbers is
/// exact, so this is the same field to the last bit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ConstantField<'g>(pub &'g Lattice, pub f64);

impl ScalarField for ConstantField<'_> {
    const IS_CONSTANT: bool = true;

    type Location = NodePoint;

    type Locations<const N: usize> = NodePoints<N>;

    fn lattice(&self) -> &Lattice {
        self.0
    }

    fn locate(&self, point: NodePoint) -> NodePoint {
        point
    }

    fn density<W: Work>(&self, _: &NodePoint, _: &mut W) -> f64 {
        self.1
    }

    fn locate_several<const N: usize>(&self, points: &NodePoints<N>) -> NodePoints<N> {
        *points
    }

    fn densities<const N: usize, W: Work>(
        &self,
        _: &NodePoints<N>,
        _: usize,
        _: &mut W,
    ) -> [f64; N] {
        [self.1; N]
    }

    fn gradient<const N: usize, W: Work>(
        &self,
        gradients: &Grid<[f32; 3]>,
        points: &NodePoints<N>,
        index: usize,
        work: &mut W,
    ) -> DVec3 {
        work.count(Event::GradientLookup);
        let point = NodePoint(points.map(|axis| axis[index]).into());
        Cell::around(gradients.lattice(), point).trilinear(gradients)
    }
}
