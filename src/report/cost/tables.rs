//! The tables of the cost of accuracy: rows for a terminal, a page and CSV alike.

use super::table::{Cell, Table, csv, key, number, words as named};
use super::words::{self, Mark};
use crate::cost::results::{
    ConvergenceOrder, Cost, Counted, EffectPrice, EstimatorTable, Event, JitterSplit, Level,
    MeanWork, Norms, Offer, Price, Study, Sweep, ThicknessSweep, Times,
};

/// A row of a table, with all its columns.
type Row = Vec<Cell>;

/// The rows about a scene.
type RowsOf = fn(&Cost) -> Vec<Row>;

/// A CSV file for each table that has rows, of all scenes: its name and its text. Times come last,
/// so that two runs can be compared without them.
pub fn cost_csv(costs: &[Cost]) -> Vec<(String, String)> {
    let tables: [(&str, RowsOf); 7] = [
        ("sweeps", |cost| rows_of(&cost.studies, sweeps_rows)),
        ("orders", |cost| {
            let mut rows = rows_of(&cost.studies, order_rows);
            rows.extend(rows_of(&cost.jitter, jitter_order_rows));
            rows
        }),
        ("prices", |cost| {
            rows_of(&cost.studies, |study| price_rows(study, |_| true))
        }),
        ("estimators", |cost| {
            rows_of(&cost.estimators, estimator_rows)
        }),
        ("thickness", |cost| rows_of(&cost.thickness, thickness_rows)),
        ("jitter", |cost| rows_of(&cost.jitter, jitter_rows)),
        ("effects", |cost| effect_rows(&cost.effects)),
    ];
    let mut files = Vec::new();
    for (name, rows_of) in tables {
        let mut all = Vec::new();
        for cost in costs {
            let scene = [
                key("scene", &*cost.scene),
                key("panel", cost.panel.as_deref()),
            ];
            let rows = rows_of(cost).into_iter();
            all.extend(rows.map(|row| [scene.to_vec(), row].concat()));
        }
        files.extend(csv(&all).map(|text| (format!("{name}.csv"), text)));
    }
    files
}

