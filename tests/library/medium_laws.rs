//! Laws of random numbers, warps and media, each over its whole domain.

use crate::common;
use glam::DVec3;
use proptest::prelude::*;
use std::f64::consts::PI;
use volref::math::rng::{Purpose, Stream};
use volref::math::sampling::*;
use volref::math::{Direction, Frame, Moments, Sum};
use volref::optics::profiles::*;
use volref::optics::*;

/// The largest relative error of one rounding.
const U: f64 = f64::EPSILON / 2.0;
/// The largest random number there is.
const LAST: f64 = 1.0 - U;

fn config() -> ProptestConfig {
    common::failures_in("fixtures/proptest-regressions/medium_laws.txt")
}

#[track_caller]
fn assert_relative(found: f64, expected: f64, roundings: f64) {
    let bound = roundings * U * expected.abs();
    assert!(
        (found - expected).abs() <= bound,
        "{found:e} is not {expected:e}"
    );
}

fn phase(g: f64) -> HenyeyGreenstein {
    HenyeyGreenstein(Asymmetry::new(g).unwrap())
}

/// A number as the generator makes them, the ends included.
fn share() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => (0..1_u64 << 53).prop_map(|i| i as f64 * U),
        1 => Just(0.0),
        1 => Just(LAST),
    ]
}

fn direction() -> impl Strategy<Value = Direction> {
    (share(), share()).prop_map(|(u, v)| sphere([u, v]))
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

    /// S8: against the inverse square of the distance every place has the same weight,
    /// so that one sample is the integral.
    #[test]
    fn s8_equiangular_sampling_of_the_inverse_square_has_no_variance(
        distance in prop_oneof![1e-6..1e-3, 1e-3..10.0_f64],
        near in -3.0..3.0, length in 1e-6..10.0, endless: bool, u in share(),
    ) {
        let far = if endless { f64::INFINITY } else { near + length };
        let light = Equiangular::new(distance, near, far).unwrap();
        let t = light.sample(u);
        prop_assert!((near..=far).contains(&t));
        let inverse_square = 1.0 / (distance * distance + t * t);
        let integral = light.angle() / distance;
        prop_assert!((inverse_square / light.pdf(t) / integral - 1.0).abs() <= 8.0 * U);
    }

    #[test]
    fn equiangular_places_invert_the_angle(
        distance in 1e-3..10.0_f64, near in -3.0..3.0_f64, length in 1e-3..10.0_f64, u in share(),
    ) {
        let whole = Equiangular::new(distance, near, near + length).unwrap();
        let t = whole.sample(u);
        prop_assume!(t > near);
        let part = Equiangular::new(distance, near, t).unwrap();
        // t is rounded relative to the size of the stretch, seen from at least the distance.
        let error = 16.0 * U * (PI + (near.abs() + length) / distance);
        prop_assert!((part.angle() - u * whole.angle()).abs() <= error);
    }

    /// S3: orthonormal around every direction.
    #[test]
    fn s3_frames_are_orthonormal(z in direction()) {
        prop_assert!(orthonormality_error(Frame::around(z)) <= 8.0 * U);
    }
}

fn orthonormality_error(Frame { x, y, z }: Frame) -> f64 {
    let lengths = [x, y].map(|axis| (axis.length_squared() - 1.0).abs());
    let angles = [x.cosine_to(y), y.cosine_to(z), z.cosine_to(x)].map(f64::abs);
    let handedness = (x.cross(*y) - *z).length();
    let errors = lengths.into_iter().chain(angles).chain([handedness]);
    errors.fold(0.0, f64::max)
}

