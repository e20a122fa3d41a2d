//! Error against work, and against time.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::picture::{
    Guide, HorizontalLine, LegendEntry, LegendKey, PlotCurve, PlotPanel, PlotPicture, PlotPoint,
};
use super::{Plot, Theme};
use crate::cost::results::{Counted, Level, Study, Sweep};
use crate::math::log10;
use crate::report::cost::words;

/// Half of the distance from 1 to the next number: one rounding.
const DOUBLE: f64 = f64::EPSILON / 2.0;
const SINGLE: f64 = f32::EPSILON as f64 / 2.0;

/// A line is drawn if it is at most so many decades away from the errors.
const NEAR: f64 = 1.5;

/// Height of a decade, where neither few of them make a picture too low nor many too high.
const PER_DECADE: f64 = 26.0;

/// The diagram: a curve for each sweep, its error against look-ups on the left and against time,
/// where that was taken, on the right.
pub(in super::super) fn work_precision(study: &Study, theme: Theme) -> Plot {
    let mut notes = Vec::new();
    let errors: Vec<f64> = study
        .sweeps
        .iter()
        .flat_map(|sweep| &sweep.levels)
        .map(|level| level.error.l2)
        .filter(|error| *error > 0.0 && error.is_finite())
        .map(log10)
        .collect();
    let y = Heights::new(study, &errors, &mut notes);
    let levels = study.sweeps.iter().flat_map(|sweep| &sweep.levels);
    let not_finite = levels.filter(|level| !level.error.l2.is_finite()).count();
    if not_finite > 0 {
        notes.push(format!(
            "Not drawn: {not_finite} settings whose error is no finite number."
        ));
    }
    let mut levels = study.sweeps.iter().flat_map(|sweep| &sweep.levels);
    if levels.any(|level| level.error.l2 == 0.0) {
        notes.push("Marks at the lower edge have no error at all.".to_owned());
    }
    let of_work = |level: &Level| (level.work.price(), None);
    let of_time = |level: &Level| match &level.time {
        Some(times) => (times.median, Some([times.min, times.max])),
        None => (0.0, None),
    };
    let title = "error against work";
    let counted = format!("{} a ray", words::counted(study));
    let work = panel(study, &y, title, &counted, Measure::Number, of_work);
    let time = panel(
        study,
        &y,
        "error against time",
        "wall time a ray: median, least to most",
        Measure::Seconds,
        of_time,
    );
    let mut legend = Vec::new();
    for (style, sweep) in study.sweeps.iter().enumerate() {
        let mut text = words::sweep(study, &sweep.estimator, sweep.parameter);
        if let Some(unit) = unit(sweep) {
            text.push_str(&format!(" [{unit}]"));
        }
        if sweep.is_ours {
            text.push_str(" (ours)");
        }
        legend.push(LegendEntry {
            key: LegendKey::Curve(style, sweep.is_ours),
            text,
        });
        let drawn_points = work.iter().flat_map(|panel| &panel.curves);
        let is_drawn = drawn_points
            .filter(|curve| curve.style == style)
            .any(|curve| !curve.points.is_empty());
        if !is_drawn && !sweep.levels.is_empty() {
            let name = &sweep.estimator;
            notes.push(format!(
                "Not drawn by work: {name}, whose work was not counted."
            ));
        }
    }
    let by_random = study
        .sweeps
        .iter()
        .filter(|sweep| {
            let mut levels = sweep.levels.iter();
            levels.any(|level| level.work.counted() == Counted::RandomNumbers)
        })
        .map(|sweep| sweep.estimator.as_str())
        .collect::<Vec<_>>();
    if !by_random.is_empty() {
        notes.push(format!(
            "Looks nothing up, so its work is the random numbers it draws: {}.",
            by_random.join(", ")
        ));
    }
    let mut panels: Vec<PlotPanel> = work.into_iter().chain(time).collect();
    for panel in panels.iter_mut().skip(1) {
        // As on the left.
        panel.y.title.clear();
    }
    let mut points = panels
        .iter()
        .flat_map(|panel| &panel.curves)
        .flat_map(|curve| &curve.points);
    let has_hollow = points.clone().any(|point| point.is_hollow);
    let has_cross = points.any(|point| point.cross.is_some());
    legend.push(LegendEntry {
        key: LegendKey::Front,
        text: "Pareto front: nothing is better in both".to_owned(),
    });
    if has_hollow {
        legend.push(LegendEntry {
            key: LegendKey::Hollow,
            text: "below what is known".to_owned(),
        });
    }
    if has_cross {
        legend.push(LegendEntry {
            key: LegendKey::Cross,
            text: "how far f32 is off, where it matters".to_owned(),
        });
    }
    legend.push(LegendEntry {
        key: LegendKey::Guide,
        text: "guide slopes".to_owned(),
    });
    let height = (PER_DECADE * (y.axis.high - y.axis.low)).clamp(320.0, 440.0);
    if panels.is_empty() && theme == Theme::Page {
        notes.push("Nothing to draw: no setting was measured.".to_owned());
        return Plot {
            svg: String::new(),
            notes,
        };
    }
    let picture = PlotPicture {
        title: format!("Work and precision of {}", study.quantity),
        panels,
        legend,
        height: height as i32,
    };
    Plot {
        svg: drawn(&picture, theme),
        notes,
    }
}

