//! NPY, a file with one NumPy array.
//!
//! The crate `npyz` multiplies the lengths of the axes unchecked and panics on a header of a few
//! bytes, so the header is read here.
//!
//! Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use super::error::check_size;
use super::{Film, FilmError};
use half::f16;
use serde::Deserialize;
use std::ops::Range;
use toml::de::ValueDeserializer;

fn unreadable(reason: impl Into<String>) -> FilmError {
    FilmError::unreadable("NPY", reason)
}

/// Longest header, as in NumPy.
const LONGEST_HEADER: usize = 10_000;

/// The header of the array.
pub(crate) struct NpyHeader {
    /// Type of a number, such as `<f4`.
    pub(crate) descr: String,
    /// Whether the first axis runs fastest instead of the last.
    pub(crate) fortran_order: bool,
    /// Lengths of the axes.
    pub(crate) shape: Vec<usize>,
}

impl Film {
    /// Reads a NumPy array: float16, float32 or float64 of either byte order, of the shape (height,
    /// width, 3), (height, width, 4) with opacity, or (height, width) or (height, width, 1) for
    /// grey, in C or Fortran order. Values that are not finite are kept, and those beyond 32 bits
    /// become infinite.
    pub fn from_npy(bytes: &[u8]) -> Result<Film, FilmError> {
        let (header, data) = NpyHeader::read(bytes)?;
        let (bytes_each, number) = number(&header.descr)?;
        let [height, width, channels] = axes(&header.shape)?;
        check_size(width, height)?;
        // In 64 bits: with words of 32 the product can overflow.
        let lengths = [width, height, channels, bytes_each].map(|length| length as u64);
        let expected: u64 = lengths.into_iter().product();
        if data.len() as u64 != expected {
            return Err(unreadable(format!(
                "an array of shape {} and type {} has {expected} bytes, and {} follow the header",
                shown(&header.shape),
                header.descr,
                data.len()
            )));
        }
        let value = |row: usize, column: usize, channel: usize| {
            let index = if header.fortran_order {
                row + height * (column + width * channel)
            } else {
                (row * width + column) * channels + channel
            };
            number(&data[index * bytes_each..][..bytes_each])
        };
        let positions = (0..height).flat_map(|row| (0..width).map(move |column| (row, column)));
        if channels == 4 {
            let pixel = |(row, column)| [0, 1, 2, 3].map(|c| value(row, column, c));
            return Ok(Film::with_opacity(
                width,
                height,
                positions.map(pixel).collect(),
            ));
        }
        let pixel = |(row, column)| [0, 1, 2].map(|c| value(row, column, c % channels));
        Ok(Film::new(width, height, positions.map(pixel).collect()))
    }

    /// The image as a NumPy array, float32, of shape (height, width, 3), or (height, width, 4) with
    /// opacity; without its noise.
    pub fn to_npy(&self) -> Vec<u8> {
        let channels = if self.opacity().is_some() { 4 } else { 3 };
        let pixels = (0..self.radiance().len()).map(|index| self.pixel(index));
        let values = pixels.flat_map(|pixel| pixel.into_iter().take(channels));
        encode_values(&[self.height(), self.width(), channels], values)
    }

    /// The depth as a NumPy array, float32, of shape (height, width), if there is any.
    pub(crate) fn depth_to_npy(&self) -> Option<Vec<u8>> {
        let depth = self.depth.as_ref()?.iter().copied();
        Some(encode_values(&[self.height, self.width], depth))
    }
}

/// The array of this shape, float32.
fn encode_values(shape: &[usize], values: impl Iterator<Item = f32>) -> Vec<u8> {
    let mut bytes = npy_header(shape);
    for value in values {
        bytes.extend_from_slice(&value.to_le_bytes());
    }
    bytes
}

/// The beginning of the file of an array of this shape, float32; its data follow.
pub(crate) fn npy_header(shape: &[usize]) -> Vec<u8> {
    let shape = shown(shape);
    let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    // Data begin at a multiple of 64, after 10 bytes, the text and the end of the line.
    let padding = (64 - (10 + text.len() + 1) % 64) % 64;
    text.extend(std::iter::repeat_n(' ', padding));
    text.push('\n');
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.bytes());
    bytes
}

fn cut_off() -> FilmError {
    unreadable("its header is truncated")
}

impl NpyHeader {
    /// Bytes at the beginning of a file that tell the length of its header.
    pub(crate) const FIRST_BYTES: usize = 12;

