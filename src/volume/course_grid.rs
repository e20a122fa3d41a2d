//! The course's binary grid.
//!
//! Little endian: `int32` nx, ny, nz; `float32` size x, y, z in world units; then nx·ny·nz
//! `float32` densities, x fastest. One spacing serves all axes, `size.x / (nx − 1)`; the first
//! node lies at the world origin.

use super::error::VolumeError;
use super::orientation::{Axes, AxisSteps};
use super::reader::{Stored, VolumeReader};
use super::samples::{fill, read_grid};
use super::source::VolumeSource;
use super::{
    Centring, Element, Encoding, Endian, Grid, GridError, Lattice, LatticeError, Layout,
    LoadOptions, SamplesError,
};
use glam::DVec3;
use std::io::BufRead;
use thiserror::Error;

/// Why bytes are no course grid, or a grid cannot be written as one.
#[derive(Debug, Error)]
pub enum CourseGridError {
    /// Not even a header.
    #[error(
        "the file ends after {bytes} of the 24 bytes of its header (int32 nx ny nz, float32 \
         size x y z)"
    )]
    Header {
        /// Bytes in the file.
        bytes: u64,
    },
    /// An axis with no or a negative number of nodes.
    #[error(
        "the header gives {0} × {1} × {2} nodes, and each axis needs at least 1: is this file \
         little endian?"
    )]
    Nodes(i32, i32, i32),
    /// A size that is negative or not finite.
    #[error(
        "the header gives the size ({0}, {1}, {2}): sizes must be finite and not negative; is \
         this file little endian?"
    )]
    Size(f32, f32, f32),
    /// The size that determines the spacing is zero.
    #[error(
        "the header gives size 0 along {axis}, where there are {nodes} nodes: their spacing \
         would be 0"
    )]
    Flat {
        /// `'x'`, `'y'` or `'z'`: the first with more than one node.
        axis: char,
        /// Nodes along it.
        nodes: usize,
    },
    /// A single node, hence no spacing.
    #[error("a course grid of 1 × 1 × 1 nodes has no spacing: at least one axis needs 2 nodes")]
    OneNode,
    /// More nodes than a lattice may have.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// Fewer or more bytes than the header says.
    #[error(
        "the header promises {} × {} × {} float32 densities, {promised} bytes in all, and the \
         file has {bytes}: it {}",
        nodes[0], nodes[1], nodes[2],
        if bytes < promised { "was cut short, or is not little endian" }
        else { "holds something else as well, or is not float32" }
    )]
    Length {
        /// Nodes along x, y and z.
        nodes: [usize; 3],
        /// Bytes a file with this header has.
        promised: u64,
        /// Bytes in the file.
        bytes: u64,
    },
    /// A value that is not finite, or a file that cannot be read.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// Writing: a density that is negative or not finite.
    #[error(transparent)]
    Density(#[from] GridError),
    /// Writing: the spacings differ.
    #[error("a course grid has one spacing, this grid has {0}: resample it first")]
    Anisotropic(DVec3),
    /// Writing: the first node is elsewhere.
    #[error("a course grid begins at the world origin, this grid at {0}: move it first")]
    NotAtOrigin(DVec3),
    /// Writing: more nodes on an axis, or a longer axis, than the header can say.
    #[error("the header of a course grid cannot hold {nodes} nodes over a length of {size}")]
    NotRepresentable {
        /// Nodes along the axis.
        nodes: usize,
        /// Length of the axis, world units.
        size: f64,
    },
}

/// Reader of the course's binary grid.
#[derive(Clone, Copy, Debug)]
pub struct CourseGrid;

impl VolumeReader for CourseGrid {
    fn name(&self) -> &'static str {
        "course grid"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[".bin"]
    }

    fn read(
        &self,
        source: &mut VolumeSource,
        options: &LoadOptions,
    ) -> Result<(Grid<f32>, Stored), VolumeError> {
        let length = source.length();
        let (grid, layout) = read(source, length, options).map_err(|error| source.fault(error))?;
        Ok((grid, Stored::Samples(layout)))
    }
}

