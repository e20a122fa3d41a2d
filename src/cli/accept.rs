//! `volref accept CASE… --reason TEXT`

use super::failure::{Exit, Failure};
use super::output::{self, Json};
use super::partition::PartitionArgument;
use super::suite::Selection;
use super::{Outcome, progress};
use crate::runs;
use crate::runs::{AcceptError, AcceptRequest, Accepted, Change};
use crate::suite::{CasesOfScene, Draft, Suite};
use serde_json::json;
use std::path::Path;

/// Render cases and accept the images as new goldens
///
/// Look at the images before and after. All cases are accepted, or none.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Cases, families, or patterns over them such as 'figures/*'; those with ! before them are left out. A scene
    /// file of the suite without a manifest gets one
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
    let (filters, drafts) = with_drafts(&suite, &arguments.cases)?;
    request.check().map_err(failure)?;
    for draft in &drafts {
        let path = output::write_within(suite.root(), &draft.file, draft.text.as_bytes())?;
        progress::note(&format!(
            "wrote {}: describe there what the image shows",
            path.display()
        ));
    }
    let suite = match drafts.is_empty() {
        true => suite,
        false => arguments.selection.open_to_change()?,
    };
    let mut cases = suite.select(&filters)?;
    arguments
        .partition
        .retain(&mut cases, |case| case.name.clone())?;
    let bar = progress::counted(cases.len());
    let store = suite.store();
    let accepted = runs::accept(&cases, &store, request, &bar, &|step| bar.show(step));
    bar.finish_and_clear();
    let accepted = accepted.map_err(failure)?;

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

fn failure(error: AcceptError) -> Failure {
    Failure {
        exit: Exit::BadInput,
        report: error.into(),
    }
}

/// The filters, with the names of cases in place of scene files, and the manifests to be written first.
fn with_drafts(suite: &Suite, given: &[String]) -> Result<(Vec<String>, Vec<Draft>), Failure> {
    let (mut filters, mut others, mut drafts) = (Vec::new(), Vec::new(), Vec::<Draft>::new());
    for filter in given {
        let file = Path::new(filter);
        let is_scene = file.extension().is_some_and(|it| it == "toml") && file.is_file();
        match is_scene.then(|| suite.cases_of_scene(file)).transpose()? {
            None => others.push(filter.clone()),
            Some(CasesOfScene::Known(names)) => others.extend(names),
            Some(CasesOfScene::New(draft)) => {
                filters.push(draft.case.clone());
                if drafts.iter().all(|other| other.case != draft.case) {
                    drafts.push(draft);
                }
            }
        }
    }
    // A mistake in them is to be found before anything is written; without any, all cases would be chosen.
    if others.iter().any(|filter| !filter.starts_with('!')) {
        suite.select(&others)?;
    }
    filters.extend(others);
    Ok((filters, drafts))
}
