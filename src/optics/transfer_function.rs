//! The classifier: opacity and colour of a value of the field.

use super::{Colormap, TransferOpacity, TransferPoints, over_length};
use crate::math::ln_1p;
use glam::DVec3;

/// Maps a value of the field to opacity and colour.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Opacity over the reference length, and colour, by value.
    pub appearance: Appearance,
    /// Path length `h0` over which opacity is stated, world units, > 0.
    pub reference_length: f64,
}

/// The two ways of saying what a value looks like.
#[derive(Clone, Debug, PartialEq)]
pub enum Appearance {
    /// The formula of the ray-casting assignment, for densities `≥ 0`.
    Formula {
        /// Opacity by density.
        opacity: TransferOpacity,
        /// Colour by density.
        colormap: Colormap,
        /// Values, in order, that are densities 0 and 1: see [`TransferFunction::density`]. Without it, values
        /// are densities.
        range: Option<[f64; 2]>,
    },
    /// A table of points, for any values: those of a scan may be negative.
    Points(TransferPoints),
}

impl TransferFunction {
    /// Opacity over a step of `length` world units at `value`: `1 − (1 − a)^(length/h0)`.
    // Always: asked once a sample, as is the colour, a call would be no small part of its cost.
    #[inline(always)]
    pub fn opacity(&self, value: f64, length: f64) -> f64 {
        over_length(
            self.reference_opacity(value),
            length / self.reference_length,
        )
    }

    /// Density of the formula at `value`: of a range, the position in it, in [0, 1]. For a table it is the value.
    #[inline(always)]
    pub fn density(&self, value: f64) -> f64 {
        match self.appearance {
            Appearance::Formula {
                range: Some([low, high]),
                ..
            } => ((value - low) / (high - low)).clamp(0.0, 1.0),
            _ => value,
        }
    }

    /// The values between which looks change, in a volume of values up to `most`.
    pub(crate) fn domain(&self, most: f64) -> [f64; 2] {
        match &self.appearance {
            Appearance::Formula { range, .. } => range.unwrap_or([0.0, most]),
            Appearance::Points(points) => {
                let points = points.points();
                [points[0].value, points[points.len() - 1].value]
            }
        }
    }

    /// Opacity `a` over the reference length at `value`.
    #[inline(always)]
    pub fn reference_opacity(&self, value: f64) -> f64 {
        match &self.appearance {
            Appearance::Formula { opacity, .. } => opacity.at(self.density(value)),
            Appearance::Points(points) => points.opacity(value),
        }
    }

    /// Extinction at `value`, per world unit: `−ln(1 − a)/h0`; infinite for an opacity of 1.
    pub fn extinction(&self, value: f64) -> f64 {
        self.extinction_of(self.reference_opacity(value))
    }

    /// Extinction of an `opacity` over the reference length, per world unit.
    pub(crate) fn extinction_of(&self, opacity: f64) -> f64 {
        // Not −0 where it is transparent.
        (-ln_1p(-opacity)).abs() / self.reference_length
    }

    /// Colour of the material.
    #[inline(always)]
    pub fn colour(&self, value: f64) -> DVec3 {
        match &self.appearance {
            Appearance::Formula { colormap, .. } => colormap.at(self.density(value)),
            Appearance::Points(points) => points.colour(value),
        }
    }

    /// Both [reference opacity](TransferFunction::reference_opacity) and
    /// [colour](TransferFunction::colour).
    #[inline(always)]
    pub fn look(&self, value: f64) -> (f64, DVec3) {
        match &self.appearance {
            Appearance::Formula {
                opacity, colormap, ..
            } => {
                let density = self.density(value);
                (opacity.at(density), colormap.at(density))
            }
            Appearance::Points(points) => points.look(value),
        }
    }

    /// Emission of a sample before its colour and shading: `d²` by the formula.
    /// That belongs to the assignment and to densities; the colours of a table are radiances as
    /// they stand, so there it is 1.
    pub fn emission(&self, value: f64) -> f64 {
        match &self.appearance {
            Appearance::Formula { .. } => {
                let density = self.density(value);
                density * density
            }
            Appearance::Points(_) => 1.0,
        }
    }

    /// No channel of a colour is above this; colormaps end at 1.
    pub fn brightest_colour(&self) -> f64 {
        match &self.appearance {
            Appearance::Formula { .. } => 1.0,
            Appearance::Points(points) => points.brightest(),
        }
    }

    /// The values, in order, between which opacity, colour and emission are smooth.
    pub fn knots(&self) -> Vec<f64> {
        let mut knots: Vec<f64> = match &self.appearance {
            Appearance::Points(points) => points.points().iter().map(|point| point.value).collect(),
            Appearance::Formula {
                opacity,
                colormap,
                range,
            } => {
                let stops = colormap.stops().len();
                let last = (stops - 1).max(1) as f64;
                let mut knots: Vec<f64> = (0..stops).map(|stop| stop as f64 / last).collect();
                // In a range there are no densities above 1, from which on all is constant.
                match range {
                    None => knots.extend(opacity.opaque_from()),
                    Some([low, high]) => {
                        knots.extend([0.0, 1.0]);
                        knots.extend(opacity.opaque_from().filter(|&density| density < 1.0));
                        let value = |density: &mut f64| *density = low + (high - low) * *density;
                        knots.iter_mut().for_each(value);
                    }
                }
                knots
            }
        };
        knots.sort_unstable_by(f64::total_cmp);
        knots.dedup();
        knots
    }

