//! Mistakes about the grid: where its values lie, and in which order they are stored.
//!
//! Mistakes that media can have, too, are there twice: "volume-…" and "grid-…".

use super::{Edit, Mistake};
use crate::volume::{Centring, Grid, Lattice};
use glam::DVec3;
use std::sync::Arc;

/// Mistakes of all grids; half a voxel along one axis by axis, suffix, side and direction.
macro_rules! of_grids {
    ($grid:literal, $kind:ident) => {
        of_grids!(
            $grid, $kind, "x" "" "larger" X, "x" "-back" "smaller" NEG_X, "y" "" "larger" Y,
            "y" "-back" "smaller" NEG_Y, "z" "" "larger" Z, "z" "-back" "smaller" NEG_Z
        )
    };
    ($grid:literal, $kind:ident, $($axis:literal $suffix:literal $side:literal $direction:ident),+) => { mistakes! {
        concat!($grid, "-half-voxel-off") => $kind(|grid| moved_by_voxels(grid, DVec3::splat(0.5))),
            concat!("the ", $grid, " is half a voxel off, towards larger coordinates: values belong to nodes, the first of which lies at the corner of the box");
        concat!($grid, "-half-voxel-back") => $kind(|grid| moved_by_voxels(grid, DVec3::splat(-0.5))),
            concat!("the ", $grid, " is half a voxel off, towards smaller coordinates: values belong to nodes, the first of which lies at the corner of the box");
        $(
        concat!($grid, "-half-voxel", $suffix, "-along-", $axis) => $kind(|grid| moved_by_voxels(grid, DVec3::$direction * 0.5)),
            concat!("the ", $grid, " is half a voxel off along ", $axis, " alone, towards ", $side, " coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?");
        )+
        concat!($grid, "-cells-for-nodes") => $kind(cells_for_nodes),
            concat!("the values of the ", $grid, " are placed at the centres of cells, as in textures: the outermost lie on the faces of the box");
        concat!($grid, "-axes-exchanged") => $kind(x_and_z_exchanged),
            concat!("x and z of the ", $grid, " are swapped: x runs fastest in memory, at index x + nx (y + ny z)");
        concat!($grid, "-x-and-y-exchanged") => $kind(x_and_y_exchanged),
            concat!("x and y of the ", $grid, " are swapped: x runs fastest in memory, at index x + nx (y + ny z)");
        concat!($grid, "-y-and-z-exchanged") => $kind(y_and_z_exchanged),
            concat!("y and z of the ", $grid, " are swapped: x runs fastest in memory, at index x + nx (y + ny z)");
        concat!($grid, "-rows-of-another-length") => $kind(rows_as_long_as_columns),
            concat!("rows of the ", $grid, " are taken for as long as its columns: the index is x + nx (y + ny z), with nx where y is multiplied, not ny");
        concat!($grid, "-upside-down") => $kind(|grid| reversed_along(grid, 1)),
            concat!("the ", $grid, " is upside down: y must grow upwards");
        concat!($grid, "-reversed-along-x") => $kind(|grid| reversed_along(grid, 0)),
            concat!("the ", $grid, " is mirrored along its own x: values are stored from the first node on, in the direction of the axis");
        concat!($grid, "-reversed-along-z") => $kind(|grid| reversed_along(grid, 2)),
            concat!("the ", $grid, " is mirrored along its own z: slices are stored from the first node on, in the direction of the axis");
    } };
}

/// Mistakes of classified volumes and of media.
pub(super) const OF_VOLUMES: &[Mistake] = of_grids!("volume", Grid);
pub(super) const OF_MEDIA: &[Mistake] = of_grids!("grid", MediumGrids);

