//! Primaries of linear RGB, and the matrix to those of Rec.709 (the primaries of sRGB).
//!
//! A white point other than D65 is adapted by the Bradford transform, as in the Academy's own
//! transforms from ACES to Rec.709; of the same white point nothing is adapted.
//!
//! Source: B. Lindbloom, <http://www.brucelindbloom.com>, "RGB/XYZ Matrices" and "Chromatic
//! Adaptation".

use glam::{DMat3, DVec3};
use std::fmt;

/// Chromaticities (CIE x, y) of red, green, blue and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Primaries(pub [[f64; 2]; 4]);

/// Linear RGB with a name: that of people, that of the Color Interop Forum (`lin_…_scene`), that of
/// OpenImageIO before.
type Named = (
    &'static str,
    &'static str,
    &'static [&'static str],
    Primaries,
);

const D65: [f64; 2] = [0.3127, 0.329];
const ACES_WHITE: [f64; 2] = [0.32168, 0.33767];

/// Primaries of Rec.709, and of sRGB.
pub(super) const REC709: Primaries = Primaries([[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], D65]);

/// Primaries of ACES2065-1.
pub(super) const AP0: Primaries =
    Primaries([[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], ACES_WHITE]);

/// Source: Color Interop Forum, "Color Space Encodings for Texture Assets and CG Rendering".
const NAMED: [Named; 6] = [
    (
        "Rec.709",
        "lin_rec709_scene",
        &["linear", "lin_rec709", "lin_srgb", "linear rec.709 (srgb)"],
        REC709,
    ),
    (
        "ACEScg (AP1)",
        "lin_ap1_scene",
        &["acescg", "lin_ap1"],
        Primaries([[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], ACES_WHITE]),
    ),
    (
        "ACES2065-1 (AP0)",
        "lin_ap0_scene",
        &["aces2065-1", "lin_ap0"],
        AP0,
    ),
    (
        "P3-D65",
        "lin_p3d65_scene",
        &["lin_p3d65"],
        Primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], D65]),
    ),
    (
        "Rec.2020",
        "lin_rec2020_scene",
        &["lin_rec2020"],
        Primaries([[0.708, 0.292], [0.17, 0.797], [0.131, 0.046], D65]),
    ),
    (
        "Adobe RGB",
        "lin_adobergb_scene",
        &["lin_adobergb"],
        Primaries([[0.64, 0.33], [0.21, 0.71], [0.15, 0.06], D65]),
    ),
];

/// Standards state four digits, and files round them; a chromaticity off by this much moves a colour
/// by less than a thousandth.
const ROUNDING: f64 = 1e-4;

/// Twice the area of the triangle of primaries, at least: a hundredth of that of Rec.709 amplifies
/// every error of a file a hundredfold.
const LEAST_AREA: f64 = 0.002;

impl Primaries {
    /// The primaries of the linear RGB called `name`.
    pub fn named(name: &str) -> Option<Primaries> {
        let name = name.to_ascii_lowercase();
        let found = NAMED
            .iter()
            .find(|(_, id, others, _)| *id == name || others.contains(&&*name));
        found.map(|(.., primaries)| *primaries)
    }

    /// The same primaries and white, up to rounding.
    pub fn is(&self, other: &Primaries) -> bool {
        let mut pairs = self.0.as_flattened().iter().zip(other.0.as_flattened());
        pairs.all(|(a, b)| (a - b).abs() <= ROUNDING)
    }

    /// Named primaries in place of their rounding.
    fn exact(&self) -> Primaries {
        let mut named = NAMED.iter().map(|(.., primaries)| *primaries);
        named.find(|named| named.is(self)).unwrap_or(*self)
    }

    /// The matrix to Rec.709; none if these are primaries of no colours.
    pub fn to_rec709(self) -> Option<DMat3> {
        let [from, to] = [self.exact(), REC709];
        let inverse = to.to_xyz()?.inverse();
        let matrix = inverse * adaptation(from.white(), to.white()) * from.to_xyz()?;
        matrix.is_finite().then_some(matrix)
    }

