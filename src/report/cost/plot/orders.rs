//! Error against the parameter: steps, nodes and pixels side by side.

use super::axis::{Axis, Measure};
use super::draw::drawn;
use super::picture::{Guide, LegendEntry, LegendKey, PlotCurve, PlotPanel, PlotPicture, PlotPoint};
use super::{Plot, Theme};
use crate::cost::results::{ConvergenceOrder, Cost, OrderVerdict, Parameter};
use crate::math::log10;
use crate::report::cost::words;

/// A panel for each length that is varied, with the sweeps of all studies; none where there are
/// no such sweeps.
pub(in super::super) fn orders(cost: &Cost, theme: Theme) -> Option<Plot> {
    let kinds = [
        (Parameter::Step, "step", "step along the ray"),
        (
            Parameter::ShadowStep,
            "shadow step",
            "step along shadow rays",
        ),
        (Parameter::Spacing, "grid", "spacing of the nodes"),
        (Parameter::Pixel, "pixel", "edge of a pixel"),
    ];
    let mut lines = OrderLines::default();
    for (parameter, title, axis) in kinds {
        for study in &cost.studies {
            for sweep in study
                .sweeps
                .iter()
                .filter(|sweep| sweep.parameter == parameter)
            {
                let estimator = words::sweep(study, &sweep.estimator, parameter);
                let name = match cost.studies.len() {
                    1 => estimator,
                    _ => format!("{}, {estimator}", study.name),
                };
                let counted = &sweep.order.counted;
                let points = sweep.levels.iter().zip(counted).map(|(level, counts)| {
                    let error = words::judged(level);
                    Falling {
                        value: level.value,
                        error,
                        counts: *counts,
                        tooltip: format!(
                            "{name}, {}: error {}",
                            level.setting,
                            words::error(error)
                        ),
                    }
                });
                lines.push(&name, points, &sweep.order, 1.0, sweep.is_ours);
            }
        }
        lines.end_panel(title, axis, "error: relative RMSE");
    }
    lines.plot("Error against step, node spacing and pixel", 270, theme)
}

/// A point of a curve that falls.
pub(super) struct Falling {
    pub(super) value: f64,
    pub(super) error: f64,
    /// Whether the order is fitted to it.
    pub(super) counts: bool,
    pub(super) tooltip: String,
}

/// Curves that fall as powers, with the powers that are expected, in panels.
#[derive(Default)]
pub(super) struct OrderLines {
    panels: Vec<PlotPanel>,
    legend: Vec<LegendEntry>,
    /// Of the panel that is being filled.
    curves: Vec<PlotCurve>,
    guides: Vec<Guide>,
}

impl OrderLines {
    /// Adds a curve. What is drawn falls by `power` times the order.
    pub(super) fn push(
        &mut self,
        name: &str,
        points: impl Iterator<Item = Falling>,
        order: &ConvergenceOrder,
        power: f64,
        is_wide: bool,
    ) {
        // No style twice: all panels have one legend.
        let style = self.legend.len();
        let mut points: Vec<Falling> = points
            .filter(|point| point.value > 0.0 && point.error > 0.0 && point.error.is_finite())
            .collect();
        points.sort_by(|a, b| b.value.total_cmp(&a.value));
        let logarithms = |point: &Falling| [log10(point.value), log10(point.error)];
        // The line that is expected goes through the finest setting that counts: errors of
        // coarser ones, which fall otherwise, show as a distance from it.
        let finest = points.iter().rfind(|point| point.counts);
        if let (Some(expected), Some(finest)) = (order.expected, finest) {
            self.guides.push(Guide {
                through: logarithms(finest),
                slope: power * expected,
                style: Some(style),
                label: None,
                is_ray: false,
            });
        }
        self.legend.push(LegendEntry {
            key: LegendKey::Curve(style, is_wide),
            text: format!("{name}: {}", fitted_and_expected(order, power)),
        });
        let last = points.len().saturating_sub(1);
        let has_order = order.fitted.is_some() || order.expected.is_some();
        let points = points.iter().enumerate().map(|(at, point)| PlotPoint {
            at: logarithms(point),
            label: (at == last && has_order).then(|| fitted(order, power)),
            is_urgent: order.verdict != OrderVerdict::AsExpected,
            tooltip: point.tooltip.clone(),
            is_hollow: !point.counts,
            ..PlotPoint::default()
        });
        self.curves.push(PlotCurve {
            style,
            is_wide,
            marks: 1.0,
            is_joined: true,
            points: points.collect(),
        });
    }

    /// Makes a panel of the curves since the last; none of no points.
    pub(super) fn end_panel(&mut self, title: &str, x_title: &str, y_title: &str) {
        let curves = std::mem::take(&mut self.curves);
        let guides = std::mem::take(&mut self.guides);
        let points = || curves.iter().flat_map(|curve| &curve.points);
        let across: Vec<f64> = points().map(|point| point.at[0]).collect();
        let up: Vec<f64> = points().map(|point| point.at[1]).collect();
        if across.is_empty() {
            return;
        }
        // The title of the axis is the same on all of them.
        let y_title = if self.panels.is_empty() { y_title } else { "" };
        self.panels.push(PlotPanel {
            title: title.to_owned(),
            x: Axis::log(x_title, Measure::Number, &across),
            y: Axis::log(y_title, Measure::Number, &up),
            curves,
            guides,
            lines: Vec::new(),
            front: Vec::new(),
        });
    }

    /// All panels; none of no panels.
    pub(super) fn plot(self, title: &str, height: i32, theme: Theme) -> Option<Plot> {
        if self.panels.is_empty() {
            return None;
        }
        let picture = PlotPicture {
            title: title.to_owned(),
            panels: self.panels,
            legend: self.legend,
            height,
        };
        Some(Plot {
            svg: drawn(&picture, theme),
            notes: Vec::new(),
        })
    }
}

/// Fitted order, with the sign of the verdict.
fn fitted(order: &ConvergenceOrder, power: f64) -> String {
    let fitted = order
        .fitted
        .map_or("–".to_owned(), |fitted| format!("{:.2}", power * fitted));
    let sign = match order.verdict {
        OrderVerdict::AsExpected => " ✓",
        OrderVerdict::TooFewRays => " ≈",
        OrderVerdict::Otherwise => " ✗",
        OrderVerdict::Undecided => " ?",
        OrderVerdict::NotYetAPower => " ~",
        OrderVerdict::NothingExpected => "",
    };
    format!("{fitted}{sign}")
}

fn fitted_and_expected(order: &ConvergenceOrder, power: f64) -> String {
    let fitted = fitted(order, power);
    match order.expected {
        Some(expected) => format!("{fitted} (expected {})", power * expected),
        None => fitted,
    }
}
