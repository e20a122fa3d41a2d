//! Pre-integrated segments against what they stand for: fine marching, quadrature, and themselves
//! cut in parts. Hard case D13.

use crate::common::quadrature::integral;
use glam::DVec3;
use proptest::prelude::*;
use volref::cost::preintegration::Preintegrated;
use volref::math::{exp, ln, ln_1p};
use volref::optics::{
    Appearance, Colormap, TransferFunction, TransferOpacity, TransferPoint, TransferPoints,
};
use volref::render::classified::compositing::{CompositingOrder, FrontToBack, Layers};

fn table(points: Vec<TransferPoint>, reference_length: f64) -> TransferFunction {
    TransferFunction {
        appearance: Appearance::Points(TransferPoints::new(points).unwrap()),
        reference_length,
    }
}

fn point(value: f64, opacity: f64, colour: DVec3) -> TransferPoint {
    TransferPoint {
        value,
        colour,
        opacity,
    }
}

/// A ray along which the field runs from 0 to 1, in `steps` equal steps, put together front to
/// back: from the values in the middle, and from whole segments.
fn crossed(transfer: &TransferFunction, length: f64, steps: u32) -> [Layers; 2] {
    let prepared = Preintegrated::new(transfer);
    let step = length / f64::from(steps);
    let value = |index: f64| index / f64::from(steps);
    let mut crossed = [Layers::default(); 2];
    for index in 0..steps {
        let index = f64::from(index);
        let middle = value(index + 0.5);
        let opacity = transfer.opacity(middle, step);
        let colour = transfer.colour(middle) * transfer.emission(middle) * opacity;
        crossed[0] = FrontToBack::add(crossed[0], colour, opacity);
        let segment = prepared.segment(value(index), value(index + 1.0), step);
        crossed[1] = FrontToBack::add(crossed[1], segment.colour, segment.opacity);
    }
    crossed
}

const BLUE: DVec3 = DVec3::new(0.0, 0.25, 1.0);
const GOLD: DVec3 = DVec3::new(3.0, 2.0, 0.5);

#[track_caller]
fn assert_close(found: Layers, opacity: f64, colour: DVec3, relative: f64) {
    let off = (found.opacity - opacity).abs();
    assert!(off <= relative * opacity, "{found:?} {opacity} {colour}");
    let off = (found.colour - colour).abs();
    let bound = relative * colour;
    assert!(off.cmple(bound).all(), "{found:?} {opacity} {colour}");
}

/// Hard case D13: opaque between 0.49 and 0.51, ten steps of 0.1 from value 0 to value 1. All
/// samples, at 0.05 to 0.95, miss it: they see nothing, of what is all there is.
#[test]
fn a_narrow_peak() {
    let peak = |opacity| {
        let points = vec![
            point(0.49, 0.0, BLUE),
            point(0.49, opacity, BLUE),
            point(0.51, opacity, GOLD),
            point(0.51, 0.0, GOLD),
        ];
        table(points, 0.01)
    };
    let [sampled, segments] = crossed(&peak(1.0), 1.0, 10);
    assert_eq!(sampled, Layers::default());
    assert_eq!(segments.opacity, 1.0);
    // As accurate as an element of the integral.
    let off = (segments.colour - BLUE).abs().max_element();
    assert!(off <= 1e-12, "{segments:?}");

    // Nearly opaque: the value takes two reference lengths to cross the peak. Of the share y of
    // it is seen (1 − a)^(2y).
    let transfer = peak(0.75);
    let [sampled, segments] = crossed(&transfer, 1.0, 10);
    assert_eq!(sampled, Layers::default());
    let rate = -2.0 * ln_1p(-0.75);
    let seen = |y: f64| rate * exp(-rate * y);
    let opacity = integral(0.0, 1.0, 200, seen);
    let gold = integral(0.0, 1.0, 200, |y| y * seen(y));
    assert!((opacity - 0.9375).abs() < 1e-14);
    assert_close(
        segments,
        opacity,
        BLUE * (opacity - gold) + GOLD * gold,
        1e-10,
    );
    // With twenty steps as little, and with forty, with samples at 0.4875 and 0.5125.
    for steps in [20, 40] {
        assert_eq!(crossed(&transfer, 1.0, steps)[0], Layers::default());
    }
}

