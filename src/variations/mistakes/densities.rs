//! Mistakes about densities: grids and noise.

use super::{Edit, Mistake};
use crate::optics::Field;
use crate::scene::{Classified, Radiative};
use crate::volume::{
    Centring, FractalDensity, FractalParameters, Grid, GridDensity, Interpolation, Lattice,
};
use glam::DVec3;
use std::sync::Arc;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "interpolation-nearest",
        advice: "densities are those of the nearest node: interpolate between the eight nodes around the sample",
        edit: Edit::Radiative(|scene| {
            grids(scene, |grid, old| {
                (old == Interpolation::Trilinear).then(|| (grid.clone(), Interpolation::Nearest))
            })
        }),
    },
    Mistake {
        name: "grid-half-voxel-off",
        advice: "the grid is half a voxel off, towards larger coordinates: values belong to nodes, the first of which lies at the corner of the box",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_on)),
    },
    Mistake {
        name: "grid-half-voxel-back",
        advice: "the grid is half a voxel off, towards smaller coordinates: values belong to nodes, the first of which lies at the corner of the box",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_back)),
    },
    Mistake {
        name: "grid-half-voxel-along-x",
        advice: "the grid is half a voxel off along x alone, towards larger coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_on_along_x)),
    },
    Mistake {
        name: "grid-half-voxel-back-along-x",
        advice: "the grid is half a voxel off along x alone, towards smaller coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_back_along_x)),
    },
    Mistake {
        name: "grid-half-voxel-along-y",
        advice: "the grid is half a voxel off along y alone, towards larger coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_on_along_y)),
    },
    Mistake {
        name: "grid-half-voxel-back-along-y",
        advice: "the grid is half a voxel off along y alone, towards smaller coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_back_along_y)),
    },
    Mistake {
        name: "grid-half-voxel-along-z",
        advice: "the grid is half a voxel off along z alone, towards larger coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_on_along_z)),
    },
    Mistake {
        name: "grid-half-voxel-back-along-z",
        advice: "the grid is half a voxel off along z alone, towards smaller coordinates: is the centre of a cell taken for its node on this axis, or its count of nodes for that of cells?",
        edit: Edit::Radiative(|scene| with_grids(scene, half_a_voxel_back_along_z)),
    },
    Mistake {
        name: "grid-cells-for-nodes",
        advice: "the values of the grid are placed at the centres of cells, as in textures: the outermost lie on the faces of the box",
        edit: Edit::Radiative(|scene| with_grids(scene, cells_for_nodes)),
    },
    Mistake {
        name: "grid-axes-exchanged",
        advice: "x and z of the grid are swapped: x runs fastest in memory, at index x + nx (y + ny z)",
        edit: Edit::Radiative(|scene| with_grids(scene, x_and_z_exchanged)),
    },
    Mistake {
        name: "grid-x-and-y-exchanged",
        advice: "x and y of the grid are swapped: x runs fastest in memory, at index x + nx (y + ny z)",
        edit: Edit::Radiative(|scene| with_grids(scene, x_and_y_exchanged)),
    },
    Mistake {
        name: "grid-y-and-z-exchanged",
        advice: "y and z of the grid are swapped: x runs fastest in memory, at index x + nx (y + ny z)",
        edit: Edit::Radiative(|scene| with_grids(scene, y_and_z_exchanged)),
    },
    Mistake {
        name: "grid-rows-of-another-length",
        advice: "rows of the grid are taken for as long as its columns: the index is x + nx (y + ny z), with nx where y is multiplied, not ny",
        edit: Edit::Radiative(|scene| with_grids(scene, rows_as_long_as_columns)),
    },
    Mistake {
        name: "grid-upside-down",
        advice: "the grid is upside down: y must grow upwards",
        edit: Edit::Radiative(|scene| with_grids(scene, upside_down)),
    },
    Mistake {
        name: "grid-reversed-along-x",
        advice: "the grid is mirrored along its own x: values are stored from the first node on, in the direction of the axis",
        edit: Edit::Radiative(|scene| with_grids(scene, reversed_along_x)),
    },
    Mistake {
        name: "grid-reversed-along-z",
        advice: "the grid is mirrored along its own z: slices are stored from the first node on, in the direction of the axis",
        edit: Edit::Radiative(|scene| with_grids(scene, reversed_along_z)),
    },
    Mistake {
        name: "density-uniform",
        advice: "the density is the same everywhere: look it up at each place and multiply the coefficients by it",
        edit: Edit::Radiative(|scene| {
            let mut occurs = false;
            for body in &mut scene.media {
                occurs |= body.density.take().is_some();
            }
            occurs
        }),
    },
    Mistake {
        name: "density-squared",
        advice: "the density counts twice: it multiplies the coefficients once",
        edit: Edit::Radiative(|scene| {
            with_grids(scene, |grid| mapped(grid, |value| value * value))
        }),
    },
    Mistake {
        name: "noise-of-one-octave",
        advice: "the noise has one octave only: the sum runs over all of them, each of another frequency and amplitude",
        edit: Edit::Radiative(|scene| noises(scene, |noise| noise.octaves = 1)),
    },
    Mistake {
        name: "noise-gain-from-lacunarity",
        advice: "the weights of octaves are 1 / lacunarity in place of gain: both are given",
        edit: Edit::Radiative(|scene| noises(scene, |noise| noise.gain = 1.0 / noise.lacunarity)),
    },
    Mistake {
        name: "noise-lacunarity-two",
        advice: "frequencies of octaves double: they grow by the lacunarity that is given",
        edit: Edit::Radiative(|scene| noises(scene, |noise| noise.lacunarity = 2.0)),
    },
    Mistake {
        name: "noise-scale-inverted",
        advice: "the noise is stretched where it should be squeezed: places are multiplied by the scale, not divided",
        edit: Edit::Radiative(|scene| noises(scene, |noise| noise.scale = noise.scale.recip())),
    },
    Mistake {
        name: "noise-threshold-left-out",
        advice: "the noise is not cut: densities up to the threshold count as 0",
        edit: Edit::Radiative(|scene| noises(scene, |noise| noise.threshold = 0.0)),
    },
    Mistake {
        name: "noise-half-a-cell-off",
        advice: "the noise is shifted by half a cell: its lattice points lie at whole numbers",
        edit: Edit::Radiative(|scene| noises(scene, |noise| noise.offset += 0.5)),
    },
];

