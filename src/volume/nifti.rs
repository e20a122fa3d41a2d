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
use super::format::{Stored, VolumeFormat, VolumeRead};
use super::orientation::{Axes, AxisSteps};
use super::samples::{check_sizes, fill, read_grid, read_unpacked};
use super::source::VolumeSource;
use super::{Centring, Element, Encoding, Endian, Grid, LatticeError, Layout, LoadOptions};
use crate::decoder::Guarded;
use glam::DVec3;
use std::io::{self, BufReader, Read};

/// Bytes of the header.
const HEADER: usize = 348;

/// Where the data begin at the earliest: four bytes after the header say whether more follows.
const FIRST_DATA: u64 = 352;

/// The square of a quaternion's real part that is lost in the rounding of the other three to
/// `f32`, at most 2⁻²⁴ of each, hence 2⁻²³ of the sum of their squares; twice that. A turn by half a
/// circle would else come out tilted by a thousandth.
const NO_COSINE: f64 = 1.0 / (1 << 22) as f64;

/// NIfTI-1, compressed or not.
pub(super) const NIFTI: VolumeFormat = VolumeFormat {
    name: "NIfTI-1",
    extensions: &[".nii", ".nii.gz"],
    is_point_cloud: false,
    read: |source, options| read(source, source.ends_in(".gz"), options),
};

/// Reads a NIfTI-1 file; `compressed` tells `.nii.gz` from `.nii`.
pub fn read_nifti(
    bytes: &[u8],
    compressed: bool,
    options: &LoadOptions,
) -> Result<Grid<f32>, VolumeFault> {
    read(&mut VolumeSource::of(bytes), compressed, options).map(|(grid, _)| grid)
}