fn rows_of<'a, T: 'a>(
    parts: impl IntoIterator<Item = &'a T>,
    rows: fn(&'a T) -> Vec<Row>,
) -> Vec<Row> {
    parts.into_iter().flat_map(rows).collect()
}

fn work_cells(work: &MeanWork) -> [Cell; 8] {
    MeanWork::REPORTED.map(|event| key(event.key(), work[event]))
}

fn time_cells(head: &'static str, times: Option<&Times>) -> [Cell; 7] {
    let mark = match times {
        Some(times) if times.is_noisy => Mark::Odd,
        _ => Mark::Plain,
    };
    [
        key("runs", times.map(|times| times.runs)),
        number(head, times.map(words::times))
            .key("median_seconds", times.map(|times| times.median))
            .marked(mark)
            .optional(),
        key("min_seconds", times.map(|times| times.min)),
        key("max_seconds", times.map(|times| times.max)),
        key("deviation_seconds", times.map(|times| times.deviation)),
        key("outliers", times.map(|times| times.outliers)),
        key("is_noisy", times.map(|times| times.is_noisy)),
    ]
}

/// The settings of a sweep.
pub(super) fn sweep(study: &Study, sweep: &Sweep) -> Table {
    let known = sweep.order.known;
    let mut notes = Vec::new();
    if sweep.levels.iter().any(|level| level.error.l2 <= known) {
        notes.push(format!(
            "° not above {}, the error of the reference: not an error of the setting",
            words::error(known)
        ));
    }
    notes.extend(sweep.cut.iter().map(|why| format!("ended early: {why}")));
    let name = words::sweep(study, &sweep.estimator, sweep.parameter);
    let ours = match sweep.is_ours {
        true => " (as in the reference renderer)",
        false => "",
    };
    Table {
        title: format!("{name}{ours}"),
        rows: sweep_rows(study, sweep),
        notes,
        ..Table::default()
    }
}

fn sweeps_rows(study: &Study) -> Vec<Row> {
    let sweeps = study.sweeps.iter();
    sweeps.flat_map(|sweep| sweep_rows(study, sweep)).collect()
}

fn sweep_rows(study: &Study, sweep: &Sweep) -> Vec<Row> {
    let (levels, order) = (&sweep.levels, &sweep.order);
    let counts = |what| levels.iter().any(|level| level.work.counted() == what);
    let by_random = counts(Counted::RandomNumbers) && !counts(Counted::Lookups);
    let draws = |level: usize| levels[level].work[Event::RandomDraw];
    let has_draws = !by_random && (0..levels.len()).any(|level| draws(level) > 0.0);
    let has_doubt = levels.iter().any(|level| level.error.uncertainty > 0.0);
    let row = |(at, level): (usize, &Level)| {
        let (error, judged, single) = (level.error, level.error_of_order, level.single_precision);
        let local = at
            .checked_sub(1)
            .and_then(|before| *order.local.get(before)?);
        let l2 = match error.l2 > order.known {
            true => words::error(error.l2),
            // As all errors are at most so large, this one says no more.
            false => format!("° {}", words::error(error.l2)),
        };
        let (counted, count) = match by_random {
            true => ("random numbers", draws(at)),
            false => ("lookups", level.work.lookups()),
        };
        let l2_of = |norms: Norms| words::error(norms.l2);
        let mut row = vec![
            key("study", &*study.name),
            key("estimator", &*sweep.estimator),
            key("is_ours", sweep.is_ours),
            key("parameter", words::key(sweep.parameter)),
            named("setting", &level.setting).key("setting", &*level.setting),
            key("value", level.value),
            number(counted, words::count(count)),
        ];
        row.extend(work_cells(&level.work));
        row.extend([
            number("L1", words::error(error.l1)).key("l1", error.l1),
            number("L2", l2).key("l2", error.l2),
            number("max", words::error(error.max)).key("max", error.max),
            number("L2 ±", has_doubt.then(|| words::percent(error.uncertainty)))
                .key("l2_uncertainty", error.uncertainty)
                .on_page()
                .optional(),
            key("judged_l1", judged.map(|norms| norms.l1)),
            number("judged", judged.map(l2_of))
                .key("judged_l2", judged.map(|norms| norms.l2))
                .optional(),
            key("judged_max", judged.map(|norms| norms.max)),
            number("order", local.map(words::order)).key("local_order", local),
            key("f32_off_l1", single.map(|norms| norms.l1)),
            number("f32 off", single.map(l2_of))
                .key("f32_off_l2", single.map(|norms| norms.l2))
                .optional(),
            key("f32_off_max", single.map(|norms| norms.max)),
            key("reference_bound", study.reference.bound),
            number("random numbers", has_draws.then(|| words::count(draws(at))))
                .on_page()
                .optional(),
        ]);
        row.extend(time_cells("time per ray", level.time.as_ref()));
        row
    };
    levels.iter().enumerate().map(row).collect()
}

/// Orders of convergence, sweep by sweep.
pub(super) fn orders(study: &Study) -> Table {
    let judged_on = study.judged_on.iter();
    let mut notes: Vec<String> = judged_on.map(|rays| format!("orders: {rays}")).collect();
    notes.extend(study.sweeps.iter().filter_map(|sweep| {
        let why = sweep.cut.as_ref()?;
        let name = words::sweep(study, &sweep.estimator, sweep.parameter);
        Some(format!("{name} ended early: {why}"))
    }));
    Table {
        title: format!("{}: convergence orders", study.name),
        rows: order_rows(study),
        notes,
        ..Table::default()
    }
}

fn order_rows(study: &Study) -> Vec<Row> {
    let row = |sweep: &Sweep| {
        let mut row = vec![
            key("study", &*study.name),
            named("estimator", &sweep.estimator).key("of", &*sweep.estimator),
            named("varied", words::parameter(sweep.parameter))
                .key("parameter", words::key(sweep.parameter)),
        ];
        row.extend(order_cells(&sweep.order, sweep.cut.as_deref()));
        row
    };
    study.sweeps.iter().map(row).collect()
}

fn order_cells(order: &ConvergenceOrder, cut: Option<&str>) -> [Cell; 6] {
    let tolerance = order.expected.map(|_| words::order(order.tolerance));
    let (mark, verdict) = words::verdict(order.verdict);
    [
        number("expected", order.expected.map(|order| order.to_string()))
            .key("expected", order.expected),
        number("±", tolerance).key("tolerance", order.tolerance),
        number("fitted", order.fitted.map(words::order)).key("fitted", order.fitted),
        number("of max", order.fitted_max.map(words::order)).key("fitted_max", order.fitted_max),
        named("verdict", verdict)
            .key("verdict", words::key(order.verdict))
            .marked(mark),
        key("cut", cut),
    ]
}

/// The cheapest settings.
pub(super) fn prices(study: &Study) -> Table {
    let mut notes = Vec::new();
    let mut by_none = Vec::new();
    for price in &study.prices {
        let error = words::round(price.error);
        let not = price.offers.iter().filter(|offer| offer.setting.is_none());
        let not: Vec<String> = not
            .map(|offer| words::sweep(study, &offer.estimator, offer.parameter))
            .collect();
        if not.len() == price.offers.len() {
            by_none.push(error);
        } else if !not.is_empty() {
            let not = not.join("; ");
            notes.push(format!(
                "{error} was not reached in the range tested by: {not}"
            ));
        }
    }
    if !by_none.is_empty() {
        let by_none = by_none.join(", ");
        notes.push(format!(
            "not reached by any setting that was measured: {by_none}"
        ));
    }
    Table {
        title: format!("{}: cheapest settings for a given error", study.name),
        rows: price_rows(study, |offer| offer.setting.is_some()),
        is_grouped: true,
        notes,
    }
}

/// The offers that are `wanted`.
fn price_rows(study: &Study, wanted: fn(&Offer) -> bool) -> Vec<Row> {
    let row = |(price, offer): (&Price, &Offer)| {
        let name = words::sweep(study, &offer.estimator, offer.parameter);
        let setting = offer.setting.as_deref();
        vec![
            key("study", &*study.name),
            named("error", &words::round(price.error)).key("error", price.error),
            named("estimator", &name).key("estimator", &*offer.estimator),
            key("parameter", words::key(offer.parameter)),
            named("setting", setting.unwrap_or_default()).key("setting", setting),
            number(words::counted(study), offer.lookups.map(words::count))
                .key("lookups", offer.lookups),
            number("× cheapest", offer.times_cheapest.map(words::factor))
                .key("times_cheapest", offer.times_cheapest),
            number("time per ray", offer.seconds.map(words::seconds))
                .key("seconds", offer.seconds)
                .optional(),
        ]
    };
    let offers = study.prices.iter().flat_map(|price| {
        let offers = price.offers.iter().filter(|offer| wanted(offer));
        offers.map(move |offer| (price, offer))
    });
    offers.map(row).collect()
}

/// Estimators against theory.
pub(super) fn estimators(table: &EstimatorTable) -> Table {
    Table {
        title: "estimators of transmittance".to_owned(),
        rows: estimator_rows(table),
        notes: vec![format!(
            "{}: optical depth {}, transmittance {}, {} samples of each",
            table.ray, table.depth, table.transmittance, table.samples
        )],
        ..Table::default()
    }
}

fn estimator_rows(table: &EstimatorTable) -> Vec<Row> {
    let rows = table.rows.iter().map(|row| {
        let (mark, agreement) = words::agreement(row);
        let theory = |prediction: Option<f64>, shown: fn(f64) -> String| {
            number("theory", prediction.map(shown))
        };
        vec![
            key("ray", &*table.ray),
            key("depth", table.depth),
            key("transmittance", table.transmittance),
            key("samples", table.samples as usize),
            named("estimator", &row.estimator).key("estimator", &*row.estimator),
            named("verdict", agreement).marked(mark),
            number("mean", format!("{:.6}", row.mean))
                .key("mean", row.mean)
                .on_page(),
            number("s.e. off", words::standard_errors(row)).key("bias", row.bias),
            key("standard_error", row.standard_error),
            number("variance", words::error(row.variance)).key("variance", row.variance),
            number("± 1 s.e.", words::error(row.variance_error))
                .key("variance_error", row.variance_error)
                .on_page(),
            theory(row.predicted_variance, words::error)
                .key("predicted_variance", row.predicted_variance),
            number("lookups", words::count(row.lookups)).key("lookups", row.lookups),
            theory(row.predicted_lookups, words::count)
                .key("predicted_lookups", row.predicted_lookups),
            number("var × work", words::error(row.variance_times_lookups))
                .key("variance_times_lookups", row.variance_times_lookups),
            key("agrees", row.agrees),
            number(
                "var × seconds",
                row.variance_times_seconds.map(words::error),
            )
            .key("variance_times_seconds", row.variance_times_seconds)
            .on_page()
            .optional(),
        ]
    });
    rows.collect()
}

/// Variance times lookups by optical thickness: a row for each thickness.
pub(super) fn thickness(sweep: &ThicknessSweep) -> Table {
    Table {
        title: "thin and dense media".to_owned(),
        rows: thickness_rows(sweep),
        is_grouped: true,
        notes: vec![sweep.ray.clone()],
    }
}

fn thickness_rows(sweep: &ThicknessSweep) -> Vec<Row> {
    let mut rows = Vec::new();
    for curve in &sweep.curves {
        for point in &curve.points {
            let both = point.measured.zip(point.predicted);
            let ratio = both.map(|(measured, predicted)| format!("{:.3}", measured / predicted));
            rows.push(vec![
                key("ray", &*sweep.ray),
                named("estimator", &curve.estimator).key("estimator", &*curve.estimator),
                number("optical depth", words::value(point.depth)).key("depth", point.depth),
                number("measured", point.measured.map(words::error))
                    .key("measured", point.measured),
                number("theory", point.predicted.map(words::error))
                    .key("predicted", point.predicted),
                number("measured / theory", ratio),
            ]);
        }
    }
    rows
}

/// Bias and variance of jittered marching.
pub(super) fn jitter(split: &JitterSplit) -> Table {
    Table {
        title: "jittered marching: bias and variance".to_owned(),
        rows: jitter_rows(split),
        is_grouped: true,
        notes: vec![split.ray.clone()],
    }
}

fn jitter_rows(split: &JitterSplit) -> Vec<Row> {
    let mut rows = Vec::new();
    for curve in &split.curves {
        for point in &curve.points {
            let squared = |value: f64| words::error(value * value);
            rows.push(vec![
                key("ray", &*split.ray),
                named("jitter", &curve.jitter).key("jitter", &*curve.jitter),
                number("step", words::value(point.step)).key("step", point.step),
                number("bias²", squared(point.bias)),
                number("variance", squared(point.deviation)),
                number("bias", words::error(point.bias)).key("bias", point.bias),
                key("deviation", point.deviation),
                number("theory", words::error(point.predicted_bias)),
                number("s.d. of depth", words::error(point.depth_deviation))
                    .key("depth_deviation", point.depth_deviation),
                key("predicted_bias", point.predicted_bias),
            ]);
        }
    }
    rows
}

/// Orders of jittered marching.
pub(super) fn jitter_orders(split: &JitterSplit) -> Table {
    Table {
        title: "jittered marching: orders".to_owned(),
        rows: jitter_order_rows(split),
        ..Table::default()
    }
}

fn jitter_order_rows(split: &JitterSplit) -> Vec<Row> {
    let mut rows = Vec::new();
    for curve in &split.curves {
        for (of, kind, order) in [
            ("deviation of depth", "deviation", &curve.deviation_order),
            ("bias of T", "bias", &curve.bias_order),
        ] {
            let mut row = vec![
                named("jitter", &curve.jitter),
                key("study", "jitter"),
                named("of", of).key("of", format!("{}, {kind}", curve.jitter)),
                key("parameter", "step"),
            ];
            row.extend(order_cells(order, None));
            rows.push(row);
        }
    }
    rows
}

/// Cost of each effect.
pub(super) fn effects(effects: &[EffectPrice]) -> Table {
    Table {
        title: "cost of each effect by itself".to_owned(),
        rows: effect_rows(effects),
        ..Table::default()
    }
}

fn effect_rows(effects: &[EffectPrice]) -> Vec<Row> {
    let row = |effect: &EffectPrice| {
        let times_lookups = effect.times_lookups;
        let count = |head, event| number(head, words::count(effect.work[event]));
        let mut row = vec![
            named("effect", &effect.effect).key("effect", &*effect.effect),
            number("lookups", words::count(effect.work.lookups())),
        ];
        row.extend(work_cells(&effect.work));
        row.extend([
            number("× first", times_lookups.map(words::factor)).key("times_lookups", times_lookups),
            count("shadow rays", Event::ShadowRay),
            count("phase", Event::PhaseEvaluation),
            count("null", Event::NullCollision).on_page(),
            count("cells", Event::CellWalked).on_page(),
            count("surface tests", Event::SurfaceTest).on_page(),
            count("random", Event::RandomDraw),
        ]);
        row.extend(time_cells("time per pixel", effect.time.as_ref()));
        row
    };
    effects.iter().map(row).collect()
}