pub(super) type GridValues = Arc<Grid<f32>>;

/// The classified volume with its grid edited by the same functions that edit those of media.
pub(super) fn in_classified(
    scene: &mut Classified,
    edit: fn(&GridValues) -> Option<GridValues>,
) -> bool {
    let Some(grid) = edit(&scene.grid) else {
        return false;
    };
    scene.grid = grid;
    true
}

/// Half a voxel off along every axis, towards larger coordinates.
pub(super) fn half_a_voxel_on(grid: &GridValues) -> Option<GridValues> {
    moved_by_voxels(grid, DVec3::splat(0.5))
}

/// Half a voxel off along every axis, towards smaller coordinates.
pub(super) fn half_a_voxel_back(grid: &GridValues) -> Option<GridValues> {
    moved_by_voxels(grid, DVec3::splat(-0.5))
}

/// Half a voxel off along one axis.
macro_rules! half_a_voxel_along {
    ($name:ident, $voxels:expr) => {
        pub(super) fn $name(grid: &GridValues) -> Option<GridValues> {
            moved_by_voxels(grid, $voxels)
        }
    };
}
half_a_voxel_along!(half_a_voxel_on_along_x, DVec3::X * 0.5);
half_a_voxel_along!(half_a_voxel_on_along_y, DVec3::Y * 0.5);
half_a_voxel_along!(half_a_voxel_on_along_z, DVec3::Z * 0.5);
half_a_voxel_along!(half_a_voxel_back_along_x, DVec3::X * -0.5);
half_a_voxel_along!(half_a_voxel_back_along_y, DVec3::Y * -0.5);
half_a_voxel_along!(half_a_voxel_back_along_z, DVec3::Z * -0.5);

