//! Numbers and verdicts, as text and page write them.

use crate::cost::results::{
    ConvergenceOrder, Cost, Counted, EstimatorRow, Level, Machine, OrderVerdict, Parameter, Study,
    Sweep, Times,
};
use serde::Serialize;
use serde_json::Value;

/// The scene, with its panel.
pub(super) fn scene(cost: &Cost) -> String {
    match &cost.panel {
        Some(panel) => format!("{}: {panel}", cost.scene),
        None => cost.scene.clone(),
    }
}

/// Name of a parameter, in a word or two.
pub(super) fn parameter(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Step => "step",
        Parameter::ShadowStep => "shadow step",
        Parameter::Spacing => "node spacing",
        Parameter::Pixel => "pixel",
        Parameter::Samples => "samples",
        Parameter::None => "none",
    }
}

/// The estimator, and the parameter where another sweep of the study varies another.
pub(super) fn sweep(study: &Study, estimator: &str, varied: Parameter) -> String {
    let is_other = |sweep: &&Sweep| sweep.estimator == estimator && sweep.parameter != varied;
    match study.sweeps.iter().find(is_other) {
        Some(_) => format!("{estimator}, {}", parameter(varied)),
        None => estimator.to_owned(),
    }
}

/// Work counted in the prices of a study; of a mixture the kind that most have: lookups.
pub(super) fn counted(study: &Study) -> &'static str {
    let levels = || study.sweeps.iter().flat_map(|sweep| &sweep.levels);
    let any = |what: Counted| levels().any(|level| level.work.counted() == what);
    match (any(Counted::Lookups), any(Counted::RandomNumbers)) {
        (false, true) => "random numbers",
        (true, true) => "lookups or random numbers",
        (_, false) => "lookups",
    }
}

/// The price of a setting, with what it counts.
pub(super) fn price(level: &Level) -> String {
    let noun = match level.work.counted() {
        Counted::RandomNumbers => "random numbers",
        Counted::Lookups | Counted::Nothing => "lookups",
    };
    format!("{} {noun}", count(level.work.price()))
}

/// Mark of a verdict: never by colour alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Mark {
    #[default]
    Plain,
    Good,
    Bad,
    Odd,
}

/// A verdict with its sign.
pub(super) fn verdict(verdict: OrderVerdict) -> (Mark, &'static str) {
    match verdict {
        OrderVerdict::AsExpected => (Mark::Good, "✓ as expected"),
        OrderVerdict::TooFewRays => (Mark::Odd, "≈ consistent with expectation (few rays)"),
        OrderVerdict::Otherwise => (Mark::Bad, "✗ not as expected"),
        OrderVerdict::Undecided => (Mark::Odd, "? undecided: too few usable settings"),
        OrderVerdict::NotYetAPower => (
            Mark::Odd,
            "~ not yet asymptotic: the order is still changing",
        ),
        OrderVerdict::NothingExpected => (Mark::Plain, "– no prediction"),
    }
}

/// The sign of a verdict alone.
pub(super) fn sign(of: OrderVerdict) -> &'static str {
    let (sign, _) = verdict(of).1.split_once(' ').unwrap_or_default();
    sign
}

/// A number that there may not be.
pub(super) fn or_dash<T>(value: Option<T>, shown: impl Fn(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), shown)
}

/// Whether an estimator keeps its promises, with a sign.
pub(super) fn agreement(row: &EstimatorRow) -> (Mark, &'static str) {
    if row.agrees {
        (Mark::Good, "✓ agrees")
    } else {
        (Mark::Bad, "✗ disagrees")
    }
}

/// Deviation of the mean in standard errors, with its sign.
pub(super) fn standard_errors(row: &EstimatorRow) -> String {
    match row.standard_error > 0.0 {
        true => format!("{:+.1}", row.bias / row.standard_error),
        // Without noise there is nothing to measure a bias by.
        false => format!("{} abs", error(row.bias)),
    }
}

/// An error or a variance, with three digits.
pub(super) fn error(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        _ if !value.is_finite() => value.to_string(),
        _ => format!("{value:.2e}"),
    }
}

/// A round number such as 1e-3, without digits that say nothing.
pub(super) fn round(value: f64) -> String {
    let [short, long] = [format!("{value:.0e}"), format!("{value:.1e}")];
    // A product such as 100 × 3e-7 is as round as can be, but for its last bit.
    let near = 4.0 * f64::EPSILON * value;
    let says_all = |text: &str| {
        let read = text.parse::<f64>();
        read.is_ok_and(|read| (read - value).abs() <= near)
    };
    if says_all(&short) { short } else { long }
}

/// A mean of counts, with three digits.
pub(super) fn count(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 9.995 => format!("{value:.2}"),
        size if size < 99.95 => format!("{value:.1}"),
        size if size < 999_999.5 => format!("{value:.0}"),
        _ => error(value),
    }
}

