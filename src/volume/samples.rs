//! The samples of a grid file: their storage, and their conversion to `f32`.
//!
//! Every header of a grid file becomes a [`Layout`]; reading the samples is the same for all
//! formats. A header is checked against the length of the file before memory is allocated; for a
//! compressed file, memory grows with the data received.

use super::error::{VolumeFault, refused};
use super::orientation::Axes;
use super::source::VolumeSource;
use super::{Grid, Lattice, LoadOptions, NonFinite};
use crate::files::decoder::Guarded;
use crate::files::gzip;
use crate::geometry::{Aabb, InvalidParameter};
use glam::DVec3;
use serde::Deserialize;
use std::io::{self, Read};

/// Declares the types of samples, one a row: name, type of Rust, and whether it is of whole numbers.
macro_rules! elements {
    ($($(#[$doc:meta])+ $variant:ident = $name:literal, $kind:ident $type:ty;)+) => {
        /// The type of a stored sample.
        #[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
        #[serde(rename_all = "lowercase")]
        pub enum Element { $($(#[$doc])+ $variant,)+ }

        impl Element {
            /// Every type, by its name.
            pub const ALL: [(&'static str, Element); 11] = [$(($name, Element::$variant),)+];

            /// Bytes of one sample.
            pub fn bytes(self) -> usize {
                match self { $(Element::$variant => size_of::<$type>(),)+ }
            }

            /// Least and most whole number; `None` of floating-point types.
            fn whole_range(self) -> Option<(i128, i128)> {
                match self { $(Element::$variant => elements!(range $kind $type),)+ }
            }
        }

        impl Samples<'_> {
            fn decode(&mut self, bytes: &[u8]) -> Result<(), VolumeFault> {
                match (self.layout.element, self.layout.endian) {$(
                    (Element::$variant, Endian::Little) => {
                        self.push(bytes, |word| elements!(number $kind <$type>::from_le_bytes(word)))
                    }
                    (Element::$variant, Endian::Big) => {
                        self.push(bytes, |word| elements!(number $kind <$type>::from_be_bytes(word)))
                    }
                )+}
            }
        }
    };
    (range whole $type:ty) => { Some((<$type>::MIN as i128, <$type>::MAX as i128)) };
    (range float $type:ty) => { None };
    (number whole $value:expr) => { $value as f64 };
    (number float $value:expr) => { f64::from($value) };
}

elements! {
    /// Signed, 8 bits.
    Int8 = "int8", whole i8;
    /// Unsigned, 8 bits.
    Uint8 = "uint8", whole u8;
    /// Signed, 16 bits.
    Int16 = "int16", whole i16;
    /// Unsigned, 16 bits.
    Uint16 = "uint16", whole u16;
    /// Signed, 32 bits.
    Int32 = "int32", whole i32;
    /// Unsigned, 32 bits.
    Uint32 = "uint32", whole u32;
    /// Signed, 64 bits.
    Int64 = "int64", whole i64;
    /// Unsigned, 64 bits.
    Uint64 = "uint64", whole u64;
    /// IEEE 754 half precision.
    Float16 = "float16", float half::f16;
    /// IEEE 754 single precision.
    Float32 = "float32", float f32;
    /// IEEE 754 double precision.
    Float64 = "float64", float f64;
}

impl Element {
    /// Its name, such as `uint16`.
    pub fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, element)| *element == self);
        found.expect("every type has a name").0
    }
}

/// The order of the bytes of a sample.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Endian {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

/// Encoding of samples.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Encoding {
    /// Binary, as in memory.
    Raw,
    /// Raw, then compressed by gzip.
    Gzip,
    /// Raw, then compressed by zlib.
    #[serde(skip)]
    Zlib,
    /// As decimal numbers with blanks or commas between them.
    #[serde(skip)]
    Text,
}

impl Encoding {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Encoding::Raw => "raw",
            Encoding::Gzip => "gzip",
            Encoding::Zlib => "zlib",
            Encoding::Text => "text",
        }
    }
}

