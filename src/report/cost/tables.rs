//! What is known about the cost of accuracy, as tables.

use super::table::{Column, ReportTable, TableCell, number, page_number, words as column_of_words};
use super::words;
use crate::cost::results::{
    ConvergenceOrder, Counted, EffectPrice, EstimatorTable, Event, JitterSplit, Norms, Offer,
    Study, Sweep, ThicknessSweep, Times,
};

/// A number that there may not be.
fn or_dash<T>(value: Option<T>, shown: impl Fn(T) -> String) -> TableCell {
    value.map_or_else(|| "–".to_owned(), shown).into()
}

fn time(times: Option<&Times>) -> TableCell {
    let mark = match times {
        Some(times) if times.is_noisy => words::Mark::Odd,
        _ => words::Mark::Plain,
    };
    TableCell {
        mark,
        ..or_dash(times, words::times)
    }
}

/// The settings of a sweep.
pub(super) fn sweep(study: &Study, sweep: &Sweep) -> ReportTable {
    let counts = |what| {
        sweep
            .levels
            .iter()
            .any(|level| level.work.counted() == what)
    };
    let by_random = counts(Counted::RandomNumbers) && !counts(Counted::Lookups);
    let mut columns = vec![
        column_of_words("setting"),
        number(if by_random {
            "random numbers"
        } else {
            "look-ups"
        }),
        number("L1"),
        number("L2"),
        number("max"),
    ];
    let has_single = sweep
        .levels
        .iter()
        .any(|level| level.single_precision.is_some());
    let has_judged = sweep
        .levels
        .iter()
        .any(|level| level.error_of_order.is_some());
    let has_doubt = sweep
        .levels
        .iter()
        .any(|level| level.error.uncertainty > 0.0);
    let has_time = sweep.levels.iter().any(|level| level.time.is_some());
    let has_random = !by_random
        && sweep
            .levels
            .iter()
            .any(|level| level.work[Event::RandomDraw] > 0.0);
    if has_doubt {
        columns.push(page_number("L2 ±"));
    }
    if has_judged {
        columns.push(number("judged"));
    }
    columns.push(number("order"));
    if has_single {
        columns.push(number("f32 off"));
    }
    if has_random {
        columns.push(page_number("random numbers"));
    }
    if has_time {
        columns.push(number("time a ray"));
    }
    let known = sweep.order.known;
    let rows = sweep.levels.iter().enumerate().map(|(at, level)| {
        let Norms {
            l1,
            l2,
            max,
            uncertainty,
        } = level.error;
        let is_known = l2 > known;
        let local = at
            .checked_sub(1)
            .and_then(|before| sweep.order.local.get(before));
        let mut row: Vec<TableCell> = vec![
            level.setting.as_str().into(),
            words::count(if by_random {
                level.work[Event::RandomDraw]
            } else {
                level.work[Event::DensityLookup] + level.work[Event::GradientLookup]
            })
            .into(),
            words::error(l1).into(),
            match is_known {
                true => words::error(l2).into(),
                // As all errors are at most so large, this one says no more.
                false => format!("° {}", words::error(l2)).into(),
            },
            words::error(max).into(),
        ];
        if has_doubt {
            row.push(format!("{:.1} %", 100.0 * uncertainty).into());
        }
        if has_judged {
            let judged = level.error_of_order;
            row.push(or_dash(judged, |norms| words::error(norms.l2)));
        }
        row.push(or_dash(local.copied().flatten(), |order| {
            format!("{order:.2}")
        }));
        if has_single {
            let single = level.single_precision;
            row.push(or_dash(single, |norms| words::error(norms.l2)));
        }
        if has_random {
            row.push(words::count(level.work[Event::RandomDraw]).into());
        }
        if has_time {
            row.push(time(level.time.as_ref()));
        }
        row
    });
    let rows: Vec<_> = rows.collect();
    let mut notes = Vec::new();
    if sweep.levels.iter().any(|level| level.error.l2 <= known) {
        notes.push(format!(
            "° not above {}, below which the reference knows no more: no error of the setting",
            words::error(known)
        ));
    }
    notes.extend(sweep.cut.iter().map(|why| format!("ended early: {why}")));
    let name = words::sweep(study, &sweep.estimator, sweep.parameter);
    let ours = if sweep.is_ours {
        " (the reference renderer's way)"
    } else {
        ""
    };
    ReportTable {
        title: format!("{name}{ours}"),
        reading:
            "Each setting with its work and its error; “order” is the power by which the root \
                  mean square error (L2) fell from the setting above."
                .to_owned(),
        columns,
        rows,
        is_grouped: false,
        notes,
    }
}

