//! Error against work, and against time.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::figure::{Curve, CurvePoint, Figure, Guide, GuideKind, Key, Line, Panel, USUAL, WIDE};
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

/// The diagram: a curve for each sweep, its error against lookups on the left and against time,
/// where that was taken, on the right.
pub(in super::super) fn work_precision(study: &Study, theme: Theme) -> Plot {
    let mut notes = Vec::new();
    let heights = Heights::new(study, &mut notes);
    let by_work = panel(study, &heights, |level| (level.work.price(), None));
    let by_time = panel(study, &heights, |level| match &level.time {
        Some(times) => (times.median, Some([times.min, times.max])),
        None => (0.0, None),
    });
    notes.extend(notes_on_errors(study));
    notes.extend(notes_on_work(study, &by_work));
    let counted = format!("{} per ray", words::counted(study));
    let wall_time = "wall time per ray: median, min to max";
    let panels: Vec<Panel> = [
        (by_work, "error against work", &*counted, Measure::Number),
        (by_time, "error against time", wall_time, Measure::Seconds),
    ]
    .into_iter()
    .filter_map(|(panel, title, x_title, measure)| {
        let points = panel.curves.iter().flat_map(|curve| &curve.points);
        let whiskers = points.filter_map(|point| point.whiskers).flatten();
        let mut across = Panel::coordinates(&panel.curves, 0);
        across.extend(whiskers);
        (!across.is_empty()).then(|| Panel {
            title: title.to_owned(),
            x: Axis::log(x_title, measure, &across),
            ..panel
        })
    })
    .collect();
    if panels.is_empty() && theme == Theme::Page {
        notes.push("Nothing to draw: no setting was measured.".to_owned());
        return Plot {
            svg: String::new(),
            notes,
        };
    }
    let height = PER_DECADE * (heights.axis.high - heights.axis.low);
    let figure = Figure {
        title: format!("Work and precision of {}", study.quantity),
        legend: legend(study, &panels),
        panels,
        height: height.clamp(320.0, 440.0).floor(),
    };
    Plot {
        svg: drawn(&figure, theme),
        notes,
    }
}

/// Notes on errors without a place on a logarithmic axis.
fn notes_on_errors(study: &Study) -> Vec<String> {
    let levels = || study.sweeps.iter().flat_map(|sweep| &sweep.levels);
    let mut notes = Vec::new();
    let not_finite = levels().filter(|level| !level.error.l2.is_finite()).count();
    if not_finite > 0 {
        notes.push(format!(
            "Not drawn: {not_finite} settings whose error is not a finite number."
        ));
    }
    if levels().any(|level| level.error.l2 == 0.0) {
        notes.push("Marks at the lower edge have no error at all.".to_owned());
    }
    notes
}

/// Notes on sweeps whose work was not counted, or not in lookups.
fn notes_on_work(study: &Study, by_work: &Panel) -> Vec<String> {
    let is_drawn = |style: usize| {
        let mut curves = by_work.curves.iter();
        curves.any(|curve| curve.style == style && !curve.points.is_empty())
    };
    let sweeps = study.sweeps.iter().enumerate();
    let uncounted = sweeps.filter(|(style, sweep)| !is_drawn(*style) && !sweep.levels.is_empty());
    let mut notes: Vec<String> = uncounted
        .map(|(_, sweep)| {
            let name = &sweep.estimator;
            format!("Not drawn by work: {name}, whose work was not counted.")
        })
        .collect();
    let by_random = study.sweeps.iter().filter(|sweep| {
        let mut levels = sweep.levels.iter();
        levels.any(|level| level.work.counted() == Counted::RandomNumbers)
    });
    let by_random: Vec<&str> = by_random.map(|sweep| sweep.estimator.as_str()).collect();
    if !by_random.is_empty() {
        notes.push(format!(
            "No lookups; work is the number of random numbers drawn: {}.",
            by_random.join(", ")
        ));
    }
    notes
}

