//! A field of a header of NRRD: its value as numbers, words and vectors.

use crate::volume::error::VolumeFault;
use glam::DVec3;

/// A field of a header.
#[derive(Clone, Copy)]
pub(in crate::volume) struct HeaderField<'h> {
    pub(in crate::volume) name: &'static str,
    pub(in crate::volume) value: &'h str,
    pub(in crate::volume) line: usize,
}

impl HeaderField<'_> {
    /// A mistake in the line of the field.
    pub(in crate::volume) fn fault(&self, message: &str) -> VolumeFault {
        VolumeFault::Line(format!("{}: {message}", self.line))
    }

    pub(in crate::volume) fn wrong(&self, expected: &str) -> VolumeFault {
        let (name, value) = (self.name, shortened(self.value));
        self.fault(&format!("`{name}` must be {expected}, not {value:?}"))
    }

    /// Refuses data in several files: a list of them, or a pattern with the numbers that take the
    /// place of its `%`.
    pub(in crate::volume) fn check_one_file(&self) -> Result<(), VolumeFault> {
        let words: Vec<&str> = self.value.split_ascii_whitespace().collect();
        let is_number = |word: &&&str| word.parse::<i64>().is_ok();
        let numbers = words.iter().rev().take_while(is_number).count();
        let name = words[..words.len() - numbers].join(" ").replace("%%", "");
        let mut conversions = name.split('%').skip(1);
        let is_pattern = conversions.any(|rest| {
            let rest = rest.trim_start_matches(|digit: char| digit.is_ascii_digit());
            rest.starts_with(['d', 'u'])
        });
        let how = match words[..] {
            [] => return Err(self.wrong("the name of a file")),
            ["LIST" | "SKIPLIST"] => "a list",
            ["LIST" | "SKIPLIST", _] if numbers == 1 => "a list",
            // Minimum, maximum and step, and perhaps the axes of a file.
            _ if is_pattern && (3..=4).contains(&numbers) => "a pattern with %",
            _ => return Ok(()),
        };
        Err(self.fault(&format!(
            "the data are spread over several files ({how}): join them into one, as by `unu save -f \
             nrrd -i several.nhdr -o one.nrrd`"
        )))
    }

    pub(in crate::volume) fn number<T: std::str::FromStr>(
        &self,
        expected: &'static str,
        accepts: impl Fn(&T) -> bool,
    ) -> Result<T, VolumeFault> {
        let number = self.value.parse().ok().filter(accepts);
        number.ok_or_else(|| self.wrong(expected))
    }

    pub(in crate::volume) fn count(
        &self,
        found: usize,
        dimension: usize,
    ) -> Result<(), VolumeFault> {
        if found == dimension {
            return Ok(());
        }
        let name = self.name;
        Err(self.fault(&format!(
            "`{name}` has {found} values, and the file {dimension} axes: give one for each axis"
        )))
    }

    /// Words that stand in quotes, or between blanks if none does.
    pub(in crate::volume) fn units(&self) -> Vec<&str> {
        if self.value.contains('"') {
            let quoted = self.value.split('"').skip(1).step_by(2);
            quoted.map(str::trim).collect()
        } else {
            self.value.split_ascii_whitespace().collect()
        }
    }

    /// One word for each axis.
    pub(in crate::volume) fn each<T>(
        &self,
        dimension: usize,
        read: impl Fn(&str) -> Result<T, VolumeFault>,
    ) -> Result<Vec<T>, VolumeFault> {
        let words: Vec<&str> = self.value.split_ascii_whitespace().collect();
        self.count(words.len(), dimension)?;
        words.into_iter().map(read).collect()
    }

    /// `(1,0,0) (0,1,0) none`
    pub(in crate::volume) fn vectors(
        &self,
        dimension: usize,
    ) -> Result<Vec<Option<DVec3>>, VolumeFault> {
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
    pub(in crate::volume) fn vector_in(&self, text: &str) -> Result<Option<DVec3>, VolumeFault> {
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

/// Text for a message, cut where it is long.
pub(in crate::volume) fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
