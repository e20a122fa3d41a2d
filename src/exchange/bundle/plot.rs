//! The plot of a transfer function in words and numbers.

use super::BundlePoint;
use crate::render::classified::curve::PlotLayout;
use crate::scene::Curve;
use serde::Serialize;

type PlotColour = [f64; 3];

/// All that is drawn. Frame, grid and letters are given as an image: fonts are not what is
/// tested.
#[derive(Serialize)]
pub(super) struct BundlePlot {
    backdrop: Backdrop,
    axes: PlotAxes,
    line: PlotLine,
    #[serde(flatten)]
    curves: Curves,
}

#[derive(Serialize)]
struct Backdrop {
    file: String,
    format: &'static str,
}

#[derive(Serialize)]
struct PlotAxes {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    from: f64,
    to: f64,
    formula: &'static str,
}

#[derive(Serialize)]
struct PlotLine {
    half_width: f64,
    coverage: &'static str,
    blending: &'static str,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Curves {
    Formula {
        floor: f64,
        transparency: &'static str,
        opacity_colour: PlotColour,
        transparency_colour: PlotColour,
        order: &'static str,
    },
    Table {
        points: Vec<BundlePoint>,
        opacity: &'static str,
        line_colour: PlotColour,
        order: &'static str,
    },
}

impl BundlePlot {
    /// The description of the plot of `curve`, whose backdrop stands in `file`.
    pub(super) fn new(curve: &Curve, layout: &PlotLayout, file: String) -> BundlePlot {
        BundlePlot {
            backdrop: Backdrop {
                file,
                format: "bare float32, little endian: linear R, G, B of every pixel, row by row \
                         from the top; all of the picture but the curves",
            },
            axes: PlotAxes {
                left: layout.left,
                right: layout.right,
                top: layout.top,
                bottom: layout.bottom,
                from: layout.from,
                to: layout.to,
                formula: "in pixels from the upper left corner of the image, whose pixels have \
                          their centres at halves: d(x) = max(from, from + (to - from)*(x - \
                          left)/(right - left)), Y(value) = bottom - (bottom - top)*value. Only \
                          pixels whose centres lie in left <= x <= right, top <= y <= bottom are \
                          drawn upon",
            },
            line: PlotLine {
                half_width: PlotLayout::HALF_WIDTH,
                coverage: match curve {
                    Curve::Formula { .. } => {
                        "share of the pixel with centre (x, y) that the curve of f covers: with \
                         H(x) = Y(f(d(x))) and slope = H(x + 1/2) - H(x - 1/2), distance = |y - \
                         H(x)|/sqrt(1 + slope^2), coverage = min(1, max(0, half_width + 1/2 - \
                         distance))"
                    }
                    Curve::Points(_) => {
                        "share of the pixel with centre (x, y) that the line covers: with \
                         distance that of (x, y) from the nearest of the straight lines between \
                         neighbours among (left, Y(a0(from))), (X(value), Y(opacity)) of each \
                         point, and (right, Y(a0(to))), where X(d) = left + (right - left)*(d - \
                         from)/(to - from), coverage = min(1, max(0, half_width + 1/2 - \
                         distance))"
                    }
                },
                blending: "pixel = pixel + (colour - pixel)*coverage, in linear RGB",
            },
            curves: Curves::new(curve),
        }
    }
}

impl Curves {
    fn new(curve: &Curve) -> Curves {
        match curve {
            Curve::Formula { opacity, .. } => Curves::Formula {
                floor: opacity.floor,
                transparency: "T(d) = min(1, max(0, (exp(-d^2) - floor)/(1 - floor)))",
                opacity_colour: PlotLayout::opacity_colour(),
                transparency_colour: PlotLayout::transparency_colour(),
                order: "first the curve of the opacity 1 - T(d), then over it that of T(d)",
            },
            Curve::Points(points) => Curves::Table {
                points: BundlePoint::list(points),
                opacity: "a0(d) goes in straight lines between the opacities of the points, \
                          colour(d) likewise, both constant beyond the outermost; of two points \
                          at one value, the later holds at the value itself",
                line_colour: PlotLayout::line_colour(),
                order: "first, where y > Y(a0(d(x))) and the pixel lies on no axis (x is not left, \
                        y is not bottom), pixel = min(1, colour(d(x))); then the line over it",
            },
        }
    }
}
