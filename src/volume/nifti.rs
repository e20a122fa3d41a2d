//! NIfTI-1 in one file: `.nii`, or `.nii.gz`.
//!
//! Source: the header `nifti1.h` of the NIfTI-1.1 reference (nifti.nimh.nih.gov).
//!
//! Where the samples lie: by the `sform` if its code is positive, else by the `qform` if its code
//! is, else by `pixdim` with the first sample at the origin. Positions are those of the file, x to
//! the right of the patient, y to the front, z up, in its units. A positive or negative `scl_slope`
//! makes a stored sample s the value `scl_slope·s + scl_inter`; 0 or NaN means no scaling.
//!
//! A reader of our own: the `nifti` crate (0.18) computes affines by code that panics on impossible
//! quaternions and spacings, scales integers within their own type (a slope of 0.35 leaves steps
//! of 1), and holds the file's bytes beside the values made of them.

use super::error::{VolumeFault, refused};
use super::orientation::Axes;
use super::samples::{VolumeRead, check_sizes, fill, read_grid, read_unpacked};
use super::source::VolumeSource;
use super::{Centring, Element, Encoding, Endian, Layout, LoadOptions};
use crate::files::gzip;
use glam::{DMat3, DQuat, DVec3};
use std::io::{self, BufReader, Read};

/// Bytes of the header.
const HEADER: usize = 348;

/// Earliest start of the data: four bytes after the header say if more header follows.
const FIRST_DATA: u64 = 352;

/// Below this, `1 − b² − c² − d²` of a quaternion is rounding error, and its real part counts as 0: `f32` rounds each of
/// the three by at most 2⁻²⁴, hence the sum of their squares by 2⁻²³; twice that. A turn by half a circle would else come
/// out tilted by a thousandth.
const NO_COSINE: f64 = 1.0 / (1 << 22) as f64;

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    if !source.ends_in(".gz") {
        let layout = layout(source, Encoding::Raw, VolumeFault::from)?;
        return read_grid(source, &layout, options);
    }
    let trouble = |error: io::Error| {
        format!("the gzip stream is damaged ({error}): compress the file again, or copy it again")
            .into()
    };
    // Header and data are one stream, so it is unpacked here and read as if it were raw; how long
    // it is nobody knows before its end.
    let length = source.remaining;
    let mut unpacked = BufReader::with_capacity(1 << 16, gzip::Unpacked::new(source));
    let layout = layout(&mut unpacked, Encoding::Gzip, trouble)?;
    read_unpacked(&mut unpacked, length, &layout, options)
}

/// Reads the header, and on to the first sample.
fn layout(
    source: &mut dyn Read,
    encoding: Encoding,
    trouble: fn(io::Error) -> VolumeFault,
) -> Result<Layout, VolumeFault> {
    let mut bytes = [0; HEADER];
    let filled = fill(source, &mut bytes).map_err(trouble)?;
    if filled < HEADER {
        return refused(format!(
            "the file ends after {filled} of the 348 bytes of its header"
        ));
    }
    let header = NiftiHeader::new(&bytes)?;
    let sizes = header.sizes()?;
    let (steps, first, space) = header.positions()?;
    let layout = Layout {
        axes: Axes {
            sizes,
            steps,
            first,
            centring: Centring::Nodes,
        },
        element: header.element()?,
        endian: header.endian,
        encoding,
        scaling: header.scaling(),
        space,
    };
    let between = header.data_offset()? - HEADER as u64;
    io::copy(&mut source.take(between), &mut io::sink()).map_err(trouble)?;
    Ok(layout)
}

/// The bytes of a header, and their order.
struct NiftiHeader<'h> {
    bytes: &'h [u8; HEADER],
    endian: Endian,
}

