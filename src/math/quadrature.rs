//! Adaptive quadrature over an interval, to a tolerance.
//!
//! Our own, because the bits must be the same everywhere: the available crates compute their nodes
//! with the platform's trigonometry, and do not subdivide where an integrand has a kink.

use super::{self as math, Sum};
use glam::DVec3;
use std::f64::consts::PI;

/// An integral and a bound on its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// The value, by channel.
    pub value: DVec3,
    /// Error bound, summed over the channels; generous for smooth integrands.
    pub error: f64,
}

/// `∫ f(x) dx` from `from` to `to`, both finite, for three channels at once.
///
/// Globally adaptive Gauss–Kronrod quadrature: each piece is integrated by 15 points and by the 7
/// Gauss points among them, whose difference bounds its error; the worst piece is halved until the
/// sum of all errors is at most `tolerance` times the value, or there are `MOST_PIECES`. A kink or
/// jump costs about one halving for each binary digit.
///
/// Source: Piessens et al. 1983, *QUADPACK*, Springer; nodes and weights as in its QK15.
pub fn integrate(mut f: impl FnMut(f64) -> DVec3, from: f64, to: f64, tolerance: f64) -> Integral {
    adaptively(&mut |from, to| piece(&mut f, from, to), from, to, tolerance)
}

/// [`integrate`] by its `piece`. Behind `dyn`, at one call a piece, it is compiled once for all
/// integrands.
fn adaptively(
    piece: &mut dyn FnMut(f64, f64) -> QuadraturePiece,
    from: f64,
    to: f64,
    tolerance: f64,
) -> Integral {
    let mut pieces = vec![piece(from, to)];
    loop {
        let all = total(&pieces);
        if all.error <= tolerance * (all.value.x + all.value.y + all.value.z).abs()
            || pieces.len() >= MOST_PIECES
        {
            return all;
        }
        let worst = (0..pieces.len())
            .max_by(|&a, &b| {
                pieces[a]
                    .integral
                    .error
                    .total_cmp(&pieces[b].integral.error)
            })
            .expect("at least one piece");
        let QuadraturePiece { from, to, .. } = pieces[worst];
        let middle = from + 0.5 * (to - from);
        if !(from < middle && middle < to) {
            // No number lies in between: nothing is left to be cut.
            return all;
        }
        pieces[worst] = piece(from, middle);
        pieces.push(piece(middle, to));
    }
}

/// Enough for sixteen jumps at full precision.
const MOST_PIECES: usize = 1000;

struct QuadraturePiece {
    from: f64,
    to: f64,
    integral: Integral,
}

fn total(pieces: &[QuadraturePiece]) -> Integral {
    let mut sums = [Sum::default(); 4];
    for QuadraturePiece { integral, .. } in pieces {
        let [x, y, z] = integral.value.to_array();
        for (sum, term) in sums.iter_mut().zip([x, y, z, integral.error]) {
            sum.add(term);
        }
    }
    let [x, y, z, error] = sums.map(|sum| sum.value());
    let value = DVec3::new(x, y, z);
    Integral { value, error }
}

/// Distances of the fifteen Kronrod points from the middle, the outermost first; every second is
/// a Gauss point.
const NODES: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_42,
    0.204_432_940_075_298_89,
    0.209_482_141_084_727_82,
];
/// Weights of the Gauss points: of nodes 1, 3, 5 and 7.
const GAUSS: [f64; 4] = [
    0.129_484_966_168_869_7,
    0.279_705_391_489_276_64,
    0.381_830_050_505_118_9,
    0.417_959_183_673_469_4,
];

/// Gauss's seven points on [−1, 1].
pub(crate) const GAUSS_POINTS: [f64; 7] = [
    -NODES[1], -NODES[3], -NODES[5], 0.0, NODES[5], NODES[3], NODES[1],
];
/// Weights of [`GAUSS_POINTS`].
pub(crate) const GAUSS_WEIGHTS: [f64; 7] = [
    GAUSS[0], GAUSS[1], GAUSS[2], GAUSS[3], GAUSS[2], GAUSS[1], GAUSS[0],
];

fn piece(f: &mut impl FnMut(f64) -> DVec3, from: f64, to: f64) -> QuadraturePiece {
    let half = 0.5 * (to - from);
    let middle = from + half;
    let (mut kronrod, mut gauss) = (DVec3::ZERO, DVec3::ZERO);
    for (index, &node) in NODES.iter().enumerate() {
        let at = if node == 0.0 {
            f(middle)
        } else {
            f(middle - half * node) + f(middle + half * node)
        };
        kronrod += at * KRONROD[index];
        if index % 2 == 1 {
            gauss += at * GAUSS[index / 2];
        }
    }
    let difference = (kronrod - gauss).abs();
    QuadraturePiece {
        from,
        to,
        integral: Integral {
            value: kronrod * half,
            error: (difference.x + difference.y + difference.z) * half.abs(),
        },
    }
}

