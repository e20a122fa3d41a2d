//! Laws of random numbers, warps and media, each over its whole domain.

use crate::common;
use proptest::prelude::*;
use std::f64::consts::PI;
use volref::math::Sum;
use volref::math::rng::{Purpose, Stream};
use volref::math::sampling::*;
use volref::optics::profiles::*;
use volref::optics::*;

/// The largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;
/// The largest random number there is.
const LAST: f64 = 1.0 - U;

fn config() -> ProptestConfig {
    common::failures_in("fixtures/proptest-regressions/medium_laws.txt")
}

/// A number as the generator makes them, the ends included.
fn share() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (0..1_u64 << 53).prop_map(|i| i as f64 * U),
        1 => Just(0.0),
        1 => Just(LAST),
    ]
}

// Random numbers.

fn purpose() -> impl Strategy<Value = Purpose> {
    use Purpose::*;
    prop::sample::select(vec![
        Camera,
        FreeFlight,
        Collision,
        Tracking,
        PhaseDirection,
        LightChoice,
        LightPoint,
        LightDistance,
        Surface,
        Roulette,
        Channel,
        LightVertex,
        Emission,
        Reference,
        AreaLightAlong,
        Caustic,
    ])
}

type StreamUse = (u32, u32, u32, Purpose, u32);

fn numbers_of((pixel, sample, bounce, purpose, pair): StreamUse) -> [f64; 2] {
    Stream::new(11, pixel, sample).pair(bounce, purpose, pair)
}

fn any_use() -> impl Strategy<Value = StreamUse> {
    (
        any::<u32>(),
        any::<u32>(),
        0..Stream::BOUNCES,
        purpose(),
        0..=u32::MAX / 2,
    )
}

proptest! {
    #![proptest_config(config())]

    /// Two uses that differ in one field alone have different numbers, and so in any.
    #[test]
    fn no_two_uses_share_a_number(a in any_use(), b in any_use()) {
        let one_field_apart = [
            (b.0, a.1, a.2, a.3, a.4),
            (a.0, b.1, a.2, a.3, a.4),
            (a.0, a.1, b.2, a.3, a.4),
            (a.0, a.1, a.2, b.3, a.4),
            (a.0, a.1, a.2, a.3, b.4),
            b,
        ];
        for other in one_field_apart.into_iter().filter(|other| *other != a) {
            // Equal by chance: 2^-106.
            prop_assert_ne!(numbers_of(a), numbers_of(other));
        }
    }

    #[test]
    fn single_numbers_are_the_halves_of_pairs(a in any_use()) {
        let (pixel, sample, bounce, purpose, pair) = a;
        let stream = Stream::new(11, pixel, sample);
        let single = |half| stream.uniform(bounce, purpose, 2 * pair + half);
        prop_assert_eq!([single(0), single(1)], numbers_of(a));
        prop_assert!((0.0..1.0).contains(&single(0)));
    }
}

/// Asserts that `counts` of equally likely classes pass Pearson's test. For `k` degrees of
/// freedom a sum above `k + 2√(kx) + 2x` has a probability below e^(−x) (Laurent & Massart 2000,
/// lemma 1); x = 6.9 makes that 1e-3.
#[track_caller]
fn assert_evenly_spread(counts: &[u32]) {
    let total: u32 = counts.iter().sum();
    let expected = f64::from(total) / counts.len() as f64;
    let squares = counts.iter().map(|&count| {
        let excess = f64::from(count) - expected;
        excess * excess / expected
    });
    let chi_squared = Sum::from_iter(squares).value();
    let (k, x) = ((counts.len() - 1) as f64, 6.9);
    let bound = k + 2.0 * (k * x).sqrt() + 2.0 * x;
    assert!(chi_squared <= bound, "{chi_squared} exceeds {bound}");
}

/// Counts how often a pair of numbers falls into each of 16 × 16 squares.
fn squares(pairs: impl Iterator<Item = [f64; 2]>) -> Vec<u32> {
    let mut counts = vec![0; 256];
    for [u, v] in pairs {
        counts[(u * 16.0) as usize * 16 + (v * 16.0) as usize] += 1;
    }
    counts
}

