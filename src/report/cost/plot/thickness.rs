//! Estimators in thin and in dense media.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::figure::{Curve, CurvePoint, Figure, Key, Panel, USUAL};
use super::{Plot, Theme};
use crate::cost::results::{ThicknessCurve, ThicknessSweep};
use crate::math::log10;
use crate::report::cost::words;

/// So many lookups for one sample of relative error 1 nobody takes. Variances of dense media grow
/// like `e^τ`: drawn to their end they would press everything else to the ground.
const HOPELESS: f64 = 1e8;

/// Relative variance times lookups against optical depth: marks are measured, lines predicted.
pub(in super::super) fn thickness(sweep: &ThicknessSweep) -> Plot {
    let mut curves = Vec::new();
    let mut legend = Vec::new();
    let mut notes = Vec::new();
    for (style, curve) in sweep.curves.iter().enumerate() {
        let name = &curve.estimator;
        let predicted = predicted(curve);
        legend.push(if predicted.is_empty() {
            (Key::Curve(style, 0.0, true), format!("{name} (no theory)"))
        } else {
            (Key::Curve(style, USUAL, true), name.clone())
        });
        let mut measured = Vec::new();
        let mut hopeless = Vec::new();
        for point in &curve.points {
            let value = point
                .measured
                .filter(|value| *value > 0.0 && point.depth > 0.0);
            match value {
                Some(value) if value < HOPELESS => {
                    let tooltip = format!(
                        "{name} at depth {}: measured {}, theory {}",
                        words::value(point.depth),
                        words::error(value),
                        words::or_dash(point.predicted, words::error),
                    );
                    let at = [log10(point.depth), log10(value)];
                    measured.push(CurvePoint::new(at, tooltip));
                }
                Some(value) => hopeless.push((point.depth, value)),
                None => {}
            }
        }
        if let (Some((first, _)), Some((_, most))) = (hopeless.first(), hopeless.last()) {
            notes.push(format!(
                "Off the top of the plot: {name} from depth {}, up to {}.",
                words::value(*first),
                words::error(*most)
            ));
        }
        if let Some(first) = curve.points.iter().find(|point| point.measured.is_none()) {
            notes.push(format!(
                "Not measured: {name} from depth {} on, where almost no sample is transmitted.",
                words::value(first.depth)
            ));
        }
        if let Some(last) = measured.last_mut() {
            last.label = Some(name.clone());
        }
        for (width, marks, points) in [(USUAL, 0.0, predicted), (0.0, 1.0, measured)] {
            curves.push(Curve {
                style,
                width,
                marks,
                points,
            });
        }
    }
    let [x, y] = [0, 1].map(|axis| Panel::coordinates(&curves, axis));
    let figure = Figure {
        title: "Relative variance times lookups against optical depth".to_owned(),
        panels: vec![Panel {
            title: "marks: measured; lines: theory; lower is better".to_owned(),
            x: Axis::log("optical depth of the ray", Measure::Number, &x),
            y: Axis::log("variance / T² × lookups", Measure::Number, &y),
            curves,
            ..Panel::default()
        }],
        legend,
        height: 320.0,
    };
    Plot {
        svg: drawn(&figure, Theme::Page),
        notes,
    }
}

/// The line of theory, up to where it is [`HOPELESS`].
fn predicted(curve: &ThicknessCurve) -> Vec<CurvePoint> {
    let top = log10(HOPELESS);
    let mut line: Vec<CurvePoint> = Vec::new();
    for point in &curve.points {
        let theory = point
            .predicted
            .filter(|theory| *theory > 0.0 && point.depth > 0.0);
        let Some(theory) = theory else {
            continue;
        };
        let [x, y] = [log10(point.depth), log10(theory)];
        let at = match line.last().map(|last| last.at) {
            _ if y < top => [x, y],
            // The last piece of the line ends at the top.
            Some([x0, y0]) => [x0 + (x - x0) * (top - y0) / (y - y0), top],
            None => break,
        };
        line.push(CurvePoint::new(at, String::new()));
        if y >= top {
            break;
        }
    }
    line
}