    /// In the words of a verdict: the adaptation of the white point; empty where there is none.
    pub fn adaptation(self) -> &'static str {
        let white = |primaries: Primaries| Primaries([primaries.0[3]; 4]);
        if white(self).is(&white(REC709)) {
            ""
        } else {
            ", its white adapted to D65 by the Bradford transform"
        }
    }

    /// The matrix to CIE XYZ, in which white has Y = 1.
    fn to_xyz(self) -> Option<DMat3> {
        let [red, green, blue, white] = self.0;
        let column = |[x, y]: [f64; 2]| DVec3::new(x, y, 1.0 - x - y);
        let columns = DMat3::from_cols(column(red), column(green), column(blue));
        // No comparison with infinity or NaN is true.
        let are_sound =
            columns.determinant().abs() >= LEAST_AREA && white[0] > 0.0 && white[1] > 0.0;
        are_sound.then(|| {
            let scale = columns.inverse() * self.white();
            columns * DMat3::from_diagonal(scale)
        })
    }

    fn white(self) -> DVec3 {
        let [x, y] = self.0[3];
        DVec3::new(x / y, 1.0, (1.0 - x - y) / y)
    }
}

/// The Bradford transform from one white point, in XYZ, to another.
fn adaptation(from: DVec3, to: DVec3) -> DMat3 {
    if from == to {
        return DMat3::IDENTITY;
    }
    let cones = DMat3::from_cols_array_2d(&[
        [0.8951, -0.7502, 0.0389],
        [0.2664, 1.7135, -0.0685],
        [-0.1614, 0.0367, 1.0296],
    ]);
    cones.inverse() * DMat3::from_diagonal((cones * to) / (cones * from)) * cones
}

impl fmt::Display for Primaries {
    /// The name, else the chromaticities.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((name, ..)) = NAMED.iter().find(|(.., named)| named.is(self)) {
            return f.write_str(name);
        }
        let [r, g, b, w] = self.0.map(|[x, y]| format!("({x:.4}, {y:.4})"));
        write!(f, "{r}, {g}, {b} with white {w}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_near(matrix: DMat3, rows: [[f64; 3]; 3]) {
        let expected = DMat3::from_cols_array_2d(&rows).transpose();
        assert!(matrix.abs_diff_eq(expected, 2e-6), "{matrix}");
    }

    /// As OpenColorIO's configuration for ACES has them, and the matrix of P3 by W3C's CSS Color 4.
    #[test]
    fn published_matrices() {
        let of = |name| Primaries::named(name).unwrap().to_rec709().unwrap();
        is_near(
            of("ACEScg"),
            [
                [1.705051, -0.621792, -0.083259],
                [-0.130256, 1.140805, -0.010548],
                [-0.024003, -0.128969, 1.152972],
            ],
        );
        is_near(
            of("lin_ap0_scene"),
            [
                [2.521686, -1.134131, -0.387555],
                [-0.276480, 1.372719, -0.096239],
                [-0.015378, -0.152975, 1.168354],
            ],
        );
        is_near(
            of("lin_p3d65_scene"),
            [
                [1.224940, -0.224940, 0.0],
                [-0.042057, 1.042057, 0.0],
                [-0.019638, -0.078636, 1.098274],
            ],
        );
    }

    #[test]
    fn white_stays_white_and_rec709_itself() {
        for (name, id, _, primaries) in NAMED {
            assert_eq!(Primaries::named(id), Some(primaries));
            assert_eq!(primaries.to_string(), name);
            let white = primaries.to_rec709().unwrap() * DVec3::ONE;
            assert!(white.abs_diff_eq(DVec3::ONE, 1e-12), "{name}: {white}");
            // As single precision rounds them.
            let rounded = Primaries(primaries.0.map(|point| point.map(|v| f64::from(v as f32))));
            assert!(rounded.is(&primaries));
            assert_eq!(rounded.to_rec709(), primaries.to_rec709());
        }
        assert_eq!(Primaries::named("srgb_rec709_scene"), None);
    }

    #[test]
    fn primaries_of_no_colours() {
        for points in [
            [[0.3, 0.3]; 4],
            [[0.0; 2]; 4],
            [[f64::NAN; 2]; 4],
            [[f64::INFINITY; 2]; 4],
            [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.0]],
        ] {
            assert_eq!(Primaries(points).to_rec709(), None, "{points:?}");
        }
    }
}
