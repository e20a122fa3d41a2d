//! `volref list [FILTER…]`, `volref list --mistakes`

use super::Outcome;
use super::failure::Failure;
use super::output::{self, Json};
use super::suite::Selection;
use crate::report::widest;
use crate::suite::{ANALYTIC, row_name};
use crate::variations::mistakes;
use serde_json::json;

/// List the cases of the suite
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Families, cases, or patterns over them; those with ! before them are left out [default: all cases]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    /// Instead: list the known mistakes, with the advice that `validate` gives
    #[arg(long, conflicts_with = "filters")]
    mistakes: bool,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    json: Json,
}

/// Links in a line of text, beside which further ones are only counted.
const MOST_LINKS: usize = 2;

/// A source as one line of text: of many links, the first ones.
fn short(source: &str) -> String {
    let links: Vec<&str> = source.split(", ").collect();
    let are_links = links.iter().all(|link| link.starts_with("github.com/"));
    if !are_links || links.len() <= MOST_LINKS {
        return source.to_owned();
    }
    let first = links[..MOST_LINKS].join(", ");
    format!("{first} and {} more", links.len() - MOST_LINKS)
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    if arguments.mistakes {
        return list_mistakes(&arguments.json);
    }
    let suite = arguments.selection.open()?;
    output::check(&[arguments.json.file()], &[])?;
    let (cases, rows) = suite.select_with_rows(&arguments.filters)?;
    let row_names: Vec<String> = rows.iter().map(|row| row_name(row)).collect();
    let names = cases.iter().map(|case| &case.name).chain(&row_names);
    let widest = widest(names);
    let mut text = String::new();
    let mut entries = Vec::new();
    for case in cases {
        text.push_str(&format!(
            "{:<widest$}  {:<13}  {}\n",
            case.name,
            case.class(),
            short(&case.source)
        ));
        entries.push(json!({
            "name": case.name,
            "family": case.family,
            "class": case.class(),
            "gate": case.gate().name(),
            "scene": case.scene,
            "source": case.source,
            "shows": case.shows,
            "computes": case.computes,
            "exposure": case.exposure,
            "opacity": case.opacity,
            "depth": case.depth.map(|depth| depth.to_string()),
        }));
    }
    let mut value = json!({ "schema": "volref/list/1", "cases": entries });
    let mut entries = Vec::new();
    for (row, name) in rows.iter().zip(&row_names) {
        text.push_str(&format!("{name:<widest$}  {ANALYTIC:<13}  {}\n", row.what));
        entries.push(json!({
            "name": name,
            "what": row.what,
            "tolerance": row.tolerance,
            "remedy": row.remedy,
            "file": row.file,
        }));
    }
    if !entries.is_empty() {
        value["rows"] = entries.into();
    }
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// Lists the catalogue of mistakes, which no suite is needed for.
fn list_mistakes(json: &Json) -> Result<Outcome, Failure> {
    output::check(&[json.file()], &[])?;
    let mut text = String::new();
    let mut entries = Vec::new();
    for mistake in mistakes::catalogue() {
        text.push_str(&format!("{}\n    {}\n", mistake.name, mistake.advice));
        entries.push(json!({ "name": mistake.name, "advice": mistake.advice }));
    }
    let value = json!({ "schema": "volref/mistakes/1", "mistakes": entries });
    json.instead_of(text, &value).map(Outcome::from)
}
