//! The field of a grid along a line: a cubic from face to face of its cells.

use crate::geometry::Span;

/// The field on a segment of a line within one cell: a cubic of the position `u`, which goes from
/// −1 at the near end of the segment to 1 at the far one.
///
/// The trilinear interpolant is linear in each of three coordinates, and these are linear along the
/// line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicSegment {
    /// The segment, in world units along the line.
    pub span: Span,
    /// Coefficients of 1, u, u² and u³.
    pub coefficients: [f64; 4],
}

/// Largest number of steps of Newton's method. Towards a root of a flat cubic, `u³`, each shortens
/// the way by a third: 91 leave less than 2^-53 of it.
const MOST_STEPS: usize = 100;

impl CubicSegment {
    /// The field at `u` in [−1, 1].
    #[inline]
    pub fn at(&self, u: f64) -> f64 {
        let [a, b, c, d] = self.coefficients;
        a + u * (b + u * (c + u * d))
    }

    /// The distance along the line at `u`.
    pub fn distance(&self, u: f64) -> f64 {
        if u < 1.0 {
            self.span.near + 0.5 * (1.0 + u) * self.span.length()
        } else {
            self.span.far
        }
    }

    /// The slope by `u`.
    fn slope(&self, u: f64) -> f64 {
        let [_, b, c, d] = self.coefficients;
        b + u * (2.0 * c + u * (3.0 * d))
    }

    /// The least and the largest value.
    pub fn extremes(&self) -> [f64; 2] {
        let fields = self.turns().map(|u| self.at(u));
        let least = fields.into_iter().fold(f64::INFINITY, f64::min);
        [least, fields.into_iter().fold(f64::NEG_INFINITY, f64::max)]
    }

    /// The integral along the segment, by world units.
    pub fn integral(&self) -> f64 {
        let [a, _, c, _] = self.coefficients;
        (a + c / 3.0) * self.span.length()
    }

    /// −1, 1, and between them the places where the field is the highest or lowest around: between
    /// two of the four it rises or falls. Missing ones are 1.
    pub fn turns(&self) -> [f64; 4] {
        let [_, b, c, d] = self.coefficients;
        // Roots of 3d u² + 2c u + b, in the form that subtracts no two numbers of one sign.
        let root = (c * c - 3.0 * d * b).max(0.0).sqrt();
        let q = -(c + root.copysign(c));
        let inside = |u: f64| if u > -1.0 && u < 1.0 { u } else { 1.0 };
        // A quotient that is none belongs to a field without turns.
        let (first, second) = (inside(q / (3.0 * d)), inside(b / q));
        [-1.0, first.min(second), first.max(second), 1.0]
    }

    /// Adds to `cuts` the two ends and, between them, the places where the field passes one of
    /// `values`, which rise; all in order.
    pub(crate) fn cut_at(&self, values: &[f64], cuts: &mut Vec<f64>) {
        let turns = self.turns();
        let fields = turns.map(|u| self.at(u));
        cuts.push(-1.0);
        for (u, field) in turns.windows(2).zip(fields.windows(2)) {
            let (least, most) = (field[0].min(field[1]), field[0].max(field[1]));
            // Values above the lower end and not above the upper one.
            let above = |bound: f64| values.partition_point(|&value| value <= bound);
            let passed = &values[above(least)..above(most)];
            let rises = field[0] < field[1];
            let crossing = |value: &f64| self.crossing(*value, rises, [u[0], u[1]]);
            if rises {
                cuts.extend(passed.iter().map(crossing));
            } else {
                cuts.extend(passed.iter().rev().map(crossing));
            }
        }
        cuts.push(1.0);
    }