fn read(source: &mut VolumeSource, compressed: bool, options: &LoadOptions) -> VolumeRead {
    if !compressed {
        let layout = layout(source, Encoding::Raw, VolumeFault::from)?;
        let grid = read_grid(source, &layout, options)?;
        return Ok((grid, Stored::Samples(layout)));
    }
    let trouble = |error: io::Error| {
        format!("the gzip stream is damaged ({error}): compress the file again, or copy it again")
            .into()
    };
    // Header and data are one stream, so it is unpacked here and read as if it were raw; how long
    // it is nobody knows before its end.
    let length = source.remaining();
    let unpacked = Guarded(flate2::bufread::MultiGzDecoder::new(source));
    let mut unpacked = BufReader::with_capacity(1 << 16, unpacked);
    let layout = layout(&mut unpacked, Encoding::Gzip, trouble)?;
    let grid = read_unpacked(&mut unpacked, length, &layout, options)?;
    Ok((grid, Stored::Samples(layout)))
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
    let layout = Layout {
        axes: Axes {
            sizes: header.sizes()?,
            steps: header.steps()?,
            first: header.first(),
            centring: Centring::Nodes,
        },
        element: header.element()?,
        endian: header.endian,
        encoding,
        scaling: header.scaling()?,
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
        let little = NiftiHeader {
            bytes,
            endian: Endian::Little,
        };
        let big = NiftiHeader {
            bytes,
            endian: Endian::Big,
        };
        let header = match (little.int(0), big.int(0)) {
            (348, _) => little,
            (_, 348) => big,
            (540, _) | (_, 540) => {
                return refused("this is NIfTI-2, but only NIfTI-1 is supported: convert it");
            }
            _ => {
                let message = "the header does not begin with its length, 348: this is not a \
                NIfTI-1 file";
                return refused(message);
            }
        };
        let message = match &bytes[344..] {
            b"n+1\0" => return Ok(header),
            b"ni1\0" => {
                "the header belongs to a pair of files, .hdr and .img: convert them to one .nii"
            }
            _ => "the header does not end in the letters n+1: this is not a single-file NIfTI-1",
        };
        refused(message)
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
        let dimensions = self.short(40);
        let count = dimensions.clamp(0, 7);
        let sizes: Vec<i16> = (1..=count)
            .map(|axis| self.short(40 + 2 * axis as usize))
            .collect();
        let three = dimensions == count
            && sizes.len() >= 3
            && sizes.iter().all(|&size| size > 0)
            && sizes[3..].iter().all(|&size| size == 1);
        if !three {
            let sizes: Vec<String> = sizes.iter().map(i16::to_string).collect();
            return refused(format!(
                "the file has {} samples: a volume has three axes and one value per sample; split \
                the file",
                sizes.join(" × ")
            ));
        }
        Ok(check_sizes([0, 1, 2].map(|axis| sizes[axis] as u64))?)
    }

    fn element(&self) -> Result<Element, VolumeFault> {
        let code = self.short(70);
        let element = match code {
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
            _ => return Err(unread_type(code)),
        };
        let (bits, expected) = (self.short(72), 8 * element.bytes());
        if i64::from(bits) != expected as i64 {
            return refused(format!(
                "the header says {bits} bits to a sample, and its data type has {expected}"
            ));
        }
        Ok(element)
    }

    fn data_offset(&self) -> Result<u64, VolumeFault> {
        let offset = self.float(108);
        // Some writers leave it 0 and mean the earliest place.
        if offset == 0.0 {
            return Ok(FIRST_DATA);
        }
        // Beyond 2⁴⁰ nothing is a file; whole numbers are exact below.
        let possible = (FIRST_DATA as f32..1e12).contains(&offset) && offset.fract() == 0.0;
        if possible {
            return Ok(offset as u64);
        }
        Err(
            format!("the data begin at byte {offset}: that must be a whole number of at least 352")
                .into(),
        )
    }

    fn scaling(&self) -> Result<Option<(f64, f64)>, VolumeFault> {
        let (slope, intercept) = (self.float(112), self.float(116));
        if slope == 0.0 || slope.is_nan() {
            return Ok(None);
        }
        if !(slope.is_finite() && intercept.is_finite()) {
            return refused(format!(
                "slope {slope} and intercept {intercept} of the values: both must be finite"
            ));
        }
        let (slope, intercept) = (f64::from(slope), f64::from(intercept));
        Ok((slope != 1.0 || intercept != 0.0).then_some((slope, intercept)))
    }

    fn by_sform(&self) -> bool {
        self.short(254) > 0
    }

    fn by_qform(&self) -> bool {
        self.short(252) > 0
    }

    /// Rows of the sform: three numbers of the matrix and one of the origin.
    fn sform(&self) -> [[f64; 4]; 3] {
        [280, 296, 312].map(|at| self.floats(at))
    }

    fn first(&self) -> DVec3 {
        if self.by_sform() {
            DVec3::from_array(self.sform().map(|row| row[3]))
        } else if self.by_qform() {
            DVec3::from_array(self.floats(268))
        } else {
            DVec3::ZERO
        }
    }

    fn steps(&self) -> Result<AxisSteps, VolumeFault> {
        if self.by_sform() {
            let rows = self.sform();
            let column = |axis: usize| DVec3::from_array([0, 1, 2].map(|row| rows[row][axis]));
            return Ok(AxisSteps::Directed([column(0), column(1), column(2)]));
        }
        let [handedness, dx, dy, dz] = self.floats(76);
        if !self.by_qform() {
            return Ok(AxisSteps::Upright(DVec3::new(dx, dy, dz)));
        }
        let [b, c, d] = self.floats(256);
        let squares = b * b + c * c + d * d;
        let (a, b, c, d) = if 1.0 - squares < NO_COSINE && squares < 1.0 + 1e-5 {
            let length = squares.sqrt();
            (0.0, b / length, c / length, d / length)
        } else if squares < 1.0 {
            ((1.0 - squares).sqrt(), b, c, d)
        } else {
            let [b, c, d] = [256, 260, 264].map(|at| self.float(at));
            let message = format!("the qform of the header, ({b}, {c}, {d}), is not a rotation");
            return refused(message);
        };
        let dz = if handedness < 0.0 { -dz } else { dz };
        let x = DVec3::new(
            a * a + b * b - c * c - d * d,
            2.0 * (b * c + a * d),
            2.0 * (b * d - a * c),
        );
        let y = DVec3::new(
            2.0 * (b * c - a * d),
            a * a + c * c - b * b - d * d,
            2.0 * (c * d + a * b),
        );
        let z = DVec3::new(
            2.0 * (b * d + a * c),
            2.0 * (c * d - a * b),
            a * a + d * d - c * c - b * b,
        );
        // Negative sizes of voxels mean nothing: the turn is in the quaternion.
        if !(dx > 0.0 && dy > 0.0 && dz != 0.0) || self.float(88) <= 0.0 {
            let spacing = DVec3::from_array(self.floats(80));
            return Err(LatticeError::Spacing(spacing).into());
        }
        Ok(AxisSteps::Directed([x * dx, y * dy, z * dz]))
    }
}

