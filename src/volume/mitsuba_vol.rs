//! Mitsuba's volume format, `.vol`, version 3.
//!
//! Little endian: the bytes `VOL` and 3; `int32` type (1 `float32`, 2 `float16`, 3 `uint8` with
//! 0 to 255 standing for 0 to 1, 4 quantised directions); `int32` nx, ny, nz; `int32` channels;
//! six `float32` of the box, minimum before maximum; samples from byte 48, x fastest.
//!
//! The header gives a box and not a spacing. Mitsuba 0.5 and the renderers that took the format
//! from it put the first and last sample of an axis on the faces of the box: node-centred, and so
//! read here. Mitsuba 3 reads the same file as a texture, with every sample in the middle of a
//! cell; [`LoadOptions::centring`] asks for that. The box is the same in both cases.

use super::error::refused;
use super::orientation::Axes;
use super::samples::{VolumeRead, Words, read_grid};
use super::source::VolumeSource;
use super::{Centring, Element, Lattice, Layout, LoadOptions};

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let header = Words::<12>::read(source)?;
    let [b'V', b'O', b'L', version] = header.0[0] else {
        return refused(
            "the file does not begin with the letters VOL: this is not a Mitsuba volume",
        );
    };
    if version != 3 {
        return refused(format!(
            "this is version {version} of the format; only version 3 is supported"
        ));
    }
    let (element, scaling) = match header.int(1) {
        1 => (Element::Float32, None),
        2 => (Element::Float16, None),
        3 => (Element::Uint8, Some((1.0 / 255.0, 0.0))),
        code => {
            return refused(format!(
                "the samples are of type {code}: types 1 (float32), 2 (float16) and 3 (uint8) are read"
            ));
        }
    };
    let sizes = header.sizes(2)?;
    let channels = header.int(5);
    if channels != 1 {
        return refused(format!(
            "the file has {channels} channels, and a density has 1: write one channel to a file"
        ));
    }
    let (min, max) = (header.vector(6), header.vector(9));
    // Refused below, with the spacing, unless each axis ascends.
    let extent = max - min;
    let centring = options.centring.unwrap_or_default();
    let (mut spacing, mut first) = (extent, min);
    for axis in 0..3 {
        // A single sample is a slab as thick as the box, in either reading.
        if centring == Centring::Cells || sizes[axis] == 1 {
            spacing[axis] = extent[axis] / sizes[axis] as f64;
            first[axis] += 0.5 * spacing[axis];
        } else {
            spacing[axis] = extent[axis] / (sizes[axis] - 1) as f64;
        }
    }
    let lattice = Lattice::new(sizes, spacing, first)?.with_centring(centring)?;
    let layout = Layout {
        scaling,
        ..Layout::raw(element, Axes::of(&lattice))
    };
    read_grid(source, &layout, options)
}