impl<'h> NiftiHeader<'h> {
    fn new(bytes: &'h [u8; HEADER]) -> Result<NiftiHeader<'h>, VolumeFault> {
        let [little, big] =
            [Endian::Little, Endian::Big].map(|endian| NiftiHeader { bytes, endian });
        let header = match (little.int(0), big.int(0)) {
            (348, _) => Some(little),
            (_, 348) => Some(big),
            _ => None,
        };
        let one_file = |_: &NiftiHeader| bytes.ends_with(b"n+1\0");
        header.filter(one_file).ok_or_else(|| {
            "this is no NIfTI-1 in a single file, whose header begins with its length, 348, and ends in n+1: convert \
             NIfTI-2, and pairs of .hdr and .img, by `nibabel.save` of `nibabel.Nifti1Image.from_image`"
                .into()
        })
    }

    fn word<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut word = [0; N];
        word.copy_from_slice(&self.bytes[at..at + N]);
        if self.endian == Endian::Big {
            word.reverse();
        }
        word
    }

    fn short(&self, at: usize) -> i16 {
        i16::from_le_bytes(self.word(at))
    }

    fn int(&self, at: usize) -> i32 {
        i32::from_le_bytes(self.word(at))
    }

    fn float(&self, at: usize) -> f32 {
        f32::from_le_bytes(self.word(at))
    }

    /// The float at `at`, and the next ones.
    fn floats<const N: usize>(&self, at: usize) -> [f64; N] {
        std::array::from_fn(|index| f64::from(self.float(at + 4 * index)))
    }

    fn sizes(&self) -> Result<[usize; 3], VolumeFault> {
        let count = self.short(40);
        let size = |axis: i16| self.short(40 + 2 * axis as usize);
        let sizes: Vec<i16> = (1..=count.clamp(0, 7)).map(size).collect();
        if sizes.len() < 3
            || sizes.iter().any(|&size| size < 1)
            || sizes[3..].iter().any(|&size| size > 1)
        {
            return refused(format!(
                "the header says {count} axes of {sizes:?} samples, and a volume has three and one value per sample: \
                 write one time or component to a file of its own, as by `image.slicer[..., 0]` of nibabel, and a plane \
                 as `data[:, :, None]` of NumPy"
            ));
        }
        Ok(check_sizes([0, 1, 2].map(|axis| sizes[axis] as u64))?)
    }

    fn element(&self) -> Result<Element, VolumeFault> {
        let code = self.short(70);
        Ok(match code {
            2 => Element::Uint8,
            4 => Element::Int16,
            8 => Element::Int32,
            16 => Element::Float32,
            64 => Element::Float64,
            256 => Element::Int8,
            512 => Element::Uint16,
            768 => Element::Uint32,
            1024 => Element::Int64,
            1280 => Element::Uint64,
            _ => {
                return refused(format!(
                    "the samples are of data type {code}: scalar integers of up to 64 bits, float32 and float64 are \
                     read; write one channel as one of these"
                ));
            }
        })
    }

    fn data_offset(&self) -> Result<u64, VolumeFault> {
        let offset = self.float(108);
        // Some writers leave it 0 and mean the earliest place.
        if offset == 0.0 {
            return Ok(FIRST_DATA);
        }
        if offset >= FIRST_DATA as f32 && offset.fract() == 0.0 {
            return Ok(offset as u64);
        }
        refused(format!(
            "`vox_offset` is {offset}: it must be a whole number of bytes, at least 352"
        ))
    }

    fn scaling(&self) -> Option<(f64, f64)> {
        let [slope, intercept] = self.floats(112);
        let is_none = slope == 0.0 || slope.is_nan() || (slope == 1.0 && intercept == 0.0);
        (!is_none).then_some((slope, intercept))
    }

    /// The numbers from `at` on, which the fields `names` hold: they must be finite.
    fn finite<const N: usize>(&self, at: usize, names: &str) -> Result<[f64; N], VolumeFault> {
        let numbers = self.floats(at);
        match numbers.iter().all(|number| number.is_finite()) {
            true => Ok(numbers),
            false => refused(format!(
                "{names}: {numbers:?} are not finite; correct the header"
            )),
        }
    }