/// Orders of convergence, sweep by sweep.
pub(super) fn orders(study: &Study) -> ReportTable {
    let row = |sweep: &Sweep| {
        let mut row: Vec<TableCell> = vec![
            sweep.estimator.as_str().into(),
            words::parameter(sweep.parameter).into(),
        ];
        row.extend(order_cells(&sweep.order));
        row
    };
    let mut columns = vec![column_of_words("estimator"), column_of_words("varied")];
    columns.extend(ORDER_COLUMNS);
    let judged_on = study.judged_on.iter();
    let mut notes: Vec<String> = judged_on.map(|rays| format!("orders: {rays}")).collect();
    notes.extend(study.sweeps.iter().filter_map(|sweep| {
        let why = sweep.cut.as_ref()?;
        let name = words::sweep(study, &sweep.estimator, sweep.parameter);
        Some(format!("{name} ended early: {why}"))
    }));
    ReportTable {
        title: format!("{}: orders of error", study.name),
        reading: "Power by which the error falls as the parameter is refined; of samples it is negative. \
                  By least squares: over the four finest settings whose error is below 0.1 and above \
                  what the reference knows, and over all settings where chance is at work."
            .to_owned(),
        columns,
        rows: study.sweeps.iter().map(row).collect(),
        is_grouped: false,
        notes,
    }
}

const ORDER_COLUMNS: [Column; 5] = [
    number("expected"),
    number("±"),
    number("fitted"),
    number("of max"),
    column_of_words("verdict"),
];

fn order_cells(order: &ConvergenceOrder) -> [TableCell; 5] {
    let tolerance = order.expected.map(|_| order.tolerance);
    [
        words::expected(order.expected).into(),
        words::order(tolerance).into(),
        words::order(order.fitted).into(),
        words::order(order.fitted_max).into(),
        words::verdict(order.verdict).into(),
    ]
}

/// The cheapest settings.
pub(super) fn prices(study: &Study) -> ReportTable {
    let mut columns = vec![
        column_of_words("error"),
        column_of_words("estimator"),
        column_of_words("setting"),
        number(words::counted(study)),
        number("× cheapest"),
    ];
    let mut offers = study.prices.iter().flat_map(|price| &price.offers);
    let has_time = offers.any(|offer| offer.seconds.is_some());
    if has_time {
        columns.push(number("time a ray"));
    }
    let mut rows = Vec::new();
    let mut notes = Vec::new();
    let mut by_none = Vec::new();
    for price in &study.prices {
        let error = words::round(price.error);
        let name = |offer: &Offer| words::sweep(study, &offer.estimator, offer.parameter);
        let (reached, not): (Vec<_>, Vec<_>) = price
            .offers
            .iter()
            .partition(|offer| offer.setting.is_some());
        let not: Vec<_> = not.into_iter().map(name).collect();
        if reached.is_empty() {
            by_none.push(error.clone());
        } else if !not.is_empty() {
            notes.push(format!(
                "{error} is not reached, as far as tried, by {}",
                not.join("; ")
            ));
        }
        for (at, offer) in reached.into_iter().enumerate() {
            let mut row: Vec<TableCell> = vec![
                if at == 0 { error.as_str() } else { "" }.into(),
                name(offer).into(),
                offer.setting.as_deref().unwrap_or_default().into(),
                or_dash(offer.lookups, words::count),
                or_dash(offer.times_cheapest, words::factor),
            ];
            if has_time {
                row.push(or_dash(offer.seconds, words::seconds));
            }
            rows.push(row);
        }
    }
    if !by_none.is_empty() {
        notes.push(format!(
            "reached by no setting that was measured: {}",
            by_none.join(", ")
        ));
    }
    ReportTable {
        title: format!("{}: price list", study.name),
        reading: "The cheapest setting of each estimator from which on the root mean square error \
                  stays at or below the one wanted, at all finer settings too: equal error, so \
                  compare the work."
            .to_owned(),
        columns,
        rows,
        is_grouped: true,
        notes,
    }
}