/// The axis of errors, which both panels share, and the lines across it.
struct Heights {
    axis: Axis,
    lines: Vec<(f64, String, bool)>,
    /// Where an error of 0 is put.
    bottom: f64,
    /// Errors at or below this are not those of a setting.
    known: f64,
}

impl Heights {
    fn new(study: &Study, errors: &[f64], notes: &mut Vec<String>) -> Heights {
        let known = words::least_known(study);
        let mut logarithms = errors.to_vec();
        let low = errors.iter().copied().fold(0.0, f64::min);
        let mut lines = Vec::new();
        let mut line = |error: f64, label: String, is_shaded: bool| {
            let logarithm = log10(error);
            let is_near = error > 0.0 && logarithm > low - NEAR;
            if is_near {
                logarithms.push(logarithm - 0.3);
                lines.push((logarithm, label, is_shaded));
            }
            is_near
        };
        let label = format!("{}: the reference knows no more", words::round(known));
        if !line(known, label, true) {
            let bound = study.reference.bound;
            notes.push(format!(
                "The reference is known to {}: every error here is one of a setting.",
                words::error(bound)
            ));
        }
        let mut levels = study.sweeps.iter().flat_map(|sweep| &sweep.levels);
        if levels.any(|level| level.single_precision.is_some()) {
            line(SINGLE, "one rounding of f32".to_owned(), false);
        }
        line(DOUBLE, "one rounding of f64".to_owned(), false);
        let axis = Axis::log("error: relative RMSE", Measure::Number, &logarithms);
        Heights {
            bottom: axis.low + 0.1,
            axis,
            lines,
            known,
        }
    }
}

/// One panel; none where nothing of it is known.
fn panel(
    study: &Study,
    y: &Heights,
    title: &str,
    x_title: &str,
    measure: Measure,
    x_of: impl Fn(&Level) -> (f64, Option<[f64; 2]>),
) -> Option<PlotPanel> {
    let mut curves = Vec::new();
    for (style, sweep) in study.sweeps.iter().enumerate() {
        let mut points = Vec::new();
        for level in &sweep.levels {
            let (x, whiskers) = x_of(level);
            let error = level.error.l2;
            if !(x > 0.0 && x.is_finite() && error.is_finite()) {
                continue;
            }
            let height = if error > 0.0 { log10(error) } else { y.bottom };
            points.push(PlotPoint {
                at: [log10(x), height],
                label: Some(short(sweep, level)),
                is_urgent: false,
                tooltip: tooltip(study, sweep, level),
                is_hollow: error <= sweep.order.known,
                whiskers: whiskers.map(|ends| ends.map(log10)),
                cross: single(
                    level,
                    y,
                    &words::sweep(study, &sweep.estimator, sweep.parameter),
                ),
            });
        }
        curves.push(PlotCurve {
            style,
            is_wide: sweep.is_ours,
            marks: 1.0,
            is_joined: true,
            points,
        });
    }
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let mut across: Vec<f64> = points().map(|point| point.at[0]).collect();
    if across.is_empty() {
        return None;
    }
    let start = [
        across.iter().copied().fold(f64::INFINITY, f64::min),
        points()
            .map(|point| point.at[1])
            .fold(f64::NEG_INFINITY, f64::max),
    ];
    across.extend(points().filter_map(|point| point.whiskers).flatten());
    let front = front(points().map(|point| point.at), log10(y.known.max(1e-300)));
    Some(PlotPanel {
        title: title.to_owned(),
        x: Axis::log(x_title, measure, &across),
        y: y.axis.clone(),
        guides: guides(study, start),
        lines: y
            .lines
            .iter()
            .map(|(at, label, is_shaded)| HorizontalLine {
                at: *at,
                label: label.clone(),
                is_shaded: *is_shaded,
            })
            .collect(),
        front,
        curves,
    })
}

