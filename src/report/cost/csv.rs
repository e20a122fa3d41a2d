//! The cost of accuracy for spreadsheets and plotting programs.

use crate::cost::results::{Cost, Event, MeanWork, Norms, Parameter, Times};
use serde::Serialize;
use serde_json::Value;

/// A file for each table that has rows: its name, and its text with a row of names on top. Numbers
/// are written in full, so that reading gives the same number; what there is not is empty. Times
/// come last, so that two runs can be compared without them.
pub fn cost_csv(costs: &[Cost]) -> Vec<(String, String)> {
    [
        sweeps(costs),
        orders(costs),
        prices(costs),
        estimators(costs),
        thickness(costs),
        jitter(costs),
        effects(costs),
    ]
    .into_iter()
    .filter(|file| !file.rows.is_empty())
    .map(CsvTable::written)
    .collect()
}

/// What becomes a file.
struct CsvTable {
    name: &'static str,
    heads: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

impl CsvTable {
    /// A table about scenes: their columns come first.
    fn new(name: &'static str, heads: &[&'static str]) -> CsvTable {
        let mut all = vec!["scene", "panel"];
        all.extend(heads);
        CsvTable {
            name,
            heads: all,
            rows: Vec::new(),
        }
    }

    fn push(&mut self, cost: &Cost, cells: impl IntoIterator<Item = String>) {
        let mut row = vec![cost.scene.clone(), cost.panel.clone().unwrap_or_default()];
        row.extend(cells);
        self.rows.push(row);
    }

    fn written(self) -> (String, String) {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // The writer refuses a row that is longer or shorter than the first.
        let all = "rows are as long as the names of the columns";
        writer.write_record(&self.heads).expect(all);
        for row in &self.rows {
            writer.write_record(row).expect(all);
        }
        let bytes = writer.into_inner().expect("a vector takes every byte");
        let text = String::from_utf8(bytes).expect("text was written");
        (format!("{}.csv", self.name), text)
    }
}

/// The shortest digits that read back as the same number.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, number)
}

/// The same word as in JSON.
fn word(choice: impl Serialize) -> String {
    match serde_json::to_value(choice) {
        Ok(Value::String(word)) => word,
        other => unreachable!("{other:?} is no word"),
    }
}

const WORK: [Event; 8] = MeanWork::REPORTED;

fn work(work: &MeanWork) -> [String; 8] {
    WORK.map(|event| number(work[event]))
}

const TIMES: [&str; 7] = [
    "runs",
    "median_seconds",
    "min_seconds",
    "max_seconds",
    "deviation_seconds",
    "outliers",
    "is_noisy",
];

fn times(times: Option<&Times>) -> [String; 7] {
    let Some(times) = times else {
        return Default::default();
    };
    [
        times.runs.to_string(),
        number(times.median),
        number(times.min),
        number(times.max),
        number(times.deviation),
        times.outliers.to_string(),
        times.is_noisy.to_string(),
    ]
}

fn norms(norms: Option<&Norms>) -> [String; 3] {
    [
        optional(norms.map(|norms| norms.l1)),
        optional(norms.map(|norms| norms.l2)),
        optional(norms.map(|norms| norms.max)),
    ]
}

fn sweeps(costs: &[Cost]) -> CsvTable {
    let mut heads = vec![
        "study",
        "estimator",
        "is_ours",
        "parameter",
        "setting",
        "value",
    ];
    heads.extend(WORK.map(Event::key));
    heads.extend(["l1", "l2", "max", "l2_uncertainty"]);
    heads.extend(["judged_l1", "judged_l2", "judged_max", "local_order"]);
    heads.extend(["f32_off_l1", "f32_off_l2", "f32_off_max", "reference_bound"]);
    heads.extend(TIMES);
    let mut file = CsvTable::new("sweeps", &heads);
    for cost in costs {
        for study in &cost.studies {
            for sweep in &study.sweeps {
                for (at, level) in sweep.levels.iter().enumerate() {
                    let before = at.checked_sub(1);
                    let local = before.and_then(|before| sweep.order.local.get(before));
                    let mut row = vec![
                        study.name.to_owned(),
                        sweep.estimator.clone(),
                        sweep.is_ours.to_string(),
                        word(sweep.parameter),
                        level.setting.clone(),
                        number(level.value),
                    ];
                    row.extend(work(&level.work));
                    row.extend(norms(Some(&level.error)));
                    row.push(number(level.error.uncertainty));
                    row.extend(norms(level.error_of_order.as_ref()));
                    row.push(optional(local.copied().flatten()));
                    row.extend(norms(level.single_precision.as_ref()));
                    row.push(number(study.reference.bound));
                    row.extend(times(level.time.as_ref()));
                    file.push(cost, row);
                }
            }
        }
    }
    file
}

