//! `volref list [FILTER…]`, `volref list --mistakes`

use super::Outcome;
use super::failure::Failure;
use super::output::{self, Json};
use super::suite::Selection;
use crate::report::{number_of, widest, wrapped};
use crate::suite::{CORE, Case, Family, Suite};
use crate::variations::mistakes;
use serde_json::{Value, json};

/// List the families of the suite and its core set, or cases
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Families, cases, patterns over them, or core; those with ! before them are left out [default: an overview of all]
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

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    if arguments.mistakes {
        return list_mistakes(&arguments.json);
    }
    let suite = arguments.selection.open()?;
    output::check(&[arguments.json.file()], &[])?;
    let cases = suite.select(&arguments.filters)?;
    let families = suite.families(&cases);
    let text = match arguments.filters.is_empty() {
        true => overview(&suite, &families),
        false => listing(&cases),
    };
    let is_core = |case: &Case| suite.core().contains(&case.name);
    let family = |family: &Family<'_>| {
        json!({
            "name": family.name,
            "asks": family.asks,
            "cases": family.cases.len(),
            "core": family.cases.iter().filter(|case| is_core(case)).count(),
        })
    };
    let value = json!({
        "schema": "volref/list/1",
        "families": families.iter().map(family).collect::<Vec<_>>(),
        "cases": cases.iter().map(|case| case_json(case, is_core(case))).collect::<Vec<_>>(),
    });
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// The families, in the order of their use, and the core set.
fn overview(suite: &Suite, families: &[Family<'_>]) -> String {
    let width = widest(families.iter().map(|family| family.name)).max("family".len());
    let mut text = format!("{:<width$}  cases  asks of a renderer\n", "family");
    for Family { name, asks, cases } in families {
        let line = format!("{name:<width$}  {:>5}  {}", cases.len(), asks.unwrap_or(""));
        text.push_str(line.trim_end());
        text.push('\n');
    }
    let cases: usize = families.iter().map(|family| family.cases.len()).sum();
    text.push_str(&format!("\nIn all {}.\n", number_of(cases, "case")));
    let core = suite.core();
    if !core.is_empty() {
        text.push_str(&format!(
            "\nThe core set, {} that a renderer is asked first, as the filter {CORE}:\n{}",
            number_of(core.len(), "case"),
            wrapped(&core.join(" "), 2)
        ));
    }
    text.push_str("\n`volref list FAMILY` lists its cases, with what they show.\n");
    text
}

/// A line for each case, and what it shows.
fn listing(cases: &[&Case]) -> String {
    let widest = widest(cases.iter().map(|case| &case.name));
    let mut text = String::new();
    for case in cases {
        let (name, source) = (&case.name, &case.source);
        text.push_str(&format!("{name:<widest$}  {}\n", case.class()));
        text.push_str(&wrapped(&format!("{} [{source}]", case.shows), 4));
    }
    text
}

fn case_json(case: &Case, is_core: bool) -> Value {
    json!({
        "name": case.name,
        "family": case.family,
        "core": is_core,
        "class": case.class(),
        "gate": case.gate().name(),
        "scene": case.scene,
        "source": case.source,
        "shows": case.shows,
        "computes": case.computes,
        "exposure": case.exposure,
        "opacity": case.opacity,
        "depth": case.depth.map(|depth| depth.to_string()),
    })
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