    /// Where the field passes `value` between two of its turns, by Newton's method, which is kept
    /// between places on either side; an end, if it does not.
    pub fn crossing(&self, value: f64, rises: bool, [mut from, mut to]: [f64; 2]) -> f64 {
        let mut u = from + 0.5 * (to - from);
        for _ in 0..MOST_STEPS {
            let excess = self.at(u) - value;
            if (excess < 0.0) == rises {
                from = u;
            } else {
                to = u;
            }
            let newton = u - excess / self.slope(u);
            let next = if from <= newton && newton <= to {
                newton
            } else {
                from + 0.5 * (to - from)
            };
            // A rounding of the longest `u`.
            if (next - u).abs() <= f64::EPSILON {
                return next;
            }
            u = next;
        }
        u
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cubic(coefficients: [f64; 4]) -> CubicSegment {
        CubicSegment {
            span: Span::new(0.0, 1.0),
            coefficients,
        }
    }

    fn cuts(coefficients: [f64; 4], values: &[f64]) -> Vec<f64> {
        let mut cuts = Vec::new();
        cubic(coefficients).cut_at(values, &mut cuts);
        cuts
    }

    #[test]
    fn a_constant_passes_nothing() {
        assert_eq!(cuts([0.5, 0.0, 0.0, 0.0], &[0.5, 0.7]), [-1.0, 1.0]);
    }

    #[test]
    fn a_line_passes_each_value_once_in_order() {
        for sign in [1.0, -1.0] {
            let cuts = cuts([0.0, sign, 0.0, 0.0], &[-3.0, -0.5, 0.25, 0.5, 3.0]);
            let right = match sign {
                1.0 => [-1.0, -0.5, 0.25, 0.5, 1.0],
                _ => [-1.0, -0.5, -0.25, 0.5, 1.0],
            };
            assert_eq!(cuts, right);
        }
    }

    /// (u + 0.9) (u − 0.1) (u − 0.6) and a parabola, through 0 and beside it.
    #[test]
    fn every_passage_is_found() {
        let found = cuts([0.054, -0.57, 0.2, 1.0], &[0.0]);
        for (found, right) in found.iter().zip([-1.0, -0.9, 0.1, 0.6, 1.0]) {
            assert!((found - right).abs() < 4.0 * f64::EPSILON, "{found}");
        }
        assert_eq!(found.len(), 5);
        assert_eq!(cuts([1e-3, 0.0, 1.0, 0.0], &[0.0]), [-1.0, 1.0]);
        let found = cuts([-0.25, 0.0, 1.0, 0.0], &[0.0]);
        assert_eq!(found, [-1.0, -0.5, 0.5, 1.0]);
        // Flat at its root, where Newton's method is slow.
        let found = cuts([0.0, 0.0, 0.0, 1.0], &[0.0]);
        assert!(found.len() == 3 && found[1].abs() < 1e-15, "{found:?}");
    }

    /// Against the signs of the field at many places, for cubics of every kind.
    #[test]
    fn between_two_cuts_no_value_is_passed() {
        use crate::math::rng::philox4x32_10;
        let values = [-0.5, -0.1, 0.0, 0.2, 0.6];
        let mut passages = 0;
        for number in 0..2000 {
            let numbers = philox4x32_10([number, 0, 0, 0], [3, 0]);
            let coefficients = numbers.map(|n| f64::from(n) / 2_147_483_648.0 - 1.0);
            let cubic = cubic(coefficients);
            let cuts = cuts(coefficients, &values);
            passages += cuts.len() - 2;
            for piece in cuts.windows(2) {
                assert!(piece[0] <= piece[1], "{coefficients:?}: {cuts:?}");
                let place = |i: u32| piece[0] + (piece[1] - piece[0]) * (f64::from(i) + 0.5) / 50.0;
                for value in values {
                    let excess = |i: u32| cubic.at(place(i)) - value;
                    // A turn may touch a value but for a few roundings.
                    let above = (0..50).any(|i| excess(i) > 1e-14);
                    let below = (0..50).any(|i| excess(i) < -1e-14);
                    assert!(!(above && below), "{coefficients:?}: {cuts:?}, {value}");
                }
            }
        }
        assert!(passages > 2000, "{passages}");
    }
}
