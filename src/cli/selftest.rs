//! `volref selftest [FILTER…]`

use super::failure::{Exit, Failure};
use super::kept::{KeepArgument, keep, run_of, say_kept};
use super::output::{self, Json};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{Outcome, progress};
use crate::judging::{SelfTest, SelfTestCases, SelfTestExtent, Step, case_trials, self_test_steps};
use crate::naming::{Naming, Predictions, naming};
use crate::report;
use crate::suite::{Case, Store};
use crate::variations::mistakes;
use crate::variations::mistakes::Mistake;
use serde_json::json;

/// The name of the command.
pub const SELF_TEST: &str = "selftest";

/// Check that the suite rejects known mistakes and no correct image
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Families, cases, or patterns over them such as 'figures/*'; those with ! before them are left out
    /// [default: all cases]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    partition: PartitionArgument,
    #[command(flatten)]
    kept: KeepArgument,
    /// Try each mistake only until a case catches it
    #[arg(long)]
    quick: bool,
    /// Instead of the self-test: simulate each mistake RUNS times and report how often it is
    /// identified first
    #[arg(long, value_name = "RUNS", value_parser = clap::value_parser!(u64).range(1..=1000))]
    naming: Option<u64>,
    /// Instead of the self-test: simulate COUNT pairs of mistakes and report how often both are among
    /// the first three named
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pairs: Option<u64>,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.selection.open()?;
    output::check(&[arguments.json.file()], &[])?;
    let mut cases = suite.select(&arguments.filters)?;
    let all = cases.clone();
    arguments
        .partition
        .retain(&mut cases, "cases", |case| case.name.clone())?;
    let store = suite.store();
    if arguments.naming.is_some() || arguments.pairs.is_some() {
        let made = made(arguments.naming.unwrap_or(0), arguments.pairs.unwrap_or(0));
        return measure_naming(&cases, &store, &made, &arguments.json);
    }
    let extent = if arguments.quick {
        SelfTestExtent::Quick
    } else {
        SelfTestExtent::Full
    };
    let kept = &arguments.kept;
    let folder = kept.folder(&arguments.partition, &arguments.selection, &suite)?;
    let bar = progress::counted("steps", self_test_steps(cases.len()));
    let which = match (arguments.partition.is_whole(), arguments.filters.is_empty()) {
        (false, _) => SelfTestCases::Part,
        (true, true) => SelfTestCases::Whole,
        (true, false) => SelfTestCases::Selected,
    };
    let found = case_trials(&cases, &store, extent, &|step| match step {
        Step::Begins(what) => bar.set_message(what),
        Step::Done => bar.inc(1),
    });
    bar.finish_and_clear();
    if let Some(folder) = folder {
        let (all, filters) = (all.into_iter(), &arguments.filters);
        let settings = [("quick".to_owned(), arguments.quick.to_string())].into();
        let run = run_of(SELF_TEST, &suite, filters, all, settings);
        let part: Vec<String> = cases.iter().map(|case| case.name.clone()).collect();
        say_kept(&keep(&folder, &run, &part, &[], &found)?);
    }
    let test = SelfTest::of(&cases, &found, which);
    let value = report::self_test_json(&test);
    let exit = exit_of(&test);
    let mut text = report::self_test_text(&test);
    if which == SelfTestCases::Part {
        text.push_str(
            "\nThis is one part: volref merge says whether every mistake is caught by some part.\n",
        );
    }
    let text = arguments.json.instead_of(text, &value)?;
    Ok(Outcome { text, exit })
}

/// The exit code of a self-test.
pub fn exit_of(test: &SelfTest) -> Exit {
    let golden = (!test.unusable.is_empty()).then_some(Exit::Golden);
    let of_the_suite = if test.judges_right() {
        Exit::Passed
    } else {
        Exit::SelfTest
    };
    Exit::first_of(golden.into_iter().chain([of_the_suite]))
}

/// Mistakes to simulate: each `runs` times, and `pairs` pairs, spread over all pairs.
fn made(runs: u64, pairs: u64) -> Vec<(Vec<&'static Mistake>, u64)> {
    let all: Vec<&'static Mistake> = mistakes::catalogue().collect();
    let mut made = Vec::new();
    for run in 1..=runs {
        made.extend(all.iter().map(|mistake| (vec![*mistake], run)));
    }
    // A stride without a common factor goes round all pairs before any comes twice.
    let every: Vec<(usize, usize)> = (0..all.len())
        .flat_map(|second| (0..second).map(move |first| (first, second)))
        .collect();
    const STRIDE: usize = 1009;
    for index in 0..pairs as usize {
        let (first, second) = every[index * STRIDE % every.len()];
        made.push((vec![all[first], all[second]], index as u64 + 1));
    }
    made
}

fn measure_naming(
    cases: &[&Case],
    store: &Store,
    made: &[(Vec<&'static Mistake>, u64)],
    json: &Json,
) -> Result<Outcome, Failure> {
    let bar = progress::counted("cases", made.len());
    let namings: Vec<Naming> = naming(cases, store, made, &Predictions::default(), &|| bar.inc(1));
    bar.finish_and_clear();
    let rows: Vec<_> = namings
        .iter()
        .map(|naming| {
            json!({
                "made": naming.made,
                "failed_cases": naming.failed,
                "rank": naming.rank(),
                "named": naming.named,
            })
        })
        .collect();
    let value = json!({ "schema": "volref/naming/1", "runs": rows });
    let text = json.instead_of(report::naming_text(&namings), &value)?;
    Ok(text.into())
}
