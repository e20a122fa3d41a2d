//! Images as NPY, a file with one NumPy array.

use super::error::check_size;
use super::{Film, FilmError};
use crate::files::npy_header::{NpyHeader, npy_header, shown};
use half::f16;

fn unreadable(reason: impl Into<String>) -> FilmError {
    FilmError::unreadable("NPY", reason)
}

impl Film {
    /// Reads a NumPy array: float16, float32 or float64 of either byte order, of the shape (height,
    /// width, 3), (height, width, 4) with opacity, or (height, width) or (height, width, 1) for
    /// grey, in C or Fortran order. Values that are not finite are kept, and those beyond 32 bits
    /// become infinite.
    pub fn from_npy(bytes: &[u8]) -> Result<Film, FilmError> {
        let (header, data) = NpyHeader::read(bytes).map_err(unreadable)?;
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
                "radiance and depths are floating-point numbers: save linear radiance before it is rounded and gamma \
                 encoded, with image.astype(np.float32), or 8-bit sRGB in .png",
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
