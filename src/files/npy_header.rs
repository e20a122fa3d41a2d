//! The header of NPY, a file with one NumPy array.
//!
//! The crate `npyz` multiplies the lengths of the axes unchecked and panics on a header of a few
//! bytes, so the header is read here. Errors end a sentence that begins "not a readable NPY image: ".
//!
//! Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

use serde::Deserialize;
use std::ops::Range;
use toml::de::ValueDeserializer;

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

fn cut_off() -> String {
    "its header is truncated".to_owned()
}

impl NpyHeader {
    /// Bytes at the beginning of a file that tell the length of its header.
    pub(crate) const FIRST_BYTES: usize = 12;

    /// Position of the text of the header, by the first bytes of a file.
    pub(crate) fn text_at(first: &[u8]) -> Result<Range<usize>, String> {
        let rest = first.strip_prefix(b"\x93NUMPY");
        let rest =
            rest.ok_or_else(|| "it does not begin with the signature of the format".to_owned())?;
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
                return Err(reason);
            }
        };
        if length > LONGEST_HEADER {
            let reason =
                format!("its header claims {length} bytes; at most {LONGEST_HEADER} are read");
            return Err(reason);
        }
        Ok(begin..begin + length)
    }

    /// The header of a file, and the data.
    pub(crate) fn read(bytes: &[u8]) -> Result<(NpyHeader, &[u8]), String> {
        let text = NpyHeader::text_at(bytes)?;
        let (header, data) = bytes.split_at_checked(text.end).ok_or_else(cut_off)?;
        let text = std::str::from_utf8(&header[text.start..]);
        let text = text.map_err(|_| "its header is not text".to_owned())?;
        Ok((NpyHeader::parse(text)?, data))
    }

    /// Python's dictionary is an inline table of TOML in other signs: of its three keys none holds such a sign itself.
    fn parse(text: &str) -> Result<NpyHeader, String> {
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
            format!("its header is not that of an array: {message}")
        })?;
        let toml::Value::String(descr) = keys.descr else {
            return Err(
                "it is an array of records; save one of its fields as an array of np.float32"
                    .to_owned(),
            );
        };
        Ok(NpyHeader {
            descr,
            fortran_order: keys.fortran_order,
            shape: keys.shape,
        })
    }
}

/// The shape in Python's notation; only the first few axes.
pub(crate) fn shown(shape: &[usize]) -> String {
    let mut lengths: Vec<String> = shape.iter().take(6).map(usize::to_string).collect();
    if shape.len() > lengths.len() {
        lengths.push("…".to_owned());
    }
    match &lengths[..] {
        [length] => format!("({length},)"),
        _ => format!("({})", lengths.join(", ")),
    }
}
