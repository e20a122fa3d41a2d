//! A ray: extinction along it, and the samples of a setting.

use super::axis::Axis;
use super::draw::drawn;
use super::figure::{Curve, CurvePoint, Figure, Key, Panel, USUAL};
use super::{Plot, Theme};
use crate::cost::results::RayTrace;
use crate::report::cost::words;

/// More samples than this would touch one another.
const MANY: usize = 60;

/// Extinction along the ray, with the samples.
pub(in super::super) fn ray(trace: &RayTrace) -> Plot {
    let is_finite = |at: &&[f64; 2]| at[0].is_finite() && at[1].is_finite();
    let along = trace.extinction.iter().filter(is_finite);
    let samples = trace.samples.iter().filter(is_finite);
    let along = along.map(|at| CurvePoint::new(*at, String::new()));
    let samples = samples.map(|at| {
        let (distance, extinction) = (words::value(at[0]), words::value(at[1]));
        let tooltip = format!("sample at {distance}: extinction {extinction}");
        CurvePoint::new(*at, tooltip)
    });
    let curves = vec![
        Curve {
            style: 0,
            width: USUAL,
            marks: 0.0,
            points: along.collect(),
        },
        Curve {
            style: 1,
            width: 0.0,
            // Many look like a thick line otherwise.
            marks: if trace.samples.len() > MANY { 0.5 } else { 1.0 },
            points: samples.collect(),
        },
    ];
    let (x, y) = (
        Panel::coordinates(&curves, 0),
        Panel::coordinates(&curves, 1),
    );
    let figure = Figure {
        title: format!("Extinction along {}", trace.ray),
        panels: vec![Panel {
            title: trace.ray.clone(),
            x: Axis::linear("distance along the ray", &x),
            y: Axis::linear("extinction", &[y, vec![0.0]].concat()),
            curves,
            ..Panel::default()
        }],
        legend: vec![
            (Key::Curve(0, USUAL, false), "extinction".to_owned()),
            (
                Key::Curve(1, 0.0, true),
                format!("looked up with {}", trace.setting),
            ),
        ],
        height: 200.0,
    };
    Plot {
        svg: drawn(&figure, Theme::Page),
        notes: Vec::new(),
    }
}