/// A length, a depth or a value, with four digits.
pub(super) fn value(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-3 => format!("{value:.3e}"),
        size if size < 1e-2 => format!("{value:.6}"),
        size if size < 0.1 => format!("{value:.5}"),
        size if size < 1.0 => format!("{value:.4}"),
        size if size < 10.0 => format!("{value:.3}"),
        size if size < 100.0 => format!("{value:.2}"),
        size if size < 1e6 => format!("{value:.1}"),
        _ => format!("{value:.3e}"),
    }
}

/// How many times as much; of nothing, it cannot be said.
pub(super) fn factor(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "–".to_owned(),
        _ if value < 99.95 => format!("{value:.1}"),
        _ => count(value),
    }
}

/// An order, or how far one may be off.
pub(super) fn order(value: f64) -> String {
    format!("{value:.2}")
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The word for a choice in JSON.
pub(super) fn key(choice: impl Serialize) -> String {
    match serde_json::to_value(choice) {
        Ok(Value::String(word)) => word,
        other => unreachable!("{other:?} is no word"),
    }
}

/// An order that was fitted beside the expected one: `1.99 (expected 2)`.
pub(super) fn fitted(order: &ConvergenceOrder) -> String {
    let fitted = match order.fitted {
        Some(fitted) => format!("order {fitted:.2}"),
        None => "no order".to_owned(),
    };
    match order.expected {
        Some(expected) => format!("{fitted}, expected {expected}"),
        None => fitted,
    }
}

/// Unit of a time, and how many seconds it has.
fn unit(seconds: f64) -> (&'static str, f64) {
    match seconds {
        _ if seconds < 0.999_5e-6 => ("ns", 1e-9),
        _ if seconds < 0.999_5e-3 => ("µs", 1e-6),
        _ if seconds < 0.999_5 => ("ms", 1e-3),
        _ => ("s", 1.0),
    }
}

/// A time with three digits and its unit.
pub(super) fn seconds(value: f64) -> String {
    let (unit, size) = unit(value);
    format!("{} {unit}", count(value / size))
}

/// Median, least and most: `1.23 (1.20–1.31) µs`.
pub(super) fn times(times: &Times) -> String {
    let (unit, size) = unit(times.median);
    let [median, min, max] = [times.median, times.min, times.max].map(|value| count(value / size));
    let noisy = if times.is_noisy { " noisy" } else { "" };
    format!("{median} ({min}–{max}) {unit}{noisy}")
}

/// The timing environment, as facts.
pub(super) fn machine(machine: &Machine) -> Vec<(&'static str, String)> {
    vec![
        ("processor", machine.processor.clone()),
        ("threads", machine.threads.to_string()),
        ("platform", machine.platform.clone()),
        ("compiler", machine.compiler.clone()),
        ("profile", machine.profile.to_owned()),
        ("target features", machine.target_features.clone()),
    ]
}

/// Reason why times of this machine are worthless.
pub(super) fn machine_warning(machine: &Machine) -> Option<&'static str> {
    (machine.profile != "release").then_some("debug build: lookup counts are valid, times are not")
}

/// Errors at or below this may be those of the reference, in all sweeps of the study.
pub(super) fn least_known(study: &Study) -> f64 {
    let of_each = study.sweeps.iter().map(|sweep| sweep.order.known);
    of_each.reduce(f64::max).unwrap_or(study.reference.bound)
}

/// The root mean square error to which an order is fitted.
pub(super) fn judged(level: &Level) -> f64 {
    level.error_of_order.unwrap_or(level.error).l2
}

/// The setting for the largest of the wanted errors, in a sentence for each scene.
pub(super) fn headlines(costs: &[Cost]) -> Vec<String> {
    let of = |cost: &Cost| {
        let advice = cost.recommendations.first()?;
        Some(format!("{}, {}", scene(cost), advice.text))
    };
    costs.iter().filter_map(of).collect()
}

/// Verdicts of a report, counted.
pub(super) struct Judgement {
    pub(super) mark: Mark,
    pub(super) counts: String,
    /// Orders and estimators that are not as expected, or not known: mark and words.
    pub(super) faults: Vec<(Mark, String)>,
}

/// All orders of a scene, with their names.
fn orders(cost: &Cost) -> Vec<(String, &ConvergenceOrder)> {
    let scene = scene(cost);
    let mut orders = Vec::new();
    for study in &cost.studies {
        for each in &study.sweeps {
            let name = sweep(study, &each.estimator, each.parameter);
            orders.push((format!("{scene}, {}, {name}", study.name), &each.order));
        }
    }
    for curve in cost.jitter.iter().flat_map(|jitter| &jitter.curves) {
        let name = format!("{scene}, {} jitter", curve.jitter);
        orders.push((format!("{name}, deviation"), &curve.deviation_order));
        orders.push((format!("{name}, bias"), &curve.bias_order));
    }
    orders
}