    /// Position of the text of the header, by the first bytes of a file.
    pub(crate) fn text_at(first: &[u8]) -> Result<Range<usize>, FilmError> {
        let rest = first.strip_prefix(b"\x93NUMPY");
        let rest =
            rest.ok_or_else(|| unreadable("it does not begin with the signature of the format"))?;
        let (&[version, minor], rest) = rest.split_first_chunk().ok_or_else(cut_off)?;
        let (begin, length) = match version {
            1 => {
                let length = rest.first_chunk().ok_or_else(cut_off)?;
                (10, usize::from(u16::from_le_bytes(*length)))
            }
            2 | 3 => {
                let length = rest.first_chunk().ok_or_else(cut_off)?;
                (12, u32::from_le_bytes(*length) as usize)
            }
            _ => {
                let reason = format!("its version is {version}.{minor}; known are 1, 2 and 3");
                return Err(unreadable(reason));
            }
        };
        if length > LONGEST_HEADER {
            let reason =
                format!("its header claims {length} bytes; at most {LONGEST_HEADER} are read");
            return Err(unreadable(reason));
        }
        Ok(begin..begin + length)
    }

    /// The header of a file, and the data.
    pub(crate) fn read(bytes: &[u8]) -> Result<(NpyHeader, &[u8]), FilmError> {
        let text = NpyHeader::text_at(bytes)?;
        let (header, data) = bytes.split_at_checked(text.end).ok_or_else(cut_off)?;
        let text = std::str::from_utf8(&header[text.start..]);
        let text = text.map_err(|_| unreadable("its header is not text"))?;
        Ok((NpyHeader::parse(text)?, data))
    }

    /// Python's dictionary is an inline table of TOML in other signs: of its three keys none holds such a sign itself.
    fn parse(text: &str) -> Result<NpyHeader, FilmError> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Keys {
            descr: toml::Value,
            fortran_order: bool,
            shape: Vec<usize>,
        }
        const SIGNS: [(&str, &str); 5] = [
            (":", "="),
            ("(", "["),
            (")", "]"),
            ("True", "true"),
            ("False", "false"),
        ];
        let toml = SIGNS
            .iter()
            .fold(text.trim().to_owned(), |text, (python, toml)| {
                text.replace(python, toml)
            });
        let keys = ValueDeserializer::parse(&toml).and_then(Keys::deserialize);
        let keys = keys.map_err(|error| {
            let message = error.message();
            unreadable(format!("its header is not that of an array: {message}"))
        })?;
        let toml::Value::String(descr) = keys.descr else {
            return Err(FilmError::unsuited(
                "an array of records",
                "save the colours alone, as an array of np.float32 of shape (height, width, 3)",
            ));
        };
        Ok(NpyHeader {
            descr,
            fortran_order: keys.fortran_order,
            shape: keys.shape,
        })
    }
}

/// Bytes of a number, and how they become one of 32 bits: the nearest, infinite beyond their range.
type Number = (usize, fn(&[u8]) -> f32);

/// Numbers of this type.
fn number(descr: &str) -> Result<Number, FilmError> {
    fn word<const N: usize>(bytes: &[u8]) -> [u8; N] {
        bytes.try_into().expect("as many bytes")
    }
    Ok(match descr {
        "<f2" => (2, |bytes| f16::from_le_bytes(word(bytes)).to_f32()),
        ">f2" => (2, |bytes| f16::from_be_bytes(word(bytes)).to_f32()),
        "<f4" => (4, |bytes| f32::from_le_bytes(word(bytes))),
        ">f4" => (4, |bytes| f32::from_be_bytes(word(bytes))),
        "<f8" => (8, |bytes| f64::from_le_bytes(word(bytes)) as f32),
        ">f8" => (8, |bytes| f64::from_be_bytes(word(bytes)) as f32),
        _ => {
            let shown: String = descr.chars().take(20).collect();
            return Err(FilmError::unsuited(
                format!("an array of dtype {shown:?}"),
                "radiance and depths are floating-point numbers: save what was there before it was rounded and gamma \
                 encoded, with image.astype(np.float32); or radiance as 8-bit sRGB in .png",
            ));
        }
    })
}

/// Rows, columns and channels: 1, 3 or 4.
fn axes(shape: &[usize]) -> Result<[usize; 3], FilmError> {
    match *shape {
        [height, width] => Ok([height, width, 1]),
        [height, width, channels @ (1 | 3 | 4)] => Ok([height, width, channels]),
        _ => Err(FilmError::unsuited(
            format!("an array of shape {}", shown(shape)),
            "an image has the shape (height, width, 3), (height, width, 4) with opacity, or (height, width) if it is \
             grey",
        )),
    }
}

/// The shape in Python's notation; only the first few axes.
fn shown(shape: &[usize]) -> String {
    let mut lengths: Vec<String> = shape.iter().take(6).map(usize::to_string).collect();
    if shape.len() > lengths.len() {
        lengths.push("…".to_owned());
    }
    match &lengths[..] {
        [length] => format!("({length},)"),
        _ => format!("({})", lengths.join(", ")),
    }
}