/// Mistakes of classified volumes alone.
pub(super) const OF_VOLUMES_ALONE: &[Mistake] = mistakes! {
    "voxels-taken-for-cubes" => Grid(as_cubes),
        "voxels are cubes: the spacing along each axis is that of the file";
    "last-slices-missing" => Grid(|grid| part(grid, [0; 3], [1; 3])),
        "the last slice along each axis is missing: n nodes have n - 1 cells between them, and all are seen";
    "last-slice-missing-along-z" => Grid(|grid| part(grid, [0; 3], [0, 0, 1])),
        "the last slice along z is missing: n nodes have n - 1 cells between them, and all are seen";
    "outermost-slices-missing" => Grid(|grid| part(grid, [1; 3], [1; 3])),
        "the first and the last slice along each axis are missing: the volume ends at its outermost nodes";
    "volume-transposed" => Grid(transposed),
        "coordinates between 0 and 1 are given in the order x, y, z to an array whose axes are z, y, x: the volume is turned over, and stretched to its box";
    "volume-indices-reversed" => Grid(indices_reversed),
        "indices of nodes are given in the order x, y, z to an array whose axes are z, y, x, and clamped to its ends: it is array[z, y, x]";
    "signed-read-as-unsigned" => Grid(signed_as_unsigned),
        "values below 0 are read as large ones: they are stored as signed numbers, and read as unsigned ones of as many bits";
    "low-byte-left-out" => Grid(without_low_byte),
        "of values of 16 bits the lower 8 are left out, so that values are in steps of 256: keep 16 bits, or scale the range of the volume to 8";
};

/// A grid as scenes share it.
pub(super) type GridValues = Arc<Grid<f32>>;

/// In place of where they are, so many voxels further.
fn moved_by_voxels(grid: &GridValues, voxels: DVec3) -> Option<GridValues> {
    let old = grid.lattice();
    let first = old.first() + old.spacing() * voxels;
    placed(grid, old.spacing(), first, old.centring())
}

/// In the same box, but each value in the middle of a cell of its own.
fn cells_for_nodes(grid: &GridValues) -> Option<GridValues> {
    let old = grid.lattice();
    let bounds = old.bounds();
    let counts = DVec3::from_array(old.nodes().map(|count| count as f64));
    let spacing = bounds.size() / counts;
    (old.centring() != Centring::Cells).then_some(())?;
    placed(grid, spacing, bounds.min + spacing * 0.5, Centring::Cells)
}

/// Every spacing is the shortest, about the same centre.
fn as_cubes(grid: &GridValues) -> Option<GridValues> {
    let old = grid.lattice();
    let spacing = DVec3::splat(old.voxel());
    let middle = old.bounds().centre();
    let steps = DVec3::from_array(old.nodes().map(|count| (count - 1) as f64));
    (spacing != old.spacing()).then_some(())?;
    placed(
        grid,
        spacing,
        middle - 0.5 * steps * spacing,
        old.centring(),
    )
}

/// The values with this spacing from this place on.
fn placed(
    grid: &GridValues,
    spacing: DVec3,
    first: DVec3,
    centring: Centring,
) -> Option<GridValues> {
    let lattice = Lattice::new(grid.lattice().nodes(), spacing, first).ok()?;
    on(
        lattice.with_centring(centring).ok()?,
        grid.values().to_vec(),
    )
}

/// Without so many of the first and of the last layers along each axis that has more.
fn part(grid: &GridValues, first: [usize; 3], last: [usize; 3]) -> Option<GridValues> {
    let old = grid.lattice();
    let nodes = old.nodes();
    let left = [0, 1, 2].map(|axis| nodes[axis].saturating_sub(first[axis] + last[axis]));
    left.iter().all(|&count| count > 1).then_some(())?;
    let lattice = Lattice::new(left, old.spacing(), old.position(first)).ok()?;
    let lattice = lattice.with_centring(old.centring()).ok()?;
    read_from(grid, lattice, |[i, j, k]| {
        old.index([i + first[0], j + first[1], k + first[2]])
    })
}

/// These values at the nodes of a lattice.
fn on(lattice: Lattice, values: Vec<f32>) -> Option<GridValues> {
    Grid::new(lattice, values).ok().map(Arc::new)
}

/// Read as though z ran fastest; nothing of a grid that is no cube of nodes is left in its place,
/// so that of any other size is read with the sizes exchanged too.
fn x_and_z_exchanged(grid: &GridValues) -> Option<GridValues> {
    let [_, ny, nz] = grid.lattice().nodes();
    rearranged(grid, |[i, j, k]| k + nz * (j + ny * i))
}

/// Read as though y ran fastest.
fn x_and_y_exchanged(grid: &GridValues) -> Option<GridValues> {
    let [nx, ny, _] = grid.lattice().nodes();
    rearranged(grid, |[i, j, k]| j + ny * (i + nx * k))
}

/// Read as though z ran faster than y.
fn y_and_z_exchanged(grid: &GridValues) -> Option<GridValues> {
    let [nx, _, nz] = grid.lattice().nodes();
    rearranged(grid, |[i, j, k]| i + nx * (k + nz * j))
}