/// Reads the course's binary grid.
///
/// The spacing is `size / (n − 1)` of the first axis with more than one node, in `f64`; that
/// size must be positive. The other sizes have no say, but must be finite and not negative: a
/// thin axis may give 0. Header and length are checked before anything is allocated. Values must
/// be finite; densities that are negative are left to [`Grid::check_densities`].
pub fn read_course_grid(bytes: &[u8], options: &LoadOptions) -> Result<Grid<f32>, CourseGridError> {
    let mut source = bytes;
    read(&mut source, bytes.len() as u64, options).map(|(grid, _)| grid)
}

/// Reads the course's binary grid from a source of `length` bytes.
pub(super) fn read(
    source: &mut impl BufRead,
    length: u64,
    options: &LoadOptions,
) -> Result<(Grid<f32>, Layout), CourseGridError> {
    let mut bytes = [0; CourseGridHeader::BYTES];
    let filled = fill(source, &mut bytes).map_err(SamplesError::Read)?;
    let header = CourseGridHeader::read(&bytes[..filled])?;
    header.check_length(length)?;
    let layout = Layout {
        axes: Axes {
            sizes: header.lattice.nodes(),
            steps: AxisSteps::Upright(header.lattice.spacing()),
            first: header.lattice.first(),
            centring: Centring::Nodes,
        },
        element: Element::Float32,
        endian: Endian::Little,
        encoding: Encoding::Raw,
        scaling: None,
    };
    let grid = read_grid(
        source,
        length - CourseGridHeader::BYTES as u64,
        &layout,
        options,
    )?;
    Ok((grid, layout))
}

/// The bytes of a course grid: for grids of one spacing whose first node lies at the origin.
///
/// The header stores lengths as `float32`, so the spacing is kept to a relative error of 2⁻²⁴.
/// A grid that came from this format survives unchanged: from size to spacing and
/// back is two roundings in `f64`, far from the border between two `float32`.
pub fn write_course_grid(grid: &Grid<f32>) -> Result<Vec<u8>, CourseGridError> {
    let lattice = grid.lattice();
    let spacing = lattice.spacing();
    if spacing != DVec3::splat(spacing.x) {
        return Err(CourseGridError::Anisotropic(spacing));
    }
    if lattice.first() != DVec3::ZERO {
        return Err(CourseGridError::NotAtOrigin(lattice.first()));
    }
    if lattice.node_count() == 1 {
        return Err(CourseGridError::OneNode);
    }
    grid.check_densities()?;
    let sizes = lattice.nodes().map(|n| spacing.x * (n - 1) as f64);
    let mut bytes = Vec::with_capacity(CourseGridHeader::BYTES + 4 * lattice.node_count());
    for (nodes, size) in lattice.nodes().into_iter().zip(sizes) {
        let stored = size as f32;
        let sayable = stored.is_finite() && (stored > 0.0 || nodes == 1);
        match i32::try_from(nodes) {
            Ok(count) if sayable => bytes.extend(count.to_le_bytes()),
            _ => return Err(CourseGridError::NotRepresentable { nodes, size }),
        }
    }
    bytes.extend(sizes.iter().flat_map(|&size| (size as f32).to_le_bytes()));
    bytes.extend(grid.values().iter().flat_map(|value| value.to_le_bytes()));
    Ok(bytes)
}

/// What the first 24 bytes say.
struct CourseGridHeader {
    lattice: Lattice,
}

impl CourseGridHeader {
    /// Length of the header.
    const BYTES: usize = 24;

    /// Reads the header at the beginning of `bytes`.
    fn read(bytes: &[u8]) -> Result<CourseGridHeader, CourseGridError> {
        if bytes.len() < Self::BYTES {
            let bytes = bytes.len() as u64;
            return Err(CourseGridError::Header { bytes });
        }
        let word = |index: usize| -> [u8; 4] {
            let word = &bytes[4 * index..4 * index + 4];
            word.try_into().expect("four bytes")
        };
        let counts = [0, 1, 2].map(|axis| i32::from_le_bytes(word(axis)));
        let sizes = [3, 4, 5].map(|axis| f32::from_le_bytes(word(axis)));
        if counts.iter().any(|&count| count < 1) {
            return Err(CourseGridError::Nodes(counts[0], counts[1], counts[2]));
        }
        if !sizes.iter().all(|&size| size.is_finite() && size >= 0.0) {
            return Err(CourseGridError::Size(sizes[0], sizes[1], sizes[2]));
        }
        // Positive, hence the same as a `usize`.
        let nodes = counts.map(|count| count as usize);
        let axis = nodes.iter().position(|&nodes| nodes > 1);
        let axis = axis.ok_or(CourseGridError::OneNode)?;
        if sizes[axis] == 0.0 {
            return Err(CourseGridError::Flat {
                axis: ['x', 'y', 'z'][axis],
                nodes: nodes[axis],
            });
        }
        let spacing = f64::from(sizes[axis]) / (nodes[axis] - 1) as f64;
        let lattice = Lattice::new(nodes, DVec3::splat(spacing), DVec3::ZERO)?;
        Ok(CourseGridHeader { lattice })
    }

