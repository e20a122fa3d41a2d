//! The catalogue of hard cases: inputs for which volume renderers silently give wrong results.
//!
//! Each row has a small set-up, a known answer, and a tolerance derived from the number of
//! roundings or of samples. It runs the code that renders images, never a copy of a formula. Its tests begin with its
//! identifier: `cargo test --lib hard_cases::data::d3`. Rows about images are also cases of the family `hard` in the suite, so
//! that other renderers can be tested with them; D13 is nothing else.
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
//! with a scene, are tests named after their row, in the file of its letter.

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

use known::{SpanInBox, Table};
use margin::Margin;
use seen::Seen;
use serde::Deserialize;
use std::path::Path;

/// A row of the catalogue.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    /// Letter and number: `G1`.
    id: String,
    /// Description of the case.
    #[serde(rename = "what")]
    _what: String,
    /// Description of the tolerance.
    #[serde(rename = "tolerance")]
    _tolerance: String,
    /// Remedy in the renderer.
    #[serde(rename = "remedy")]
    _remedy: String,
    /// The source file with the remedy and its reason.
    file: String,
    #[serde(default)]
    table: Vec<Table>,
    #[serde(default)]
    spans: Vec<SpanInBox>,
    #[serde(default)]
    seen: Vec<Seen>,
}

impl Row {
    fn is_in_numbers(&self) -> bool {
        !(self.table.is_empty() && self.spans.is_empty() && self.seen.is_empty())
    }

    /// Compares the numbers of the row.
    fn compare(&self) {
        let margin = &Margin;
        self.table.iter().for_each(|table| table.compare(margin));
        self.spans.iter().for_each(|span| span.compare(margin));
        self.seen.iter().for_each(|seen| seen.compare(margin));
    }
}

/// All rows, in the order of the catalogue: geometry, exponentials, data, objects, scattering, accumulation.
fn rows() -> Vec<Row> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Catalogue {
        row: Vec<Row>,
    }
    let catalogue: Catalogue = toml::from_str(include_str!("catalogue.toml")).unwrap();
    catalogue.row
}

/// Tests of the rows that the catalogue has in numbers.
macro_rules! in_numbers {
    ($($id:ident)*) => {
        $(#[test]
        fn $id() {
            let id = stringify!($id).to_uppercase();
            let rows = rows();
            let row = rows.iter().find(|row| row.id == id).unwrap();
            assert!(row.is_in_numbers());
            row.compare();
        })*

        pub const IN_NUMBERS: &[&str] = &[$(stringify!($id)),*];
    };
}

mod numbers {
    use super::rows;
    in_numbers! { g1 g2 g4 e1 e2 e3 e4 e5 e6 e7 s1 s5 s7 s8 s9 }
}

#[test]
fn remedies_stand_where_they_are_said_to() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for row in rows() {
        assert!(root.join(&row.file).is_file(), "{}: {}", row.id, row.file);
    }
}

#[test]
fn no_row_is_missing() {
    let ids: Vec<_> = rows().into_iter().map(|row| row.id).collect();
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

/// A test, or an image with a known answer.
#[test]
fn every_row_is_tested() {
    let files = [
        include_str!("geometry.rs"),
        include_str!("exponentials.rs"),
        include_str!("data.rs"),
        include_str!("objects.rs"),
        include_str!("scattering.rs"),
        include_str!("accumulation.rs"),
    ];
    for row in rows() {
        let id = row.id.to_lowercase();
        let is_in_numbers = numbers::IN_NUMBERS.contains(&&*id);
        assert_eq!(is_in_numbers, row.is_in_numbers(), "{id}");
        let test = format!("#[test]\nfn {id}_");
        let is_law = files.iter().any(|file| file.contains(&test));
        assert!(is_in_numbers || is_law || row.id == "D13", "{id}");
    }
}

/// An image of the family is named after its row, and names it as its source.
#[test]
fn images_belong_to_rows() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/hard");
    let (mut found, rows) = (0, rows());
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let id = name.split('-').next().unwrap_or_default().to_uppercase();
        let source = format!("source = \"Catalogue of hard cases, {id}\"");
        let is_source = std::fs::read_to_string(&path).unwrap().contains(&source);
        let is_row = rows.iter().any(|row| row.id == id);
        assert!(
            is_source && is_row,
            "{name} belongs to no row, or not to that of its name"
        );
        found += 1;
    }
    assert!(found > 100, "{found}");
}
