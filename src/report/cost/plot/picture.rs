//! What is to be drawn: panels with axes, curves and lines. Coordinates are places on an
//! [`Axis`]: logarithms where that is logarithmic.

use super::axis::Axis;

/// Panels side by side, with one legend below.
#[derive(Debug, Default)]
pub(super) struct PlotPicture {
    /// For those who do not see it.
    pub(super) title: String,
    pub(super) panels: Vec<PlotPanel>,
    pub(super) legend: Vec<LegendEntry>,
    /// Height of the axes.
    pub(super) height: i32,
}

#[derive(Debug)]
pub(super) struct PlotPanel {
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) curves: Vec<PlotCurve>,
    pub(super) guides: Vec<Guide>,
    pub(super) lines: Vec<HorizontalLine>,
    /// Corners of the border of what can be had.
    pub(super) front: Vec<[f64; 2]>,
}

/// Points that belong together.
#[derive(Debug)]
pub(super) struct PlotCurve {
    /// Number of colour, dashes and shape of the marks.
    pub(super) style: usize,
    pub(super) is_wide: bool,
    /// Radius of the marks, relative to the usual; 0 for none.
    pub(super) marks: f64,
    /// Whether they are joined.
    pub(super) is_joined: bool,
    pub(super) points: Vec<PlotPoint>,
}

/// A point of a curve.
#[derive(Clone, Debug, Default)]
pub(super) struct PlotPoint {
    pub(super) at: [f64; 2],
    pub(super) label: Option<String>,
    /// Whether its label goes before those of other points.
    pub(super) is_urgent: bool,
    /// Text of its tooltip.
    pub(super) tooltip: String,
    /// Not to be trusted: drawn without filling.
    pub(super) is_hollow: bool,
    /// From where to where it may be along the first axis.
    pub(super) whiskers: Option<[f64; 2]>,
    /// Where a cross is drawn above or below it, and the text of its tooltip.
    pub(super) cross: Option<(f64, String)>,
}

/// A thin line through a point.
#[derive(Debug)]
pub(super) struct Guide {
    pub(super) through: [f64; 2],
    pub(super) slope: f64,
    /// In the colour of this curve; grey otherwise.
    pub(super) style: Option<usize>,
    pub(super) label: Option<String>,
    /// Whether it begins at the point, and goes on to the right only.
    pub(super) is_ray: bool,
}

/// A line across the panel.
#[derive(Debug)]
pub(super) struct HorizontalLine {
    pub(super) at: f64,
    pub(super) label: String,
    /// Whether everything below it is shaded.
    pub(super) is_shaded: bool,
}

/// A line of a legend.
#[derive(Clone, Debug)]
pub(super) struct LegendEntry {
    pub(super) key: LegendKey,
    pub(super) text: String,
}

/// What a line of a legend explains.
#[derive(Clone, Copy, Debug)]
pub(super) enum LegendKey {
    /// Line and mark of a curve, in that style; wide or not.
    Curve(usize, bool),
    /// The line of a curve, in that style.
    Line(usize),
    /// The mark of a curve, in that style.
    Mark(usize),
    /// A mark without filling.
    Hollow,
    /// A cross.
    Cross,
    /// The border of what can be had.
    Front,
    /// A thin line.
    Guide,
}
