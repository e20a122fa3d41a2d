//! The cost of accuracy: for a terminal, for spreadsheets, for programs, and as one offline page.

mod plot;
mod table;
mod words;

pub use plot::plot as cost_plot;
pub(crate) use words::wrapped;

use super::template::{Template, rendered};
use crate::cost::timing::{Machine, Times};
use crate::cost::{Cost, Event, MeanWork};
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

/// The files `sweeps.csv`, a row for each setting, and `effects.csv`: their names and texts. Times come last, so that
/// two runs can be compared without them.
pub fn cost_csv(costs: &[Cost]) -> [(&'static str, String); 2] {
    let of_scene = |cost: &Cost| [cost.scene.clone(), cost.panel.clone().unwrap_or_default()];
    let settings = costs.iter().flat_map(|cost| {
        let sweeps = cost.sweeps.iter();
        let levels = sweeps.flat_map(|sweep| (0..sweep.levels.len()).map(move |at| (sweep, at)));
        levels.map(move |(sweep, at)| {
            let (level, order) = (&sweep.levels[at], &sweep.order);
            let local = at.checked_sub(1).and_then(|before| order.local[before]);
            let [parameter, verdict] = [json!(sweep.parameter), json!(order.verdict)];
            let word = |word: &Value| word.as_str().unwrap_or_default().to_owned();
            let error = level.error;
            let mut row = of_scene(cost).to_vec();
            row.extend([sweep.name.to_owned(), word(&parameter)]);
            row.extend([level.setting.clone(), digits(level.value)]);
            row.extend(work(&level.work));
            row.extend([error.l1, error.l2, error.max, error.uncertainty].map(digits));
            row.extend([local, order.fitted, order.expected].map(or_nothing));
            row.extend([word(&verdict), digits(sweep.reference.bound)]);
            row.extend(times(level.time.as_ref()));
            row
        })
    });
    let effects = costs.iter().flat_map(|cost| {
        cost.effects.iter().map(|effect| {
            let mut row = of_scene(cost).to_vec();
            row.push(effect.effect.clone());
            row.extend(work(&effect.work));
            row.push(or_nothing(effect.times_lookups));
            row.extend(times(effect.time.as_ref()));
            row
        })
    });
    let work = Event::ALL.map(|event| event.key()).join(",");
    let times = "runs,median_seconds,min_seconds,max_seconds,deviation_seconds,outliers,is_noisy";
    let of_sweeps = format!(
        "scene,panel,sweep,parameter,setting,value,{work},l1,l2,max,l2_uncertainty,local_order,fitted_order,\
         expected_order,verdict,reference_bound,{times}"
    );
    let of_effects = format!("scene,panel,effect,{work},times_lookups,{times}");
    [
        ("sweeps.csv", csv(&of_sweeps, settings)),
        ("effects.csv", csv(&of_effects, effects)),
    ]
}

fn csv(heads: &str, rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = heads.split(',').map(str::to_owned).collect();
    for row in std::iter::once(heads).chain(rows) {
        writer
            .write_record(&row)
            .expect("rows have the same columns");
    }
    let bytes = writer.into_inner().expect("a vector takes every byte");
    String::from_utf8(bytes).expect("text was written")
}

/// The shortest digits that read back as the same number.
fn digits(number: f64) -> String {
    format!("{number:?}")
}

fn or_nothing(number: Option<f64>) -> String {
    number.map_or(String::new(), digits)
}

fn work(work: &MeanWork) -> [String; Event::COUNT] {
    Event::ALL.map(|event| digits(work[event]))
}

fn times(times: Option<&Times>) -> [String; 7] {
    let Some(times) = times else {
        return Default::default();
    };
    let [median, min, max, deviation] =
        [times.median, times.min, times.max, times.deviation].map(digits);
    let [runs, outliers] = [times.runs, times.outliers].map(|count| count.to_string());
    [
        runs,
        median,
        min,
        max,
        deviation,
        outliers,
        times.is_noisy.to_string(),
    ]
}