    /// Checks that a file of `bytes` bytes is as long as the header says.
    fn check_length(&self, bytes: u64) -> Result<(), CourseGridError> {
        // No overflow: a lattice has at most 2³¹ nodes.
        let promised = Self::BYTES as u64 + 4 * self.lattice.node_count() as u64;
        if bytes == promised {
            return Ok(());
        }
        Err(CourseGridError::Length {
            nodes: self.lattice.nodes(),
            promised,
            bytes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<Grid<f32>, CourseGridError> {
        read_course_grid(bytes, &LoadOptions::default())
    }

    fn file(nodes: [i32; 3], sizes: [f32; 3], values: &[f32]) -> Vec<u8> {
        let nodes = nodes.iter().flat_map(|word| word.to_le_bytes());
        let floats = sizes.iter().chain(values);
        nodes
            .chain(floats.flat_map(|word| word.to_le_bytes()))
            .collect()
    }

    fn message(bytes: &[u8]) -> String {
        read(bytes).unwrap_err().to_string()
    }

    #[test]
    fn x_runs_fastest_and_the_first_node_is_the_origin() {
        let values = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let grid = read(&file([3, 2, 1], [1.0, 0.5, 0.0], &values)).unwrap();
        assert_eq!(grid.lattice().nodes(), [3, 2, 1]);
        assert_eq!(grid.lattice().spacing(), DVec3::splat(0.5));
        assert_eq!(grid.lattice().first(), DVec3::ZERO);
        assert_eq!(grid.values()[grid.lattice().index([0, 1, 0])], 3.0);
    }

    #[test]
    fn the_spacing_comes_from_the_first_axis_that_has_one() {
        let grid = read(&file([1, 1, 3], [9.0, 0.0, 4.0], &[1.0; 3])).unwrap();
        assert_eq!(grid.lattice().spacing(), DVec3::splat(2.0));
        assert_eq!(
            message(&file([1, 1, 1], [1.0; 3], &[1.0])),
            "a course grid of 1 × 1 × 1 nodes has no spacing: at least one axis needs 2 nodes"
        );
    }

    #[test]
    fn files_of_the_wrong_length_say_both_lengths() {
        let whole = file([2, 2, 2], [1.0; 3], &[1.0; 8]);
        for cut in 0..24 {
            assert_eq!(
                message(&whole[..cut]),
                format!(
                    "the file ends after {cut} of the 24 bytes of its header (int32 nx ny nz, \
                     float32 size x y z)"
                )
            );
        }
        for cut in 24..whole.len() {
            assert_eq!(
                message(&whole[..cut]),
                format!(
                    "the header promises 2 × 2 × 2 float32 densities, 56 bytes in all, and the \
                     file has {cut}: it was cut short, or is not little endian"
                )
            );
        }
        let mut longer = whole;
        longer.push(0);
        assert_eq!(
            message(&longer),
            "the header promises 2 × 2 × 2 float32 densities, 56 bytes in all, and the file has \
             57: it holds something else as well, or is not float32"
        );
    }

    #[test]
    fn impossible_node_counts() {
        for nodes in [[0, 2, 2], [2, -1, 2], [2, 2, i32::MIN]] {
            assert_eq!(
                message(&file(nodes, [1.0; 3], &[])),
                format!(
                    "the header gives {} × {} × {} nodes, and each axis needs at least 1: is \
                     this file little endian?",
                    nodes[0], nodes[1], nodes[2]
                )
            );
        }
        for nodes in [[1 << 20; 3], [i32::MAX; 3]] {
            assert_eq!(
                message(&file(nodes, [1.0; 3], &[])),
                format!(
                    "a grid of {0} × {0} × {0} nodes is too large: at most 2³¹ nodes are \
                     accepted",
                    nodes[0]
                )
            );
        }
    }

    #[test]
    fn impossible_sizes() {
        for (sizes, shown) in [
            ([f32::NAN, 1.0, 1.0], "(NaN, 1, 1)"),
            ([1.0, f32::INFINITY, 1.0], "(1, inf, 1)"),
            ([1.0, 1.0, -1.0], "(1, 1, -1)"),
        ] {
            assert_eq!(
                message(&file([2, 2, 2], sizes, &[1.0; 8])),
                format!(
                    "the header gives the size {shown}: sizes must be finite and not negative; \
                     is this file little endian?"
                )
            );
        }
        assert_eq!(
            message(&file([1, 2, 2], [1.0, 0.0, 1.0], &[1.0; 4])),
            "the header gives size 0 along y, where there are 2 nodes: their spacing would be 0"
        );
    }

    #[test]
    fn impossible_values_name_their_voxel() {
        for (value, shown) in [
            (f32::NAN, "NaN"),
            (f32::INFINITY, "inf"),
            (f32::NEG_INFINITY, "-inf"),
        ] {
            let mut values = [1.0; 12];
            values[9] = value;
            assert_eq!(
                message(&file([2, 3, 2], [1.0; 3], &values)),
                format!(
                    "voxel (1, 1, 1), counted as stored, holds {shown}: values must be finite, \
                     and not beyond 3.4e38; mend it, or give a value to replace it"
                )
            );
        }
    }

    #[test]
    fn negative_values_are_read_and_are_no_densities() {
        let mut values = [1.0; 12];
        values[9] = -0.5;
        let grid = read(&file([2, 3, 2], [1.0; 3], &values)).unwrap();
        assert_eq!(
            grid.check_densities().unwrap_err().to_string(),
            "voxel (1, 1, 1) holds -0.5: densities must be finite and not negative"
        );
        assert!(write_course_grid(&grid).is_err());
    }

    #[test]
    fn what_was_read_survives_being_written() {
        for nodes in [2, 3, 7, 56, 111] {
            for size in [1.0, 0.1, 55.7, 1e-30, 3e38] {
                let header = [size, 0.0, size];
                let bytes = file([nodes, 1, 2], header, &vec![0.5; 2 * nodes as usize]);
                let grid = read(&bytes).unwrap();
                let again = write_course_grid(&grid).unwrap();
                assert_eq!(read(&again).unwrap(), grid, "{nodes} {size}");
            }
        }
        let whole = file([3, 2, 1], [1.0, 0.5, 0.0], &[0.5; 6]);
        let grid = read(&whole).unwrap();
        assert_eq!(write_course_grid(&grid).unwrap(), whole);
    }

    #[test]
    fn grids_that_the_format_cannot_hold() {
        let message = |nodes: [usize; 3], spacing, first, value| {
            let lattice = Lattice::new(nodes, spacing, first).unwrap();
            let grid = Grid::new(lattice, vec![value; lattice.node_count()]).unwrap();
            write_course_grid(&grid).unwrap_err().to_string()
        };
        let (zero, one) = (DVec3::ZERO, DVec3::ONE);
        assert_eq!(
            message([2, 2, 2], DVec3::new(1.0, 2.0, 1.0), zero, 1.0),
            "a course grid has one spacing, this grid has [1, 2, 1]: resample it first"
        );
        assert_eq!(
            message([2, 2, 2], one, DVec3::X, 1.0),
            "a course grid begins at the world origin, this grid at [1, 0, 0]: move it first"
        );
        assert!(message([1, 1, 1], one, zero, 1.0).contains("has no spacing"));
        assert!(message([2, 1, 1], one, zero, f32::NAN).contains("voxel (0, 0, 0) holds NaN"));
        for spacing in [1e39, 1e-46] {
            assert!(
                message([2, 1, 1], DVec3::splat(spacing), zero, 1.0)
                    .starts_with("the header of a course grid cannot hold 2 nodes over a length")
            );
        }
    }
}