    /// The steps along the axes, the position of the first sample, and the space of both, which have none where neither
    /// form counts.
    fn positions(&self) -> Result<([DVec3; 3], DVec3, Option<&'static str>), VolumeFault> {
        if self.short(254) > 0 {
            let row = |at| self.finite(at, "`srow_x`, `srow_y` and `srow_z`");
            let rows: [[f64; 4]; 3] = [row(280)?, row(296)?, row(312)?];
            let [x, y, z, first] =
                [0, 1, 2, 3].map(|axis| DVec3::from_array(rows.map(|row| row[axis])));
            let space = "RAS+ (right, anterior, superior), by the sform";
            return Ok(([x, y, z], first, Some(space)));
        }
        // As FSL and nibabel do: a sign means nothing, a turn is in the quaternion, a reflection in pixdim[0].
        let spacing = DVec3::from_array(self.finite(80, "`pixdim`")?).abs();
        if self.short(252) <= 0 {
            return Ok((DVec3::AXES.map(|axis| axis * spacing), DVec3::ZERO, None));
        }
        let steps = self.turned(spacing)?;
        let first = self.finite(268, "`qoffset_x`, `qoffset_y` and `qoffset_z`")?;
        let space = "RAS+ (right, anterior, superior), by the qform";
        Ok((steps, DVec3::from_array(first), Some(space)))
    }

