//! `volref accept CASE… --reason TEXT`

use super::failure::{Exit, Failure};
use super::output::{self, Json};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{Outcome, progress};
use crate::judging;
use crate::judging::{AcceptRequest, Accepted, Change};
use serde_json::json;

/// Render cases and accept the images as new goldens
///
/// Look at the images before and after. All cases are accepted, or none.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Cases, families, or patterns over them such as 'figures/*'; those with ! before them are left out
    #[arg(value_name = "CASE", required = true)]
    cases: Vec<String>,
    /// What was wrong with the old goldens, or what new ones are for; stored with each golden
    #[arg(long, value_name = "TEXT")]
    reason: String,
    /// Keep the images of stochastic cases, and re-record only the hashes of their quick renderings,
    /// which must still agree; for changes of the sampling, not of the physics
    #[arg(long)]
    keep_images: bool,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    partition: PartitionArgument,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let request = AcceptRequest {
        reason: &arguments.reason,
        keep_images: arguments.keep_images,
        in_ci: super::is_in_ci(),
    };
    let suite = arguments.selection.open_to_change()?;
    output::check(&[arguments.json.file()], &[])?;
    let mut cases = suite.select(&arguments.cases)?;
    arguments
        .partition
        .retain(&mut cases, |case| case.name.clone())?;
    let bar = progress::counted(cases.len());
    let store = suite.store();
    let accepted = judging::accept(&cases, &store, request, &bar, &|step| bar.show(step));
    drop(bar);
    let accepted = accepted.map_err(|error| Failure {
        exit: Exit::BadInput,
        report: error.into(),
    })?;

    let mut text = String::new();
    let mut entries = Vec::new();
    for Accepted {
        case,
        change,
        detail,
    } in &accepted
    {
        let change = change.word();
        text.push_str(&format!("{change:<9}  {case}: {detail}\n"));
        entries.push(json!({ "name": case, "change": change, "reason": detail }));
    }
    let is_image = |it: &Accepted| matches!(it.change, Change::New | Change::Replaced);
    if accepted.iter().any(is_image) {
        let folder = suite.golden_folder();
        text.push_str(&format!(
            "\nNow look at the images in {}.\n",
            folder.display()
        ));
    }
    let value = json!({ "schema": "volref/accept/1", "cases": entries });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}