/// A key for each sweep, and for what there is in `panels` beside curves.
fn legend(study: &Study, panels: &[Panel]) -> Vec<(Key, String)> {
    let of_sweeps = study.sweeps.iter().enumerate().map(|(style, sweep)| {
        let mut text = words::sweep(study, &sweep.estimator, sweep.parameter);
        if let Some(unit) = unit(sweep) {
            text.push_str(&format!(" [{unit}]"));
        }
        if sweep.is_ours {
            text.push_str(" (volref)");
        }
        (Key::Curve(style, line_width(sweep), true), text)
    });
    let points = || {
        let curves = panels.iter().flat_map(|panel| &panel.curves);
        curves.flat_map(|curve| &curve.points)
    };
    let others = [
        (Key::Front, "Pareto front: nothing is better in both", true),
        (
            Key::Hollow,
            "below the reference error",
            points().any(|point| point.is_hollow),
        ),
        (
            Key::Cross,
            "f32 rounding error, where significant",
            points().any(|point| point.cross.is_some()),
        ),
        (Key::Guide, "guide slopes", true),
    ];
    let others = others.into_iter().filter(|(.., is_there)| *is_there);
    of_sweeps
        .chain(others.map(|(key, text, _)| (key, text.to_owned())))
        .collect()
}

/// The axis of errors, which both panels share, and the lines across it.
struct Heights {
    axis: Axis,
    lines: Vec<Line>,
    /// Place of an error of 0.
    bottom: f64,
    /// Errors at or below this are not those of a setting.
    known: f64,
}

impl Heights {
    fn new(study: &Study, notes: &mut Vec<String>) -> Heights {
        let levels = || study.sweeps.iter().flat_map(|sweep| &sweep.levels);
        let errors = levels().map(|level| level.error.l2);
        let mut logarithms: Vec<f64> = errors
            .filter(|error| *error > 0.0 && error.is_finite())
            .map(log10)
            .collect();
        let low = logarithms.iter().copied().fold(0.0, f64::min);
        let known = words::least_known(study);
        let has_single = levels().any(|level| level.single_precision.is_some());
        let below_known = format!("{}: error of the reference", words::round(known));
        let mut lines = Vec::new();
        for (error, label, is_wanted, is_shaded) in [
            (known, below_known, true, true),
            (SINGLE, "f32 unit roundoff".to_owned(), has_single, false),
            (DOUBLE, "f64 unit roundoff".to_owned(), true, false),
        ] {
            let at = log10(error);
            if is_wanted && error > 0.0 && at > low - NEAR {
                logarithms.push(at - 0.3);
                lines.push(Line {
                    at,
                    label,
                    is_shaded,
                });
            }
        }
        if !lines.iter().any(|line| line.is_shaded) {
            notes.push(format!(
                "The reference is known to {}: every error here is one of a setting.",
                words::error(study.reference.bound)
            ));
        }
        let axis = Axis::log("error: relative RMSE", Measure::Number, &logarithms);
        Heights {
            bottom: axis.low + 0.1,
            axis,
            lines,
            known,
        }
    }
}

/// One panel but for its title and its first axis; `x_of` is the place of a setting on that, with a
/// range.
fn panel(study: &Study, heights: &Heights, x_of: fn(&Level) -> (f64, Option<[f64; 2]>)) -> Panel {
    let curves = study.sweeps.iter().enumerate().map(|(style, sweep)| {
        let points = sweep.levels.iter().filter_map(|level| {
            let ((x, whiskers), error) = (x_of(level), level.error.l2);
            let is_shown = x > 0.0 && x.is_finite() && error.is_finite();
            let height = if error > 0.0 {
                log10(error)
            } else {
                heights.bottom
            };
            is_shown.then(|| CurvePoint {
                at: [log10(x), height],
                label: Some(short(sweep, level)),
                is_urgent: false,
                tooltip: tooltip(study, sweep, level),
                is_hollow: error <= sweep.order.known,
                whiskers: whiskers.map(|ends| ends.map(log10)),
                cross: single(study, sweep, level, &heights.axis),
            })
        });
        Curve {
            style,
            width: line_width(sweep),
            marks: 1.0,
            points: points.collect(),
        }
    });
    let curves: Vec<Curve> = curves.collect();
    let [across, up] = [0, 1].map(|axis| Panel::coordinates(&curves, axis));
    let start = [
        across.iter().copied().fold(f64::INFINITY, f64::min),
        up.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    ];
    let points = across.into_iter().zip(up).map(|(x, y)| [x, y]);
    Panel {
        y: heights.axis.clone(),
        guides: guides(study, start),
        lines: heights.lines.clone(),
        front: front(points, log10(heights.known.max(1e-300))),
        curves,
        ..Panel::default()
    }
}

