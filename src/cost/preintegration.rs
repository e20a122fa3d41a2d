//! Pre-integrated classification: segments are classified, not points.
//!
//! Between two samples of a ray the field is taken to run straight from the one value to the other. A
//! sample in the middle sees one value of them all, and a narrow peak of the transfer function may lie
//! beside it. Here the whole segment counts: its light is that of the integral of emission and
//! absorption, by [collocation](crate::optics::collocation) between the knots of the transfer function.
//!
//! The segment weakens its own light, which the two-dimensional tables in use often leave out; and
//! there is no table here, whose entries would have an error of their own. Where the field does run
//! straight between the samples, nothing is left of the step length: one segment is the integral.
//! Shading and the light that arrives are no functions of the value alone; they are the caller's, as
//! factors of the radiance.
//!
//! Source: Engel, Kraus & Ertl 2001, "High-quality pre-integrated volume rendering using
//! hardware-accelerated pixel shading", Graphics Hardware 2001, 9–16.

use crate::optics::collocation::{Collocation, LocalProperties};
use crate::optics::{TransferFunction, opacity, transmittance};
use crate::render::classified::compositing::Layers;

/// Accuracy of each element of the integral, for a radiance of 1: far below that of any step.
const TOLERANCE: f64 = 1e-13;

/// A transfer function, ready for segments.
#[derive(Clone, Debug)]
pub struct Preintegrated<'t> {
    transfer: &'t TransferFunction,
    knots: Vec<f64>,
    collocation: Collocation,
}

impl Preintegrated<'_> {
    /// Prepares `transfer`.
    pub fn new(transfer: &TransferFunction) -> Preintegrated<'_> {
        Preintegrated {
            transfer,
            knots: transfer.knots(),
            collocation: Collocation::new(),
        }
    }

    /// Opacity and associated radiance of a segment of `length` world units along which the value runs straight
    /// from `front`, nearer to the eye, to `back`.
    ///
    /// Domain: finite values, for the formula not negative; `length ≥ 0`, finite also in units of
    /// the reference length. Equal values make a homogeneous segment, with the opacity of
    /// [`TransferFunction::opacity`] to the last bit. Where the segment passes an interval of
    /// values of opacity 1 the opacity is 1, and nothing behind its first value is seen. Where a ramp
    /// ends at opacity 1, at an infinite extinction, opacity and radiance are off by 1e-13 for each
    /// such end; elsewhere by roundings.
    pub fn segment(&self, front: f64, back: f64, length: f64) -> Layers {
        let transfer = self.transfer;
        let source = |value: f64| transfer.colour(value) * transfer.emission(value);
        if length == 0.0 {
            return Layers::default();
        }
        if front == back {
            let opacity = transfer.opacity(front, length);
            return Layers::single(source(front) * opacity, opacity);
        }
        // The share of the segment before each knot that it passes.
        let rise = back - front;
        let passed = self.knots.iter().map(|knot| (knot - front) / rise);
        let mut cuts: Vec<f64> = passed.filter(|share| (0.0..1.0).contains(share)).collect();
        cuts.extend([0.0, 1.0]);
        cuts.sort_unstable_by(f64::total_cmp);
        let light = self.collocation.light(&cuts, TOLERANCE, |share| {
            let value = front + rise * share;
            LocalProperties::with_source(transfer.extinction(value) * length, source(value))
        });
        Layers {
            colour: light.radiance,
            opacity: opacity(light.depth),
            transparency: transmittance(light.depth),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::integrate;
    use crate::math::{exp_m1, ln, ln_1p};
    use crate::optics::{Appearance, Colormap, TransferOpacity, TransferPoint, TransferPoints};
    use glam::DVec3;

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
                range: None,
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
    fn nothing_over_no_length() {
        let transfer = points(&[(0.0, 1.0, RED)]);
        let table = Preintegrated::new(&transfer);
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
            // Half of the last segment lies on the ramps. Two ends, of depths above 0.1.
            assert_relative(found.opacity, opacity(depth), 20.0 * TOLERANCE);
            assert_relative(found.colour.x, opacity(depth), 20.0 * TOLERANCE);
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
        assert_relative(found.colour.x, 1.0 - transmittance, 10.0 * TOLERANCE);
        assert_relative(found.colour.y, 2.0 * transmittance, 10.0 * TOLERANCE);
        // From the other side it begins with what is opaque.
        let back = prepared.segment(1.5, 0.0, 2.0);
        assert_eq!(back.opacity, 1.0);
        let off = (back.colour - transfer.colour(1.5)).abs().max_element();
        assert!(off <= 10.0 * TOLERANCE, "{back:?}");
        // Ending on the edge is not passing it.
        assert!(prepared.segment(0.0, 1.0, 2.0).opacity < 1.0);
    }

    /// With `f = 0` the extinction is `s²`: a depth of `∫ s² = (q³ − p³)/3 / (q − p)`.
    #[test]
    fn the_formula_without_a_floor() {
        let transfer = formula(0.0, "white");
        let prepared = Preintegrated::new(&transfer);
        for (front, back) in [(0.0, 1.0), (0.1, 0.2), (2.0, 0.5), (1e-8, 3e-8)] {
            let depth = (front * front + front * back + back * back) / 3.0 * 0.25;
            let found = prepared.segment(front, back, 0.25);
            // Sums of a few hundred positive terms that are roundings off, partial sums at random.
            assert_relative(found.opacity, opacity(depth), 1e-14);
        }
    }

    /// The formula against adaptive quadrature of its extinction as the renderer has it, `−ln1p(−a)`,
    /// which has `u/(1 − a)` of error: segments end where that is below 1e-13.
    #[test]
    fn depth_of_the_formula() {
        for floor in [0.0, 1e-300, 1e-12, 1e-3, 0.36, 0.9, 0.999] {
            let transfer = formula(floor, "viridis");
            let bell = TransferOpacity { floor };
            let mut end = bell.opaque_from().unwrap_or(7.0);
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
    /// `s = s* − y⁴` the integrand of the quadrature is smooth enough. At a distance `w` from the end
    /// `1 − a` is `w` times the slope of `a`, and known to `u`: the depth is off by `u ∫ dw/w = 36 u`
    /// over the slope.
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
            let bell = TransferOpacity { floor };
            let mut last = end;
            while bell.at(last) == 1.0 {
                last = last.next_down();
            }
            let near = (end - last).max(0.0).sqrt().sqrt();
            let depth = integrate(extinction, near, end.sqrt().sqrt(), 1e-13);
            let depth = depth.value.x / last * 0.1;
            let slope = 2.0 * end * floor / (1.0 - floor);
            let unknown = 18.0 * f64::EPSILON / slope / end * 0.1;
            let found = prepared.segment(0.0, last, 0.1);
            let off = (found.opacity - opacity(depth)).abs();
            assert!(off <= unknown + 10.0 * TOLERANCE, "{off:e} {unknown:e}");
            assert_eq!(prepared.segment(0.0, 2.0 * end, 0.1).opacity, 1.0);
        }
    }
}
