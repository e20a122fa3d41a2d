//! Pre-integrated classification: segments are classified, not points.
//!
//! Between two samples of a ray the field is taken to run straight from the one value to the
//! other. A sample in the middle sees one value of them all, and a narrow peak of the transfer
//! function may lie beside it. Here the whole segment counts, with extinction
//! `σ(s) = −ln(1 − a(s))/h₀`:
//!
//! ```text
//! opacity    α = 1 − e^(−D),  D = ∫ σ dt over the segment
//! radiance   C = ∫ e(s) σ(s) e^(−τ) dt,  τ the depth from its beginning, e = colour · strength
//! ```
//!
//! The segment weakens its own light, which the two-dimensional tables in use often leave out; and
//! there is no table here, whose entries would have an error of their own. Where the field does
//! run straight between the samples, nothing is left of the step length: one segment is the
//! integral. Shading and the light that arrives are no functions of the value alone; they are the
//! caller's, as factors of the radiance.
//!
//! **Pieces.** Within a piece of the transfer function the colour is a straight line, and so is
//! the opacity, or it is the bell curve of the formula. A segment is cut at the ends of the pieces,
//! and what it sees of each is put together front to back.
//!
//! **Depth** of a segment is its length times the mean of `−ln(1 − a)` over the values in it.
//! Where `1 − a` is a straight line from `x` down to `(1 − q) x`, that mean is `−ln x + ψ(q)`
//! with
//!
//! ```text
//! ψ(q) = Σ_{n ≥ 1} q^n/(n (n + 1)) = 1 + (1 − q) ln(1 − q)/q,  q in [0, 1],  ψ(1) = 1
//! ```
//!
//! and both terms are positive: no digit cancels. A ramp up to opacity 1 has a finite depth. For
//! the bell curve see `Bell`.
//!
//! **Radiance** by parts, with `e` a polynomial along the segment and `x` the share of it behind:
//!
//! ```text
//! ∫ e σ e^(−τ) dt = e(0) α + ∫₀¹ e'(x) (e^(−τ(x)) − e^(−D)) dx
//! ```
//!
//! The extinction, which may be infinite at an end, is gone; constant colours leave no integral; and
//! where there is one it is a sum of integrals of positive numbers, by adaptive quadrature.
//!
//! **Accuracy.** Opacity to some tens of roundings, times `1 + 1/(1 − a)` with `a` the largest
//! opacity at an end of the segment: near opacity 1 the value itself says no more. Radiance to
//! 1e-12 of opacity times the largest emission on the segment, with the same factor.
//!
//! Source: Engel, Kraus & Ertl 2001, "High-quality pre-integrated volume rendering using
//! hardware-accelerated pixel shading", Graphics Hardware 2001, 9–16.

use crate::math::quadrature::integrate;
use crate::math::{exp, exp_m1, ln, ln_1p};
use crate::optics::{
    Appearance, Colormap, TransferFunction, TransferOpacity, TransferPoint, TransferPoints,
    opacity, optical_depth, source_factor, transmittance,
};
use crate::render::classified::compositing::Layers;
use crate::volume::Lerp;
use glam::DVec3;

/// A transfer function, ready for segments.
#[derive(Clone, Debug, PartialEq)]
pub struct Preintegrated {
    transfer: TransferFunction,
    /// By rising value, without gaps.
    pieces: Vec<LinearPiece>,
}

/// A range of values in which the transfer function has no kink.
#[derive(Clone, Copy, Debug, PartialEq)]
struct LinearPiece {
    from: f64,
    to: f64,
    /// At either end, seen from inside.
    colour: [DVec3; 2],
    law: Law,
}

/// How opacity over the reference length depends on the value within a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law {
    /// 1 everywhere.
    Opaque,
    /// Straight from one end to the other.
    Line([f64; 2]),
    /// The formula's, below opacity 1.
    Bell(Bell),
}

impl Preintegrated {
    /// Prepares `transfer`: cuts it into pieces.
    pub fn new(transfer: &TransferFunction) -> Preintegrated {
        let pieces = match &transfer.appearance {
            Appearance::Formula { opacity, colormap } => pieces_of_formula(opacity, colormap),
            Appearance::Points(points) => pieces_of_points(points),
        };
        Preintegrated {
            transfer: transfer.clone(),
            pieces,
        }
    }