fn orders(costs: &[Cost]) -> CsvTable {
    let heads = [
        "study",
        "of",
        "parameter",
        "expected",
        "tolerance",
        "fitted",
        "fitted_max",
        "verdict",
        "cut",
    ];
    let mut file = CsvTable::new("orders", &heads);
    for cost in costs {
        let mut all = Vec::new();
        for study in &cost.studies {
            for sweep in &study.sweeps {
                let of = sweep.estimator.clone();
                let cut = sweep.cut.clone().unwrap_or_default();
                all.push((study.name, of, word(sweep.parameter), &sweep.order, cut));
            }
        }
        for curve in cost.jitter.iter().flat_map(|jitter| &jitter.curves) {
            for (what, order) in [
                ("deviation", &curve.deviation_order),
                ("bias", &curve.bias_order),
            ] {
                let of = format!("{}, {what}", curve.jitter);
                all.push(("jitter", of, word(Parameter::Step), order, String::new()));
            }
        }
        for (study, of, parameter, order, cut) in all {
            let row = [
                study.to_owned(),
                of,
                parameter,
                optional(order.expected),
                number(order.tolerance),
                optional(order.fitted),
                optional(order.fitted_max),
                word(order.verdict),
                cut,
            ];
            file.push(cost, row);
        }
    }
    file
}

fn prices(costs: &[Cost]) -> CsvTable {
    let heads = [
        "study",
        "error",
        "estimator",
        "parameter",
        "setting",
        "lookups",
        "times_cheapest",
        "seconds",
    ];
    let mut file = CsvTable::new("prices", &heads);
    for cost in costs {
        for study in &cost.studies {
            for price in &study.prices {
                for offer in &price.offers {
                    let row = [
                        study.name.to_owned(),
                        number(price.error),
                        offer.estimator.clone(),
                        word(offer.parameter),
                        offer.setting.clone().unwrap_or_default(),
                        optional(offer.lookups),
                        optional(offer.times_cheapest),
                        optional(offer.seconds),
                    ];
                    file.push(cost, row);
                }
            }
        }
    }
    file
}

fn estimators(costs: &[Cost]) -> CsvTable {
    let heads = [
        "ray",
        "depth",
        "transmittance",
        "samples",
        "estimator",
        "mean",
        "bias",
        "standard_error",
        "variance",
        "variance_error",
        "predicted_variance",
        "lookups",
        "predicted_lookups",
        "variance_times_lookups",
        "agrees",
        "variance_times_seconds",
    ];
    let mut file = CsvTable::new("estimators", &heads);
    for cost in costs {
        let Some(table) = &cost.estimators else {
            continue;
        };
        for row in &table.rows {
            let cells = [
                table.ray.clone(),
                number(table.depth),
                number(table.transmittance),
                table.samples.to_string(),
                row.estimator.clone(),
                number(row.mean),
                number(row.bias),
                number(row.standard_error),
                number(row.variance),
                number(row.variance_error),
                optional(row.predicted_variance),
                number(row.lookups),
                optional(row.predicted_lookups),
                number(row.variance_times_lookups),
                row.agrees.to_string(),
                optional(row.variance_times_seconds),
            ];
            file.push(cost, cells);
        }
    }
    file
}

fn thickness(costs: &[Cost]) -> CsvTable {
    let mut file = CsvTable::new(
        "thickness",
        &["ray", "estimator", "depth", "measured", "predicted"],
    );
    for cost in costs {
        let Some(sweep) = &cost.thickness else {
            continue;
        };
        for curve in &sweep.curves {
            for point in &curve.points {
                let row = [
                    sweep.ray.clone(),
                    curve.estimator.clone(),
                    number(point.depth),
                    optional(point.measured),
                    optional(point.predicted),
                ];
                file.push(cost, row);
            }
        }
    }
    file
}

fn jitter(costs: &[Cost]) -> CsvTable {
    let heads = [
        "ray",
        "jitter",
        "step",
        "bias",
        "deviation",
        "depth_deviation",
        "predicted_bias",
    ];
    let mut file = CsvTable::new("jitter", &heads);
    for cost in costs {
        let Some(split) = &cost.jitter else {
            continue;
        };
        for curve in &split.curves {
            for point in &curve.points {
                let row = [
                    split.ray.clone(),
                    curve.jitter.clone(),
                    number(point.step),
                    number(point.bias),
                    number(point.deviation),
                    number(point.depth_deviation),
                    number(point.predicted_bias),
                ];
                file.push(cost, row);
            }
        }
    }
    file
}

fn effects(costs: &[Cost]) -> CsvTable {
    let mut heads = vec!["effect"];
    heads.extend(WORK.map(Event::key));
    heads.push("times_lookups");
    heads.extend(TIMES);
    let mut file = CsvTable::new("effects", &heads);
    for cost in costs {
        for effect in &cost.effects {
            let mut row = vec![effect.effect.clone()];
            row.extend(work(&effect.work));
            row.push(optional(effect.times_lookups));
            row.extend(times(effect.time.as_ref()));
            file.push(cost, row);
        }
    }
    file
}
