//! Colours and their distance (the paper's colour pipeline, section 4.1).
//!
//! From sRGB codes to the linear opponent space in which the eye's blur is applied, and from
//! there to a perceptual space in which colours are subtracted.

use super::SrgbImage;
use super::plane::Plane;
use super::power::power;
use crate::math::{quick_cbrt, srgb_to_linear};

/// A colour as three numbers, in the colour space named by the variable.
pub type Colour = [f64; 3];
type Matrix = [[f64; 3]; 3];

/// Linear RGB to CIE XYZ in units of the white point (white is [1, 1, 1]).
///
/// BT.709 primaries, red (0.64, 0.33), green (0.30, 0.60), blue (0.15, 0.06), and D65 white at
/// (0.31271, 0.32902) give rational numbers, and dividing a row by its sum leaves these
/// integers: each row is a weighted mean of red, green and blue.
const RELATIVE_XYZ: Matrix = [
    mean_weights([10_135_552, 8_788_810, 4_435_075]),
    mean_weights([2_613_072, 8_788_810, 887_015]),
    mean_weights([1_425_312, 8_788_810, 70_074_185]),
];

/// CIE XYZ in units of the white point to linear RGB.
const LINEAR_RGB: Matrix = inverse(RELATIVE_XYZ);

const fn mean_weights(shares: [u32; 3]) -> [f64; 3] {
    let [r, g, b] = [shares[0] as f64, shares[1] as f64, shares[2] as f64];
    let total = r + g + b;
    [r / total, g / total, b / total]
}

