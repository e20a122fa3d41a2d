//! The binary grid of the ray-casting assignment.
//!
//! Little endian: `int32` nx, ny, nz; `float32` size x, y, z in world units; then nx·ny·nz
//! `float32` densities, x fastest. One spacing serves all axes, `size.x / (nx − 1)`; the first
//! node lies at the world origin.

use super::orientation::Axes;
use super::samples::{VolumeRead, Words, read_grid};
use super::source::VolumeSource;
use super::{Element, Lattice, Layout, LoadOptions};
use glam::DVec3;

const ONE_NODE: &str =
    "a binary grid of 1 × 1 × 1 nodes has no spacing: at least one axis needs 2 nodes";

/// The spacing is `size / (n − 1)` of the first axis with more than one node, in `f64`; that
/// size must be positive. The other sizes have no effect. Header and length are checked before anything is allocated. Values must be
/// finite; densities that are negative are left to
/// [`Grid::check_densities`](super::Grid::check_densities).
pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let header = Words::<6>::read(source)?;
    let (nodes, sizes) = (header.sizes(0)?, header.vector(3).to_array());
    let axis = nodes.iter().position(|&nodes| nodes > 1).ok_or(ONE_NODE)?;
    let spacing = sizes[axis] / (nodes[axis] - 1) as f64;
    let axes = Axes::of(&Lattice::new(nodes, DVec3::splat(spacing), DVec3::ZERO)?);
    read_grid(source, &Layout::raw(Element::Float32, axes), options)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, read_volume};

    fn read(bytes: &[u8]) -> Result<Grid<f32>, crate::volume::VolumeFault> {
        read_volume("grid.bin", bytes, None, &LoadOptions::default())
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
            "a binary grid of 1 × 1 × 1 nodes has no spacing: at least one axis needs 2 nodes"
        );
    }

    #[test]
    fn files_of_the_wrong_length_say_both_lengths() {
        let whole = file([2, 2, 2], [1.0; 3], &[1.0; 8]);
        for cut in 0..24 {
            assert_eq!(
                message(&whole[..cut]),
                format!("the file ends after {cut} of the 24 bytes of its header")
            );
        }
        let declared = "the header declares 2 × 2 × 2 samples of float32, 32 bytes, but";
        for cut in 24..whole.len() {
            let found = format!(
                "{declared} {} bytes follow it: the file is truncated",
                cut - 24
            );
            assert!(message(&whole[..cut]).starts_with(&found));
        }
        let found = format!("{declared} 33 bytes follow it: the file is truncated, has extra data");
        assert!(message(&[&whole[..], &[0]].concat()).starts_with(&found));
    }

    #[test]
    fn impossible_node_counts() {
        for nodes in [[0, 2, 2], [2, -1, 2], [2, 2, i32::MIN]] {
            assert_eq!(
                message(&file(nodes, [1.0; 3], &[])),
                format!(
                    "the header gives {} × {} × {} samples, and each axis needs at least 1: is \
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
        for sizes in [[f32::NAN, 1.0, 1.0], [-1.0, 1.0, 1.0], [0.0, 1.0, 1.0]] {
            let message = message(&file([2, 2, 2], sizes, &[1.0; 8]));
            assert!(message.starts_with("the node spacing must be positive"));
        }
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
                    "voxel (1, 1, 1) in the order of the file holds {shown}: values must be finite, \
                     and not beyond 3.4e38; correct it, or set `replace_non_finite` \
                     beside `file` in the scene, to a value that replaces it"
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
    }

    #[test]
    fn the_spacing_keeps_the_size() {
        for nodes in [2, 3, 7, 56, 111] {
            for size in [1.0, 0.1, 55.7, 1e-30, 3e38] {
                let header = [size, 0.0, size];
                let bytes = file([nodes, 1, 2], header, &vec![0.5; 2 * nodes as usize]);
                let spacing = read(&bytes).unwrap().lattice().spacing();
                // Two roundings in `f64`, far from the border between two `f32`.
                assert_eq!((spacing.x * f64::from(nodes - 1)) as f32, size, "{nodes}");
            }
        }
    }
}
