//! Contents of a figure: panels with axes, curves and lines. Coordinates are places on an [`Axis`]:
//! logarithms where that is logarithmic.

use super::axis::Axis;

/// Panels side by side, with one legend below.
pub(super) struct Figure {
    /// For readers that do not see it.
    pub(super) title: String,
    pub(super) panels: Vec<Panel>,
    pub(super) legend: Vec<(Key, String)>,
    /// Height of the axes.
    pub(super) height: f64,
}

#[derive(Default)]
pub(super) struct Panel {
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<Curve>,
    pub(super) guides: Vec<Guide>,
    pub(super) lines: Vec<Line>,
    /// Corners of the Pareto front.
    pub(super) front: Vec<[f64; 2]>,
}

/// Points of one colour and shape.
pub(super) struct Curve {
    /// Number of colour, dashes and shape of the marks.
    pub(super) style: usize,
    /// Width of the line that joins them; 0 for none.
    pub(super) width: f64,
    /// Radius of the marks, relative to the usual; 0 for none.
    pub(super) marks: f64,
    pub(super) points: Vec<CurvePoint>,
}

/// Widths of the line of a curve, and of one that stands out.
pub(super) const USUAL: f64 = 1.5;
pub(super) const WIDE: f64 = 2.8;

/// A point of a curve.
#[derive(Default)]
pub(super) struct CurvePoint {
    pub(super) at: [f64; 2],
    pub(super) label: Option<String>,
    /// Whether its label goes before those of other points.
    pub(super) is_urgent: bool,
    pub(super) tooltip: String,
    /// Not to be trusted: drawn without filling.
    pub(super) is_hollow: bool,
    /// Range along the first axis.
    pub(super) whiskers: Option<[f64; 2]>,
    /// Height of a cross above or below it, and its tooltip.
    pub(super) cross: Option<(f64, String)>,
}

impl CurvePoint {
    /// A point with a tooltip, or none if that is empty.
    pub(super) fn new(at: [f64; 2], tooltip: String) -> CurvePoint {
        CurvePoint {
            at,
            tooltip,
            ..CurvePoint::default()
        }
    }
}

/// A thin line of a slope through a point.
pub(super) struct Guide {
    pub(super) through: [f64; 2],
    pub(super) slope: f64,
    pub(super) kind: GuideKind,
}

pub(super) enum GuideKind {
    /// Across the panel, in the colour of a curve.
    OfCurve(usize),
    /// From the point on to the right, with this label.
    Labelled(String),
}

/// A line across the panel at a height.
#[derive(Clone)]
pub(super) struct Line {
    pub(super) at: f64,
    pub(super) label: String,
    /// Whether everything below it is shaded.
    pub(super) is_shaded: bool,
}

/// The part of a figure that an entry of a legend explains.
#[derive(Clone, Copy)]
pub(super) enum Key {
    /// A curve: style, width of the line or 0, and whether it has marks.
    Curve(usize, f64, bool),
    /// A mark without filling.
    Hollow,
    Cross,
    Front,
    Guide,
}

impl Panel {
    /// Coordinates of all points along an axis.
    pub(super) fn coordinates(curves: &[Curve], axis: usize) -> Vec<f64> {
        let points = curves.iter().flat_map(|curve| &curve.points);
        points.map(|point| point.at[axis]).collect()
    }
}
