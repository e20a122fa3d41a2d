//! A ray: what is along it, and where a setting looked.

use super::axis::Axis;
use super::draw::drawn;
use super::picture::{LegendEntry, LegendKey, PlotCurve, PlotPanel, PlotPicture, PlotPoint};
use super::{Plot, Theme};
use crate::cost::results::RayTrace;
use crate::report::cost::words;

/// More samples than this would touch one another.
const MANY: usize = 60;

/// Extinction along the ray, with the samples.
pub(in super::super) fn ray(trace: &RayTrace, theme: Theme) -> Plot {
    let point = |at: &[f64; 2]| PlotPoint {
        at: *at,
        ..PlotPoint::default()
    };
    let tooltip = |at: &[f64; 2]| PlotPoint {
        tooltip: format!(
            "sample at {}: extinction {}",
            words::value(at[0]),
            words::value(at[1])
        ),
        ..point(at)
    };
    let is_finite = |at: &&[f64; 2]| at[0].is_finite() && at[1].is_finite();
    let extinction = trace.extinction.iter().filter(is_finite);
    let samples = trace.samples.iter().filter(is_finite);
    let curves = vec![
        PlotCurve {
            style: 0,
            is_wide: false,
            marks: 0.0,
            is_joined: true,
            points: extinction.map(point).collect(),
        },
        PlotCurve {
            style: 1,
            is_wide: false,
            // Many look like a thick line otherwise.
            marks: if trace.samples.len() > MANY { 0.5 } else { 1.0 },
            is_joined: false,
            points: samples.map(tooltip).collect(),
        },
    ];
    let of = |axis: usize| -> Vec<f64> {
        let points = curves.iter().flat_map(|curve| &curve.points);
        points.map(|point| point.at[axis]).collect()
    };
    let picture = PlotPicture {
        title: format!("Extinction along {}", trace.ray),
        panels: vec![PlotPanel {
            title: trace.ray.clone(),
            x: Axis::linear("distance along the ray", &of(0)),
            y: Axis::linear("extinction", &[of(1), vec![0.0]].concat()),
            curves,
            guides: Vec::new(),
            lines: Vec::new(),
            front: Vec::new(),
        }],
        legend: vec![
            LegendEntry {
                key: LegendKey::Line(0),
                text: "extinction".to_owned(),
            },
            LegendEntry {
                key: LegendKey::Mark(1),
                text: format!("looked up with {}", trace.setting),
            },
        ],
        height: 200,
    };
    Plot {
        svg: drawn(&picture, theme),
        notes: Vec::new(),
    }
}