/// A Mitsuba volume of `float32` samples in a box.
pub fn vol_bytes(counts: [i32; 3], corners: [[f32; 3]; 2], values: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(48 + 4 * values.len());
    bytes.extend(b"VOL\x03");
    let [nx, ny, nz] = counts;
    for word in [1, nx, ny, nz, 1] {
        bytes.extend(word.to_le_bytes());
    }
    let coordinates = corners.as_flattened();
    bytes.extend(
        coordinates
            .iter()
            .chain(values)
            .flat_map(|number| number.to_le_bytes()),
    );
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, read_volume};
    use glam::DVec3;

    /// A header and its data.
    fn file(kind: i32, sizes: [i32; 3], channels: i32, corners: [f32; 6], data: &[u8]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        for word in [kind, sizes[0], sizes[1], sizes[2], channels] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(corners.iter().flat_map(|word| word.to_le_bytes()));
        bytes.extend(data);
        bytes
    }

    const UNIT: [f32; 6] = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0];

    fn small() -> Vec<u8> {
        file(3, [2, 1, 3], 1, UNIT, &[0, 51, 102, 153, 204, 255])
    }

    fn read_vol(
        bytes: &[u8],
        options: &LoadOptions,
    ) -> Result<Grid<f32>, crate::volume::VolumeFault> {
        read_volume("grid.vol", bytes, None, options)
    }

    fn message(bytes: &[u8]) -> String {
        let error = read_vol(bytes, &LoadOptions::default()).unwrap_err();
        error.to_string()
    }

    #[test]
    fn bytes_stand_for_zero_to_one_and_nodes_lie_on_the_box() {
        let grid = read_vol(&small(), &LoadOptions::default()).unwrap();
        assert_eq!(grid.values(), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(grid.lattice().spacing(), DVec3::new(1.0, 2.0, 1.5));
        assert_eq!(grid.lattice().first(), DVec3::new(0.0, 1.0, 0.0));
        assert_eq!(grid.lattice().bounds().max, DVec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn cells_fill_the_same_box() {
        let options = LoadOptions {
            centring: Some(Centring::Cells),
            ..LoadOptions::default()
        };
        let grid = read_vol(&small(), &options).unwrap();
        assert_eq!(grid.lattice().spacing(), DVec3::new(0.5, 2.0, 1.0));
        assert_eq!(grid.lattice().first(), DVec3::new(0.25, 1.0, 0.5));
        assert_eq!(grid.lattice().bounds().min, DVec3::ZERO);
        assert_eq!(grid.lattice().bounds().max, DVec3::new(1.0, 2.0, 3.0));
    }

    #[test]
    fn halves() {
        let data: Vec<u8> = [0x3c00_u16, 0xc100]
            .iter()
            .flat_map(|h| h.to_le_bytes())
            .collect();
        let grid = read_vol(&file(2, [2, 1, 1], 1, UNIT, &data), &LoadOptions::default());
        assert_eq!(grid.unwrap().values(), [1.0, -2.5]);
    }

    #[test]
    fn what_was_written_is_read_again() {
        for centring in [Centring::Nodes, Centring::Cells] {
            let options = LoadOptions {
                centring: Some(centring),
                ..LoadOptions::default()
            };
            for corners in [UNIT, [-0.1, 1e-20, 3e7, 0.7, 2e-20, 4e7]] {
                let data: Vec<u8> = (0..30)
                    .flat_map(|v| (v as f32 - 7.3).to_le_bytes())
                    .collect();
                let bytes = file(1, [5, 3, 2], 1, corners, &data);
                let grid = read_vol(&bytes, &options).unwrap();
                let bounds = grid.lattice().bounds();
                let corners = [bounds.min, bounds.max].map(|it| it.as_vec3().to_array());
                assert_eq!(vol_bytes([5, 3, 2], corners, grid.values()), bytes);
            }
        }
    }

    #[test]
    fn what_a_header_must_not_say() {
        let whole = small();
        for (bytes, expected) in [
            (
                &b""[..],
                "the file ends after 0 of the 48 bytes of its header",
            ),
            (
                &whole[..47],
                "the file ends after 47 of the 48 bytes of its header",
            ),
            (
                &[7; 48],
                "the file does not begin with the letters VOL: this is not a Mitsuba volume",
            ),
            (
                &whole[..50],
                "the header declares 2 × 1 × 3 samples of uint8, 6 bytes, but 2 bytes follow it: \
                 the file is truncated, has extra data, or has a wrong type or size in its header",
            ),
            (
                &[&whole[..], b"x"].concat(),
                "the header declares 2 × 1 × 3 samples of uint8, 6 bytes, but 7 bytes follow it: \
                 the file is truncated, has extra data, or has a wrong type or size in its header",
            ),
            (
                &file(1, [1 << 20; 3], 1, UNIT, &[]),
                "a grid of 1048576 × 1048576 × 1048576 nodes is too large: at most 2³¹ nodes are \
                 accepted",
            ),
            (
                &file(1, [2, -2, 2], 1, UNIT, &[]),
                "the header gives 2 × -2 × 2 samples, and each axis needs at least 1: is this \
                 file little endian?",
            ),
            (
                &file(4, [2, 2, 2], 3, UNIT, &[]),
                "the samples are of type 4: types 1 (float32), 2 (float16) \
                 and 3 (uint8) are read",
            ),
            (
                &file(1, [2, 2, 2], 3, UNIT, &[]),
                "the file has 3 channels, and a density has 1: write one channel to a file",
            ),
            (
                &file(1, [2, 2, 2], 1, [0.0, 0.0, 0.0, 1.0, 0.0, 1.0], &[]),
                "the node spacing must be positive and finite on every axis, and not below 2.3e-308, got [1, 0, 1]",
            ),
            (
                &file(1, [2, 2, 2], 1, [0.0, 0.0, 0.0, 1.0, f32::NAN, 1.0], &[]),
                "the node spacing must be positive and finite on every axis, and not below 2.3e-308, got [1, NaN, 1]",
            ),
        ] {
            assert_eq!(message(bytes), expected);
        }
        let mut other = whole.clone();
        other[3] = 2;
        assert_eq!(
            message(&other),
            "this is version 2 of the format; only version 3 is supported"
        );
    }
}