/// The layout of the samples of a grid in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Positions of the samples.
    pub axes: Axes,
    /// Type of a sample.
    pub element: Element,
    /// Order of its bytes; irrelevant for samples of one byte and for text.
    pub endian: Endian,
    /// Encoding of samples.
    pub encoding: Encoding,
    /// Slope a and intercept b: a stored sample s stands for the value `a·s + b`.
    pub scaling: Option<(f64, f64)>,
    /// Coordinate system of the positions, where the file states one.
    pub space: Option<&'static str>,
}

impl Layout {
    /// Binary samples, little endian, as they stand.
    pub(super) fn raw(element: Element, axes: Axes) -> Layout {
        Layout {
            axes,
            element,
            endian: Endian::Little,
            encoding: Encoding::Raw,
            scaling: None,
            space: None,
        }
    }

    /// Bytes of all samples, not compressed. No overflow: a lattice has at most 2³¹ nodes.
    pub(super) fn promised(&self) -> u64 {
        let count: usize = self.axes.sizes.iter().product();
        count as u64 * self.element.bytes() as u64
    }
}

/// Grid of a file, and its storage.
pub(super) type VolumeRead = Result<(Grid<f32>, Stored), VolumeFault>;

/// The storage of a volume in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Stored {
    /// As points.
    Cloud {
        /// Number of points.
        points: usize,
        /// The box around them.
        extent: Aabb,
    },
    /// As samples of a grid.
    Samples {
        /// Their layout.
        layout: Layout,
    },
}

/// Reads the samples that follow a header, and all that follows them: nothing may.
///
/// Values are computed in `f64` and rounded to `f32` once more.
pub(super) fn read_grid(
    source: &mut VolumeSource,
    layout: &Layout,
    options: &LoadOptions,
) -> VolumeRead {
    let remaining = source.remaining;
    match layout.encoding {
        Encoding::Raw => read_as(layout, options, &mut |samples| {
            samples.check_length(remaining)?;
            samples.reserve(samples.count)?;
            samples.read_binary(source, VolumeFault::from)
        }),
        Encoding::Gzip => {
            let mut unpacked = gzip::Unpacked::new(source);
            read_unpacked(&mut unpacked, remaining, layout, options)
        }
        Encoding::Zlib => {
            let zlib = flate2::bufread::ZlibDecoder::new(source);
            read_unpacked(&mut Guarded(zlib), remaining, layout, options)
        }
        // A digit and a blank are the shortest sample; a last one without the blank is refused when it is read.
        Encoding::Text => read_as(layout, options, &mut |samples| {
            let most = 0.5 * layout.element.bytes() as f64;
            samples.check_density(remaining.saturating_add(1), most)?;
            samples.read_text(source)
        }),
    }
}

/// As [`read_grid`], for samples that `source` unpacks from a file of `length` bytes.
pub(super) fn read_unpacked(
    source: &mut dyn Read,
    length: u64,
    layout: &Layout,
    options: &LoadOptions,
) -> VolumeRead {
    let trouble = |error: io::Error| {
        let message = "compress the file again, or copy it again";
        format!("the compressed stream of the data is damaged ({error}): {message}").into()
    };
    read_as(layout, options, &mut |samples| {
        samples.check_density(length, MOST_EXPANSION)?;
        samples.read_binary(source, trouble)
    })
}

/// Checks the positions of the samples, reads them by `read`, and puts them there.
fn read_as(
    layout: &Layout,
    options: &LoadOptions,
    read: &mut dyn FnMut(&mut Samples) -> Result<(), VolumeFault>,
) -> VolumeRead {
    let placement = layout
        .axes
        .placement(options.centring, options.orientation)?;
    let mut samples = Samples {
        layout,
        non_finite: options.non_finite,
        count: layout.axes.sizes.iter().product(),
        values: Vec::new(),
    };
    read(&mut samples)?;
    let values = placement.put(samples.values, layout.axes.sizes);
    let grid = Grid::new(placement.lattice, values).expect("one value per node");
    Ok((grid, Stored::Samples { layout: *layout }))
}

/// Deflate cannot do better than 1032 to 1: 258 bytes from two bits.
///
/// Source: zlib's technical notes, "Maximum compression factor".
const MOST_EXPANSION: f64 = 1032.0;

