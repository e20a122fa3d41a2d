//! `volref accept CASE… --reason TEXT`

use super::failure::{Exit, Failure};
use super::output::{self, Json};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{Outcome, progress};
use crate::runs;
use crate::runs::{AcceptError, AcceptRequest, Change, UnitFolder};
use crate::suite::StoreError;
use serde_json::json;

/// Render cases and accept the images as new goldens
///
/// Look at the images before and after. All cases are accepted, or none. Finished units of stochastic cases (see volref units) are kept
/// in .volref until all goldens are written, so an interrupted run continues where it stopped.
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
    let suite = arguments.selection.open_to_change()?;
    output::check(&[arguments.json.file()], &[])?;
    let mut cases = suite.select(&arguments.cases)?;
    arguments
        .partition
        .retain(&mut cases, "cases", |case| case.name.clone())?;
    let bar = progress::work();
    let kept = UnitFolder::open(suite.cache_folder());
    let request = AcceptRequest {
        reason: &arguments.reason,
        keep_images: arguments.keep_images,
        in_ci: super::is_in_ci(),
    };
    let accepted = runs::accept(&cases, &suite.store(), &kept, request, &bar);
    bar.finish_and_clear();
    let accepted = accepted.map_err(|error| {
        let exit = match error {
            AcceptError::Store(StoreError::Journal { .. } | StoreError::Lost { .. }) => {
                Exit::Golden
            }
            _ => Exit::BadInput,
        };
        Failure {
            exit,
            report: error.into(),
        }
    })?;

    let mut text = String::new();
    let mut entries = Vec::new();
    for entry in &accepted {
        let (word, detail) = match &entry.change {
            Change::New { damaged: false } => ("new", "its first golden".to_owned()),
            Change::New { damaged: true } => ("new", "the old golden was damaged".to_owned()),
            Change::Unchanged => ("unchanged", "kept, with its old reason".to_owned()),
            Change::SamePicture => (
                "recorded",
                "same image; its record (scene, plan, truth, how it is judged, quick rendering or sensitivities) changed".to_owned(),
            ),
            Change::Replaced(difference) => ("replaced", difference.clone()),
        };
        let detail = if entry.resumed {
            format!("{detail} (rendered by an earlier run)")
        } else {
            detail
        };
        text.push_str(&format!("{word:<9}  {}: {detail}\n", entry.case));
        entries.push(json!({ "name": entry.case, "change": word, "reason": detail }));
    }
    if accepted
        .iter()
        .any(|entry| matches!(entry.change, Change::New { .. } | Change::Replaced(_)))
    {
        let folder = suite.golden_folder();
        text.push_str(&format!(
            "\nNow look at the images in {}.\n",
            folder.display()
        ));
    }
    let value = json!({ "schema": "volref/accept/1", "cases": entries });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}
