//! The catalogue of hard cases, one named trial for each row: `cargo test --test hard_cases G10`.

use libtest_mimic::{Arguments, Failed, Trial};
use std::path::Path;
use volref::hard_cases::{Row, rows};

fn main() {
    let arguments = Arguments::from_args();
    let mut trials: Vec<_> = rows().map(trial).collect();
    trials.push(Trial::test("all-56-rows-are-there", all_rows));
    trials.push(Trial::test("images-belong-to-rows", images));
    libtest_mimic::run(&arguments, trials).exit();
}

fn trial(row: &'static Row) -> Trial {
    let name = format!("{}: {}", row.id, row.what);
    Trial::test(name, move || {
        let margin = row.run();
        println!(
            "{:<4} {:<9.3e} of {}",
            row.id,
            margin.share(),
            row.tolerance
        );
        if margin.passed() {
            Ok(())
        } else {
            Err(format!(
                "{} times the tolerance, which is {}: {}",
                margin.share(),
                row.tolerance,
                margin.worst()
            )
            .into())
        }
    })
}

/// An empty run of trials would pass, and nobody would notice.
fn all_rows() -> Result<(), Failed> {
    match rows().count() {
        56 => Ok(()),
        count => Err(format!("the catalogue has 56 rows, here are {count}").into()),
    }
}

/// An image of the family is named after its row, and names it as its source.
fn images() -> Result<(), Failed> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/hard");
    let mut found = 0;
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let id = name.split('-').next().unwrap_or_default().to_uppercase();
        let source = format!("source = \"Catalogue of hard cases, {id}\"");
        let is_source = std::fs::read_to_string(&path)?.contains(&source);
        if !is_source || !rows().any(|row| row.id == id) {
            return Err(format!("{name} belongs to no row, or not to that of its name").into());
        }
        found += 1;
    }
    if found == 0 {
        Err("no images".into())
    } else {
        Ok(())
    }
}
