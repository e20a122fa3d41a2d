//! PFM, the portable float map.
//!
//! A line `PF` (colour) or `Pf` (grey), columns and rows, a scale, and after one character of
//! white space 32-bit floats, the lowest row first. A negative scale says little endian; its
//! magnitude is a factor that samples are multiplied by.
//!
//! Source: P. Debevec, <https://www.pauldebevec.com/Research/HDR/PFM/>.

use super::error::check_size;
use super::{Film, FilmError};

fn unreadable(reason: impl Into<String>) -> FilmError {
    FilmError::unreadable("PFM", reason)
}

/// Longest word of a header.
const LONGEST_WORD: usize = 32;

/// The next word of the header, and the rest: white space and data.
fn word(bytes: &[u8]) -> Result<(&str, &[u8]), FilmError> {
    let start = bytes.iter().position(|byte| !byte.is_ascii_whitespace());
    let bytes = &bytes[start.unwrap_or(bytes.len())..];
    let mut first = bytes.iter().take(LONGEST_WORD + 1);
    let end = first.position(|byte| byte.is_ascii_whitespace());
    let end = end.ok_or_else(|| unreadable("its header is truncated or missing"))?;
    let word = std::str::from_utf8(&bytes[..end]);
    let word = word.map_err(|_| unreadable("its header is not text"))?;
    Ok((word, &bytes[end..]))
}

fn length<'b>(bytes: &'b [u8], what: &str) -> Result<(usize, &'b [u8]), FilmError> {
    let (text, rest) = word(bytes)?;
    let length = text.parse();
    let length = length.map_err(|_| {
        unreadable(format!(
            "{text:?} is no whole number, as the number of {what} must be"
        ))
    })?;
    Ok((length, rest))
}

impl Film {
    /// Reads a PFM image: colour, or grey as three equal channels, of either byte order, multiplied
    /// by the magnitude of its scale. Values that are not finite are kept.
    pub fn from_pfm(bytes: &[u8]) -> Result<Film, FilmError> {
        let (channels, rest) = match word(bytes)? {
            ("PF", rest) => (3, rest),
            ("Pf", rest) => (1, rest),
            _ => {
                return Err(unreadable(
                    "it does not begin with PF or Pf; variants of the format are not read",
                ));
            }
        };
        let (width, rest) = length(rest, "columns")?;
        let (height, rest) = length(rest, "rows")?;
        check_size(width, height)?;
        let (text, rest) = word(rest)?;
        let scale: f32 = text.parse().unwrap_or(f32::NAN);
        if !scale.is_finite() || scale == 0.0 {
            let reason = format!("its scale is {text:?}, and must be a number other than 0");
            return Err(unreadable(reason));
        }
        let expected = width * height * channels * 4;
        let data = match rest.strip_prefix(b"\r\n") {
            // A line may end in two characters, but then the data would begin with the second.
            Some(data) if data.len() == expected => data,
            _ => &rest[1..],
        };
        if data.len() != expected {
            return Err(unreadable(format!(
                "{width} × {height} pixels of {channels} channels are {expected} bytes, and {} follow the header",
                data.len()
            )));
        }
        let is_little = scale < 0.0;
        let factor = scale.abs();
        let stored = |bytes: &[u8; 4]| match is_little {
            true => f32::from_le_bytes(*bytes),
            false => f32::from_be_bytes(*bytes),
        };
        let (numbers, _) = data.as_chunks::<4>();
        let rows = numbers.chunks_exact(width * channels).rev();
        let pixels = rows.flat_map(|row| row.chunks_exact(channels));
        let colour = |pixel: &[[u8; 4]]| [0, 1, 2].map(|c| stored(&pixel[c % channels]) * factor);
        let mut film = Film::new(width, height, pixels.map(colour).collect());
        if factor != 1.0 {
            let change = format!("was multiplied by {factor}, the magnitude of its scale");
            film.changes_on_reading.push(change);
        }
        Ok(film)
    }

    /// The image as PFM, little endian, without its opacity and noise.
    pub fn to_pfm(&self) -> Vec<u8> {
        let mut bytes = format!("PF\n{} {}\n-1.0\n", self.width(), self.height()).into_bytes();
        for row in self.radiance().chunks_exact(self.width().max(1)).rev() {
            bytes.extend(row.iter().flatten().flat_map(|value| value.to_le_bytes()));
        }
        bytes
    }
}