fn moved_by_voxels(grid: &GridValues, voxels: DVec3) -> Option<GridValues> {
    let old = grid.lattice();
    let first = old.first() + old.spacing() * voxels;
    let lattice = Lattice::new(old.nodes(), old.spacing(), first).ok()?;
    on(lattice.with_centring(old.centring()).ok()?, grid)
}

/// In the same box, but each value in the middle of a cell of its own.
pub(super) fn cells_for_nodes(grid: &GridValues) -> Option<GridValues> {
    let old = grid.lattice();
    if old.centring() == Centring::Cells {
        return None;
    }
    let bounds = old.bounds();
    let counts = DVec3::from_array(old.nodes().map(|count| count as f64));
    let spacing = bounds.size() / counts;
    let lattice = Lattice::new(old.nodes(), spacing, bounds.min + spacing * 0.5).ok()?;
    on(lattice.with_centring(Centring::Cells).ok()?, grid)
}

/// Every spacing is the shortest, about the same centre.
pub(super) fn as_cubes(grid: &GridValues) -> Option<GridValues> {
    let old = grid.lattice();
    let spacing = DVec3::splat(old.voxel());
    let middle = old.bounds().centre();
    let steps = DVec3::from_array(old.nodes().map(|count| (count - 1) as f64));
    let lattice = Lattice::new(old.nodes(), spacing, middle - 0.5 * steps * spacing).ok()?;
    (spacing != old.spacing()).then_some(())?;
    on(lattice.with_centring(old.centring()).ok()?, grid)
}

/// Without so many of the first and of the last layers along each axis that has more.
pub(super) fn part(grid: &GridValues, first: [usize; 3], last: [usize; 3]) -> Option<GridValues> {
    let old = grid.lattice();
    let nodes = old.nodes();
    let left = [0, 1, 2].map(|axis| nodes[axis].saturating_sub(first[axis] + last[axis]));
    left.iter().all(|&count| count > 1).then_some(())?;
    let lattice = Lattice::new(left, old.spacing(), old.position(first)).ok()?;
    let lattice = lattice.with_centring(old.centring()).ok()?;
    let source = |index| {
        let [i, j, k] = lattice.node(index);
        old.index([i + first[0], j + first[1], k + first[2]])
    };
    let values = (0..lattice.node_count()).map(|index| grid.values()[source(index)]);
    Grid::new(lattice, values.collect()).ok().map(Arc::new)
}

/// The values of `grid` at the nodes of another lattice.
fn on(lattice: Lattice, grid: &GridValues) -> Option<GridValues> {
    let grid = Grid::new(lattice, grid.values().to_vec());
    grid.ok().map(Arc::new)
}

/// Read as though z ran fastest; nothing of a grid that is no cube of nodes is left in its place,
/// so that of any other size is read with the sizes exchanged too.
pub(super) fn x_and_z_exchanged(grid: &GridValues) -> Option<GridValues> {
    let [_, ny, nz] = grid.lattice().nodes();
    rearranged(grid, |[i, j, k]| k + nz * (j + ny * i))
}

/// Read as though y ran fastest.
pub(super) fn x_and_y_exchanged(grid: &GridValues) -> Option<GridValues> {
    let [nx, ny, _] = grid.lattice().nodes();
    rearranged(grid, |[i, j, k]| j + ny * (i + nx * k))
}

/// Read as though z ran faster than y.
pub(super) fn y_and_z_exchanged(grid: &GridValues) -> Option<GridValues> {
    let [nx, _, nz] = grid.lattice().nodes();
    rearranged(grid, |[i, j, k]| i + nx * (k + nz * j))
}

/// Read with the number of nodes along y as the length of a row; nothing of a grid with as many along x.
pub(super) fn rows_as_long_as_columns(grid: &GridValues) -> Option<GridValues> {
    let [nx, ny, _] = grid.lattice().nodes();
    let count = grid.values().len();
    (nx != ny)
        .then(|| rearranged(grid, |[i, j, k]| (i + ny * j + nx * ny * k) % count))
        .flatten()
}