/// Bytes decoded at a time: a multiple of every sample's size, small enough for the cache.
const CHUNK: usize = 1 << 18;

/// Longest number read from text.
const LONGEST_NUMBER: usize = 64;

/// Bytes of text that a number takes at most, blanks included: a longer text is not held in memory.
const MOST_OF_A_NUMBER: u64 = 256;

struct Samples<'l> {
    layout: &'l Layout,
    non_finite: NonFinite,
    count: usize,
    values: Vec<f32>,
}

impl Samples<'_> {
    fn check_length(&self, found: u64) -> Result<(), VolumeFault> {
        let promised = self.layout.promised();
        match found == promised {
            true => Ok(()),
            false => refused(
                self.wrong_length(&format!("{promised} bytes, but {found} bytes follow it")),
            ),
        }
    }

    fn check_density(&self, found: u64, most_expansion: f64) -> Result<(), VolumeFault> {
        let promised = self.layout.promised();
        if promised as f64 <= found as f64 * most_expansion {
            return Ok(());
        }
        let what = format!("{promised} bytes, which the {found} bytes that follow it cannot hold");
        refused(self.wrong_length(&what))
    }

    /// Makes room for `more` samples.
    fn reserve(&mut self, more: usize) -> Result<(), VolumeFault> {
        let count = self.count;
        self.values.try_reserve_exact(more).map_err(|_| {
            format!("no memory for {count} samples: cut the file into parts, or thin it out").into()
        })
    }

    /// Makes room for `more` samples where there is none, and for an eighth beside: memory stays
    /// in proportion to what has arrived, and little is left over.
    fn grow(&mut self, more: usize) -> Result<(), VolumeFault> {
        if self.values.capacity() - self.values.len() >= more {
            return Ok(());
        }
        let missing = self.count - self.values.len();
        self.reserve(missing.min(more + self.values.len() / 8))
    }

    fn read_binary(
        &mut self,
        source: &mut dyn Read,
        trouble: fn(io::Error) -> VolumeFault,
    ) -> Result<(), VolumeFault> {
        let bytes_each = self.layout.element.bytes();
        let mut chunk = vec![0; CHUNK];
        while self.values.len() < self.count {
            let wanted = (self.count - self.values.len()).min(CHUNK / bytes_each);
            let chunk = &mut chunk[..wanted * bytes_each];
            let filled = fill(source, chunk).map_err(trouble)?;
            let whole = filled / bytes_each;
            self.grow(whole)?;
            self.decode(&chunk[..whole * bytes_each])?;
            if filled < chunk.len() {
                return refused(self.ends());
            }
        }
        // Reading the end of a gzip stream is also what checks its sum.
        match fill(source, &mut [0]).map_err(trouble)? {
            0 => Ok(()),
            _ => refused(self.goes_on()),
        }
    }

    fn push<const N: usize>(
        &mut self,
        bytes: &[u8],
        number: impl Fn([u8; N]) -> f64,
    ) -> Result<(), VolumeFault> {
        let (words, _) = bytes.as_chunks::<N>();
        let start = self.values.len();
        match self.layout.scaling {
            None => self.values.extend(words.iter().map(|&b| number(b) as f32)),
            Some((slope, intercept)) => {
                let scaled = words.iter().map(|&b| slope * number(b) + intercept);
                self.values.extend(scaled.map(|value| value as f32));
            }
        }
        let wrong = self.values[start..].iter().position(|v| !v.is_finite());
        let Some(first) = wrong else {
            return Ok(());
        };
        let stored = number(words[first]);
        self.mend(start, start + first, stored)
    }

    /// Deals with values that are not finite, from `start` on; `first` is the first of them, and
    /// stands for the stored sample `stored`.
    fn mend(&mut self, start: usize, first: usize, stored: f64) -> Result<(), VolumeFault> {
        match self.non_finite {
            NonFinite::Kept => Ok(()),
            NonFinite::Replaced(by) => {
                let values = self.values[start..].iter_mut();
                values
                    .filter(|value| !value.is_finite())
                    .for_each(|value| *value = by);
                Ok(())
            }
            NonFinite::Refused => {
                let [nx, ny, _] = self.layout.axes.sizes;
                let [i, j, k] = [first % nx, first / nx % ny, first / nx / ny];
                let scaling = self.layout.scaling;
                let value = scaling.map_or(stored, |(slope, intercept)| slope * stored + intercept);
                refused(format!(
                    "voxel ({i}, {j}, {k}) in the order of the file holds {value}: values must be \
                     finite, and not beyond 3.4e38; correct it, or set \
                     `replace_non_finite` beside `file` in the scene, to a value that replaces it"
                ))
            }
        }
    }

    fn read_text(&mut self, source: &mut VolumeSource) -> Result<(), VolumeFault> {
        let separates = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
        if source.remaining > self.count as u64 * MOST_OF_A_NUMBER + CHUNK as u64 {
            return refused(self.goes_on());
        }
        let (first_line, mut text, mut at) = (source.line + 1, Vec::new(), 0);
        source.read_to_end(&mut text)?;
        for piece in text.split_inclusive(separates) {
            let word = piece.strip_suffix(b",").unwrap_or(piece).trim_ascii();
            let before = &text[..at];
            at += piece.len();
            if word.is_empty() {
                continue;
            }
            if self.values.len() == self.count {
                return refused(self.goes_on());
            }
            let is_ended = piece.last().is_some_and(separates);
            let number = self.number(word, is_ended).map_err(|message| {
                let line = first_line + before.iter().filter(|byte| **byte == b'\n').count();
                let mut lines = before.rsplit(|byte| *byte == b'\n');
                let column = 1 + lines.next().map_or(0, <[u8]>::len);
                let (index, word) = (self.values.len(), &word[..word.len().min(LONGEST_NUMBER)]);
                let word = String::from_utf8_lossy(word);
                VolumeFault::Line(format!(
                    "{line}:{column}: sample {index} is {word:?}, {message}"
                ))
            })?;
            self.grow(1)?;
            self.push(&[0; 1], |_: [u8; 1]| number)?;
        }
        match self.values.len() < self.count {
            true => refused(self.ends()),
            false => Ok(()),
        }
    }

    /// The sample that `word` stands for, or what it is instead.
    fn number(&self, word: &[u8], is_ended: bool) -> Result<f64, String> {
        let text = std::str::from_utf8(word)
            .ok()
            .filter(|text| text.len() <= LONGEST_NUMBER);
        let number = text.and_then(|text| text.parse::<f64>().ok());
        let (text, number) = text.zip(number).ok_or("no number")?;
        // Writers end the last number as they do the others; one that is cut short is a number, too.
        if !is_ended && self.values.len() + 1 == self.count {
            return Err(
                "the last, and may have lost digits: end the text with a line break".to_owned(),
            );
        }
        if let Some((least, most)) = self.layout.element.whole_range() {
            // Some write large ones as 1e+17.
            let fits = match text.parse::<i128>() {
                Ok(whole) => (least..=most).contains(&whole),
                Err(_) => number.fract() == 0.0 && (least as f64..=most as f64).contains(&number),
            };
            if !fits {
                let element = self.layout.element.name();
                return Err(format!(
                    "no {element}, a whole number from {least} to {most}: correct it, or the type in the header"
                ));
            }
        }
        Ok(number)
    }

    fn ends(&self) -> String {
        let found = self.values.len();
        self.wrong_length(&format!("but the data end after {found}"))
    }

    fn goes_on(&self) -> String {
        self.wrong_length("but there is more data after them")
    }

    /// The header and the data contradict each other.
    fn wrong_length(&self, what: &str) -> String {
        let sizes = self.layout.axes.sizes.map(|size| size.to_string());
        format!(
            "the header declares {} samples of {}, {what}: the file is truncated, has extra data, or has a wrong type or \
             size in its header",
            sizes.join(" × "),
            self.layout.element.name()
        )
    }
}

