//! The catalogue of hard cases, one named trial for each row: `cargo test --test hard_cases G10`.

use libtest_mimic::{Arguments, Failed, Trial};
use volref::hard_cases::{Row, rows};

fn main() {
    let arguments = Arguments::from_args();
    let mut trials: Vec<_> = rows().map(trial).collect();
    trials.push(Trial::test("all-52-rows-are-there", all_rows));
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
        52 => Ok(()),
        count => Err(format!("the catalogue has 52 rows, here are {count}").into()),
    }
}