fn line_width(sweep: &Sweep) -> f64 {
    if sweep.is_ours { WIDE } else { USUAL }
}

/// The error of single precision, where that is not small beside the error.
fn single(study: &Study, sweep: &Sweep, level: &Level, y: &Axis) -> Option<(f64, String)> {
    let off = level.single_precision?.l2;
    let matters = off > 0.1 * level.error.l2;
    (matters && off > 0.0 && off.is_finite()).then(|| {
        let name = words::sweep(study, &sweep.estimator, sweep.parameter);
        let (setting, error) = (&level.setting, words::error(off));
        let tooltip = format!("{name}, {setting}: f32 is off by {error}");
        (log10(off).clamp(y.low, y.high), tooltip)
    })
}

/// Slopes −½, −1 and −2, and −4 where that is expected of anything.
fn guides(study: &Study, through: [f64; 2]) -> Vec<Guide> {
    let mut slopes = vec![(-0.5, "−½"), (-1.0, "−1"), (-2.0, "−2")];
    let steep = |sweep: &Sweep| sweep.order.expected.is_some_and(|order| order > 3.0);
    if study.sweeps.iter().any(steep) {
        slopes.push((-4.0, "−4"));
    }
    let guide = |(slope, name)| Guide {
        through,
        slope,
        kind: GuideKind::Labelled(format!("slope {name}")),
    };
    slopes.into_iter().map(guide).collect()
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
            Some(&[_, best]) => corners.extend([[x, best], [x, y]]),
            None => corners.push([x, y]),
        }
    }
    corners
}

/// The setting as it is written beside a point: its number, as the unit is in the legend.
fn short(sweep: &Sweep, level: &Level) -> String {
    let words = level
        .setting
        .split(' ')
        .next()
        .filter(|_| unit(sweep).is_some());
    words.unwrap_or(&level.setting).to_owned()
}

/// The unit after the numbers of all settings of a sweep.
fn unit(sweep: &Sweep) -> Option<&str> {
    fn unit_of(level: &Level) -> Option<&str> {
        let (number, unit) = level.setting.split_once(' ')?;
        number.parse::<f64>().is_ok().then_some(unit)
    }
    let units: Option<Vec<&str>> = sweep.levels.iter().map(unit_of).collect();
    let units = units?;
    // One sample and two samples are the same unit.
    let stem = |unit: &&str| unit.trim_end_matches('s').to_owned();
    let is_shared = units
        .windows(2)
        .all(|pair| stem(&pair[0]) == stem(&pair[1]));
    units.last().copied().filter(|_| is_shared)
}

fn tooltip(study: &Study, sweep: &Sweep, level: &Level) -> String {
    let name = words::sweep(study, &sweep.estimator, sweep.parameter);
    let (setting, error) = (&level.setting, level.error);
    let doubt = match error.uncertainty > 0.0 {
        true => format!(" ± {}", words::percent(error.uncertainty)),
        false => String::new(),
    };
    let time = match &level.time {
        Some(times) => format!(", {}", words::times(times)),
        None => String::new(),
    };
    format!(
        "{name}, {setting}: error {}{doubt} (largest {}), {}{time}",
        words::error(error.l2),
        words::error(error.max),
        words::price(level),
    )
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
