//! Optical depths of every size, and opacities over other lengths.
//!
//! Bounds in units of `u`, to first order: `exp`, `expm1` and `log1p` are within one ulp by their
//! own analysis, so within 2. [`SECOND_ORDER`] is more than the products of roundings.

use super::exact::U;
use super::exact::shapes::SECOND_ORDER;
use super::{config, octaves};
use proptest::prelude::*;
use volref::math::exp_m1;
use volref::optics::*;

/// Thirty decades, and what lies beyond: nothing, subnormal, as large as numbers are, infinite;
/// and where `e^−τ` leaves the numbers.
fn depth() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => octaves(-66.0, 34.0),
        1 => Just(0.0),
        1 => (1..1_u64 << 52).prop_map(f64::from_bits),
        1 => 690.0..750.0_f64,
        1 => octaves(-56.0, -48.0),
        1 => octaves(34.0, 1023.9),
        1 => Just(f64::INFINITY),
    ]
}

/// Not 0: of every size, close to 1, and 1.
fn opaque() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => octaves(-60.0, 0.0),
        2 => octaves(-53.0, -1.0).prop_map(|rest| 1.0 - rest),
        1 => Just(1.0),
    ]
}

/// The condition of `1 − e^−x` in `x`, at most 1.
fn condition(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x / exp_m1(x) }
}

/// Extinctions and lengths of which any product is a number, and both ends.
fn factor() -> impl Strategy<Value = f64> {
    prop_oneof![8 => octaves(-500.0, 500.0), 1 => Just(0.0), 1 => Just(f64::INFINITY)]
}

proptest! {
    #![proptest_config(config())]

    /// 2 of either, which are 1 together, and the sum: 3.
    #[test]
    fn e1_e2_what_is_not_held_back_comes_through(depth in depth()) {
        let (held, through) = (opacity(depth), transmittance(depth));
        prop_assert!((0.0..=1.0).contains(&held) && (0.0..=1.0).contains(&through));
        prop_assert!((held + through - 1.0).abs() <= 3.0 * U);
    }

    /// Two functions of 2 each, and a quotient each for the source factor.
    #[test]
    fn e1_e2_e3_more_depth_holds_back_more(a in depth(), b in depth()) {
        let (thin, thick) = (a.min(b), a.max(b));
        prop_assert!(opacity(thin) <= opacity(thick) * (1.0 + 4.0 * U * SECOND_ORDER));
        // The smallest numbers are a whole ulp apart.
        let least = f64::from_bits(1);
        let bound = transmittance(thin) * (1.0 + 4.0 * U * SECOND_ORDER) + least;
        prop_assert!(transmittance(thick) <= bound);
        let bound = source_factor(thin) * (1.0 + 6.0 * U * SECOND_ORDER) + least;
        prop_assert!(source_factor(thick) <= bound);
    }

    #[test]
    fn e3_the_source_factor_is_a_mean_transmittance(depth in depth()) {
        let factor = source_factor(depth);
        prop_assert!(factor <= 1.0 && (factor > 0.0 || depth == f64::INFINITY), "{factor:e}");
        prop_assert!(depth != 0.0 || factor == 1.0);
        // A quotient and a product give back the opacity, where all three are normal numbers.
        if (1e-300..1e300).contains(&depth) {
            let held = opacity(depth);
            prop_assert!((factor * depth - held).abs() <= 2.0 * U * SECOND_ORDER * held);
        }
    }

    /// A product and a sum to either side: 4 in all; and what underflows, three times.
    #[test]
    fn e5_depths_add_up(sigma in factor(), near in factor(), far in factor()) {
        let parts = optical_depth(sigma, near) + optical_depth(sigma, far);
        let whole = optical_depth(sigma, near + far);
        let bound = 4.0 * U * SECOND_ORDER * whole + 3.0 * f64::from_bits(1);
        // Equal, if infinite; never no number.
        prop_assert!(parts == whole || (parts - whole).abs() <= bound, "{parts:e} {whole:e}");
    }

    /// As one: the sum of the depths, with a condition of at most 1, and the opacity, 3. One behind
    /// the other: 2, and 2 + 2 + 1 of what is behind, and the sum, at most 6. Together 9.
    #[test]
    fn e1_to_e3_opacities_compose(near in depth(), far in depth()) {
        let whole = opacity(near + far);
        let parts = opacity(near) + transmittance(near) * opacity(far);
        // What comes through the near part may be subnormal, next to an opacity of 1.
        let bound = 9.0 * U * SECOND_ORDER * whole + f64::from_bits(1);
        prop_assert!((parts - whole).abs() <= bound, "{parts:e} {whole:e}");
    }

    /// Over 1 nothing changes: the logarithm with the condition of the exponential, 2, and that, 2.
    #[test]
    fn e4_e5_opacity_over_lengths_is_an_opacity(
        a in opaque(),
        ratio in prop_oneof![8 => octaves(-1000.0, 1000.0), 1 => Just(f64::INFINITY)],
        more in octaves(0.0, 10.0),
    ) {
        let (thin, thick) = (over_length(a, ratio), over_length(a, ratio * more));
        prop_assert!((0.0..=1.0).contains(&thin) && (0.0..=1.0).contains(&thick));
        // The depth is off by 3, the opacity by 2 more, either time; what underflows by one number.
        prop_assert!(thin <= thick * (1.0 + 10.0 * U * SECOND_ORDER) + f64::from_bits(1));
        prop_assert!((over_length(a, 1.0) - a).abs() <= 4.0 * U * SECOND_ORDER * a);
        prop_assert_eq!(over_length(a, 0.0), 0.0);
        prop_assert_eq!(over_length(0.0, ratio), 0.0);
        prop_assert_eq!(over_length(1.0, ratio), 1.0);
    }

    /// Over `r` and then over `s` is over `rs`, with `x` the depth over `r`, up to 20.
    ///
    /// - Over `r`: `x` is off by 3 (logarithm, product). The opacity is off by 2 besides, which is
    ///   `2(e^x − 1)/x` of the depth that is made of it again: a dense material keeps few digits of
    ///   its depth. That takes 2 more, and the product with `s` 1.
    /// - Over `rs`: two products and the logarithm, 4.
    /// - All of this has the condition of opacity in its depth `sx`; either opacity is off by 2.
    ///
    /// Up to 20 what the depth loses is below 1e-8 of it, and its square no matter.
    #[test]
    fn e4_opacity_over_a_length_of_a_length(
        depth in octaves(-55.0, 5.17), over_first in octaves(-60.0, 4.3), s in octaves(-20.0, 20.0),
    ) {
        let a = opacity(depth);
        let r = over_first / depth;
        let x = -r * volref::math::ln_1p(-a);
        prop_assume!(x <= 20.0);
        let in_turn = over_length(over_length(a, r), s);
        let at_once = over_length(a, r * s);
        let lost = 3.0 + 2.0 * exp_m1(x) / x + 2.0 + 1.0 + 4.0;
        let bound = (condition(s * x) * lost + 4.0) * U * (1.0 + 1e-7) * at_once;
        prop_assert!((in_turn - at_once).abs() <= bound, "{in_turn:e} {at_once:e}");
    }
}