#[test]
fn numbers_are_uniform_and_neighbours_independent() {
    const DRAWS: u32 = 1 << 16;
    let use_at = |pixel, sample, bounce, purpose, index| {
        Stream::new(0, pixel, sample).uniform(bounce, purpose, index)
    };
    let flight = Purpose::FreeFlight;
    let here = |i| use_at(0, 0, 0, flight, i);
    let draws = || 0..DRAWS;
    // One number against the next along every field of the counter.
    assert_evenly_spread(&squares(draws().map(|i| [here(2 * i), here(2 * i + 1)])));
    assert_evenly_spread(&squares(
        draws().map(|i| [here(2 * i + 1), here(2 * i + 2)]),
    ));
    let next = |other: &dyn Fn(u32) -> f64| squares(draws().map(|i| [here(i), other(i)]));
    assert_evenly_spread(&next(&|i| use_at(1, 0, 0, flight, i)));
    assert_evenly_spread(&next(&|i| use_at(0, 1, 0, flight, i)));
    assert_evenly_spread(&next(&|i| use_at(0, 0, 1, flight, i)));
    assert_evenly_spread(&next(&|i| use_at(0, 0, 0, Purpose::Collision, i)));
    assert_evenly_spread(&next(&|i| Stream::new(1, 0, 0).uniform(0, flight, i)));
    // The first number of each pixel against its neighbour's, and the lowest eight bits.
    let first = |pixel| use_at(pixel, 0, 0, flight, 0);
    assert_evenly_spread(&squares(draws().map(|i| [first(2 * i), first(2 * i + 1)])));
    let mut low = vec![0; 256];
    draws().for_each(|i| low[((here(i) / U) as u64 % 256) as usize] += 1);
    assert_evenly_spread(&low);
}

// Warps.

proptest! {
    #![proptest_config(config())]

    #[test]
    fn directions_have_length_one_and_a_density(u in share(), v in share(), angle in 1e-9..PI) {
        let cone = Cone::of_half_angle(angle).unwrap();
        let (anywhere, up, inside) =
            (sphere([u, v]), cosine_hemisphere([u, v]), cone.direction([u, v]));
        for direction in [anywhere, up, inside] {
            prop_assert!((direction.length() - 1.0).abs() <= 8.0 * U);
        }
        prop_assert!(sphere_pdf() > 0.0 && cosine_hemisphere_pdf(up.z) > 0.0);
        prop_assert!(cone.pdf() > 0.0 && cone.pdf().is_finite());
        prop_assert!(up.z > 0.0 && inside.z >= cone.cos());
    }

    /// The share of flights that have collided by the optical distance for `u` is `u`.
    #[test]
    fn flights_invert_opacity(u in share(), sigma in 1e-6..1e6_f64, depth in 1e-6..1e6_f64) {
        prop_assert!((opacity(optical_distance(u)) - u).abs() <= 8.0 * U);
        let colliding = opacity(depth);
        let distance = truncated_optical_distance(colliding, u);
        prop_assert!(distance >= 0.0);
        prop_assert!((opacity(distance) / colliding - u).abs() <= 16.0 * U);
        prop_assert!(truncated_free_flight_pdf(sigma, distance, colliding) >= 0.0);
    }

}

proptest! {
    #![proptest_config(config())]

    /// The optical depth of a whole is that of its parts.
    #[test]
    fn profiles_compose(
        start in 0.01..10.0_f64, change in -1.0..1.0_f64, near in 0.0..5.0_f64, more in 0.0..5.0_f64,
    ) {
        let far = near + more;
        let exponential = ExponentialProfile { start, rate: change };
        let rising = LinearProfile { start, slope: change.abs() };
        let depths = |depth: &dyn Fn(f64, f64) -> f64| (depth(0.0, far), depth(0.0, near) + depth(near, far));
        for (whole, parts) in [
            depths(&|near, far| exponential.optical_depth(near, far)),
            depths(&|near, far| rising.optical_depth(near, far)),
        ] {
            // Ten roundings, and those of an exponent up to 10, which the function makes relative.
            // The rounding of the far end moves the whole by less than one of an exponent of 10.
            prop_assert!((whole - parts).abs() <= 40.0 * U * whole);
        }
    }
}