#[test]
fn s9_every_warp_at_the_ends_of_the_random_range() {
    let cone = Cone::of_half_angle(0.3).unwrap();
    for (u, v) in [(0.0, 0.0), (0.0, LAST), (LAST, 0.0), (LAST, LAST)] {
        for direction in [
            sphere([u, v]),
            cosine_hemisphere([u, v]),
            cone.direction([u, v]),
        ] {
            assert!((direction.length() - 1.0).abs() <= 8.0 * U);
        }
        assert!(cosine_hemisphere_pdf(cosine_hemisphere([u, v]).z) > 0.0);
        let depth = truncated_optical_distance(opacity(6.0), u);
        // The condition at the end is 67: see `truncated_optical_distance`.
        assert!((0.0..=6.0 * (1.0 + 204.0 * U)).contains(&depth));
        assert!(truncated_free_flight_pdf(2.0, depth, opacity(6.0)) > 0.0);
        for far in [2.0, f64::INFINITY] {
            let light = Equiangular::new(1e-6, 1.0, far).unwrap();
            assert!(light.sample(u).is_finite() && light.pdf(light.sample(u)) > 0.0);
        }
        let turn = phase(0.9).deflection(u);
        assert!(turn.sine().is_finite() && phase(0.9).per_steradian(&turn) > 0.0);
    }
    // No cone has no inside.
    assert_eq!(Cone::of_half_angle(0.0), None);
    assert_eq!(Cone::of_half_angle(f64::NAN), None);
    assert_relative(Cone::of_half_angle(PI).unwrap().pdf(), sphere_pdf(), 2.0);
    // A cone of 1e-9 rad has the solid angle π·1e-18, though its cosine is 1.
    assert_relative(Cone::of_half_angle(1e-9).unwrap().pdf(), 1e18 / PI, 8.0);
}

/// Moments that uniform directions, directions by cosine and those in a cone must have.
#[test]
fn warps_have_the_moments_of_their_densities() {
    let mut moments = [Moments::default(); 4];
    let stream = Stream::new(5, 0, 0);
    for pair in 0..1 << 16 {
        let uv = stream.pair(0, Purpose::Surface, pair);
        let (anywhere, up) = (sphere(uv), cosine_hemisphere(uv));
        let inside = Cone::of_half_angle(0.5).unwrap().direction(uv);
        let values = [anywhere.x * anywhere.x, anywhere.z, up.z, inside.z];
        moments
            .iter_mut()
            .zip(values)
            .for_each(|(moments, value)| moments.add(value));
    }
    let cone_mean = (1.0 + Cone::of_half_angle(0.5).unwrap().cos()) / 2.0;
    let expected = [1.0 / 3.0, 0.0, 2.0 / 3.0, cone_mean];
    for (moments, expected) in moments.iter().zip(expected) {
        let error = (moments.mean() - expected).abs();
        assert!(
            error <= 4.0 * moments.variance_of_mean().unwrap().sqrt(),
            "{expected}"
        );
    }
}

// Exponentials and opacity.

#[test]
fn s10_strongly_coloured_media() {
    let sigma_t = DVec3::new(1e-3, 1.0, 1e3);
    let expected = [0.999_000_499_833_375, 0.367_879_441_171_442_3, 0.0];
    let mut escaped = [Moments::default(); 3];
    let mut all = [Moments::default(); 3];
    let stream = Stream::new(9, 0, 0);
    for sample in 0..1 << 16 {
        let channel = (3.0 * stream.uniform(0, Purpose::Channel, sample)) as usize;
        let u = stream.uniform(0, Purpose::FreeFlight, sample);
        let t = optical_distance(u) / sigma_t[channel];
        let (through, weight) = if t < 1.0 {
            (
                DVec3::ZERO,
                collision_weight(DVec3::ONE, sigma_t, sigma_t * t, DVec3::ONE),
            )
        } else {
            let weight = escape_weight(DVec3::ONE, sigma_t, DVec3::ONE);
            (weight, weight)
        };
        assert!(weight.min_element() >= 0.0 && weight.max_element() <= 3.0 * (1.0 + 4.0 * U));
        for c in 0..3 {
            escaped[c].add(through[c]);
            all[c].add(weight[c]);
        }
    }
    for c in 0..3 {
        let error = |moments: &Moments, expected: f64| {
            (moments.mean() - expected).abs() / moments.variance_of_mean().unwrap().sqrt()
        };
        // The blue channel lets 1e-435 through: 0, without variance.
        assert!(expected[c] == escaped[c].mean() || error(&escaped[c], expected[c]) <= 4.0);
        // Whatever does not collide escapes.
        assert!(error(&all[c], 1.0) <= 4.0, "{c}");
    }
}

proptest! {
    #![proptest_config(config())]

    /// Crossing a path in two steps changes nothing.
    #[test]
    fn transmittance_composes(sigma in 0.0..50.0_f64, near in 0.0..4.0_f64, far in 0.0..4.0_f64) {
        let (a, b) = (optical_depth(sigma, near), optical_depth(sigma, far));
        let whole = transmittance(optical_depth(sigma, near + far));
        // exp turns rounding of its argument into relative error.
        let bound = whole * 4.0 * (a + b + 2.0) * U;
        prop_assert!((whole - transmittance(a) * transmittance(b)).abs() <= bound);
    }

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