/// Inverse by Cramer's rule.
const fn inverse(m: Matrix) -> Matrix {
    let mut cofactors = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 3 {
        let mut j = 0;
        while j < 3 {
            let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            cofactors[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
            j += 1;
        }
        i += 1;
    }
    let determinant =
        m[0][0] * cofactors[0][0] + m[0][1] * cofactors[1][0] + m[0][2] * cofactors[2][0];
    let mut i = 0;
    while i < 9 {
        cofactors[i / 3][i % 3] /= determinant;
        i += 1;
    }
    cofactors
}

fn apply(m: &Matrix, v: Colour) -> Colour {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// An image in the linear opponent space YCxCz: luminance as a fraction of white's, red–green and blue–yellow.
///
/// With x, y, z the XYZ in units of white, the paper has Y = 116 y − 16, Cx = 500 (x − y),
/// Cz = 200 (y − z). The factors and the offset are left out here: every filter is linear and
/// its weights sum to one (or, for features, to zero), so they would be undone unchanged.
#[derive(Clone, Debug)]
pub struct OpponentPlanes(pub [Plane; 3]);

impl OpponentPlanes {
    pub fn of(image: &SrgbImage) -> Self {
        let light_of_code: Vec<f64> = (0..256)
            .map(|code| srgb_to_linear(f64::from(code) / 255.0))
            .collect();
        let mut planes = [(); 3].map(|()| Plane::new(image.width(), image.height()));
        for (index, pixel) in image.pixels().iter().enumerate() {
            let rgb = pixel.map(|code| light_of_code[usize::from(code)]);
            for (plane, value) in planes.iter_mut().zip(opponent(apply(&RELATIVE_XYZ, rgb))) {
                plane.samples[index] = value;
            }
        }
        Self(planes)
    }
}

fn opponent([x, y, z]: Colour) -> Colour {
    [y, x - y, y - z]
}

fn opponent_to_xyz([y, cx, cz]: Colour) -> Colour {
    [y + cx, y, y - cz]
}

/// CIE L*a*b* of XYZ in units of white, with chroma a and b weighted by L/100: the Hunt effect,
/// colours of dark regions count for less. Source: section 4.1 ("Hunt-adjusted"); L*a*b*:
/// CIE 15.
fn hunt_lab(xyz: Colour) -> Colour {
    let [x, y, z] = xyz.map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// The cube root, continued below (6/29)³ by its tangent.
fn lab_curve(t: f64) -> f64 {
    const KNEE: f64 = 6.0 / 29.0;
    if t > KNEE * KNEE * KNEE {
        quick_cbrt(t)
    } else {
        t / (3.0 * KNEE * KNEE) + 4.0 / 29.0
    }
}

/// The HyAB distance: city-block in lightness, Euclidean in chroma. Source: section 4.1.
fn hyab(p: Colour, q: Colour) -> f64 {
    let [dl, da, db] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    dl.abs() + (da * da + db * db).sqrt()
}

/// `q_c`: exponent that compresses large colour distances. Source: section 4.1.
const COMPRESSION: f64 = 0.7;
/// `p_c`: fraction of the largest compressed distance up to which differences get most of the
/// range. Source: section 4.1.
const KNEE_DISTANCE: f64 = 0.4;
/// `p_t`: the part of the range they get. Source: section 4.1.
const KNEE_DIFFERENCE: f64 = 0.95;

/// Maps colour distances to differences in [0, 1].
#[derive(Clone, Copy, Debug)]
pub struct ColourScale {
    /// `c_max`: the largest compressed distance, that of green and blue.
    largest: f64,
}

impl ColourScale {
    pub fn new() -> Self {
        let [green, blue] =
            [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt_lab(apply(&RELATIVE_XYZ, rgb)));
        Self {
            largest: power(hyab(green, blue), COMPRESSION),
        }
    }

    /// `ΔE_c`: the colour difference in [0, 1] of two blurred colours in the opponent space.
    pub fn difference(self, reference: Colour, test: Colour) -> f64 {
        self.of_distance(hyab(displayed_lab(reference), displayed_lab(test)))
    }

    /// Compresses a HyAB distance and redistributes it: the lower 40 % take 95 % of the range.
    fn of_distance(self, distance: f64) -> f64 {
        let compressed = power(distance, COMPRESSION);
        let knee = KNEE_DISTANCE * self.largest;
        if compressed < knee {
            KNEE_DIFFERENCE * (compressed / knee)
        } else {
            let beyond = (compressed - knee) / (self.largest - knee);
            // Green and blue themselves may round to a little more than the largest distance.
            (KNEE_DIFFERENCE + (1.0 - KNEE_DIFFERENCE) * beyond).min(1.0)
        }
    }
}

/// The Hunt-adjusted L*a*b* of an opponent colour as a display can show it: clamped to the RGB
/// cube, which opponent channels of different blur can leave.
fn displayed_lab(ycxcz: Colour) -> Colour {
    let rgb = apply(&LINEAR_RGB, opponent_to_xyz(ycxcz)).map(|light| light.clamp(0.0, 1.0));
    hunt_lab(apply(&RELATIVE_XYZ, rgb))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The CIE definition: a primary's XYZ is its chromaticity times its luminance, and the
    /// primaries add up to white.
    #[test]
    fn the_matrix_has_the_primaries_and_the_white_point_it_claims() {
        let white = [0.31271 / 0.32902, 1.0, (1.0 - 0.31271 - 0.32902) / 0.32902];
        for (i, (x, y)) in [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)]
            .into_iter()
            .enumerate()
        {
            let [cx, cy, cz] = [0, 1, 2].map(|row| RELATIVE_XYZ[row][i] * white[row]);
            let total = cx + cy + cz;
            assert!((cx / total - x).abs() < 1e-15, "{}", cx / total);
            assert!((cy / total - y).abs() < 1e-15, "{}", cy / total);
        }
    }

    #[test]
    fn the_inverse_undoes_the_matrix() {
        for rgb in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.2, 0.5, 0.9]] {
            let back = apply(&LINEAR_RGB, apply(&RELATIVE_XYZ, rgb));
            for (b, c) in back.iter().zip(rgb) {
                assert!((b - c).abs() < 4e-15);
            }
        }
    }

    #[test]
    fn green_and_blue_are_the_full_range_apart() {
        let [green, blue] =
            [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| opponent(apply(&RELATIVE_XYZ, rgb)));
        let difference = ColourScale::new().difference(green, blue);
        assert!((difference - 1.0).abs() < 1e-14, "{difference}");
    }

    #[test]
    fn the_scale_is_continuous_and_rising() {
        let scale = ColourScale::new();
        let knee = crate::math::pow(KNEE_DISTANCE * scale.largest, 1.0 / COMPRESSION);
        let [below, above] = [0.999_999, 1.000_001].map(|f| scale.of_distance(f * knee));
        assert!(below < KNEE_DIFFERENCE && above > KNEE_DIFFERENCE);
        assert!(above - below < 2e-6);
        assert_eq!(scale.of_distance(0.0), 0.0);
    }
}
