//! The phase function for every asymmetry, up to an ulp from where light only goes straight on.
//!
//! Bounds in units of `u`, to first order. Where a formula's own is derived:
//! `tests/library/kernel_precision.rs`: 13 for either distance of the cosine from ±1, 14 for the value, 12
//! for the distribution.

use super::exact::U;
use super::exact::shapes::SECOND_ORDER;
use super::{config, octaves, share};
use proptest::prelude::*;
use volref::optics::{Asymmetry, Deflection, HenyeyGreenstein};

fn phase(g: f64) -> HenyeyGreenstein {
    HenyeyGreenstein(Asymmetry::new(g).unwrap())
}

/// Of either sign: any, close to 0, close to 1, and both.
fn asymmetry() -> impl Strategy<Value = f64> {
    let size = prop_oneof![
        4 => 0.0..1.0_f64,
        2 => octaves(-1074.0, -1.0),
        4 => octaves(-53.0, -1.0).prop_map(|gap| (1.0 - gap).min(1.0 - U)),
        1 => Just(0.0),
        1 => Just(1.0 - U),
        1 => Just(1.0 - 2.0 * U),
    ];
    (size, any::<bool>()).prop_map(|(size, back)| if back { -size } else { size })
}

fn mirrored(turn: Deflection) -> Deflection {
    Deflection {
        cos: -turn.cos,
        one_minus_cos: turn.one_plus_cos,
        one_plus_cos: turn.one_minus_cos,
    }
}

/// Of a cosine, and as it is sampled.
fn turn() -> impl Strategy<Value = Deflection> {
    prop_oneof![
        (-1.0..=1.0_f64).prop_map(Deflection::from_cos),
        octaves(-53.0, 0.0).prop_map(|gap| Deflection::from_cos(1.0 - gap)),
        octaves(-53.0, 0.0).prop_map(|gap| Deflection::from_cos(gap - 1.0)),
        (asymmetry(), share()).prop_map(|(g, u)| phase(g).deflection(u)),
    ]
}

proptest! {
    #![proptest_config(config())]

    /// Both distances are 2 together, with 13 of them and the sum, 28. The cosine is a rounding of
    /// its own, one of `2u − 1` and 13 of the shift between these; it is one distance from 1.
    #[test]
    fn s1_deflections_are_on_the_circle_and_mirror(g in asymmetry(), u in share()) {
        let turn = phase(g).deflection(u);
        prop_assert!((-1.0..=1.0).contains(&turn.cos));
        prop_assert!(turn.one_minus_cos >= 0.0 && turn.one_plus_cos >= 0.0);
        let both = turn.one_minus_cos + turn.one_plus_cos;
        prop_assert!((both - 2.0).abs() <= 28.0 * U * SECOND_ORDER);
        let shift = (turn.cos - (2.0 * u - 1.0)).abs();
        let bound = 3.0 + 13.0 * shift + 13.0 * turn.one_minus_cos;
        // The shift is itself known to its roundings only: of second order.
        let bound = bound * U * (1.0 + 1e-12);
        prop_assert!((turn.cos - (1.0 - turn.one_minus_cos)).abs() <= bound);
        prop_assert!(turn.sine() >= 0.0 && turn.sine().is_finite());
        prop_assert_eq!(phase(-g).deflection(1.0 - u), mirrored(turn));
    }

    /// The distribution is in proportion to one distance, 13, and through `r²` it has a condition
    /// of at most ½ · 3/2 in the one at the peak, 10; it rounds by 12 itself. All relative: the
    /// smallest share is found again to its digits.
    #[test]
    fn s1_deflections_invert_the_distribution(g in asymmetry(), u in share()) {
        let found = phase(g).cdf(&phase(g).deflection(u));
        prop_assert!((found - u).abs() <= 35.0 * U * SECOND_ORDER * u, "{found:e}");
    }

    /// More of the light turns less, but for 13 either time.
    #[test]
    fn s1_deflections_rise_with_the_share(g in asymmetry(), a in share(), b in share()) {
        let (low, high) = (phase(g).deflection(a.min(b)), phase(g).deflection(a.max(b)));
        let slack = 1.0 + 26.0 * U * SECOND_ORDER;
        prop_assert!(low.one_plus_cos <= high.one_plus_cos * slack);
        prop_assert!(high.one_minus_cos <= low.one_minus_cos * slack);
    }

    /// Least against the peak, largest at it, but for 14 either time, and 3/2 of the 13 that the
    /// distance of a sampled turn may be off.
    #[test]
    fn s2_values_lie_between_those_straight_on_and_back(g in asymmetry(), turn in turn()) {
        let at = |cos| phase(g).per_steradian(&Deflection::from_cos(cos));
        let (least, most) = (at(-g.signum()), at(g.signum()));
        let value = phase(g).per_steradian(&turn);
        let slack = 1.0 + 48.0 * U * SECOND_ORDER;
        prop_assert!(least > 0.0 && most.is_finite());
        prop_assert!(least <= value * slack && value <= most * slack, "{value:e}");
    }

    /// The same bits from both sides; and both distributions are 1 together, with 12 of either and
    /// the sum.
    #[test]
    fn s1_s2_forward_and_backward_are_mirror_images(g in asymmetry(), turn in turn()) {
        let (forward, backward) = (phase(g), phase(-g));
        let image = mirrored(turn);
        prop_assert_eq!(forward.per_steradian(&turn), backward.per_steradian(&image));
        // A sampled turn has its two distances each with an error of its own, up to 13, and both
        // distributions the condition of the law above in them: 23 more.
        let both = forward.cdf(&turn) + backward.cdf(&image);
        prop_assert!((both - 1.0).abs() <= (12.0 + 23.0 + 1.0) * U * SECOND_ORDER);
    }
}