/// The same with ramps: up to opacity 1 and down again. Its depth, two reference lengths times
/// `∫₀¹ −ln(1 − a) da = 1`, is 2.
#[test]
fn a_narrow_ridge() {
    let points = vec![
        point(0.49, 0.0, BLUE),
        point(0.5, 1.0, GOLD),
        point(0.51, 0.0, BLUE),
    ];
    let [sampled, segments] = crossed(&table(points, 0.01), 1.0, 10);
    assert_eq!(sampled, Layers::default());

    // With w = 1 − a the depth from the edge to w is 1 − w + w ln w, and from the top down to w
    // w − w ln w. With w = y⁴ the integrands are smooth enough for the quadrature.
    let depth = |w: f64| if w == 0.0 { 0.0 } else { w - w * ln(w) };
    let power = |y: f64| y * y * y * y;
    let weight = |y: f64| -ln(power(y)) * 4.0 * y * y * y;
    let through = |w: f64| exp(-(1.0 - depth(w))) + exp(-1.0 - depth(w));
    let up_and_down = |f: &dyn Fn(f64) -> f64| {
        integral(0.0, 1.0, 2000, |y| {
            let w = power(y);
            f(w) * weight(y) * through(w)
        })
    };
    let opacity = up_and_down(&|_| 1.0);
    assert!((opacity - (1.0 - exp(-2.0))).abs() < 1e-12);
    let colour = BLUE * up_and_down(&|w| w) + GOLD * up_and_down(&|w| 1.0 - w);
    assert_close(segments, opacity, colour, 1e-10);
}

/// The step length is no parameter: one segment is the ray.
#[test]
fn one_segment_is_the_integral() {
    let formula = |floor, colormap| TransferFunction {
        appearance: Appearance::Formula {
            opacity: TransferOpacity { floor },
            colormap: Colormap::named(colormap).unwrap(),
            range: None,
        },
        reference_length: 0.2,
    };
    let points = vec![
        point(0.2, 0.0, BLUE),
        point(0.4, 0.5, GOLD),
        point(0.4, 0.1, BLUE),
        point(0.7, 0.999, GOLD),
    ];
    for transfer in [
        formula(0.36, "heat"),
        formula(0.36, "viridis"),
        formula(0.1, "white"),
        table(points, 0.2),
    ] {
        let [_, whole] = crossed(&transfer, 1.5, 1);
        let mut off = Vec::new();
        for steps in [2, 3, 10, 64] {
            let [sampled, segments] = crossed(&transfer, 1.5, steps);
            off.push((sampled.colour - whole.colour).abs().max_element());
            // 1e-13 of an element each, at most.
            assert_close(segments, whole.opacity, whole.colour, 1e-12);
        }
        println!("samples in the middle are off by {off:.7?}");
        assert!(off[0] > 1e-3 && off[3] > 1e-7);
    }
}

/// The formula's colours against quadrature of the sum that the renderer evaluates.
#[test]
fn colours_of_the_formula() {
    let opacity = TransferOpacity { floor: 0.36 };
    let transfer = TransferFunction {
        appearance: Appearance::Formula {
            opacity,
            colormap: Colormap::named("heat").unwrap(),
            range: None,
        },
        reference_length: 0.25,
    };
    let prepared = Preintegrated::new(&transfer);
    // Within one line of the colormap, as the quadrature here does not cut.
    for (front, back) in [(0.3, 0.45), (0.7, 0.55), (0.0, 0.2), (1e-6, 0.0)] {
        let length = 0.6;
        let sigma = |s: f64| -ln_1p(-opacity.at(s)) / 0.25;
        let value = |t: f64| front + (back - front) * (t / length);
        let depth = |t: f64| integral(0.0, t, 8, |t| sigma(value(t)));
        let found = prepared.segment(front, back, length);
        let colour = [0, 1, 2].map(|channel| {
            integral(0.0, length, 32, |t| {
                let s = value(t);
                transfer.colour(s)[channel] * s * s * sigma(s) * exp(-depth(t))
            })
        });
        // Against the largest emission: from 1e-6 to 0 nearly all is weighed near the front.
        let bound = 1e-12 * found.opacity * front.max(back) * front.max(back);
        let off = (found.colour - DVec3::from_array(colour)).abs();
        assert!(
            off.max_element() <= bound,
            "{front} {back}: {off} of {bound:e}"
        );
    }
}

/// Beyond a depth of some thousand, all that is seen lies in the first thousandth.
#[test]
fn dense_segments() {
    let transfer = table(vec![point(0.0, 0.9, BLUE), point(1.0, 0.9, GOLD)], 1e-7);
    let found = Preintegrated::new(&transfer).segment(0.0, 1.0, 1.0);
    // ∫ e^(−τ) dx, whose mean place is 1/D.
    let depth = -ln_1p(-0.9) * 1e7;
    assert_close(found, 1.0, BLUE + (GOLD - BLUE) / depth, 1e-12);
}

/// Tables of up to eight points, with steps; opacities of 0 and of `most` come often.
fn tables(most: f64) -> impl Strategy<Value = TransferFunction> {
    let colour = prop::array::uniform3(0.0..2.0).prop_map(DVec3::from_array);
    let opacity = prop_oneof![4 => 0.0..most, 1 => Just(0.0), 1 => Just(most)];
    let points = prop::collection::vec((0..6_u32, opacity, colour), 1..8);
    (points, 0.1..3.0).prop_map(|(mut points, length)| {
        points.sort_by_key(|&(value, ..)| value);
        let mut kept: Vec<TransferPoint> = Vec::new();
        for (value, opacity, colour) in points {
            let value = f64::from(value) * 0.2;
            if kept.len() < 2 || kept[kept.len() - 2].value < value {
                kept.push(point(value, opacity, colour));
            }
        }
        table(kept, length)
    })
}

