//! The plot of a transfer function in words and numbers.

use super::inline_arrays::{Entries, entries};
use super::points;
use crate::render::{PlotLayout, curve};
use crate::scene::Curve;

/// All that is drawn for the plot of `curve`, whose backdrop stands in `file`. Frame, grid and
/// letters are given as an image: fonts are not what is tested.
pub(super) fn described(curve: &Curve, layout: &PlotLayout<'_>, file: String) -> Entries {
    let format = "bare float32, little endian: linear R, G, B of every pixel, row by row from the \
                  top; all of the picture but the curves";
    let backdrop = entries! { "file": file, "format": format };
    let formula = "in pixels from the upper left corner of the image, whose pixels have their \
                   centres at halves: d(x) = max(from, from + (to - from)*(x - left)/(right - \
                   left)), Y(value) = bottom - (bottom - top)*value. Only pixels whose centres lie \
                   in left <= x <= right, top <= y <= bottom are drawn upon";
    let axes = entries! {
        "left": layout.left, "right": layout.right, "top": layout.top, "bottom": layout.bottom,
        "from": layout.from, "to": layout.to, "formula": formula,
    };
    let coverage = match curve {
        Curve::Formula { .. } => {
            "share of the pixel with centre (x, y) that the curve of f covers: with H(x) = \
             Y(f(d(x))) and slope = H(x + 1/2) - H(x - 1/2), distance = |y - H(x)|/sqrt(1 + \
             slope^2), coverage = min(1, max(0, half_width + 1/2 - distance))"
        }
        Curve::Points(_) => {
            "share of the pixel with centre (x, y) that the line covers: with distance that of (x, y) from the \
             nearest of the straight lines between neighbours among (left, Y(a0(from))), (X(value), Y(opacity)) of \
             each point, and (right, Y(a0(to))), where X(d) = left + (right - left)*(d - from)/(to - from), coverage \
             = min(1, max(0, half_width + 1/2 - distance))"
        }
    };
    let blending = "pixel = pixel + (colour - pixel)*coverage, in linear RGB";
    let line = entries! {
        "half_width": curve::HALF_WIDTH, "coverage": coverage, "blending": blending,
    };
    let mut entries = entries! {
        "shows": "plot", "backdrop": backdrop, "axes": axes, "line": line,
    };
    entries.extend(curves(curve));
    entries
}

fn curves(curve: &Curve) -> Entries {
    match curve {
        Curve::Formula { opacity, .. } => {
            let transparency = "T(d) = min(1, max(0, (exp(-d^2) - floor)/(1 - floor)))";
            let order = "first the curve of the opacity 1 - T(d), then over it that of T(d)";
            entries! {
                "kind": "formula", "floor": opacity.floor, "transparency": transparency,
                "opacity_colour": curve::linear(curve::OPACITY),
                "transparency_colour": curve::linear(curve::TRANSPARENCY), "order": order,
            }
        }
        Curve::Points(table) => {
            let opacity = "a0(d) goes in straight lines between the opacities of the points, \
                           colour(d) likewise, both constant beyond the outermost; of two points \
                           at one value, the later holds at the value itself";
            let order = "first, where y > Y(a0(d(x))) and the pixel lies on no axis (x is not left, \
                         y is not bottom), pixel = min(1, colour(d(x))); then the line over it";
            entries! {
                "kind": "table", "points": points(table), "opacity": opacity,
                "line_colour": curve::linear(curve::INK), "order": order,
            }
        }
    }
}
