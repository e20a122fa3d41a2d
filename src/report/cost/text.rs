//! The cost of accuracy for a terminal.

use super::table::{Table, wrapped};
use super::{tables, words};
use crate::cost::results::{Cost, Machine, OrderVerdict, Sweep};

/// Tables as plain text, no line longer than 100 columns except for commands: for each scene first
/// the recommended settings and the price list, then orders, then settings and the rest. All
/// settings of all sweeps are in [`super::cost_csv`] and [`super::cost_html`].
pub fn cost_text(costs: &[Cost], machine: Option<&Machine>) -> String {
    let mut text = String::new();
    for cost in costs {
        text.push_str(&scene(cost));
        text.push('\n');
    }
    for headline in words::headlines(costs) {
        text.push_str(&wrapped(&headline, 0));
    }
    let judgement = words::judgement(costs);
    for (_, fault) in &judgement.faults {
        text.push_str(&wrapped(fault, 0));
    }
    text.push_str(&wrapped(&judgement.counts, 0));
    if let Some(machine) = machine {
        let facts = words::machine(machine).into_iter();
        let facts: Vec<_> = facts
            .filter(|(_, value)| !value.is_empty())
            .map(|(name, value)| match name {
                "threads" if value == "1" => "1 thread".to_owned(),
                "threads" => format!("{value} threads"),
                "target features" => format!("target features {value}"),
                _ => value,
            })
            .collect();
        text.push_str(&wrapped(&format!("times: {}", facts.join(", ")), 0));
        if let Some(warning) = words::machine_warning(machine) {
            text.push_str(&wrapped(warning, 0));
        }
    }
    text
}

fn scene(cost: &Cost) -> String {
    let name = words::scene(cost);
    let rule = "=".repeat(name.chars().count());
    let mut text = format!("{name}\n{rule}\n");
    if !cost.recommendations.is_empty() {
        text.push_str("\nrecommended settings\n");
    }
    for recommendation in &cost.recommendations {
        text.push_str(&wrapped(&recommendation.text, 2));
        if let Some(command) = &recommendation.command {
            // In one piece, to be copied.
            text.push_str(&format!("    {command}\n"));
        }
    }
    let mut later = Vec::new();
    for study in &cost.studies {
        let (method, bound) = (&study.reference.method, words::error(study.reference.bound));
        text.push_str(&format!("\n{}\n", study.name));
        text.push_str(&wrapped(&study.quantity, 2));
        let reference = format!("reference: {method}; its own error at most {bound}");
        text.push_str(&wrapped(&reference, 2));
        if !study.prices.is_empty() {
            push(&mut text, &tables::prices(study));
        }
        if !study.sweeps.is_empty() {
            later.push(tables::orders(study));
        }
    }
    later.extend(cost.jitter.iter().map(tables::jitter_orders));
    later.extend(cost.estimators.iter().map(tables::estimators));
    if !cost.effects.is_empty() {
        later.push(tables::effects(&cost.effects));
    }
    later.iter().for_each(|table| push(&mut text, table));
    for study in &cost.studies {
        let mut rest = Vec::new();
        for sweep in &study.sweeps {
            if is_shown(sweep) {
                let mut table = tables::sweep(study, sweep);
                table.title = format!("{}: {}", study.name, table.title);
                push(&mut text, &table);
            } else {
                rest.push(words::sweep(study, &sweep.estimator, sweep.parameter));
            }
        }
        if !rest.is_empty() {
            let (study, rest) = (&study.name, rest.join("; "));
            let where_else = format!("{study}: page and CSV have all settings of {rest}");
            text.push('\n');
            text.push_str(&wrapped(&where_else, 0));
        }
    }
    let last = cost.thickness.iter().map(tables::thickness);
    let last = last.chain(cost.jitter.iter().map(tables::jitter));
    last.for_each(|table| push(&mut text, &table));
    if !cost.notes.is_empty() {
        text.push_str("\nnot measured\n");
    }
    for note in &cost.notes {
        text.push_str(&wrapped(note, 2));
    }
    text
}

/// True if all settings of a sweep are shown on a terminal: for the methods of the fast renderer,
/// and for those that do not converge as expected.
fn is_shown(sweep: &Sweep) -> bool {
    let is_fine = matches!(
        sweep.order.verdict,
        OrderVerdict::AsExpected | OrderVerdict::TooFewRays | OrderVerdict::NothingExpected
    );
    sweep.is_ours || !is_fine
}

fn push(text: &mut String, table: &Table) {
    text.push_str(&format!("\n{}\n", table.title));
    text.push_str(&table.text(2));
    for note in &table.notes {
        text.push_str(&wrapped(note, 2));
    }
}