/// How much `f` rises and falls, in all, from value 0 to value 1: of a table of lines at least
/// what is seen at its points and just before and after them.
fn variation(f: impl Fn(f64) -> f64) -> f64 {
    let ends = (0..=5).flat_map(|i| {
        let value = f64::from(i) * 0.2;
        [value.next_down(), value, value.next_up()]
    });
    let values: Vec<f64> = ends.map(f).collect();
    values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .sum()
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Against marching with samples in the middle of `n` steps.
    ///
    /// A midpoint sum of a function of variation `V` is off by at most `V/(2n)` at any place, the
    /// depth thus by `δ = V(σ)/(2n)`. Within a step the emission differs from that in the middle by
    /// no more than it varies there, and the step sees a share of at most its opacity; a depth off
    /// by `δ` moves `∫ e d(1 − e^(−τ))`, in parts, by at most `δ` times `e` at the end and `V(e)`.
    /// The sums of the march round `n` times.
    #[test]
    fn marching_comes_to_the_same(transfer in tables(0.95), length in 0.0..3.0) {
        const STEPS: u32 = 4000;
        let [marched, _] = crossed(&transfer, length, STEPS);
        let [_, whole] = crossed(&transfer, length, 1);
        let sigma = |value| -ln_1p(-transfer.reference_opacity(value));
        let steps = f64::from(STEPS);
        let lengths = length / transfer.reference_length;
        let off = variation(sigma) * lengths / (2.0 * steps);
        prop_assert!((marched.opacity - whole.opacity).abs() <= off + 1e-11);
        // -ln(1 − 0.95) is 3.
        let step = 3.0 * lengths / steps;
        for channel in 0..3 {
            let emission = |value| transfer.colour(value)[channel];
            let varied = variation(emission);
            let bound = varied * step + off * (2.0 + varied);
            let found = (marched.colour - whole.colour)[channel].abs();
            prop_assert!(found <= bound + 1e-11, "{found:e} {bound:e}");
        }
    }

    /// Two halves, one behind the other, are the whole.
    ///
    /// In units of half an ulp of 1: opacities at the ends of stretches are four off, which
    /// `−ln(1 − a)` makes 400 of; the rest of a depth is some twenty roundings of at most 4.6; on
    /// either side. The middle is 1.5 off, as a share of the range of values, with the extinction's
    /// variation, at most 37, on either side of it. The emission is at most 2, of variation 16:
    /// a depth off by `δ` moves the radiance by at most `18 δ`, a shift by the emission's variation
    /// times the extinction. Quadrature adds what is promised.
    #[test]
    fn halves_make_the_whole(
        transfer in tables(0.99),
        front in -0.5..1.5,
        back in -0.5..1.5,
        length in 0.0..5.0,
    ) {
        let prepared = Preintegrated::new(&transfer);
        let whole = prepared.segment(front, back, length);
        let middle = front + 0.5 * (back - front);
        let mut halves = Layers::default();
        for (front, back) in [(front, middle), (middle, back)] {
            let half = prepared.segment(front, back, 0.5 * length);
            halves = FrontToBack::add(halves, half.colour, half.opacity);
        }
        let range = (back - front).abs().max(f64::MIN_POSITIVE);
        let lengths = length / transfer.reference_length;
        let units = lengths * (1000.0 + 120.0 / range) + 8.0;
        let bound = units * f64::EPSILON / 2.0;
        prop_assert!((halves.opacity - whole.opacity).abs() <= bound);
        let off = (halves.colour - whole.colour).abs().max_element();
        prop_assert!(off <= 20.0 * bound + 4e-12 * whole.opacity, "{off:e}");
    }

    /// Light of one colour is as much as the opacity, and no colour shines brighter than the
    /// brightest: whatever the table, opaque places included. Sixteen ends of ramps at opacity 1, at
    /// most, are off by 1e-13 each.
    #[test]
    fn radiance_stays_in_range(
        transfer in tables(1.0),
        front in -0.5..1.5,
        back in -0.5..1.5,
        length in 0.0..1e6,
    ) {
        let found = Preintegrated::new(&transfer).segment(front, back, length);
        prop_assert!((0.0..=1.0).contains(&found.opacity));
        let most = transfer.brightest_colour() * found.opacity;
        prop_assert!(found.colour.is_finite());
        let ends = 16.0 * 1e-13;
        prop_assert!(found.colour.max_element() <= most + ends * (1.0 + most));
        prop_assert!(found.colour.min_element() >= 0.0);
        let reversed = Preintegrated::new(&transfer).segment(back, front, length);
        prop_assert!((reversed.opacity - found.opacity).abs() <= ends);
    }
}