/// Estimators against theory.
pub(super) fn estimators(table: &EstimatorTable) -> ReportTable {
    let mut columns = vec![
        column_of_words("estimator"),
        column_of_words("verdict"),
        page_number("mean"),
        number("s.e. off"),
        number("variance"),
        page_number("± 1 s.e."),
        number("theory"),
        number("look-ups"),
        number("theory"),
        number("var × work"),
    ];
    let has_time = table
        .rows
        .iter()
        .any(|row| row.variance_times_seconds.is_some());
    if has_time {
        columns.push(page_number("var × seconds"));
    }
    let rows = table.rows.iter().map(|row| {
        let mut cells: Vec<TableCell> = vec![
            row.estimator.as_str().into(),
            words::agreement(row).into(),
            format!("{:.6}", row.mean).into(),
            words::standard_errors(row).into(),
            words::error(row.variance).into(),
            words::error(row.variance_error).into(),
            or_dash(row.predicted_variance, words::error),
            words::count(row.lookups).into(),
            or_dash(row.predicted_lookups, words::count),
            words::error(row.variance_times_lookups).into(),
        ];
        if has_time {
            cells.push(or_dash(row.variance_times_seconds, words::error));
        }
        cells
    });
    ReportTable {
        title: "estimators of transmittance".to_owned(),
        reading: "One ray, whose transmittance is known to the last digits. An estimator agrees if \
                  its mean is within 4 standard errors (s.e.) of the truth, its look-ups within 5 % \
                  and its variance within 4 s.e. of theory. Variance × work, in look-ups: the smaller, the \
                  better, whatever the number of samples."
            .to_owned(),
        columns,
        rows: rows.collect(),
        is_grouped: false,
        notes: vec![format!(
            "{}: optical depth {}, transmittance {}, {} samples of each",
            table.ray, table.depth, table.transmittance, table.samples
        )],
    }
}

/// Variance times look-ups by optical thickness: a row for each thickness.
pub(super) fn thickness(sweep: &ThicknessSweep) -> ReportTable {
    let rows = sweep.curves.iter().flat_map(|curve| {
        curve
            .points
            .iter()
            .enumerate()
            .map(|(at, point)| -> Vec<TableCell> {
                let name = if at == 0 {
                    curve.estimator.as_str()
                } else {
                    ""
                };
                let both = point.measured.zip(point.predicted);
                let ratio = both.map(|(measured, predicted)| measured / predicted);
                vec![
                    name.into(),
                    words::value(point.depth).into(),
                    or_dash(point.measured, words::error),
                    or_dash(point.predicted, words::error),
                    or_dash(ratio, |ratio| format!("{ratio:.3}")),
                ]
            })
    });
    ReportTable {
        title: "thin and dense media".to_owned(),
        reading: "Relative variance times look-ups, by the optical depth of the ray: the smallest \
                  wins at that depth."
            .to_owned(),
        columns: vec![
            column_of_words("estimator"),
            number("optical depth"),
            number("measured"),
            number("theory"),
            number("measured / theory"),
        ],
        rows: rows.collect(),
        is_grouped: true,
        notes: vec![sweep.ray.clone()],
    }
}

