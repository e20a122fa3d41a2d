//! Lines of a scene file, by key.

use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// The line of each key and table that a file gives, by its dotted path from the root, such as
/// `classified.phong` or `radiative.medium[0].sigma_a`. A list of tables has the line of its first
/// table. Empty for a scene without a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeyLines(BTreeMap<String, usize>);

impl KeyLines {
    /// The lines of the keys in `table`, which stands in the text of these `lines`.
    pub(super) fn of(lines: &Lines, table: &DeTable) -> KeyLines {
        let mut lines_of_keys = KeyLines::default();
        lines_of_keys.note_table(lines, "", table);
        lines_of_keys
    }

    /// The line, from 1, of `key`; `None` if the file leaves it out.
    pub fn line(&self, key: &str) -> Option<usize> {
        self.0.get(key).copied()
    }

    /// Whether the file gives `key`.
    pub fn has(&self, key: &str) -> bool {
        self.0.contains_key(key)
    }

    fn note_table(&mut self, lines: &Lines, path: &str, table: &DeTable) {
        for (key, value) in table {
            let name = key.get_ref();
            let path = match path {
                "" => name.to_string(),
                _ => format!("{path}.{name}"),
            };
            self.0.insert(path.clone(), lines.at(key.span().start));
            match value.get_ref() {
                DeValue::Table(table) => self.note_table(lines, &path, table),
                DeValue::Array(items) => {
                    for (index, item) in items.iter().enumerate() {
                        if let DeValue::Table(table) = item.get_ref() {
                            let path = format!("{path}[{index}]");
                            let line = lines.at(item.span().start);
                            self.0.insert(path.clone(), line);
                            self.note_table(lines, &path, table);
                        }
                    }
                }
                _ => {}
            }
        }
    }
}

/// The offsets at which the lines of a text end.
pub(super) struct Lines(Vec<usize>);

impl Lines {
    pub(super) fn of(text: &str) -> Lines {
        Lines(text.match_indices('\n').map(|(offset, _)| offset).collect())
    }

    /// The line, from 1, of the byte at `offset`.
    fn at(&self, offset: usize) -> usize {
        1 + self.0.partition_point(|&end| end < offset)
    }
}

#[cfg(test)]
mod tests {
    use super::super::reader::Document;
    use super::*;

    #[test]
    fn every_key_has_the_line_it_stands_on() {
        let text = "\
title = 'x'
[radiative]
scattering = 'single'

[[radiative.medium]]
sigma_a = 1
sphere = { centre = [0, 0, 0], radius = 1 }

[[radiative.medium]]
g = 0.5
[radiative.medium.noise]
octaves = 2
";
        let document = Document {
            path: "scene.toml",
            text,
        };
        let root = document.parse().unwrap();
        let key_lines = KeyLines::of(&Lines::of(text), root.get_ref());
        for (key, line) in [
            ("title", 1),
            ("radiative", 2),
            ("radiative.scattering", 3),
            ("radiative.medium", 5),
            ("radiative.medium[0]", 5),
            ("radiative.medium[0].sigma_a", 6),
            ("radiative.medium[0].sphere.radius", 7),
            ("radiative.medium[1]", 9),
            ("radiative.medium[1].g", 10),
            ("radiative.medium[1].noise", 11),
            ("radiative.medium[1].noise.octaves", 12),
        ] {
            assert_eq!(key_lines.line(key), Some(line), "{key}");
        }
        assert_eq!(key_lines.line("radiative.medium[0].g"), None);
        assert!(!key_lines.has("radiative.light"));
    }
}