/// Verdicts of all orders and estimators of the scenes.
pub(super) fn judgement(costs: &[Cost]) -> Judgement {
    let (orders, mut faults) = judged_orders(costs);
    let (estimators, of_estimators) = judged_estimators(costs);
    faults.extend(of_estimators);
    // What is wrong before what is not known.
    faults.sort_by_key(|(mark, _)| *mark != Mark::Bad);
    let parts: Vec<String> = [orders, estimators].into_iter().flatten().collect();
    let mark = match faults.first() {
        None if parts.is_empty() => Mark::Plain,
        None => Mark::Good,
        Some((mark, _)) => *mark,
    };
    let counts = match parts.is_empty() {
        true => "There were no predicted orders to check.".to_owned(),
        false => format!("{}.", parts.join("; ")),
    };
    Judgement {
        mark,
        counts,
        faults,
    }
}

/// Orders of the scenes, counted by verdict; and those at fault.
fn judged_orders(costs: &[Cost]) -> (Option<String>, Vec<(Mark, String)>) {
    let mut faults = Vec::new();
    // As expected, as far as rays tell, otherwise, undecided, not yet a power, nothing expected.
    let mut counts = [0_usize; 6];
    for (name, order) in costs.iter().flat_map(orders) {
        counts[order.verdict as usize] += 1;
        let fitted = fitted(order);
        let fault = match order.verdict {
            OrderVerdict::Otherwise => format!("{fitted} ± {:.2}", order.tolerance),
            OrderVerdict::Undecided => format!(
                "undecided, too few settings are fine enough and above the error of the reference \
                 ({fitted})"
            ),
            OrderVerdict::NotYetAPower => format!(
                "not yet asymptotic, the order still changes from setting to setting ({fitted})"
            ),
            _ => continue,
        };
        let sign = sign(order.verdict);
        faults.push((verdict(order.verdict).0, format!("{sign} {name}: {fault}")));
    }
    let judged: usize = counts[..5].iter().sum();
    let words = [
        "as expected",
        "consistent with expectation (few rays)",
        "not as expected",
        "undecided",
        "not yet asymptotic",
    ];
    let said = words.iter().zip(counts).enumerate();
    let said = said.filter(|(at, (_, count))| *at == 0 || *count > 0);
    let said: Vec<String> = said
        .map(|(_, (words, count))| format!("{count} {words}"))
        .collect();
    let noun = if judged == 1 { "order" } else { "orders" };
    let sentence = format!("{judged} convergence {noun}: {}", said.join(", "));
    ((judged > 0).then_some(sentence), faults)
}

/// Estimators that agree with theory, counted; and those that do not.
fn judged_estimators(costs: &[Cost]) -> (Option<String>, Vec<(Mark, String)>) {
    let rows = costs.iter().flat_map(|cost| {
        let tables = cost.estimators.iter();
        let rows = tables.flat_map(|table| &table.rows);
        rows.map(move |row| (cost, row))
    });
    let (agreeing, disagreeing): (Vec<_>, Vec<_>) = rows.partition(|(_, row)| row.agrees);
    let fault = |(cost, row): &(&Cost, &EstimatorRow)| {
        let fault = format!(
            "✗ {}, {}: disagrees with theory: mean off by {} s.e., variance {} (theory {}), lookups {} (theory {})",
            scene(cost),
            row.estimator,
            standard_errors(row),
            error(row.variance),
            or_dash(row.predicted_variance, error),
            count(row.lookups),
            or_dash(row.predicted_lookups, count),
        );
        (Mark::Bad, fault)
    };
    let (agreed, all) = (agreeing.len(), agreeing.len() + disagreeing.len());
    let sentence = format!("{agreed} of {all} estimators agree with theory");
    let faults = disagreeing.iter().map(fault).collect();
    ((all > 0).then_some(sentence), faults)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        assert_eq!(
            [0.0, 1.234_5e-4, 0.999_9, f64::NAN].map(error),
            ["0", "1.23e-4", "1.00e0", "NaN"]
        );
        assert_eq!(
            [1e-3, 0.1, 2.5e-4, 100.0 * 3e-7].map(round),
            ["1e-3", "1e-1", "2.5e-4", "3e-5"]
        );
        assert_eq!(
            [0.0, 2.224_6, 9.996, 123.4, 65_536.0, 1.5e7].map(count),
            ["0", "2.22", "10.0", "123", "65536", "1.50e7"]
        );
        assert_eq!(
            [0.0, 0.003_125, 0.5, 31.622_8, -1e-5].map(value),
            ["0", "0.003125", "0.5000", "31.62", "-1.000e-5"]
        );
        assert_eq!([1.0, 12.34, 12_345.0].map(factor), ["1.0", "12.3", "12345"]);
        assert_eq!(
            [1.5e-9, 999.7e-9, 1.234e-5, 0.25, 3.0].map(seconds),
            ["1.50 ns", "1.00 µs", "12.3 µs", "250 ms", "3.00 s"]
        );
    }
}