    /// What a segment of `length` world units looks like along which the value runs straight from
    /// `front`, nearer to the eye, to `back`: its opacity, and its associated radiance.
    ///
    /// Domain: finite values, for the formula not negative; `length ≥ 0`, finite also in units of
    /// the reference length. Equal values make a homogeneous segment, with the opacity of
    /// [`TransferFunction::opacity`] to the last bit. Where the segment passes an interval of
    /// values of opacity 1 the opacity is 1, and nothing behind its first value is seen.
    pub fn segment(&self, front: f64, back: f64, length: f64) -> Layers {
        let transfer = &self.transfer;
        if length == 0.0 {
            return Layers::default();
        }
        if front == back {
            let opacity = transfer.opacity(front, length);
            let colour = transfer.colour(front) * transfer.emission(front) * opacity;
            return Layers::single(colour, opacity);
        }
        let lengths = length / transfer.reference_length;
        let mut colour = DVec3::ZERO;
        let mut depth = 0.0;
        let mut see = |piece: &LinearPiece, values: [f64; 2]| {
            let share = (values[1] - values[0]).abs() / (back - front).abs();
            let segment = LinearSegment {
                piece,
                values,
                lengths: lengths * share,
            };
            let emission = segment.emission(&transfer.appearance);
            let own = segment.depth(1.0);
            colour += transmittance(depth) * segment.radiance(&emission, own);
            depth += own;
        };
        let [low, high] = [front.min(back), front.max(back)];
        let first = self.pieces.partition_point(|piece| piece.to <= low);
        let last = self.pieces.partition_point(|piece| piece.from < high);
        let touched = &self.pieces[first..last];
        if front < back {
            for piece in touched {
                see(piece, [low.max(piece.from), high.min(piece.to)]);
            }
        } else {
            for piece in touched.iter().rev() {
                see(piece, [high.min(piece.to), low.max(piece.from)]);
            }
        }
        Layers {
            colour,
            opacity: opacity(depth),
            transparency: transmittance(depth),
        }
    }
}

fn pieces_of_points(points: &TransferPoints) -> Vec<LinearPiece> {
    let constant = |point: &TransferPoint, from, to| LinearPiece {
        from,
        to,
        colour: [point.colour; 2],
        law: line(point.opacity, point.opacity),
    };
    let points = points.points();
    let (first, last) = (&points[0], &points[points.len() - 1]);
    let mut pieces = vec![constant(first, f64::NEG_INFINITY, first.value)];
    for pair in points.windows(2) {
        // The sides of a step have no values between them.
        if pair[0].value < pair[1].value {
            pieces.push(LinearPiece {
                from: pair[0].value,
                to: pair[1].value,
                colour: [pair[0].colour, pair[1].colour],
                law: line(pair[0].opacity, pair[1].opacity),
            });
        }
    }
    pieces.push(constant(last, last.value, f64::INFINITY));
    pieces
}

fn line(from: f64, to: f64) -> Law {
    if from == 1.0 && to == 1.0 {
        return Law::Opaque;
    }
    Law::Line([from, to])
}

fn pieces_of_formula(opacity: &TransferOpacity, colormap: &Colormap) -> Vec<LinearPiece> {
    let bell = Bell::new(opacity);
    let end = opaque_from(opacity).min(bell.end);
    let mut cuts = vec![0.0, bell.crossover.min(end), end];
    // What `Bell::mean` asks for.
    let panels = (8.0 * end * end).max(16.0).ceil() as u32;
    cuts.extend((1..panels).map(|panel| end * f64::from(panel) / f64::from(panels)));
    let intervals = colormap.stops().len() - 1;
    let stops = (1..=intervals).map(|stop| stop as f64 / intervals as f64);
    cuts.extend(stops);
    cuts.push(f64::INFINITY);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup();
    let pieces = cuts.windows(2).map(|ends| LinearPiece {
        from: ends[0],
        to: ends[1],
        colour: [colormap.at(ends[0]), colormap.at(ends[1])],
        law: if ends[0] < end {
            Law::Bell(bell)
        } else {
            Law::Opaque
        },
    });
    pieces.collect()
}

/// The least density at which the formula's opacity is 1 as rounded.
fn opaque_from(opacity: &TransferOpacity) -> f64 {
    // e^(−49) is far below half an ulp of 1.
    let (mut below, mut from) = (0.0, 7.0);
    loop {
        let middle = 0.5 * (below + from);
        if !(below < middle && middle < from) {
            return from;
        }
        if opacity.at(middle) < 1.0 {
            below = middle;
        } else {
            from = middle;
        }
    }
}

