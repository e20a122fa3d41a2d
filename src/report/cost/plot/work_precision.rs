//! Error against work, and against time.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::picture::{Curve, Entry, Guide, Key, Level, Panel, Picture, Point};
use super::{Dress, Plot};
use crate::cost::results::{Counted, Ladder, Rung, Study};
use crate::math::log10;
use crate::report::cost::words;

/// Half of the distance from 1 to the next number: one rounding.
const DOUBLE: f64 = f64::EPSILON / 2.0;
const SINGLE: f64 = f32::EPSILON as f64 / 2.0;

/// A line is drawn if it is at most so many decades away from the errors.
const NEAR: f64 = 1.5;

/// Height of a decade, where neither few of them make a picture too low nor many too high.
const PER_DECADE: f64 = 26.0;

/// The diagram: a curve for each ladder, its error against look-ups on the left and against time,
/// where that was taken, on the right.
pub(in super::super) fn work_precision(study: &Study, dress: Dress) -> Plot {
    let mut notes = Vec::new();
    let errors: Vec<f64> = study
        .ladders
        .iter()
        .flat_map(|ladder| &ladder.rungs)
        .map(|rung| rung.error.l2)
        .filter(|error| *error > 0.0 && error.is_finite())
        .map(log10)
        .collect();
    let y = Heights::new(study, &errors, &mut notes);
    let rungs = study.ladders.iter().flat_map(|ladder| &ladder.rungs);
    let not_finite = rungs.filter(|rung| !rung.error.l2.is_finite()).count();
    if not_finite > 0 {
        notes.push(format!(
            "Not drawn: {not_finite} settings whose error is no finite number."
        ));
    }
    let mut rungs = study.ladders.iter().flat_map(|ladder| &ladder.rungs);
    if rungs.any(|rung| rung.error.l2 == 0.0) {
        notes.push("Marks at the lower edge have no error at all.".to_owned());
    }
    let of_work = |rung: &Rung| (rung.work.price(), None);
    let of_time = |rung: &Rung| match &rung.time {
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
    for (style, ladder) in study.ladders.iter().enumerate() {
        let mut text = words::ladder(study, &ladder.estimator, ladder.knob);
        if let Some(unit) = unit(ladder) {
            text.push_str(&format!(" [{unit}]"));
        }
        if ladder.is_ours {
            text.push_str(" (ours)");
        }
        legend.push(Entry {
            key: Key::Curve(style, ladder.is_ours),
            text,
        });
        let drawn_points = work.iter().flat_map(|panel| &panel.curves);
        let is_drawn = drawn_points
            .filter(|curve| curve.style == style)
            .any(|curve| !curve.points.is_empty());
        if !is_drawn && !ladder.rungs.is_empty() {
            let name = &ladder.estimator;
            notes.push(format!(
                "Not drawn by work: {name}, whose work was not counted."
            ));
        }
    }
    let by_random = study
        .ladders
        .iter()
        .filter(|ladder| {
            let mut rungs = ladder.rungs.iter();
            rungs.any(|rung| rung.work.counted() == Counted::RandomNumbers)
        })
        .map(|ladder| ladder.estimator.as_str())
        .collect::<Vec<_>>();
    if !by_random.is_empty() {
        notes.push(format!(
            "Looks nothing up, so its work is the random numbers it draws: {}.",
            by_random.join(", ")
        ));
    }
    let mut panels: Vec<Panel> = work.into_iter().chain(time).collect();
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
    legend.push(Entry {
        key: Key::Front,
        text: "Pareto front: nothing is better in both".to_owned(),
    });
    if has_hollow {
        legend.push(Entry {
            key: Key::Hollow,
            text: "below what is known".to_owned(),
        });
    }
    if has_cross {
        legend.push(Entry {
            key: Key::Cross,
            text: "how far f32 is off, where it matters".to_owned(),
        });
    }
    legend.push(Entry {
        key: Key::Guide,
        text: "guide slopes".to_owned(),
    });
    let height = (PER_DECADE * (y.axis.high - y.axis.low)).clamp(320.0, 440.0);
    if panels.is_empty() && dress == Dress::Page {
        notes.push("Nothing to draw: no setting was measured.".to_owned());
        return Plot {
            svg: String::new(),
            notes,
        };
    }
    let picture = Picture {
        title: format!("Work and precision of {}", study.quantity),
        panels,
        legend,
        height: height as i32,
    };
    Plot {
        svg: drawn(&picture, dress),
        notes,
    }
}

/// The axis of errors, which both panels share, and the lines across it.
struct Heights {
    axis: Axis,
    levels: Vec<(f64, String, bool)>,
    /// Where an error of 0 is put.
    bottom: f64,
    /// Errors at or below this are not those of a setting.
    known: f64,
}

impl Heights {
    fn new(study: &Study, errors: &[f64], notes: &mut Vec<String>) -> Heights {
        let known = words::least_known(study);
        let mut places = errors.to_vec();
        let low = errors.iter().copied().fold(0.0, f64::min);
        let mut levels = Vec::new();
        let mut level = |error: f64, label: String, is_shaded: bool| {
            let place = log10(error);
            let is_near = error > 0.0 && place > low - NEAR;
            if is_near {
                places.push(place - 0.3);
                levels.push((place, label, is_shaded));
            }
            is_near
        };
        let label = format!("{}: the reference knows no more", words::round(known));
        if !level(known, label, true) {
            let bound = study.reference.bound;
            notes.push(format!(
                "The reference is known to {}: every error here is one of a setting.",
                words::error(bound)
            ));
        }
        let mut rungs = study.ladders.iter().flat_map(|ladder| &ladder.rungs);
        if rungs.any(|rung| rung.single_precision.is_some()) {
            level(SINGLE, "one rounding of f32".to_owned(), false);
        }
        level(DOUBLE, "one rounding of f64".to_owned(), false);
        let axis = Axis::log("error: relative RMSE", Measure::Number, &places);
        Heights {
            bottom: axis.low + 0.1,
            axis,
            levels,
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
    x_of: impl Fn(&Rung) -> (f64, Option<[f64; 2]>),
) -> Option<Panel> {
    let mut curves = Vec::new();
    for (style, ladder) in study.ladders.iter().enumerate() {
        let mut points = Vec::new();
        for rung in &ladder.rungs {
            let (x, whiskers) = x_of(rung);
            let error = rung.error.l2;
            if !(x > 0.0 && x.is_finite() && error.is_finite()) {
                continue;
            }
            let height = if error > 0.0 { log10(error) } else { y.bottom };
            points.push(Point {
                at: [log10(x), height],
                label: Some(short(ladder, rung)),
                is_urgent: false,
                told: told(study, ladder, rung),
                is_hollow: error <= ladder.order.known,
                whiskers: whiskers.map(|ends| ends.map(log10)),
                cross: single(
                    rung,
                    y,
                    &words::ladder(study, &ladder.estimator, ladder.knob),
                ),
            });
        }
        curves.push(Curve {
            style,
            is_wide: ladder.is_ours,
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
    Some(Panel {
        title: title.to_owned(),
        x: Axis::log(x_title, measure, &across),
        y: y.axis.clone(),
        guides: guides(study, start),
        levels: y
            .levels
            .iter()
            .map(|(at, label, is_shaded)| Level {
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
fn single(rung: &Rung, y: &Heights, name: &str) -> Option<(f64, String)> {
    let off = rung.single_precision?.l2;
    let matters = off > 0.1 * rung.error.l2;
    (matters && off > 0.0 && off.is_finite()).then(|| {
        let told = format!(
            "{name}, {}: f32 is off by {}",
            rung.setting,
            words::error(off)
        );
        (log10(off).clamp(y.axis.low, y.axis.high), told)
    })
}

/// Slopes −½, −1 and −2, and −4 where that is expected of anything.
fn guides(study: &Study, through: [f64; 2]) -> Vec<Guide> {
    let mut slopes = vec![(0.5, "−½"), (1.0, "−1"), (2.0, "−2")];
    let steep = |ladder: &Ladder| ladder.order.expected.is_some_and(|order| order > 3.0);
    if study.ladders.iter().any(steep) {
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
fn short(ladder: &Ladder, rung: &Rung) -> String {
    match unit(ladder) {
        Some(_) => rung
            .setting
            .split(' ')
            .next()
            .unwrap_or_default()
            .to_owned(),
        None => rung.setting.clone(),
    }
}

/// What all settings of a ladder have after their numbers.
fn unit(ladder: &Ladder) -> Option<&str> {
    fn parts(rung: &Rung) -> Option<&str> {
        let (number, unit) = rung.setting.split_once(' ')?;
        number.parse::<f64>().is_ok().then_some(unit)
    }
    let unit = parts(ladder.rungs.first()?)?;
    // One sample and two samples are the same unit.
    let stem = unit.trim_end_matches('s');
    let mut rest = ladder.rungs.iter();
    let is_shared = rest.all(|rung| parts(rung).is_some_and(|u| u.trim_end_matches('s') == stem));
    is_shared
        .then(|| ladder.rungs.last().and_then(parts))
        .flatten()
}

fn told(study: &Study, ladder: &Ladder, rung: &Rung) -> String {
    let name = words::ladder(study, &ladder.estimator, ladder.knob);
    let mut told = format!(
        "{name}, {}: error {}",
        rung.setting,
        words::error(rung.error.l2)
    );
    if rung.error.uncertainty > 0.0 {
        told.push_str(&format!(" ± {:.1} %", 100.0 * rung.error.uncertainty));
    }
    told.push_str(&format!(
        " (largest {}), {}",
        words::error(rung.error.max),
        words::price(rung),
    ));
    if let Some(times) = &rung.time {
        told.push_str(&format!(", {}", words::times(times)));
    }
    told
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
