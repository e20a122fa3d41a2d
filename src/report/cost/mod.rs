//! The cost of accuracy: for a terminal, for spreadsheets, for programs, and as one offline page.

mod plot;
mod table;
mod words;

pub use plot::plot as cost_plot;
pub(crate) use words::wrapped;

use super::template::{Template, rendered};
use crate::cost::timing::Machine;
use crate::cost::{Cost, Event};
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

/// Columns of the files in their order, each with the place of its values where that is another. Times come last, so that
/// two runs can be compared without them.
const OF_SWEEPS: &str = "scene panel sweep=sweep/name parameter=sweep/parameter setting value {work} l2=error/l2 \
    l2_uncertainty=error/uncertainty local_order fitted_order=sweep/order/fitted \
    expected_order=sweep/order/expected verdict=sweep/order/verdict reference_bound=sweep/reference/bound {times}";
const OF_EFFECTS: &str = "scene panel effect {work} times_lookups {times}";
const TIMES: &str = "runs=time/runs median_seconds=time/median min_seconds=time/min max_seconds=time/max \
    is_noisy=time/is_noisy";

/// The files `sweeps.csv`, a row for each setting, and `effects.csv`: their names and texts.
pub fn cost_csv(costs: &[Cost]) -> [(&'static str, String); 2] {
    let (mut settings, mut effects) = (Vec::new(), Vec::new());
    for cost in costs {
        let row = |mut row: Value| {
            row["scene"] = json!(cost.scene);
            row["panel"] = json!(cost.panel);
            row
        };
        for sweep in &cost.sweeps {
            let before = std::iter::once(&None).chain(&sweep.order.local);
            for (level, local) in sweep.levels.iter().zip(before) {
                let mut of_level = row(json!(level));
                of_level["sweep"] = json!(sweep);
                of_level["local_order"] = json!(local);
                settings.push(of_level);
            }
        }
        effects.extend(cost.effects.iter().map(|effect| row(json!(effect))));
    }
    [
        ("sweeps.csv", csv(OF_SWEEPS, &settings)),
        ("effects.csv", csv(OF_EFFECTS, &effects)),
    ]
}

/// The `rows` under these columns; numbers have the shortest digits that read back as the same number.
fn csv(columns: &str, rows: &[Value]) -> String {
    let work = Event::ALL.map(|event| format!("{0}=work/{0}", event.key()));
    let columns = columns.replace("{work}", &work.join(" "));
    let columns = columns.replace("{times}", TIMES);
    let columns = columns.split_whitespace();
    let columns: Vec<(&str, &str)> = columns
        .map(|column| column.split_once('=').unwrap_or((column, column)))
        .collect();
    let cell = |row: &Value, place: &str| match row.pointer(&format!("/{place}")) {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(number) => number.to_string(),
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = columns.iter().map(|(head, _)| (*head).to_owned()).collect();
    let cells = |row| columns.iter().map(|(_, place)| cell(row, place)).collect();
    for line in std::iter::once(heads).chain(rows.iter().map(cells)) {
        let line: Vec<String> = line;
        let written = writer.write_record(&line);
        written.expect("rows have the same columns");
    }
    let bytes = writer.into_inner().expect("a vector takes every byte");
    String::from_utf8(bytes).expect("text was written")
}