/// Bias and variance of jittered marching.
pub(super) fn jitter(split: &JitterSplit) -> ReportTable {
    let rows = split.curves.iter().flat_map(|curve| {
        curve
            .points
            .iter()
            .enumerate()
            .map(|(at, point)| -> Vec<TableCell> {
                let name = if at == 0 { curve.jitter.as_str() } else { "" };
                let (bias, variance) = (point.bias * point.bias, point.deviation * point.deviation);
                vec![
                    name.into(),
                    words::value(point.step).into(),
                    words::error(bias).into(),
                    words::error(variance).into(),
                    words::error(point.bias).into(),
                    words::error(point.predicted_bias).into(),
                    words::error(point.depth_deviation).into(),
                ]
            })
    });
    ReportTable {
        title: "jittered marching: bias and variance".to_owned(),
        reading: "Both relative to the transmittance; their sum is the mean square error. Bias is \
                  what more samples do not take away."
            .to_owned(),
        columns: vec![
            column_of_words("jitter"),
            number("step"),
            number("bias²"),
            number("variance"),
            number("bias"),
            number("theory"),
            number("s.d. of depth"),
        ],
        rows: rows.collect(),
        is_grouped: true,
        notes: vec![split.ray.clone()],
    }
}

/// Orders of jittered marching.
pub(super) fn jitter_orders(split: &JitterSplit) -> ReportTable {
    let mut columns = vec![column_of_words("jitter"), column_of_words("of")];
    columns.extend(ORDER_COLUMNS);
    let rows = split.curves.iter().flat_map(|curve| {
        [
            ("deviation of depth", &curve.deviation_order),
            ("bias of T", &curve.bias_order),
        ]
        .map(|(of, order)| {
            let mut row: Vec<TableCell> = vec![curve.jitter.as_str().into(), of.into()];
            row.extend(order_cells(order));
            row
        })
    });
    ReportTable {
        title: "jittered marching: orders".to_owned(),
        reading: "Power of the step by which deviation and bias fall.".to_owned(),
        columns,
        rows: rows.collect(),
        is_grouped: false,
        notes: Vec::new(),
    }
}

/// What each effect costs.
pub(super) fn effects(effects: &[EffectPrice]) -> ReportTable {
    let mut columns = vec![
        column_of_words("effect"),
        number("look-ups"),
        number("× first"),
        number("shadow rays"),
        number("phase"),
        page_number("null"),
        page_number("cells"),
        page_number("surface tests"),
        number("random"),
    ];
    let has_time = effects.iter().any(|effect| effect.time.is_some());
    if has_time {
        columns.push(number("time a pixel"));
    }
    let rows = effects.iter().map(|effect| {
        let work = &effect.work;
        let mut row: Vec<TableCell> = vec![
            effect.effect.as_str().into(),
            words::count(work[Event::DensityLookup] + work[Event::GradientLookup]).into(),
            or_dash(effect.times_lookups, words::factor),
            words::count(work[Event::ShadowRay]).into(),
            words::count(work[Event::PhaseEvaluation]).into(),
            words::count(work[Event::NullCollision]).into(),
            words::count(work[Event::CellWalked]).into(),
            words::count(work[Event::SurfaceTest]).into(),
            words::count(work[Event::RandomDraw]).into(),
        ];
        if has_time {
            row.push(time(effect.time.as_ref()));
        }
        row
    });
    ReportTable {
        title: "what each effect costs by itself".to_owned(),
        reading:
            "Work for each pixel with one effect switched on: shadow rays, values of the phase \
                  function, null collisions, random numbers."
                .to_owned(),
        columns,
        rows: rows.collect(),
        is_grouped: false,
        notes: Vec::new(),
    }
}
