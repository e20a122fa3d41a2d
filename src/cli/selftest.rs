//! `volref selftest [FILTER…]`

use super::failure::{Exit, Failure};
use super::kept::PartArguments;
use super::output::{self, Json};
use super::{Outcome, progress};
use crate::judging::{SelfTest, SelfTestCases, case_trials, self_test_steps};
use crate::report;
use crate::suite::Case;

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
    part: PartArguments,
    /// Try each mistake only until a case catches it
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let (part, filters) = (&arguments.part, &arguments.filters);
    let suite = part.selection.open()?;
    output::check(&[arguments.json.file()], &[])?;
    let mut cases = suite.select(filters)?;
    let settings = [("quick".to_owned(), arguments.quick.to_string())].into();
    let to_keep = part.kept(&suite, SELF_TEST, filters, &cases, settings)?;
    let name = |case: &&Case| case.name.clone();
    part.partition.retain(&mut cases, name)?;
    let store = suite.store();
    let bar = progress::counted(self_test_steps(cases.len()));
    let which = SelfTestCases::of(part.partition.is_whole(), filters.is_empty());
    let found = case_trials(&cases, &store, arguments.quick, &|step| bar.show(step));
    drop(bar);
    if let Some(kept) = to_keep {
        let names: Vec<String> = cases.iter().map(name).collect();
        kept.keep(&names, &[], &found)?;
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
    let wrong = (!test.judges_right()).then_some(Exit::SelfTest);
    Exit::first_of(golden.into_iter().chain(wrong).chain([Exit::Passed]))
}