/// Read with the number of nodes along y as the length of a row; nothing of a grid with as many along x.
fn rows_as_long_as_columns(grid: &GridValues) -> Option<GridValues> {
    let [nx, ny, _] = grid.lattice().nodes();
    let count = grid.values().len();
    (nx != ny).then_some(())?;
    rearranged(grid, |[i, j, k]| (i + ny * j + nx * ny * k) % count)
}

/// Whole numbers, some below 0, of the fewest bits that hold them: 8, 16 or 32.
fn signed_as_unsigned(grid: &GridValues) -> Option<GridValues> {
    let (low, high) = whole_range(grid)?;
    let holds = |bits: i32| low >= -exp2(bits - 1) && high < exp2(bits - 1);
    let bits = [8, 16, 32].into_iter().find(|&bits| holds(bits))?;
    let past = exp2(bits) as f32;
    let unsigned = |value| if value < 0.0 { value + past } else { value };
    (low < 0.0).then(|| mapped(grid, unsigned)).flatten()
}

/// Whole numbers of 16 bits, some of more than 8.
fn without_low_byte(grid: &GridValues) -> Option<GridValues> {
    let (low, high) = whole_range(grid)?;
    let are_of_two_bytes = low >= 0.0 && (256.0..65536.0).contains(&high);
    let high_byte = |value: f32| (value / 256.0).floor() * 256.0;
    let lost = are_of_two_bytes.then(|| mapped(grid, high_byte)).flatten();
    lost.filter(|lost| lost.values() != grid.values())
}

/// The range of values that are whole numbers.
fn whole_range(grid: &GridValues) -> Option<(f64, f64)> {
    let are_whole = grid.values().iter().all(|value| value.fract() == 0.0);
    are_whole.then(|| grid.range())
}

/// A power of two.
fn exp2(bits: i32) -> f64 {
    (1_u64 << bits) as f64
}

/// Nodes in the reverse order along an axis.
fn reversed_along(grid: &GridValues, axis: usize) -> Option<GridValues> {
    let lattice = grid.lattice();
    rearranged(grid, |mut node| {
        node[axis] = lattice.nodes()[axis] - 1 - node[axis];
        lattice.index(node)
    })
}

/// In the same box, x and z exchanged with their counts of nodes; nothing of a grid with as many along both, where it
/// is [`x_and_z_exchanged`].
fn transposed(grid: &GridValues) -> Option<GridValues> {
    let old = grid.lattice();
    let ([nx, ny, nz], bounds) = (old.nodes(), old.bounds());
    let nodes = [nz, ny, nx];
    let (ends, first) = match old.centring() {
        Centring::Nodes => (1, 0.0),
        Centring::Cells => (0, 0.5),
    };
    let cells = nodes.map(|count| (count - ends) as f64);
    let spacing = bounds.size() / DVec3::from_array(cells);
    let lattice = Lattice::new(nodes, spacing, bounds.min + spacing * first).ok()?;
    let lattice = lattice.with_centring(old.centring()).ok()?;
    (nx != nz).then_some(())?;
    read_from(grid, lattice, |[i, j, k]| old.index([k, j, i]))
}

/// The node of x and z exchanged, clamped to the grid; nothing of a grid with as many nodes along both.
fn indices_reversed(grid: &GridValues) -> Option<GridValues> {
    let lattice = grid.lattice();
    let [nx, _, nz] = lattice.nodes();
    let exchanged = |[i, j, k]: [usize; 3]| lattice.index([k.min(nx - 1), j, i.min(nz - 1)]);
    (nx != nz).then(|| rearranged(grid, exchanged)).flatten()
}

/// The value of each node is that of the index that `source` gives.
pub(super) fn rearranged(
    grid: &GridValues,
    source: impl Fn([usize; 3]) -> usize,
) -> Option<GridValues> {
    read_from(grid, *grid.lattice(), source)
}

/// A grid on `lattice` whose nodes have the values of `grid` at the indices that `source` gives.
fn read_from(
    grid: &GridValues,
    lattice: Lattice,
    source: impl Fn([usize; 3]) -> usize,
) -> Option<GridValues> {
    let values = (0..lattice.node_count()).map(|node| grid.values()[source(lattice.node(node))]);
    on(lattice, values.collect())
}

/// Each value by itself.
pub(super) fn mapped(grid: &GridValues, map: impl Fn(f32) -> f32) -> Option<GridValues> {
    let values = grid.values().iter().map(|&value| map(value));
    on(*grid.lattice(), values.collect())
}