    /// Whether opacity is exactly 0 wherever the field lies between nodes with values from
    /// `least` to `most`, both finite and, for the formula, not negative.
    pub(crate) fn is_transparent_between(&self, least: f64, most: f64) -> bool {
        match &self.appearance {
            // Opacity rises with density, so the largest decides; it is 0 for density 0 only, which no rounding
            // exceeds between zeros.
            Appearance::Formula {
                opacity,
                range: None,
                ..
            } => opacity.at(most) == 0.0,
            Appearance::Formula { .. } => {
                self.reference_opacity(most + interpolation_slack(least, most)) == 0.0
            }
            Appearance::Points(points) => {
                let slack = interpolation_slack(least, most);
                points.is_transparent_between(least - slack, most + slack)
            }
        }
    }

    /// Whether any value from `least` to `most` has opacity 0: if not, no place in the volume is
    /// transparent.
    pub(crate) fn may_be_transparent_between(&self, least: f64, most: f64) -> bool {
        match &self.appearance {
            Appearance::Formula { .. } => self.reference_opacity(least) == 0.0,
            Appearance::Points(points) => points.may_be_transparent_between(least, most),
        }
    }
}

/// How far rounding can take a trilinear interpolant out of the interval of its nodes, at most.
///
/// One interpolation `a + (b − a)·t`, `t` in [0, 1], passes `b` by no more than `2u·|b − a|`:
/// rounding is monotonic, so the product is at most the rounded difference, which is off by
/// `u·|b − a|`; the sum of that and `a` then rounds to `b`, or beyond it by no more than it
/// already was. There are three in a row, each over an interval wider by that much: below
/// `7u·|most − least|`. Equal nodes give exactly their value.
fn interpolation_slack(least: f64, most: f64) -> f64 {
    4.0 * f64::EPSILON * (most - least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::Lerp;

    fn table(points: &[(f64, f64)]) -> TransferFunction {
        let point = |&(value, opacity)| super::super::TransferPoint {
            value,
            colour: DVec3::ONE,
            opacity,
        };
        TransferFunction {
            appearance: Appearance::Points(
                TransferPoints::new(points.iter().map(point).collect()).unwrap(),
            ),
            reference_length: 2.0,
        }
    }

    #[test]
    fn a_step_lets_the_share_of_its_length_through() {
        let table = table(&[(-1.0, 0.0), (1.0, 0.75)]);
        assert_eq!(table.reference_opacity(1.0), 0.75);
        assert_eq!(table.opacity(1.0, 2.0), 0.75);
        assert!((table.opacity(1.0, 1.0) - 0.5).abs() <= f64::EPSILON);
        assert_eq!(table.opacity(-1.0, 1.0), 0.0);
        assert_eq!(table.emission(-1000.0), 1.0);
    }

    /// Values look as their positions in the range do, and as its ends beyond them.
    #[test]
    fn a_range_maps_values_to_densities() {
        let formula = |range| TransferFunction {
            appearance: Appearance::Formula {
                opacity: TransferOpacity { floor: 0.36 },
                colormap: Colormap::named("heat").unwrap(),
                range,
            },
            reference_length: 2.0,
        };
        let (mapped, plain) = (formula(Some([-1000.0, 1048.0])), formula(None));
        for (value, density) in [
            (-1e30, 0.0),
            (-1000.0, 0.0),
            (-488.0, 0.25),
            (24.0, 0.5),
            (1048.0, 1.0),
            (1e30, 1.0),
        ] {
            assert_eq!(mapped.look(value), plain.look(density));
            assert_eq!(mapped.emission(value), plain.emission(density));
        }
        assert_eq!(mapped.knots(), [-1000.0, -488.0, 24.0, 536.0, 1048.0]);
        assert!(mapped.is_transparent_between(-2000.0, -1001.0));
        assert!(!mapped.is_transparent_between(-2000.0, -999.0));
        assert!(mapped.may_be_transparent_between(-1000.0, 5.0));
        assert!(!mapped.may_be_transparent_between(-999.0, 5.0));
    }

    /// The interval of the nodes is not quite that of the field between them.
    #[test]
    fn rounding_of_the_interpolation_is_allowed_for() {
        let clear = table(&[(0.3, 0.0), (0.3, 1.0)]);
        let below = 0.3 - f64::EPSILON;
        assert!(clear.is_transparent_between(0.1, 0.2));
        assert!(clear.is_transparent_between(below, below));
        assert!(!clear.is_transparent_between(-0.9, below));

        let (mut beyond, mut farthest) = (0, 0.0_f64);
        for i in 0..200_000_u32 {
            let number = |salt: u32| {
                let bits = i.wrapping_mul(2_654_435_761).wrapping_add(salt);
                let bits = bits.wrapping_mul(2_246_822_519) ^ (bits >> 15);
                // A third, so that differences round.
                (f64::from(bits) / 2_147_483_648.0 - 1.0) / 3.0
            };
            let (a, b) = (number(1), number(77));
            let value = f64::lerp_between(a, b, 1.0);
            let passed = if b > a { value - b } else { b - value };
            assert!(passed <= interpolation_slack(a.min(b), a.max(b)));
            beyond += usize::from(passed > 0.0);
            farthest = farthest.max(passed);
        }
        assert!(beyond > 0 && farthest > 0.0, "the slack is needed");
    }
}
