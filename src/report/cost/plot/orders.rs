//! Errors that fall as powers: of the images and transmittances by their parameters, of jittered
//! marching by its step.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::figure::{Curve, CurvePoint, Figure, Guide, GuideKind, Key, Panel, USUAL, WIDE};
use super::{Plot, Theme};
use crate::cost::results::{
    ConvergenceOrder, Cost, JitterPoint, JitterSplit, OrderVerdict, Parameter,
};
use crate::math::log10;
use crate::report::cost::words;

/// A panel for each length that is varied, with the sweeps of all studies; none where there are
/// no such sweeps.
pub(in super::super) fn orders(cost: &Cost) -> Option<Plot> {
    let mut curves = FallingCurves::default();
    for (parameter, title, axis) in [
        (Parameter::Step, "step", "step along the ray"),
        (
            Parameter::ShadowStep,
            "shadow step",
            "step along shadow rays",
        ),
        (Parameter::Spacing, "grid", "spacing of the nodes"),
        (Parameter::Pixel, "pixel", "edge of a pixel"),
    ] {
        for study in &cost.studies {
            let sweeps = study.sweeps.iter();
            for sweep in sweeps.filter(|sweep| sweep.parameter == parameter) {
                let estimator = words::sweep(study, &sweep.estimator, parameter);
                let name = match cost.studies.len() {
                    1 => estimator,
                    _ => format!("{}, {estimator}", study.name),
                };
                let counted = sweep.order.counted.iter();
                let points = sweep.levels.iter().zip(counted).map(|(level, counts)| {
                    let (setting, error) = (&level.setting, words::judged(level));
                    FallingPoint {
                        value: level.value,
                        error,
                        counts: *counts,
                        tooltip: format!("{name}, {setting}: error {}", words::error(error)),
                    }
                });
                let width = if sweep.is_ours { WIDE } else { USUAL };
                curves.push(&name, points.collect(), &sweep.order, 1.0, width);
            }
        }
        curves.end_panel(title, axis, "error: relative RMSE");
    }
    curves.plot("Error against step, node spacing and pixel", 270.0)
}

/// Squared bias and variance of jittered marching against the step, in panels of one kind of
/// jitter each.
pub(in super::super) fn jitter(split: &JitterSplit) -> Option<Plot> {
    let mut curves = FallingCurves::default();
    for curve in &split.curves {
        let jitter = &curve.jitter;
        let mut push = |part: &str, of: fn(&JitterPoint) -> f64, order: &ConvergenceOrder| {
            let points = curve.points.iter().map(|point| {
                let (step, error) = (words::value(point.step), of(point) * of(point));
                FallingPoint {
                    value: point.step,
                    error,
                    counts: true,
                    tooltip: format!("{jitter}, step {step}: {part} {}", words::error(error)),
                }
            });
            let name = format!("{jitter}: {part}");
            curves.push(&name, points.collect(), order, 2.0, USUAL);
        };
        push("variance", |point| point.deviation, &curve.deviation_order);
        push("bias²", |point| point.bias, &curve.bias_order);
        curves.end_panel(jitter, "step", "relative to T²");
    }
    let title = "Squared bias and variance of jittered marching against the step";
    curves.plot(title, 260.0)
}

/// A point of a curve that falls.
struct FallingPoint {
    value: f64,
    error: f64,
    /// Whether the order is fitted to it.
    counts: bool,
    tooltip: String,
}

/// Curves that fall as powers, with the powers that are expected, in panels.
#[derive(Default)]
struct FallingCurves {
    panels: Vec<Panel>,
    legend: Vec<(Key, String)>,
    /// The panel that is being filled.
    open: Panel,
}

impl FallingCurves {
    /// Adds a curve. It falls by `power` times the order.
    fn push(
        &mut self,
        name: &str,
        mut points: Vec<FallingPoint>,
        order: &ConvergenceOrder,
        power: f64,
        width: f64,
    ) {
        // No style twice: all panels have one legend.
        let style = self.legend.len();
        points.retain(|point| point.value > 0.0 && point.error > 0.0 && point.error.is_finite());
        points.sort_by(|a, b| b.value.total_cmp(&a.value));
        let logarithms = |point: &FallingPoint| [log10(point.value), log10(point.error)];
        // The line that is expected goes through the finest setting that counts: errors of
        // coarser ones, which fall otherwise, show as a distance from it.
        let finest = points.iter().rfind(|point| point.counts);
        if let (Some(expected), Some(finest)) = (order.expected, finest) {
            self.open.guides.push(Guide {
                through: logarithms(finest),
                slope: power * expected,
                kind: GuideKind::OfCurve(style),
            });
        }
        let fitted = match order.fitted {
            Some(fitted) => format!("{:.2}", power * fitted),
            None => "–".to_owned(),
        };
        let fitted = match order.verdict {
            OrderVerdict::NothingExpected => fitted,
            verdict => format!("{fitted} {}", words::sign(verdict)),
        };
        let expected = match order.expected {
            Some(expected) => format!(" (expected {})", power * expected),
            None => String::new(),
        };
        let text = format!("{name}: {fitted}{expected}");
        self.legend.push((Key::Curve(style, width, true), text));
        let last = points.len().saturating_sub(1);
        let has_order = order.fitted.is_some() || order.expected.is_some();
        let points = points
            .into_iter()
            .enumerate()
            .map(|(at, point)| CurvePoint {
                at: logarithms(&point),
                label: (at == last && has_order).then(|| fitted.clone()),
                is_urgent: order.verdict != OrderVerdict::AsExpected,
                tooltip: point.tooltip,
                is_hollow: !point.counts,
                ..CurvePoint::default()
            });
        self.open.curves.push(Curve {
            style,
            width,
            marks: 1.0,
            points: points.collect(),
        });
    }

    /// Makes a panel of the curves since the last; none of no points.
    fn end_panel(&mut self, title: &str, x_title: &str, y_title: &str) {
        let open = std::mem::take(&mut self.open);
        let [x, y] = [0, 1].map(|axis| Panel::coordinates(&open.curves, axis));
        if !x.is_empty() {
            self.panels.push(Panel {
                title: title.to_owned(),
                x: Axis::log(x_title, Measure::Number, &x),
                y: Axis::log(y_title, Measure::Number, &y),
                ..open
            });
        }
    }

    /// All panels; none of no panels.
    fn plot(self, title: &str, height: f64) -> Option<Plot> {
        let figure = Figure {
            title: title.to_owned(),
            panels: self.panels,
            legend: self.legend,
            height,
        };
        (!figure.panels.is_empty()).then(|| Plot {
            svg: drawn(&figure, Theme::Page),
            notes: Vec::new(),
        })
    }
}
