//! Bias and variance of jittered marching.

use super::orders::{Falling, OrderLines};
use super::{Plot, Theme};
use crate::cost::results::{ConvergenceOrder, JitterPoint, JitterSplit};
use crate::report::cost::words;

/// Squared bias and variance against the step, in panels of one kind of jitter each.
pub(in super::super) fn jitter(split: &JitterSplit, theme: Theme) -> Option<Plot> {
    let mut lines = OrderLines::default();
    for curve in &split.curves {
        let jitter = &curve.jitter;
        let mut push = |part: &str, of: fn(&JitterPoint) -> f64, order: &ConvergenceOrder| {
            let points = curve.points.iter().map(|point| Falling {
                value: point.step,
                error: of(point),
                counts: true,
                tooltip: format!(
                    "{jitter}, step {}: {part} {}",
                    words::value(point.step),
                    words::error(of(point))
                ),
            });
            lines.push(&format!("{jitter}: {part}"), points, order, 2.0, false);
        };
        let variance = |point: &JitterPoint| point.deviation * point.deviation;
        push("variance", variance, &curve.deviation_order);
        let bias = |point: &JitterPoint| point.bias * point.bias;
        push("bias²", bias, &curve.bias_order);
        lines.end_panel(jitter, "step", "relative to T²");
    }
    lines.plot(
        "Squared bias and variance of jittered marching against the step",
        260,
        theme,
    )
}
