//! Fields of a header of text: their values as numbers, words and vectors.

use super::LoadOptions;
use super::error::VolumeFault;
use super::samples::VolumeRead;
use super::source::VolumeSource;
use glam::DVec3;
use std::io::{BufRead, Read};

/// The fields of a header, as they stand there.
#[derive(Default)]
pub(super) struct HeaderFields(Vec<HeaderField>);

impl HeaderFields {
    /// Adds a field that is not there yet.
    pub(super) fn add(&mut self, name: &str, value: &str, line: usize) -> Result<(), VolumeFault> {
        if self.get(name).is_some() {
            return Err(in_line(line, &format!("the field `{name}` is there twice")));
        }
        let (name, value) = (name.to_owned(), value.to_owned());
        self.0.push(HeaderField { name, value, line });
        Ok(())
    }

    /// A field that the format demands.
    pub(super) fn required(&self, name: &str) -> Result<&HeaderField, VolumeFault> {
        self.get(name).ok_or_else(|| {
            format!("the header has no field `{name}`, which the format demands").into()
        })
    }

    pub(super) fn get(&self, name: &str) -> Option<&HeaderField> {
        self.0.iter().find(|field| field.name == name)
    }

    /// The number of samples along each of `dimension` axes.
    pub(super) fn sizes(&self, name: &str, dimension: usize) -> Result<Vec<u64>, VolumeFault> {
        let field = self.required(name)?;
        field.each(dimension, |word| {
            let size = word.parse().ok().filter(|&size| size > 0);
            size.ok_or_else(|| field.wrong("positive whole numbers"))
        })
    }

    /// The number of bytes before the data, 0 if the field is missing; `None` for -1, which says that the
    /// data are the last bytes of their file.
    pub(super) fn byte_skip(&self, name: &str) -> Result<Option<u64>, VolumeFault> {
        match self.get(name) {
            Some(field) if field.value == "-1" => Ok(None),
            Some(field) => field.number("a number of bytes, or -1", |_| true).map(Some),
            None => Ok(Some(0)),
        }
    }
}

/// Longest header: those of diffusion scans have some hundred kilobytes.
const LONGEST_HEADER: u64 = 1 << 20;

/// Gives `is_last` each line of the header at the beginning of `source`, with its number, until it returns true; then
/// `source` is left behind that line. Where the text ends, the line is `None`.
pub(super) fn read_lines(
    source: &mut VolumeSource,
    mut is_last: impl FnMut(Option<&str>, usize) -> Result<bool, VolumeFault>,
) -> Result<(), VolumeFault> {
    let mut header = source.by_ref().take(LONGEST_HEADER);
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        let length = header.read_until(b'\n', &mut line)?;
        let text = String::from_utf8_lossy(line.trim_ascii_end());
        if is_last((length > 0).then_some(&*text), number)? {
            source.line = number;
            break;
        }
    }
    Ok(())
}

/// A mistake in a line of a header.
pub(super) fn in_line(line: usize, message: &str) -> VolumeFault {
    VolumeFault::Line(format!("{line}: {message}"))
}

/// Reads data by `read`: from the rest of `source`, or from the file that its header names.
pub(super) fn read_data(
    source: &mut VolumeSource,
    name: Option<&str>,
    options: &LoadOptions,
    read: impl Fn(&mut VolumeSource) -> VolumeRead,
) -> VolumeRead {
    let Some(name) = name else {
        return read(source);
    };
    let data = source.open_data(name, options)?;
    read(data).map_err(|fault| match fault {
        // A fault with a place of its own needs the file of that place.
        VolumeFault::Line(_) => format!("its data file {}", data.error(fault)).into(),
        _ => fault,
    })
}

/// A field of a header.
pub(super) struct HeaderField {
    pub(super) name: String,
    pub(super) value: String,
    pub(super) line: usize,
}

impl HeaderField {
    /// A mistake in the line of the field.
    pub(super) fn fault(&self, message: &str) -> VolumeFault {
        in_line(self.line, message)
    }

    pub(super) fn wrong(&self, expected: &str) -> VolumeFault {
        let (name, value) = (&self.name, &self.value);
        self.fault(&format!("`{name}` must be {expected}, not {value:?}"))
    }

    /// The name of the file of the data. Refused: a list of files, or a pattern with numbers in the place of its `%`.
    pub(super) fn one_file(&self, remedy: &str) -> Result<String, VolumeFault> {
        let Some(first) = self.value.split_ascii_whitespace().next() else {
            return Err(self.wrong("the name of a file"));
        };
        let is_pattern = self.value.contains("%d") || self.value.contains("%0");
        if is_pattern || matches!(first, "LIST" | "SKIPLIST") {
            let message = format!("the data are spread over several files: {remedy}");
            return Err(self.fault(&message));
        }
        Ok(self.value.clone())
    }

    pub(super) fn number<T: std::str::FromStr>(
        &self,
        expected: &'static str,
        accepts: impl Fn(&T) -> bool,
    ) -> Result<T, VolumeFault> {
        let number = self.value.parse().ok().filter(accepts);
        number.ok_or_else(|| self.wrong(expected))
    }

    pub(super) fn count(&self, found: usize, dimension: usize) -> Result<(), VolumeFault> {
        if found == dimension {
            return Ok(());
        }
        let name = &self.name;
        Err(self.fault(&format!(
            "`{name}` has {found} values, and the file {dimension} axes: give one for each axis"
        )))
    }

    /// One word for each axis, as `read` understands it.
    pub(super) fn each<T>(
        &self,
        dimension: usize,
        read: impl Fn(&str) -> Result<T, VolumeFault>,
    ) -> Result<Vec<T>, VolumeFault> {
        let words: Vec<&str> = self.value.split_ascii_whitespace().collect();
        self.count(words.len(), dimension)?;
        words.into_iter().map(read).collect()
    }

    /// Vectors such as `(1,0,0) (0,1,0) none`, one for each axis.
    pub(super) fn vectors(&self, dimension: usize) -> Result<Vec<Option<DVec3>>, VolumeFault> {
        let mut vectors = Vec::new();
        let mut rest = self.value.trim();
        while !rest.is_empty() {
            if let Some(after) = rest.strip_prefix("none") {
                vectors.push(None);
                rest = after.trim_start();
                continue;
            }
            let end = rest.find(')').map_or(rest.len(), |end| end + 1);
            vectors.push(self.vector_in(&rest[..end])?);
            rest = rest[end..].trim_start();
        }
        self.count(vectors.len(), dimension)?;
        Ok(vectors)
    }

    /// `(1,0,0)`; `None` for `none` or `(nan,nan,nan)`.
    pub(super) fn vector_in(&self, text: &str) -> Result<Option<DVec3>, VolumeFault> {
        let text = text.trim();
        if text == "none" {
            return Ok(None);
        }
        let inner = text.strip_prefix('(');
        let inner = inner.and_then(|inner| inner.strip_suffix(')'));
        let numbers: Option<Vec<f64>> =
            inner.and_then(|inner| inner.split(',').map(|n| n.trim().parse().ok()).collect());
        match numbers.as_deref() {
            Some([x, y, z]) if [x, y, z].iter().all(|number| number.is_nan()) => Ok(None),
            Some(&[x, y, z]) if DVec3::new(x, y, z).is_finite() => Ok(Some(DVec3::new(x, y, z))),
            _ => Err(self.wrong("vectors of three finite numbers, such as (1,0,0), or none")),
        }
    }
}
