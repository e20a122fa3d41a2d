//! `volref list [FILTER…]`

use super::Outcome;
use super::failure::Failure;
use super::output::Json;
use super::suite::{Selection, select};
use serde_json::json;

/// List the cases of the suite
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Families, cases, or patterns over them [default: all cases]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.selection.open()?;
    let cases = select(&suite, &arguments.filters)?;
    let widest = cases.iter().map(|case| case.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    let mut entries = Vec::new();
    for case in cases {
        text.push_str(&format!(
            "{:<widest$}  {:<13}  {}\n",
            case.name, case.class, case.source
        ));
        entries.push(json!({
            "name": case.name,
            "family": case.family,
            "class": case.class,
            "gate": case.gate(),
            "scene": case.scene,
            "source": case.source,
            "shows": case.shows,
            "computes": case.computes,
            "exposure": case.exposure,
        }));
    }
    let value = json!({ "schema": "volref/list/1", "cases": entries });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}
