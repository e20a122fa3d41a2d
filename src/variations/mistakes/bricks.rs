//! Mistakes in volumes that are stored in bricks, or as an atlas of their slices.
//!
//! Bricks have 8 to 128 nodes to an edge: brick m holds nodes n·m to n·m + n − 1 along each axis.

use super::grids::{GridValues, rearranged};
use super::{Edit, Mistake, makes};
use crate::scene::{Classified, Fault};
use crate::volume::{Grid, Interpolation, Lattice};
use std::sync::Arc;

macro_rules! of_bricks {
    ($($edge:literal)+) => { mistakes! {
        $(
        concat!("brick-borders-doubled-", $edge) => Grid(|grid| doubled(grid, $edge)),
            concat!("the volume is stored in bricks of ", $edge, " nodes, and the last layer of each is there twice: a layer that two bricks share counts once in the position of what follows");
        concat!("brick-borders-dropped-", $edge) => Grid(|grid| dropped(grid, $edge)),
            concat!("the volume is stored in bricks of ", $edge, " nodes, and a layer between any two is missing: bricks follow each other without a gap");
        concat!("brick-borders-clamped-", $edge) => Classified(|scene| clamped(scene, $edge)),
            concat!("the volume is stored in bricks of ", $edge, " nodes, and values are not interpolated across their borders: a brick needs the first layer of the next");
        concat!("samples-counted-from-bricks-of-", $edge) => Classified(|scene| {
            makes(scene, !scene.continuous && has_borders(scene.grid.lattice(), $edge), Fault::StepsFromBricks($edge))
        }),
            concat!("samples are counted anew from the face of each brick of ", $edge, " cells: continue the steps of the ray across bricks, from where it enters the volume");
        )+
        "atlas-width-wrong" => Grid(of_a_wrong_atlas),
            "slices of the volume are taken from the wrong places of their atlas: of an atlas of nx by ny slices, slice k is in column k mod nx and row floor(k / nx), not floor(k / ny); a square one hides it";
    } };
}

pub(super) const MISTAKES: &[Mistake] = of_bricks!(8 16 32 64 128);

/// True if bricks of so many nodes to an edge have borders within the volume.
fn has_borders(lattice: &Lattice, edge: usize) -> bool {
    lattice.nodes().iter().any(|&count| count > edge)
}

/// Each layer before a border twice.
fn doubled(grid: &GridValues, edge: usize) -> Option<GridValues> {
    by_layers(grid, edge, |index, _| index - index / edge)
}

/// A layer at each border left out; beyond the last that there is, it is repeated.
fn dropped(grid: &GridValues, edge: usize) -> Option<GridValues> {
    by_layers(grid, edge, |index, last| (index + index / edge).min(last))
}

/// The layer of each index along any axis is that of another.
fn by_layers(
    grid: &GridValues,
    edge: usize,
    source: impl Fn(usize, usize) -> usize,
) -> Option<GridValues> {
    let lattice = grid.lattice();
    let nodes = lattice.nodes();
    let moved = |node: [usize; 3]| [0, 1, 2].map(|axis| source(node[axis], nodes[axis] - 1));
    has_borders(lattice, edge).then_some(())?;
    rearranged(grid, |node| lattice.index(moved(node)))
}

fn clamped(scene: &mut Classified, edge: u32) -> bool {
    let occurs = !scene.continuous
        && scene.interpolation == Interpolation::Trilinear
        && has_borders(scene.grid.lattice(), edge as usize);
    makes(scene, occurs, Fault::BricksWithoutNeighbours(edge))
}

/// The slices of an atlas whose rows are counted by their own number, as deep as the atlas is wide in
/// powers of two; what lies beyond the last slice is empty.
fn of_a_wrong_atlas(grid: &GridValues) -> Option<GridValues> {
    let (lattice, values) = (*grid.lattice(), grid.values());
    let [nx, ny, nz] = lattice.nodes();
    let columns = (0..32)
        .map(|bits| 1_usize << bits)
        .find(|columns| columns * columns >= nz)?;
    let rows = nz.div_ceil(columns);
    if rows == columns {
        return None;
    }
    let plane = nx * ny;
    let slices = (0..nz).flat_map(|k| {
        let read = k % columns + columns * (k / rows % rows);
        let slice = values.get(read * plane..(read + 1) * plane);
        (0..plane).map(move |index| slice.map_or(0.0, |slice| slice[index]))
    });
    let moved = Grid::new(lattice, slices.collect()).ok()?;
    (moved.values() != values).then(|| Arc::new(moved))
}
