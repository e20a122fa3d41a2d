//! The catalogue of hard cases: inputs for which volume renderers silently give wrong results.
//!
//! Each row has a small set-up, a known answer, and a tolerance derived from the number of
//! roundings or of samples. It runs the code that renders images, never a copy of a formula.
//! `volref verify hard` prints every row with its error relative to its tolerance; `cargo test
//! --test hard_cases` has a test for each.
//!
//! Rows about images are also cases of the family `hard` in the suite, so that other renderers can
//! be tested with them.
//!
//! # Policies that the rows rely on
//!
//! 1. A ray that lies *in* a face of a box belongs to the box whose minimum face it is, never to
//!    the one whose maximum face it is, so that touching boxes neither count twice nor leave a gap.
//!    `−0` is 0.
//! 2. An effect is skipped only if its coefficient is exactly zero.
//! 3. Rays are not ended early, and paths are not cut, unless the scene asks for it.
//! 4. A density that is not finite or is negative is refused, and the voxel named, unless the scene
//!    says what to use instead.
//! 5. All transcendental functions are those of one pinned implementation ([`crate::math`]), and a
//!    fused multiply-add is used nowhere.
//! 6. An axis of one node is a slab one spacing thick, in either centring. (Elsewhere it may be taken
//!    for a mistake, where values stand at nodes.)
//!
//! What a row says of images may also stand in a case of the suite: moved pictures of G9, goldens of
//! A7, both of which are verified there.
//!
//! # One description per row
//!
//! `catalogue.toml` describes every row, with all that is known of it in numbers. Laws, and set-ups
//! with a scene, are functions named after their row, in the file of its letter.

mod accumulation;
mod data;
mod exponentials;
mod geometry;
mod known;
mod margin;
mod objects;
mod scattering;
mod scenes;
mod seen;
mod test_ray;

pub use margin::{Margin, STANDARD_ERRORS, U};

use known::{SpanInBox, Table};
use seen::Seen;
use serde::Deserialize;
use std::sync::LazyLock;

/// A row of the catalogue.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// Letter and number: `G1`.
    pub id: String,
    /// Description of the case.
    pub what: String,
    /// Description of the tolerance.
    pub tolerance: String,
    /// Remedy in the renderer.
    pub remedy: String,
    /// The source file with the remedy and its reason.
    pub file: String,
    #[serde(default)]
    table: Vec<Table>,
    #[serde(default)]
    spans: Vec<SpanInBox>,
    #[serde(default)]
    seen: Vec<Seen>,
}

/// The laws and set-ups of a row, by its id.
type Check = (&'static str, fn(&mut Margin));

/// Checks of all rows but those that are known in numbers alone.
fn checks() -> impl Iterator<Item = &'static Check> {
    [
        geometry::CHECKS,
        exponentials::CHECKS,
        data::CHECKS,
        objects::CHECKS,
        scattering::CHECKS,
        accumulation::CHECKS,
    ]
    .into_iter()
    .flatten()
}

impl Row {
    /// Runs the row. Same result on every run and machine.
    pub fn run(&self) -> Margin {
        let mut margin = Margin::default();
        self.table
            .iter()
            .for_each(|table| table.compare(&mut margin));
        self.spans.iter().for_each(|span| span.compare(&mut margin));
        self.seen.iter().for_each(|seen| seen.compare(&mut margin));
        for (_, check) in checks().filter(|(id, _)| *id == self.id) {
            check(&mut margin);
        }
        margin
    }
}

/// All rows, in the order of the catalogue: geometry, exponentials, data, objects, scattering, accumulation.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    CATALOGUE.row.iter()
}

/// The file that the rows are from, in the sources of volref.
pub(crate) const CATALOGUE_FILE: &str = "src/hard_cases/catalogue.toml";

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Catalogue {
    row: Vec<Row>,
}

static CATALOGUE: LazyLock<Catalogue> =
    LazyLock::new(|| toml::from_str(include_str!("catalogue.toml")).expect("a valid catalogue"));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remedies_stand_where_they_are_said_to() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        for row in rows() {
            assert!(root.join(&row.file).is_file(), "{}: {}", row.id, row.file);
        }
    }

    #[test]
    fn no_row_is_missing() {
        let ids: Vec<_> = rows().map(|row| row.id.clone()).collect();
        let all = [
            ("G", 12),
            ("E", 9),
            ("D", 14),
            ("O", 4),
            ("S", 10),
            ("A", 7),
        ];
        let all = all.into_iter();
        let all = all.flat_map(|(group, last)| (1..=last).map(move |row| format!("{group}{row}")));
        assert_eq!(ids, all.collect::<Vec<_>>());
    }

    #[test]
    fn every_check_belongs_to_a_row() {
        for (id, _) in checks() {
            assert!(rows().any(|row| row.id == *id), "{id}");
        }
    }
}
