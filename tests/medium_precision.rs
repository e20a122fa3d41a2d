//! How many digits the formulas keep, judged by 200-bit arithmetic on random inputs. Run with
//! `--nocapture` to see the worst errors, which the documentation quotes.

use dashu_float::FBig;
use dashu_float::ops::SquareRoot;
use dashu_float::round::mode::HalfEven;
use volref::math::exp2;
use volref::math::rng::{Purpose, Stream};
use volref::media::*;

type Big = FBig<HalfEven>;

/// The largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;
const INPUTS: u32 = 20_000;

fn big(x: f64) -> Big {
    Big::try_from(x).unwrap().with_precision(200).value()
}

/// The worst error of a formula, and where it occurred.
#[derive(Default)]
struct Worst {
    roundings: f64,
    last_places: f64,
    at: String,
}

impl Worst {
    fn see(&mut self, found: f64, exact: &Big, at: impl std::fmt::Debug) {
        let error = (big(found) - exact).to_f64().value().abs();
        let nearest = exact.to_f64().value().abs();
        if error / nearest / U > self.roundings {
            self.roundings = error / nearest / U;
            self.at = format!("{at:?}");
        }
        let last_place = nearest.next_up() - nearest;
        self.last_places = self.last_places.max(error / last_place);
    }

    #[track_caller]
    fn at_most(&self, roundings: f64, what: &str) {
        println!(
            "{what}: {:.2} ulp, {:.2} u at {}",
            self.last_places, self.roundings, self.at
        );
        assert!(self.roundings <= roundings, "{what} at {}", self.at);
    }
}

/// Pairs of random numbers, the same in every run.
fn random_pairs() -> impl Iterator<Item = [f64; 2]> {
    let stream = Stream::new(1, 0, 0);
    (0..INPUTS).map(move |pair| stream.pair(0, Purpose::PhaseDirection, pair))
}

#[test]
fn e1_and_e3_opacity_and_source_factor_to_four_roundings() {
    let (mut opacities, mut factors) = (Worst::default(), Worst::default());
    for [u, v] in random_pairs() {
        // From 2^-60 to 2^6, with a random significand.
        let depth = exp2(66.0 * u - 60.0) * (1.0 + v);
        let exact = -(-big(depth)).exp_m1();
        opacities.see(opacity(depth), &exact, depth);
        factors.see(source_factor(depth), &(exact / big(depth)), depth);
    }
    opacities.at_most(4.0, "opacity");
    factors.at_most(4.0, "source_factor");
}

/// Asymmetries of every size and sign, close to 0 and to ±1 too.
fn asymmetry(kind: u32, u: f64) -> f64 {
    let magnitude = match kind % 3 {
        0 => u,
        1 => exp2(-60.0 * u),
        _ => 1.0 - exp2(-1.0 - 49.0 * u),
    };
    let magnitude = magnitude.min(1.0 - U);
    if kind.is_multiple_of(2) {
        magnitude
    } else {
        -magnitude
    }
}

#[test]
fn s1_both_distances_of_the_cosine_from_one_to_eight_roundings() {
    let (mut minus, mut plus) = (Worst::default(), Worst::default());
    let mut cosine: f64 = 0.0;
    let shares = Stream::new(2, 0, 0);
    for (i, [u, kind]) in (0..).zip(random_pairs()) {
        let g = asymmetry((kind * 6.0) as u32, u);
        let xi = match i % 4 {
            0 => exp2(-50.0 * shares.uniform(0, Purpose::PhaseDirection, i)),
            1 => 1.0 - exp2(-50.0 * shares.uniform(0, Purpose::PhaseDirection, i)),
            _ => shares.uniform(0, Purpose::PhaseDirection, i),
        };
        if xi == 0.0 || xi == 1.0 {
            continue;
        }
        let phase = HenyeyGreenstein(Asymmetry::new(g).unwrap());
        let turn = phase.deflection(xi);
        let (one, g, u) = (big(1.0), big(g), big(xi));
        let denominator = &one - &g + big(2.0) * &g * &u;
        let square = &denominator * &denominator;
        let back = &one - &g;
        let ahead = &one + &g;
        let exact_minus = big(2.0) * &back * &back * (&one - &u) * (&one + &g * &u) / &square;
        let exact_plus = big(2.0) * &ahead * &ahead * &u * (&one - &g + &g * &u) / &square;
        minus.see(turn.one_minus_cos, &exact_minus, (phase, xi));
        plus.see(turn.one_plus_cos, &exact_plus, (phase, xi));
        // The cosine is 2u − 1 plus a shift by g: two roundings, and those of the shift.
        let exact = &one - &exact_minus;
        let balance = big(2.0) * &u - &one;
        let shift = (&exact - &balance).to_f64().value().abs();
        let error = (big(turn.cos) - &exact).to_f64().value().abs();
        let both = exact.to_f64().value().abs() + balance.to_f64().value().abs();
        cosine = cosine.max((error / U - both) / shift);
    }
    println!("cos: {cosine:.2} u of the shift");
    assert!(cosine <= 8.0);
    minus.at_most(8.0, "1 - cos");
    plus.at_most(8.0, "1 + cos");
}

#[test]
fn s2_phase_function_and_distribution_to_ten_roundings() {
    let (mut values, mut distribution) = (Worst::default(), Worst::default());
    for (kind, [u, v]) in (0..).zip(random_pairs()).take(4000) {
        let phase = HenyeyGreenstein(Asymmetry::new(asymmetry(kind, u)).unwrap());
        let turn = Deflection::from_cos(2.0 * v - 1.0);
        let (one, g, mu) = (big(1.0), big(phase.0.g()), big(turn.cos));
        let bracket = &one + &g * &g - big(2.0) * &g * &mu;
        let r = bracket.sqrt();
        let pi = big(std::f64::consts::PI);
        let value = (&one - &g) * (&one + &g) / (big(4.0) * pi * &bracket * &r);
        values.see(phase.per_steradian(&turn), &value, (phase, turn));
        let cdf = (&one - &g) * (&one + &mu) / (&r * (&one + &g + &r));
        distribution.see(phase.cdf(&turn), &cdf, (phase, turn));
    }
    values.at_most(10.0, "phase function");
    distribution.at_most(10.0, "distribution");
}