impl LinearPiece {
    /// Where in the piece `value` lies, in [0, 1]: as [`TransferPoints::opacity`] has it.
    fn share(&self, value: f64) -> f64 {
        let share = (value - self.from) / (self.to - self.from);
        // Only constants have no end.
        if share.is_finite() { share } else { 0.0 }
    }

    /// The mean of `−ln(1 − a)` over the values from `p` to `q`, in either order.
    fn mean_depth(&self, p: f64, q: f64) -> f64 {
        match &self.law {
            Law::Opaque => f64::INFINITY,
            Law::Line([from, to]) => {
                let at = |value| f64::lerp_between(*from, *to, self.share(value));
                let (p, q) = (at(p), at(q));
                mean_of_minus_ln(p.min(q), p.max(q))
            }
            Law::Bell(bell) => bell.mean(p.min(q), p.max(q)),
        }
    }
}

/// The mean of `−ln(1 − a)` for `a` from `low` to `high ≥ low`, in [0, 1].
fn mean_of_minus_ln(low: f64, high: f64) -> f64 {
    if low == 1.0 {
        return f64::INFINITY;
    }
    // Rounding is monotonic: the quotient does not pass 1.
    -ln_1p(-low) + psi((high - low) / (1.0 - low))
}

/// `ψ(q) = 1 + (1 − q) ln(1 − q)/q` for `q` in [0, 1]; to ten roundings.
///
/// From 1/2 on by that form, where `1 − q` is exact and at most 0.69 is taken from 1, leaving 0.30.
/// Below by the series of positive terms, `q^n/(n (n + 1))`: each is less than half the one
/// before, so the sum ends before the 54th.
fn psi(q: f64) -> f64 {
    if q == 1.0 {
        return 1.0;
    }
    if q >= 0.5 {
        return 1.0 + (1.0 - q) * ln_1p(-q) / q;
    }
    let (mut power, mut n, mut sum) = (q, 1.0, 0.0);
    loop {
        let longer = sum + power / (n * (n + 1.0));
        if longer == sum {
            return sum;
        }
        (sum, power, n) = (longer, power * q, n + 1.0);
    }
}

/// The formula's extinction times the reference length, `−ln((e^(−s²) − f)/(1 − f))`, below the
/// density `s* = √(−ln f)` at which it is infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bell {
    floor: f64,
    /// `s*`; infinite for `f = 0`.
    end: f64,
    /// Below, the extinction is evaluated as it is; above, without its infinity.
    crossover: f64,
}

impl Bell {
    fn new(opacity: &TransferOpacity) -> Bell {
        let floor = opacity.floor;
        Bell {
            floor,
            end: (-ln(floor)).sqrt(),
            // Where what is taken from 1 in `smooth_below` is 1/2: e^(s²) = (1 + f)/(2f).
            crossover: ln((1.0 + floor) / (2.0 * floor)).sqrt(),
        }
    }

    /// The mean over the densities from `p` to `q ≥ p`, both within one piece.
    ///
    /// By Gauss and Legendre's rule with eight points, of a function whose nearest singularities
    /// are `s*` for densities below the crossover, and `√(s*² ± 2πi)` above. The crossover is
    /// `ln(2/(1 + f))` divided by the sum of both below `s*`, and pieces are no wider than `s*/16`
    /// and `1/(8 s*)`. In half-widths, the singularities are thus at least 5.8 from the middle of a
    /// piece, at any `f`, and the error falls like `(5.8 + √32.6)^(−16) = 1e-17`.
    fn mean(&self, p: f64, q: f64) -> f64 {
        let half = 0.5 * (q - p);
        let middle = p + half;
        let rule = |f: &dyn Fn(f64) -> f64| -> f64 {
            let pair = |&(node, weight): &(f64, f64)| {
                0.5 * weight * (f(middle - half * node) + f(middle + half * node))
            };
            GAUSS_8.iter().map(pair).sum()
        };
        if q <= self.crossover {
            return rule(&|s| self.smooth_below(s));
        }
        // The infinity is −ln w, w = s* − s, whose mean has the closed form of a line's.
        let far = self.end - p;
        rule(&|s| self.smooth_above(s)) - ln(far) + psi(((q - p) / far).min(1.0))
    }