/// How far single precision is off, where that is not small beside the error.
fn single(level: &Level, y: &Heights, name: &str) -> Option<(f64, String)> {
    let off = level.single_precision?.l2;
    let matters = off > 0.1 * level.error.l2;
    (matters && off > 0.0 && off.is_finite()).then(|| {
        let tooltip = format!(
            "{name}, {}: f32 is off by {}",
            level.setting,
            words::error(off)
        );
        (log10(off).clamp(y.axis.low, y.axis.high), tooltip)
    })
}

/// Slopes −½, −1 and −2, and −4 where that is expected of anything.
fn guides(study: &Study, through: [f64; 2]) -> Vec<Guide> {
    let mut slopes = vec![(0.5, "−½"), (1.0, "−1"), (2.0, "−2")];
    let steep = |sweep: &Sweep| sweep.order.expected.is_some_and(|order| order > 3.0);
    if study.sweeps.iter().any(steep) {
        slopes.push((4.0, "−4"));
    }
    slopes
        .into_iter()
        .map(|(slope, name)| Guide {
            through,
            slope: -slope,
            style: None,
            label: Some(format!("slope {name}")),
            is_ray: true,
        })
        .collect()
}

/// Corners of the border between what can be had and what cannot: to the right of each point its
/// error can be had as well, until a better one. Errors at or below `known` are all the same.
fn front(points: impl Iterator<Item = [f64; 2]>, known: f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = points.map(|[x, y]| [x, y.max(known)]).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for [x, y] in points {
        match corners.last() {
            Some([_, best]) if y >= *best => {}
            Some([_, best]) => {
                let best = *best;
                corners.extend([[x, best], [x, y]]);
            }
            None => corners.push([x, y]),
        }
    }
    corners
}

/// The setting as it is written beside a point: its number, as the unit is in the legend.
fn short(sweep: &Sweep, level: &Level) -> String {
    match unit(sweep) {
        Some(_) => level
            .setting
            .split(' ')
            .next()
            .unwrap_or_default()
            .to_owned(),
        None => level.setting.clone(),
    }
}

/// The unit after the numbers of all settings of a sweep.
fn unit(sweep: &Sweep) -> Option<&str> {
    fn parts(level: &Level) -> Option<&str> {
        let (number, unit) = level.setting.split_once(' ')?;
        number.parse::<f64>().is_ok().then_some(unit)
    }
    let unit = parts(sweep.levels.first()?)?;
    // One sample and two samples are the same unit.
    let stem = unit.trim_end_matches('s');
    let mut rest = sweep.levels.iter();
    let is_shared = rest.all(|level| parts(level).is_some_and(|u| u.trim_end_matches('s') == stem));
    is_shared
        .then(|| sweep.levels.last().and_then(parts))
        .flatten()
}

fn tooltip(study: &Study, sweep: &Sweep, level: &Level) -> String {
    let name = words::sweep(study, &sweep.estimator, sweep.parameter);
    let mut tooltip = format!(
        "{name}, {}: error {}",
        level.setting,
        words::error(level.error.l2)
    );
    if level.error.uncertainty > 0.0 {
        tooltip.push_str(&format!(" ± {:.1} %", 100.0 * level.error.uncertainty));
    }
    tooltip.push_str(&format!(
        " (largest {}), {}",
        words::error(level.error.max),
        words::price(level),
    ));
    if let Some(times) = &level.time {
        tooltip.push_str(&format!(", {}", words::times(times)));
    }
    tooltip
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_a_staircase() {
        let points = [
            [0.0, 0.0],
            [1.0, -1.0],
            [1.5, -0.5],
            [2.0, -4.0],
            [3.0, -5.0],
        ];
        let corners = front(points.into_iter(), -3.0);
        assert_eq!(
            corners,
            [
                [0.0, 0.0],
                [1.0, 0.0],
                [1.0, -1.0],
                [2.0, -1.0],
                [2.0, -3.0]
            ]
        );
    }
}
