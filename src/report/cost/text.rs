//! The cost of accuracy for a terminal.

use super::table::{ReportTable, wrapped};
use super::{tables, words};
use crate::cost::results::{Cost, Machine, OrderVerdict, Recommendation, Sweep};

/// Tables as plain text, no line longer than 100 columns but for commands: of each scene what to
/// take and the price list first, then orders, then settings and the rest. All settings of all
/// sweeps are in [`super::cost_csv`] and [`super::cost_html`].
pub fn cost_text(costs: &[Cost], machine: Option<&Machine>) -> String {
    let mut text = String::new();
    for cost in costs {
        text.push_str(&scene(cost));
        text.push('\n');
    }
    let judgement = words::judgement(costs);
    for (_, fault) in &judgement.faults {
        text.push_str(&wrapped(fault, 0));
    }
    text.push_str(&wrapped(&judgement.headline, 0));
    if let Some(machine) = machine {
        let facts = words::machine(machine);
        let facts: Vec<_> = facts
            .into_iter()
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
        text.push_str("\nwhat to take\n");
        for recommendation in &cost.recommendations {
            text.push_str(&advice(recommendation));
        }
    }
    for study in &cost.studies {
        let reference = &study.reference;
        text.push_str(&format!("\n{}\n", study.name));
        text.push_str(&wrapped(&study.quantity, 2));
        text.push_str(&wrapped(
            &format!(
                "reference: {}; its own error at most {}",
                reference.method,
                words::error(reference.bound)
            ),
            2,
        ));
        if !study.prices.is_empty() {
            push(&mut text, &tables::prices(study));
        }
    }
    for study in cost.studies.iter().filter(|study| !study.sweeps.is_empty()) {
        push(&mut text, &tables::orders(study));
    }
    if let Some(jitter) = &cost.jitter {
        push(&mut text, &tables::jitter_orders(jitter));
    }
    if let Some(estimators) = &cost.estimators {
        push(&mut text, &tables::estimators(estimators));
    }
    if !cost.effects.is_empty() {
        push(&mut text, &tables::effects(&cost.effects));
    }
    for study in &cost.studies {
        let (shown, rest): (Vec<_>, Vec<_>) =
            study.sweeps.iter().partition(|sweep| is_shown(sweep));
        for sweep in shown {
            let mut table = tables::sweep(study, sweep);
            table.title = format!("{}: {}", study.name, table.title);
            push(&mut text, &table);
        }
        if !rest.is_empty() {
            let names: Vec<_> = rest
                .into_iter()
                .map(|sweep| words::sweep(study, &sweep.estimator, sweep.parameter))
                .collect();
            let names = names.join("; ");
            text.push('\n');
            text.push_str(&wrapped(
                &format!("{}: page and CSV have all settings of {names}", study.name),
                0,
            ));
        }
    }
    if let Some(thickness) = &cost.thickness {
        push(&mut text, &tables::thickness(thickness));
    }
    if let Some(jitter) = &cost.jitter {
        push(&mut text, &tables::jitter(jitter));
    }
    if !cost.notes.is_empty() {
        text.push_str("\nnot measured\n");
        for note in &cost.notes {
            text.push_str(&wrapped(note, 2));
        }
    }
    text
}

/// Whether all settings of a sweep are shown on a terminal: of what the reference renderer does,
/// and of what does not do as expected.
fn is_shown(sweep: &Sweep) -> bool {
    let is_fine = matches!(
        sweep.order.verdict,
        OrderVerdict::AsExpected | OrderVerdict::TooFewRays | OrderVerdict::NothingExpected
    );
    sweep.is_ours || !is_fine
}

fn advice(recommendation: &Recommendation) -> String {
    let mut text = wrapped(&recommendation.text, 2);
    if let Some(command) = &recommendation.command {
        // In one piece, to be copied.
        text.push_str(&format!("    {command}\n"));
    }
    text
}

fn push(text: &mut String, table: &ReportTable) {
    text.push_str(&format!("\n{}\n", table.title));
    text.push_str(&table.text(2));
    for note in &table.notes {
        text.push_str(&wrapped(note, 2));
    }
}