    /// The extinction, as `s² − ln(1 − f (e^(s²) − 1)/(1 − f))`: positive terms.
    fn smooth_below(&self, s: f64) -> f64 {
        s * s - ln_1p(-self.floor * exp_m1(s * s) / (1.0 - self.floor))
    }

    /// The extinction and `ln(s* − s)`. From `e^(−s²) − f = e^(−s²) (1 − e^(−y))` with
    /// `y = s*² − s² = (s* − s)(s* + s)`, the extinction is `s² + ln(1 − f) − ln(1 − e^(−y))`.
    fn smooth_above(&self, s: f64) -> f64 {
        let sum = self.end + s;
        let y = (self.end - s).max(0.0) * sum;
        s * s + ln_1p(-self.floor) - ln(source_factor(y) * sum)
    }
}

/// Positive nodes and weights of Gauss and Legendre's rule with eight points on [−1, 1].
/// Abramowitz & Stegun, table 25.4.
const GAUSS_8: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// What a segment sees of one piece.
struct LinearSegment<'p> {
    piece: &'p LinearPiece,
    /// In front and at the back.
    values: [f64; 2],
    /// Length in units of the reference length.
    lengths: f64,
}

impl LinearSegment<'_> {
    /// Depth of the share `x` of the segment in front.
    fn depth(&self, x: f64) -> f64 {
        let [front, back] = self.values;
        let value = if x == 1.0 {
            back
        } else {
            f64::lerp_between(front, back, x)
        };
        optical_depth(self.piece.mean_depth(front, value), self.lengths * x)
    }

    /// Colour times strength along the segment: coefficients of the powers of `x`.
    fn emission(&self, appearance: &Appearance) -> [DVec3; 4] {
        let [front, back] = self.values;
        let [from, to] = self.piece.colour;
        let colour = |value| DVec3::lerp_between(from, to, self.piece.share(value));
        let (start, rise) = (colour(front), colour(back) - colour(front));
        match appearance {
            Appearance::Points(_) => [start, rise, DVec3::ZERO, DVec3::ZERO],
            Appearance::Formula { .. } => {
                // (s + dx)² (c + gx).
                let (s, d) = (front, back - front);
                [
                    start * (s * s),
                    start * (2.0 * s * d) + rise * (s * s),
                    start * (d * d) + rise * (2.0 * s * d),
                    rise * (d * d),
                ]
            }
        }
    }

    /// Associated radiance, given the emission and the depth of the whole segment.
    fn radiance(&self, emission: &[DVec3; 4], depth: f64) -> DVec3 {
        let [start, slope, ..] = *emission;
        if depth == 0.0 {
            return DVec3::ZERO;
        }
        let constant = emission[1..].iter().all(|&power| power == DVec3::ZERO);
        if depth == f64::INFINITY || constant {
            return start * opacity(depth);
        }
        let reach = self.reach(depth);
        // e^(−τ) − e^(−D), times 1, x and x².
        let moments = |x: f64| {
            let before = self.depth(x);
            let seen = exp(-before) * opacity((depth - before).max(0.0));
            DVec3::new(1.0, x, x * x) * seen
        };
        let moments = integrate(moments, 0.0, reach, TOLERANCE).value;
        start * opacity(depth)
            + slope * moments.x
            + emission[2] * (2.0 * moments.y)
            + emission[3] * (3.0 * moments.z)
    }

    /// Up to which share of the segment there is anything to be seen. Beyond a depth of `UNSEEN`
    /// there is not, and quadrature from there on might step over what is before.
    fn reach(&self, depth: f64) -> f64 {
        if depth <= UNSEEN {
            return 1.0;
        }
        let (mut seen, mut unseen) = (0.0, 1.0);
        // An eighth more than needed does no harm.
        while unseen - seen > 0.125 * unseen {
            let middle = 0.5 * (seen + unseen);
            if self.depth(middle) < UNSEEN {
                seen = middle;
            } else {
                unseen = middle;
            }
        }
        unseen
    }
}

/// Of the mean of positive numbers, relative.
const TOLERANCE: f64 = 1e-13;