/// The error of a type that is no scalar, or none that is known.
fn unread_type(code: i16) -> VolumeFault {
    let name = match code {
        1 => " (bits)",
        32 => " (complex64)",
        128 => " (RGB)",
        1536 => " (float128)",
        1792 => " (complex128)",
        2048 => " (complex256)",
        2304 => " (RGBA)",
        _ => "",
    };
    format!(
        "the samples are of data type {code}{name}: scalar integers of up to 64 bits, float32 and \
         float64 are read"
    )
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;
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
        read_nifti(bytes, false, &LoadOptions::default())
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
        assert_eq!(
            read(&turned(1.0, 2.0)).unwrap_err().to_string(),
            "the qform of the header, (0, 0, 2), is not a rotation"
        );
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
        let rows: [(Change, &str); 18] = [
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
            (
                |b| b[0] = 7,
                "the header does not begin with its length, 348",
            ),
            (
                |b| put(b, 0, &540_i32.to_be_bytes()),
                "this is NIfTI-2, but only NIfTI-1 is supported",
            ),
            (
                |b| put(b, 344, b"ni1\0"),
                "the header belongs to a pair of files, .hdr and .img",
            ),
            (
                |b| put(b, 344, b"\0\0\0\0"),
                "the header does not end in the letters n+1",
            ),
            (
                |b| short(b, 40, 2),
                "the file has 2 × 1 samples: a volume has three axes",
            ),
            (
                |b| short(b, 40, -3),
                "the file has  samples: a volume has three axes",
            ),
            (|b| short(b, 44, -1), "the file has 2 × -1 × 2 samples"),
            (
                |b| short(b, 70, 128),
                "the samples are of data type 128 (RGB): scalar integers",
            ),
            (
                |b| short(b, 72, 8),
                "the header says 8 bits to a sample, and its data type has 16",
            ),
            (|b| float(b, 108, 351.0), "the data begin at byte 351"),
            (|b| float(b, 108, f32::NAN), "the data begin at byte NaN"),
            (
                |b| float(b, 112, f32::INFINITY),
                "slope inf and intercept 0 of the values",
            ),
            (
                |b| float(b, 84, 0.0),
                "the node spacing must be positive and finite",
            ),
            (
                |b| [42, 44, 46].iter().for_each(|&at| short(b, at, i16::MAX)),
                "a grid of 32767 × 32767 × 32767 nodes is too large",
            ),
        ];
        for (change, expected) in rows {
            let message = message(change);
            assert!(message.starts_with(expected), "{message}");
        }
        // With a form, impossible sizes of voxels do not come through either.
        let negative = message(|b| {
            short(b, 252, 1);
            float(b, 80, -1.0);
        });
        assert!(
            negative.contains("must be positive and finite"),
            "{negative}"
        );
    }

    #[test]
    fn compressed_files_end_where_they_should() {
        let gzip = |bytes: &[u8]| {
            let level = flate2::Compression::best();
            let mut encoder = flate2::write::GzEncoder::new(Vec::new(), level);
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        };
        let read = |bytes: &[u8]| read_nifti(bytes, true, &LoadOptions::default());
        let whole = file(|_| {});
        assert_eq!(read(&gzip(&whole)).unwrap().values(), [1.0, 2.0, 3.0, 4.0]);
        let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert!(message(&whole).starts_with("the gzip stream is damaged"));
        let short = message(&gzip(&whole[..357]));
        assert!(
            short.starts_with("the header declares 2 × 1 × 2 samples, but the data ends after 2")
        );
        let mut long = whole.clone();
        long.extend([0; 100_000]);
        assert!(message(&gzip(&long)).starts_with("there is data after the 2 × 1 × 2 samples"));
    }
}