    /// The steps along axes that the quaternion of the qform turns.
    fn turned(&self, spacing: DVec3) -> Result<[DVec3; 3], VolumeFault> {
        let handedness = self.float(76);
        let [b, c, d] = self.finite(256, "`quatern_b`, `quatern_c` and `quatern_d`")?;
        let squares = b * b + c * c + d * d;
        let (a, b, c, d) = if 1.0 - squares < NO_COSINE && squares < 1.0 + 1e-5 {
            let length = squares.sqrt();
            (0.0, b / length, c / length, d / length)
        } else if squares < 1.0 {
            ((1.0 - squares).sqrt(), b, c, d)
        } else {
            let [b, c, d] = [b, c, d].map(|part| part as f32);
            return refused(format!(
                "`quatern_b`, `quatern_c` and `quatern_d` are {b}, {c} and {d}, which is not a rotation: their \
                 squares add up to at most 1; correct the qform, or set `qform_code` to 0"
            ));
        };
        let turn = DMat3::from_quat(DQuat::from_xyzw(b, c, d, a));
        let last = spacing.z * if handedness < 0.0 { -1.0 } else { 1.0 };
        Ok([
            turn.x_axis * spacing.x,
            turn.y_axis * spacing.y,
            turn.z_axis * last,
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, read_volume};
    use std::io::Write;

    /// A file of 2 × 1 × 2 little-endian `int16` 1, 2, 3, 4, changed by `change`.
    fn file(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
        let mut bytes = vec![0; HEADER];
        put(&mut bytes, 0, &348_i32.to_le_bytes());
        for (at, value) in [(40, 3), (42, 2), (44, 1), (46, 2), (70, 4), (72, 16)] {
            short(&mut bytes, at, value);
        }
        for (at, value) in [(80, 0.5), (84, 2.0), (88, 3.0), (108, 352.0)] {
            float(&mut bytes, at, value);
        }
        put(&mut bytes, 344, b"n+1\0");
        bytes.extend([0, 0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0]);
        change(&mut bytes);
        bytes
    }

    fn put(bytes: &mut [u8], at: usize, word: &[u8]) {
        bytes[at..at + word.len()].copy_from_slice(word);
    }

    fn short(bytes: &mut [u8], at: usize, value: i16) {
        put(bytes, at, &value.to_le_bytes());
    }

    fn float(bytes: &mut [u8], at: usize, value: f32) {
        put(bytes, at, &value.to_le_bytes());
    }

    fn floats(bytes: &mut [u8], at: usize, values: &[f32]) {
        for (index, &value) in values.iter().enumerate() {
            float(bytes, at + 4 * index, value);
        }
    }

    fn read(bytes: &[u8]) -> Result<Grid<f32>, VolumeFault> {
        read_volume("grid.nii", bytes, None, &LoadOptions::default())
    }

    fn message(change: impl Fn(&mut Vec<u8>)) -> String {
        read(&file(change)).unwrap_err().to_string()
    }

    #[test]
    fn without_a_form_the_first_sample_is_the_origin() {
        let grid = read(&file(|_| {})).unwrap();
        assert_eq!(grid.values(), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(grid.lattice().spacing(), DVec3::new(0.5, 2.0, 3.0));
        assert_eq!(grid.lattice().first(), DVec3::ZERO);
        // A fourth axis of one sample, and an offset left out, change nothing.
        let same = file(|bytes| {
            short(bytes, 40, 4);
            short(bytes, 48, 1);
            float(bytes, 108, 0.0);
        });
        assert_eq!(read(&same).unwrap(), grid);
    }

    /// Half a circle about z: x and y run backwards, and the quaternion has no real part.
    #[test]
    fn quaternions_turn_and_mirror() {
        let turned = |handedness: f32, d: f32| {
            file(|bytes| {
                short(bytes, 252, 1);
                float(bytes, 76, handedness);
                floats(bytes, 256, &[0.0, 0.0, d, 10.0, 20.0, 30.0]);
            })
        };
        for d in [1.0, 0.999_999_94, 1.000_000_1] {
            let grid = read(&turned(1.0, d)).unwrap();
            assert_eq!(grid.values(), [2.0, 1.0, 4.0, 3.0]);
            assert_eq!(grid.lattice().first(), DVec3::new(9.5, 20.0, 30.0));
        }
        let mirrored = read(&turned(-1.0, 1.0)).unwrap();
        assert_eq!(mirrored.values(), [4.0, 3.0, 2.0, 1.0]);
        assert_eq!(mirrored.lattice().first(), DVec3::new(9.5, 20.0, 27.0));
        // A quarter of a circle: x and y change places.
        let quarter = read(&turned(1.0, 0.5_f32.sqrt())).unwrap();
        assert_eq!(quarter.lattice().nodes(), [1, 2, 2]);
        assert!(
            read(&turned(1.0, 0.1))
                .unwrap_err()
                .to_string()
                .contains("rotated by 11.4")
        );
        let said = read(&turned(1.0, 2.0)).unwrap_err().to_string();
        assert!(said.contains("which is not a rotation"), "{said}");
    }

    #[test]
    fn the_sform_comes_first() {
        let bytes = file(|bytes| {
            short(bytes, 252, 1);
            short(bytes, 254, 2);
            floats(bytes, 280, &[0.0, 0.0, 4.0, -1.0]);
            floats(bytes, 296, &[0.0, -1.0, 0.0, 5.0]);
            floats(bytes, 312, &[2.0, 0.0, 0.0, 7.0]);
        });
        let grid = read(&bytes).unwrap();
        assert_eq!(grid.lattice().nodes(), [2, 1, 2]);
        assert_eq!(grid.lattice().spacing(), DVec3::new(4.0, 1.0, 2.0));
        assert_eq!(grid.lattice().first(), DVec3::new(-1.0, 5.0, 7.0));
        assert_eq!(grid.values(), [1.0, 3.0, 2.0, 4.0]);
    }

    #[test]
    fn headers_that_cannot_be() {
        type Change = fn(&mut Vec<u8>);
        let rows: [(Change, &str); 15] = [
            (
                |b| b.truncate(347),
                "the file ends after 347 of the 348 bytes of its header",
            ),
            (
                |b| b.truncate(350),
                "the header declares 2 × 1 × 2 samples of int16, 8 bytes, but 0",
            ),
            (
                |b| b.truncate(359),
                "the header declares 2 × 1 × 2 samples of int16, 8 bytes, but 7",
            ),
            (
                |b| b.push(0),
                "the header declares 2 × 1 × 2 samples of int16, 8 bytes, but 9",
            ),
            (|b| b[0] = 7, "this is no NIfTI-1 in a single file"),
            (|b| put(b, 344, b"ni1\0"), "this is no NIfTI-1"),
            (
                |b| short(b, 40, 2),
                "the header says 2 axes of [2, 1] samples",
            ),
            (|b| short(b, 40, -3), "the header says -3 axes"),
            (|b| short(b, 44, -1), "the header says 3 axes of [2, -1, 2]"),
            (
                |b| short(b, 70, 128),
                "the samples are of data type 128: scalar integers",
            ),
            (|b| float(b, 108, 351.0), "`vox_offset` is 351"),
            (|b| float(b, 108, f32::NAN), "`vox_offset` is NaN"),
            (|b| float(b, 112, f32::INFINITY), "voxel (0, 0, 0)"),
            (|b| float(b, 84, 0.0), "the node spacing must be positive"),
            (
                |b| [42, 44, 46].iter().for_each(|&at| short(b, at, i16::MAX)),
                "a grid of 32767 × 32767 × 32767 nodes is too large",
            ),
        ];
        for (change, expected) in rows {
            let message = message(change);
            assert!(message.starts_with(expected), "{message}");
        }
    }

    /// The field that is wrong, whichever form it belongs to.
    #[test]
    fn faults_of_positions_name_their_field() {
        let qform = |bytes: &mut Vec<u8>| short(bytes, 252, 1);
        let sform = |bytes: &mut Vec<u8>| {
            short(bytes, 254, 2);
            floats(bytes, 280, &[0.5, 0.0, 0.0, 1.0]);
            floats(bytes, 296, &[0.0, 2.0, 0.0, 2.0]);
            floats(bytes, 312, &[0.0, 0.0, 3.0, 3.0]);
        };
        type Change = fn(&mut Vec<u8>);
        let faults: [(Change, usize, f32, &str); 7] = [
            (qform, 80, -1.0, ""),
            (qform, 88, f32::NAN, "`pixdim`: "),
            (qform, 260, f32::NAN, "`quatern_b`, "),
            (qform, 276, f32::INFINITY, "`qoffset_x`, "),
            (sform, 280, f32::NAN, "`srow_x`, "),
            (sform, 320, 0.0, "the node spacing must be positive"),
            (sform, 80, -1.0, ""),
        ];
        for (form, at, value, expected) in faults {
            assert!(read(&file(form)).is_ok());
            let read = read(&file(|bytes| {
                form(bytes);
                float(bytes, at, value);
            }));
            match read {
                Ok(_) => assert_eq!(expected, "", "what does not count is not looked at"),
                Err(error) => assert!(error.to_string().starts_with(expected), "{error}"),
            }
        }
    }

    #[test]
    fn axes_that_are_no_space() {
        for (axis, count) in [(4, 4), (5, 5)] {
            let message = message(|bytes| {
                short(bytes, 40, count);
                for at in [48, 50] {
                    short(bytes, at, 1);
                }
                short(bytes, 40 + 2 * axis, 3);
            });
            let said = format!("the header says {count} axes of [2, 1, 2, ");
            assert!(message.starts_with(&said), "{message}");
        }
    }

    #[test]
    fn compressed_files_end_where_they_should() {
        let gzip = |bytes: &[u8]| {
            let level = flate2::Compression::best();
            let mut encoder = flate2::write::GzEncoder::new(Vec::new(), level);
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        };
        let options = LoadOptions::default();
        let read = |bytes: &[u8]| read_volume("grid.nii.gz", bytes, None, &options);
        let whole = file(|_| {});
        assert_eq!(read(&gzip(&whole)).unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
        let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(message(&whole).contains("gzip"));
        let short = message(&gzip(&whole[..357]));
        assert!(short.starts_with(
            "the header declares 2 × 1 × 2 samples of int16, but the data end after 2"
        ));
        let mut long = whole.clone();
        long.extend([0; 100_000]);
        assert!(message(&gzip(&long)).contains("there is more data after them"));
    }
}