/// Integral over [from, to] of a polynomial of degree at most 3, from two values: the
/// Gauss–Legendre rule. Exact up to rounding, for example for a trilinear density inside one cell,
/// which is a cubic along a straight line.
pub fn cubic_integral(mut function: impl FnMut(f64) -> f64, from: f64, to: f64) -> f64 {
    // The roots of the second Legendre polynomial, ±1/√3, on the unit interval.
    const OFFSET: f64 = 0.288_675_134_594_812_9;
    let length = to - from;
    let (first, second) = (
        from + (0.5 - OFFSET) * length,
        from + (0.5 + OFFSET) * length,
    );
    (function(first) + function(second)) * (length / 2.0)
}

/// Points of Gauss and Legendre's rule on [−1, 1], ascending, with their weights: exact up to degree
/// 2 `count` − 1.
///
/// Roots of the Legendre polynomial, each by Newton's method from `cos(π (i + 3/4)/(count + 1/2))`.
///
/// Source: Davis & Rabinowitz 1984, *Methods of Numerical Integration*, §2.7.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    let root = |i: usize| {
        let mut x = -math::cos(PI * (i as f64 + 0.75) / (n + 0.5));
        let mut slope = 1.0;
        // Five steps double three digits to all of them; one more does no harm.
        for _ in 0..6 {
            let (mut before, mut here) = (1.0, x);
            for degree in 2..=count {
                let k = degree as f64;
                (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
            }
            slope = n * (x * here - before) / (x * x - 1.0);
            x -= here / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(root).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{exp, powu};

    fn scalar(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        integrate(|x| DVec3::splat(f(x)), from, to, 1e-12).value.x
    }

    #[test]
    fn weights_sum_to_the_length() {
        assert!((scalar(|_| 1.0, -3.0, 2.0) - 5.0).abs() < 8.0 * f64::EPSILON);
    }

    /// Fifteen Kronrod points are exact to degree 22, seven Gauss points to 13: a wrong digit
    /// of any node or weight shows.
    #[test]
    fn polynomials_up_to_the_degree_of_the_rule() {
        for degree in [2, 12, 22] {
            let exact = 1.0 / f64::from(degree + 1);
            let value = piece(&mut |x| DVec3::splat(powu(x, degree)), 0.0, 1.0);
            assert!(
                (value.integral.value.x - exact).abs() < 4.0 * f64::EPSILON,
                "{degree}"
            );
            if degree <= 12 {
                assert!(value.integral.error < 8.0 * f64::EPSILON, "{degree}");
            }
        }
    }

    #[test]
    fn peaks_kinks_and_jumps() {
        let peak = |x: f64| 1e-3 / (1e-6 + (x - 0.3) * (x - 0.3));
        // atan(700) + atan(300).
        assert!((scalar(peak, 0.0, 1.0) / 3.136_830_762_145_301_3 - 1.0).abs() < 1e-11);
        assert!((scalar(|x| (x - 0.3).abs(), 0.0, 1.0) - 0.29).abs() < 1e-13);
        let step = |x: f64| if x < 1.0 / 3.0 { 1.0 } else { 0.0 };
        assert!((scalar(step, 0.0, 1.0) - 1.0 / 3.0).abs() < 1e-12);
        assert!((scalar(|x| exp(-x), 0.0, 700.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_is_nothing() {
        assert_eq!(scalar(|_| 0.0, 0.0, 1.0), 0.0);
        assert_eq!(scalar(|x| x, 1.0, 1.0), 0.0);
    }

    #[test]
    fn gauss_and_legendres_rules_are_exact_to_their_degree() {
        for count in [1, 2, 3, 4, 12] {
            let rule = gauss_legendre(count);
            assert!(rule.is_sorted_by(|a, b| a.0 < b.0));
            for degree in 0..2 * count as u32 {
                let found: f64 = rule.iter().map(|(x, w)| w * powu(*x, degree)).sum();
                let right = if degree % 2 == 0 {
                    2.0 / f64::from(degree + 1)
                } else {
                    0.0
                };
                assert!(
                    (found - right).abs() < 32.0 * f64::EPSILON,
                    "{count} {degree}"
                );
            }
        }
    }

    #[test]
    fn the_two_point_rule_is_exact_for_cubics() {
        let cubic = |t: f64| 1.0 + t * (2.0 + t * (3.0 + t * 4.0));
        assert!((cubic_integral(cubic, 0.0, 2.0) - 30.0).abs() <= 30.0 * 4.0 * f64::EPSILON);
        // From −1 to 2: t + t² + t³ + t⁴ is 30 there and 0 here.
        assert!((cubic_integral(cubic, -1.0, 2.0) - 30.0).abs() <= 30.0 * 8.0 * f64::EPSILON);
    }
}