/// Reads until `bytes` are full or the source ends. The number of bytes read.
pub(super) fn fill(source: &mut dyn Read, bytes: &mut [u8]) -> io::Result<usize> {
    let mut filled = 0;
    while filled < bytes.len() {
        match source.read(&mut bytes[filled..]) {
            Ok(0) => break,
            Ok(count) => filled += count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(filled)
}

/// The first `N` words of 32 bits of a file, little endian: its header.
pub(super) struct Words<const N: usize>(pub [[u8; 4]; N]);

impl<const N: usize> Words<N> {
    pub(super) fn read(source: &mut dyn Read) -> Result<Words<N>, VolumeFault> {
        let mut words = [[0; 4]; N];
        let filled = fill(source, words.as_flattened_mut())?;
        if filled < 4 * N {
            return refused(format!(
                "the file ends after {filled} of the {} bytes of its header",
                4 * N
            ));
        }
        Ok(Words(words))
    }

    pub(super) fn int(&self, word: usize) -> i32 {
        i32::from_le_bytes(self.0[word])
    }

    /// Three numbers from this word on.
    pub(super) fn vector(&self, word: usize) -> DVec3 {
        let number = |axis| f64::from(f32::from_le_bytes(self.0[word + axis]));
        DVec3::new(number(0), number(1), number(2))
    }

    /// Samples along three axes, from this word on.
    pub(super) fn sizes(&self, word: usize) -> Result<[usize; 3], VolumeFault> {
        let counts @ [nx, ny, nz] = [0, 1, 2].map(|axis| self.int(word + axis));
        if counts.iter().any(|&count| count < 1) {
            return refused(format!(
                "the header gives {nx} × {ny} × {nz} samples, and each axis needs at least 1: is this file little \
                 endian?"
            ));
        }
        Ok(check_sizes(counts.map(|count| count as u64))?)
    }
}

/// Checks that a file may have `sizes` samples: what [`Lattice::check_count`] says about nodes, none
/// of which is beyond 2³¹ then.
pub(super) fn check_sizes(sizes: [u64; 3]) -> Result<[usize; 3], InvalidParameter> {
    Lattice::check_count(sizes)?;
    Ok(sizes.map(|size| size as usize))
}

#[cfg(test)]
mod tests {
    use super::super::Centring;
    use super::*;
    use glam::DVec3;
    use std::io::Write;

    fn layout(element: Element, endian: Endian, encoding: Encoding, sizes: [usize; 3]) -> Layout {
        Layout {
            axes: Axes {
                sizes,
                steps: DVec3::AXES,
                first: DVec3::ZERO,
                centring: Centring::Nodes,
            },
            element,
            endian,
            encoding,
            scaling: None,
            space: None,
        }
    }

    fn read(layout: &Layout, bytes: &[u8]) -> Result<Vec<f32>, VolumeFault> {
        let options = LoadOptions::default();
        let grid = read_grid(&mut VolumeSource::of("", bytes, None), layout, &options);
        grid.map(|(grid, _)| grid.values().to_vec())
    }

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn every_type_in_either_order() {
        macro_rules! check {
            ($($element:ident: $type:ty = $least:expr, $most:expr;)*) => {$({
                let values: [$type; 2] = [$least, $most];
                let expected = values.map(|value| f64::from(value as f32));
                for (endian, bytes) in [
                    (Endian::Little, values.map(<$type>::to_le_bytes).concat()),
                    (Endian::Big, values.map(<$type>::to_be_bytes).concat()),
                ] {
                    let layout = layout(Element::$element, endian, Encoding::Raw, [2, 1, 1]);
                    let read = read(&layout, &bytes).unwrap();
                    let read: Vec<f64> = read.into_iter().map(f64::from).collect();
                    assert_eq!(read, expected, "{layout:?}");
                }
            })*};
        }
        check! {
            Int8: i8 = i8::MIN, i8::MAX;
            Uint8: u8 = 1, u8::MAX;
            Int16: i16 = i16::MIN, 0x102;
            Uint16: u16 = 0x102, u16::MAX;
            Int32: i32 = i32::MIN, 0x10203;
            Uint32: u32 = 0x10203, u32::MAX;
            Int64: i64 = i64::MIN, 0x10203;
            Uint64: u64 = 0x10203, u64::MAX;
            Float32: f32 = -1.5e-40, f32::MAX;
            Float64: f64 = 0.1, -1e-300;
        }
        let halves = layout(Element::Float16, Endian::Big, Encoding::Raw, [2, 1, 1]);
        assert_eq!(
            read(&halves, &[0x3c, 0, 0xfb, 0xff]).unwrap(),
            [1.0, -65504.0]
        );
    }

    #[test]
    fn many_chunks() {
        let values: Vec<u16> = (0..400_000_u32).map(|v| (v % 65_521) as u16).collect();
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let raw = layout(
            Element::Uint16,
            Endian::Little,
            Encoding::Raw,
            [400, 100, 10],
        );
        let expected: Vec<f32> = values.iter().map(|&v| f32::from(v)).collect();
        assert_eq!(read(&raw, &bytes).unwrap(), expected);
        let packed = Layout {
            encoding: Encoding::Gzip,
            ..raw
        };
        assert_eq!(read(&packed, &gzip(&bytes)).unwrap(), expected);
        // Two streams, one after the other, as some compressors in parallel write them.
        let parts = [gzip(&bytes[..7]), gzip(&bytes[7..])].concat();
        assert_eq!(read(&packed, &parts).unwrap(), expected);
    }

    #[test]
    fn slopes_are_applied_before_rounding() {
        let mut layout = layout(Element::Int16, Endian::Little, Encoding::Raw, [2, 1, 1]);
        layout.scaling = Some((0.1, -1024.0));
        let read = read(&layout, &[3, 0, 255, 255]).unwrap();
        assert_eq!(read, [(0.1 * 3.0 - 1024.0) as f32, (-0.1 - 1024.0) as f32]);
    }

    /// Nothing beyond what the header declares is unpacked, and nothing is set aside for a
    /// promise that the file cannot keep.
    #[test]
    fn gzip_that_lies() {
        let packed = |sizes| layout(Element::Uint8, Endian::Little, Encoding::Gzip, sizes);
        let message = |sizes, bytes: &[u8]| read(&packed(sizes), bytes).unwrap_err().to_string();
        let bomb = gzip(&vec![0; 50_000_000]);
        assert!(bomb.len() < 50_000);
        assert!(message([2, 2, 2], &bomb).contains("there is more data after them"));
        assert!(message([1290, 1290, 1290], &bomb).contains("that follow it cannot hold"));
        let sound = gzip(&[1; 8]);
        assert!(message([3, 3, 1], &sound).contains("but the data end after 8"));
        assert!(
            message([2, 2, 2], &sound[..sound.len() - 5])
                .contains("the compressed stream of the data is damaged")
        );
        let mut wrong_sum = sound.clone();
        wrong_sum[sound.len() - 8] ^= 1;
        assert!(
            message([2, 2, 2], &wrong_sum).contains("the compressed stream of the data is damaged")
        );
        assert!(
            message([2, 2, 2], b"<!DOCTYPE html>")
                .contains("the compressed stream of the data is damaged")
        );
    }

    #[test]
    fn what_is_not_finite() {
        let layout = layout(Element::Float64, Endian::Little, Encoding::Raw, [2, 1, 2]);
        let bytes: Vec<u8> = [1.0, f64::NAN, 2.0, -1e39]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let with = |non_finite| {
            let options = LoadOptions {
                non_finite,
                ..LoadOptions::default()
            };
            let grid = read_grid(&mut VolumeSource::of("", &bytes, None), &layout, &options);
            grid.map(|(grid, _)| grid.values().to_vec())
        };
        assert_eq!(
            with(NonFinite::Refused).unwrap_err().to_string(),
            "voxel (1, 0, 0) in the order of the file holds NaN: values must be finite, and not beyond \
             3.4e38; correct it, or set `replace_non_finite` beside `file` in the scene, to a value \
             that replaces it"
        );
        assert_eq!(
            with(NonFinite::Replaced(-7.0)).unwrap(),
            [1.0, -7.0, 2.0, -7.0]
        );
        let kept = with(NonFinite::Kept).unwrap();
        assert!(kept[1].is_nan() && kept[3] == f32::NEG_INFINITY);
    }
}