/// Whole numbers, some below 0, of the fewest bits that hold them: 8, 16 or 32.
pub(super) fn signed_as_unsigned(grid: &GridValues) -> Option<GridValues> {
    let (low, high) = whole_range(grid)?;
    let holds = |bits: i32| low >= -exp2(bits - 1) && high < exp2(bits - 1);
    let bits = [8, 16, 32].into_iter().find(|&bits| holds(bits))?;
    let past = exp2(bits) as f32;
    let unsigned = |value| if value < 0.0 { value + past } else { value };
    (low < 0.0).then(|| mapped(grid, unsigned)).flatten()
}

/// Whole numbers of 16 bits, some of more than 8.
pub(super) fn without_low_byte(grid: &GridValues) -> Option<GridValues> {
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

/// Nodes in the reverse order along x.
pub(super) fn reversed_along_x(grid: &GridValues) -> Option<GridValues> {
    reversed_along(0, grid)
}

/// Rows in the reverse order along y.
pub(super) fn upside_down(grid: &GridValues) -> Option<GridValues> {
    reversed_along(1, grid)
}

/// Slices in the reverse order along z.
pub(super) fn reversed_along_z(grid: &GridValues) -> Option<GridValues> {
    reversed_along(2, grid)
}

fn reversed_along(axis: usize, grid: &GridValues) -> Option<GridValues> {
    let lattice = grid.lattice();
    rearranged(grid, |mut node| {
        node[axis] = lattice.nodes()[axis] - 1 - node[axis];
        lattice.index(node)
    })
}

/// In the same box, x and z exchanged with their counts of nodes; nothing of a grid with as many along both, where it
/// is [`x_and_z_exchanged`].
pub(super) fn transposed(grid: &GridValues) -> Option<GridValues> {
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
    let values = (0..grid.values().len()).map(|index| {
        let [i, j, k] = lattice.node(index);
        grid.values()[old.index([k, j, i])]
    });
    let values = (nx != nz).then(|| values.collect())?;
    Grid::new(lattice, values).ok().map(Arc::new)
}

/// The node of x and z exchanged, clamped to the grid; nothing of a grid with as many nodes along both.
pub(super) fn indices_reversed(grid: &GridValues) -> Option<GridValues> {
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
    let (lattice, values) = (*grid.lattice(), grid.values());
    let moved = (0..values.len()).map(|index| values[source(lattice.node(index))]);
    Grid::new(lattice, moved.collect()).ok().map(Arc::new)
}

fn mapped(grid: &GridValues, map: impl Fn(f32) -> f32) -> Option<GridValues> {
    let values = grid.values().iter().map(|&value| map(value)).collect();
    Grid::new(*grid.lattice(), values).ok().map(Arc::new)
}

fn grids(
    scene: &mut Radiative,
    edit: impl Fn(&GridValues, Interpolation) -> Option<(GridValues, Interpolation)>,
) -> bool {
    let mut occurs = false;
    for density in scene.media.iter_mut().flat_map(|body| &mut body.density) {
        if let Field::Grid(field) = density.field()
            && let Some((grid, interpolation)) = edit(field.shared(), field.interpolation())
        {
            *density = density.with_field(Field::Grid(GridDensity::new(grid, interpolation)));
            occurs = true;
        }
    }
    occurs
}

fn with_grids(scene: &mut Radiative, edit: fn(&GridValues) -> Option<GridValues>) -> bool {
    grids(scene, |grid, interpolation| {
        edit(grid).map(|grid| (grid, interpolation))
    })
}

fn noises(scene: &mut Radiative, edit: fn(&mut FractalParameters)) -> bool {
    let mut occurs = false;
    for density in scene.media.iter_mut().flat_map(|body| &mut body.density) {
        let Field::Noise(noise) = density.field() else {
            continue;
        };
        let mut parameters = *noise.parameters();
        edit(&mut parameters);
        let is_finite = |v: DVec3| v.is_finite();
        if parameters == *noise.parameters() || !is_finite(parameters.scale) {
            continue;
        }
        if let Ok(noise) = FractalDensity::new(parameters) {
            *density = density.with_field(Field::Noise(noise));
            occurs = true;
        }
    }
    occurs
}
