//! Which estimator wins in thin and in dense media.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::picture::{LegendEntry, LegendKey, PlotCurve, PlotPanel, PlotPicture, PlotPoint};
use super::{Plot, Theme};
use crate::cost::results::{ThicknessCurve, ThicknessPoint, ThicknessSweep};
use crate::math::log10;
use crate::report::cost::words;

/// So many look-ups for one sample of relative error 1 nobody takes. Variances of dense media grow
/// like `e^τ`: drawn to their end they would press everything else to the ground.
const HOPELESS: f64 = 1e8;

/// Relative variance times look-ups against optical depth: marks are measured, lines predicted.
pub(in super::super) fn thickness(sweep: &ThicknessSweep, theme: Theme) -> Plot {
    let mut curves = Vec::new();
    let mut legend = Vec::new();
    let mut notes = Vec::new();
    for (style, curve) in sweep.curves.iter().enumerate() {
        let name = &curve.estimator;
        let predicted = predicted(curve);
        legend.push(LegendEntry {
            key: if predicted.is_empty() {
                LegendKey::Mark(style)
            } else {
                LegendKey::Curve(style, false)
            },
            text: if predicted.is_empty() {
                format!("{name} (no theory)")
            } else {
                name.clone()
            },
        });
        let known = curve.points.iter().filter_map(|point| {
            let measured = point.measured.filter(|measured| *measured > 0.0);
            Some((point, measured?)).filter(|(point, _)| point.depth > 0.0)
        });
        let (shown, hopeless): (Vec<_>, Vec<_>) =
            known.partition(|(_, measured)| *measured < HOPELESS);
        if let (Some((first, _)), Some((_, most))) = (hopeless.first(), hopeless.last()) {
            notes.push(format!(
                "Above the picture: {name} from depth {} on, up to {}.",
                words::value(first.depth),
                words::error(*most)
            ));
        }
        let is_unknown = |point: &&ThicknessPoint| point.measured.is_none();
        if let Some(first) = curve.points.iter().find(is_unknown) {
            notes.push(format!(
                "Not measured: {name} from depth {} on, where almost no sample gets through.",
                words::value(first.depth)
            ));
        }
        let mut measured: Vec<PlotPoint> = shown
            .into_iter()
            .map(|(point, measured)| PlotPoint {
                at: [log10(point.depth), log10(measured)],
                tooltip: tooltip(name, point),
                ..PlotPoint::default()
            })
            .collect();
        if let Some(last) = measured.last_mut() {
            last.label = Some(name.clone());
        }
        for (is_marked, points) in [(false, predicted), (true, measured)] {
            curves.push(PlotCurve {
                style,
                is_wide: false,
                marks: if is_marked { 1.0 } else { 0.0 },
                is_joined: !is_marked,
                points,
            });
        }
    }
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let across: Vec<f64> = points().map(|point| point.at[0]).collect();
    let up: Vec<f64> = points().map(|point| point.at[1]).collect();
    let picture = PlotPicture {
        title: "Relative variance times look-ups against optical depth".to_owned(),
        panels: vec![PlotPanel {
            title: "marks: measured; lines: theory; lower is better".to_owned(),
            x: Axis::log("optical depth of the ray", Measure::Number, &across),
            y: Axis::log("variance / T² × look-ups", Measure::Number, &up),
            curves,
            guides: Vec::new(),
            lines: Vec::new(),
            front: Vec::new(),
        }],
        legend,
        height: 320,
    };
    Plot {
        svg: drawn(&picture, theme),
        notes,
    }
}

/// What theory says, up to where it is [`HOPELESS`].
fn predicted(curve: &ThicknessCurve) -> Vec<PlotPoint> {
    let top = log10(HOPELESS);
    let mut points: Vec<[f64; 2]> = Vec::new();
    for point in &curve.points {
        let Some(theory) = point.predicted else {
            continue;
        };
        if !(point.depth > 0.0 && theory > 0.0) {
            continue;
        }
        let [x, y] = [log10(point.depth), log10(theory)];
        if y < top {
            points.push([x, y]);
        } else {
            // The last piece of the line ends at the top.
            if let Some(&[x0, y0]) = points.last() {
                points.push([x0 + (x - x0) * (top - y0) / (y - y0), top]);
            }
            break;
        }
    }
    let point = |at| PlotPoint {
        at,
        ..PlotPoint::default()
    };
    points.into_iter().map(point).collect()
}

fn tooltip(name: &str, point: &ThicknessPoint) -> String {
    let shown = |value: Option<f64>| value.map_or("–".to_owned(), words::error);
    format!(
        "{name} at depth {}: measured {}, theory {}",
        words::value(point.depth),
        shown(point.measured),
        shown(point.predicted),
    )
}
