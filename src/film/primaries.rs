//! The primaries of Rec.709, which are those of sRGB: images with others are refused.

/// Chromaticities (CIE x, y) of red, green, blue and white.
const REC709: [[f64; 2]; 4] = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];

/// Standards state four digits, and files round them; a chromaticity off by this much moves a colour
/// by less than a thousandth.
const ROUNDING: f64 = 1e-4;

/// True if these are the primaries and the white of Rec.709, up to rounding.
pub(super) fn are_rec709(points: &[[f64; 2]; 4]) -> bool {
    let mut pairs = points.as_flattened().iter().zip(REC709.as_flattened());
    pairs.all(|(a, b)| (a - b).abs() <= ROUNDING)
}