/// `e^(−40) = 4e-18`: what lies behind so great a depth is less than a rounding.
const UNSEEN: f64 = 40.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn points(points: &[(f64, f64, DVec3)]) -> TransferFunction {
        let point = |&(value, opacity, colour): &(f64, f64, DVec3)| TransferPoint {
            value,
            colour,
            opacity,
        };
        TransferFunction {
            appearance: Appearance::Points(
                TransferPoints::new(points.iter().map(point).collect()).unwrap(),
            ),
            reference_length: 0.5,
        }
    }

    fn formula(floor: f64, colormap: &str) -> TransferFunction {
        TransferFunction {
            appearance: Appearance::Formula {
                opacity: TransferOpacity { floor },
                colormap: Colormap::named(colormap).unwrap(),
            },
            reference_length: 1.0,
        }
    }

    #[track_caller]
    fn assert_relative(value: f64, expected: f64, bound: f64) {
        let off = (value - expected).abs();
        assert!(off <= bound * expected.abs(), "{value:e} {expected:e}");
    }

    const RED: DVec3 = DVec3::new(1.0, 0.0, 0.0);
    const GREEN: DVec3 = DVec3::new(0.0, 2.0, 0.0);

    #[test]
    fn psi_by_either_form() {
        assert_eq!((psi(0.0), psi(1.0)), (0.0, 1.0));
        assert_eq!(psi(1e-300), 5e-301);
        let closed = |q: f64| 1.0 + (1.0 - q) * ln_1p(-q) / q;
        // Four roundings of 1.4 before the subtraction, of which a share 1/ψ is left.
        for i in 1..100 {
            let q = f64::from(i) * 0.005;
            assert!((psi(q) - closed(q)).abs() <= 4.0 * f64::EPSILON, "{q}");
        }
        assert_relative(psi(0.5_f64.next_down()), psi(0.5), 5.0 * f64::EPSILON);
        assert_relative(psi(0.5), 1.0 - core::f64::consts::LN_2, 5.0 * f64::EPSILON);
    }

    /// Eight points are exact to degree 15: a wrong digit of any node or weight shows.
    #[test]
    fn the_rule_of_eight_points() {
        for degree in (0..=14).step_by(2) {
            let pair = |&(node, weight): &(f64, f64)| weight * crate::math::powu(node, degree);
            let sum: f64 = GAUSS_8.iter().map(pair).sum();
            let exact = 1.0 / f64::from(degree + 1);
            assert!((sum - exact).abs() <= 4.0 * f64::EPSILON, "{degree}");
        }
    }

    #[test]
    fn nothing_over_no_length() {
        let table = Preintegrated::new(&points(&[(0.0, 1.0, RED)]));
        assert_eq!(table.segment(-1.0, 3.0, 0.0), Layers::default());
        assert_eq!(table.segment(1.0, 1.0, 0.0), Layers::default());
    }

    #[test]
    fn equal_values_are_a_homogeneous_segment() {
        for transfer in [
            points(&[(0.0, 0.0, RED), (1.0, 1.0, GREEN), (2.0, 0.5, RED)]),
            formula(0.36, "heat"),
        ] {
            let prepared = Preintegrated::new(&transfer);
            for i in 0..=30 {
                let value = f64::from(i) * 0.1;
                let opacity = transfer.opacity(value, 0.3);
                let colour = transfer.colour(value) * transfer.emission(value) * opacity;
                let expected = Layers::single(colour, opacity);
                assert_eq!(prepared.segment(value, value, 0.3), expected);
                // And next to it: the depth follows from values that differ by roundings.
                let next = prepared.segment(value, value.next_up(), 0.3);
                let bound = 1e-13 * (1.0 + 1.0 / (1.0 - transfer.reference_opacity(value)));
                assert!((next.opacity - opacity).abs() <= bound * opacity.max(f64::MIN_POSITIVE));
            }
        }
    }

    /// A ramp from 0 to 1 has depth `∫₀¹ −ln(1 − a) da = 1`.
    #[test]
    fn a_ramp_to_opacity_one_is_not_opaque() {
        let transfer = points(&[(0.0, 0.0, RED), (1.0, 1.0, RED), (2.0, 0.0, RED)]);
        let prepared = Preintegrated::new(&transfer);
        for (front, back, depth) in [(0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (-1.0, 3.0, 0.5)] {
            let found = prepared.segment(front, back, 0.5);
            // Half of the last segment lies on the ramps.
            assert_relative(found.opacity, opacity(depth), 4.0 * f64::EPSILON);
            assert_relative(found.colour.x, opacity(depth), 4.0 * f64::EPSILON);
        }
        assert_eq!(prepared.segment(1.0, 1.0, 0.5).opacity, 1.0);
    }

    #[test]
    fn opaque_values_hide_what_is_behind() {
        let transfer = points(&[
            (0.0, 0.0, RED),
            (0.0, 0.75, RED),
            (1.0, 0.75, RED),
            (1.0, 1.0, GREEN),
            (2.0, 1.0, RED),
        ]);
        let prepared = Preintegrated::new(&transfer);
        // Half of four reference lengths at 0.75: a depth of 2 ln 4, and then green.
        let found = prepared.segment(0.0, 2.0, 2.0);
        assert_eq!(found.opacity, 1.0);
        let transmittance = 1.0 / 16.0;
        assert_relative(found.colour.x, 1.0 - transmittance, 4.0 * f64::EPSILON);
        assert_relative(found.colour.y, 2.0 * transmittance, 16.0 * f64::EPSILON);
        // From the other side it begins with what is opaque.
        let back = prepared.segment(1.5, 0.0, 2.0);
        assert_eq!(back, Layers::single(transfer.colour(1.5), 1.0));
        // Ending on the edge is not passing it.
        assert!(prepared.segment(0.0, 1.0, 2.0).opacity < 1.0);
    }

    /// With `f = 0` the extinction is `s²`: a depth of `∫ s² = (q³ − p³)/3 / (q − p)`.
    #[test]
    fn the_formula_without_a_floor() {
        let prepared = Preintegrated::new(&formula(0.0, "white"));
        for (front, back) in [(0.0, 1.0), (0.1, 0.2), (2.0, 0.5), (1e-8, 3e-8), (5.0, 6.0)] {
            let depth = (front * front + front * back + back * back) / 3.0 * 0.25;
            let found = prepared.segment(front, back, 0.25);
            // Sums of a few hundred positive terms that are roundings off, partial sums at random.
            assert_relative(found.opacity, opacity(depth), 1e-14);
        }
    }

    /// The formula's pieces against adaptive quadrature of its extinction as the renderer has it,
    /// `−ln1p(−a)`, which has `u/(1 − a)` of error: segments end where that is below 1e-13.
    #[test]
    fn depth_of_the_formula() {
        for floor in [0.0, 1e-300, 1e-12, 1e-3, 0.36, 0.9, 0.999] {
            let transfer = formula(floor, "viridis");
            let bell = TransferOpacity { floor };
            let mut end = opaque_from(&bell);
            while bell.at(end) > 0.998 {
                end *= 0.99;
            }
            let prepared = Preintegrated::new(&transfer);
            for (front, back) in [(0.0, end), (0.3 * end, 0.9 * end), (end, 0.5 * end)] {
                let extinction = |s: f64| DVec3::splat(-ln_1p(-bell.at(s)));
                let (low, high): (f64, f64) = (front.min(back), front.max(back));
                let whole = integrate(extinction, low, high, 1e-13).value.x;
                let depth = whole / (high - low) * 0.01;
                let found = prepared.segment(front, back, 0.01);
                assert_relative(found.opacity, opacity(depth), 2e-13);
            }
        }
    }

    /// Up to where the opacity rounds to 1, next to the infinity of the extinction: with
    /// `s = s* − y⁴` the integrand of the quadrature is smooth enough.
    #[test]
    fn up_to_the_end_of_the_formula() {
        for floor in [0.36, 1e-6] {
            let transfer = formula(floor, "heat");
            let prepared = Preintegrated::new(&transfer);
            let end = (-ln(floor)).sqrt();
            let extinction = |y: f64| {
                let w = y * y * y * y;
                // e^(−s²) − f with its digits: f expm1(s*² − s²).
                let clear = floor * exp_m1(w * (2.0 * end - w)) / (1.0 - floor);
                DVec3::splat(-ln(clear) * 4.0 * y * y * y)
            };
            let last = opaque_from(&TransferOpacity { floor }).next_down();
            let near = (end - last).max(0.0).sqrt().sqrt();
            let depth = integrate(extinction, near, end.sqrt().sqrt(), 1e-13);
            let depth = depth.value.x / last * 0.1;
            let found = prepared.segment(0.0, last, 0.1);
            assert_relative(found.opacity, opacity(depth), 1e-12);
            assert_eq!(prepared.segment(0.0, 2.0 * end, 0.1).opacity, 1.0);
        }
    }
}
