//! The cost of accuracy: for a terminal, for programs, and as one offline page.

mod plot;
mod table;
mod words;

pub use plot::plot as cost_plot;
pub(crate) use words::wrapped;

use super::template::{Template, rendered};
use crate::cost::Cost;
use crate::cost::timing::Machine;
use minijinja::context;
use serde_json::{Value, json};

/// The cost of accuracy as JSON.
pub fn cost_json(costs: &[Cost], machine: Option<&Machine>) -> Value {
    json!({
        "schema": "volref/cost/1",
        "machine": machine,
        "costs": costs,
    })
}

/// The cost of accuracy for a terminal, no line longer than 100 columns except for commands: for each scene first the
/// recommended settings, then the settings with error, work and time, then the effects.
pub fn cost_text(costs: &[Cost], machine: Option<&Machine>) -> String {
    let mut text = String::new();
    for cost in costs {
        let name = words::scene(cost);
        let rule = "=".repeat(name.chars().count());
        text.push_str(&format!("{name}\n{rule}\n"));
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
        for table in table::tables(cost) {
            text.push_str(&format!("\n{}\n{}", table.title, table.text()));
            for note in &table.notes {
                text.push_str(&wrapped(note, 2));
            }
        }
        if !cost.notes.is_empty() {
            text.push_str("\nnotes\n");
        }
        for note in &cost.notes {
            text.push_str(&wrapped(note, 2));
        }
        text.push('\n');
    }
    if let Some(machine) = machine {
        let facts = words::machine(machine).join(", ");
        text.push_str(&wrapped(&format!("times: {facts}"), 0));
    }
    text
}

const TEMPLATE: Template = Template {
    blocks: include_str!("page.html"),
    style: include_str!("page.css"),
    script: "",
};

/// The page as a complete HTML file. It loads nothing else, runs no script, and works from
/// `file://`.
pub fn cost_html(command: &str, costs: &[Cost], machine: Option<&Machine>) -> String {
    let costs = costs.iter().map(|cost| {
        context! {
            name => words::scene(cost),
            advice => cost.recommendations,
            plot => cost_plot(cost),
            tables => table::tables(cost),
            notes => cost.notes,
        }
    });
    rendered(
        &TEMPLATE,
        context! {
            command,
            costs => costs.collect::<Vec<_>>(),
            machine => machine.map(words::machine),
        },
    )
}
