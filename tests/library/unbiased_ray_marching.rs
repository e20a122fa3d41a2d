//! Unbiased ray marching: its mean, its noise and what it costs, against what is known of them
//! beforehand.
//!
//! Seeds are fixed, so nothing fails by chance. Means must agree within four standard errors.

use crate::common::quadrature::integral;
use crate::common::test_ray::{DEPTH, LENGTH, TRANSMITTANCE, smooth};
use glam::DVec3;
use proptest::prelude::*;
use volref::cost::unbiased_ray_marching::*;
use volref::geometry::Span;
use volref::math::rng::{Purpose, Stream};
use volref::math::{Moments, Sum, exp};
use volref::optics::estimators::ratio_tracking_variance;
use volref::render::radiative::sampler::{NumberRow, Sampler};
use volref::render::radiative::tracking::{
    Control, Effort, MajorantSegment, Majorants, Small, ratio_tracking,
};

const SAMPLES: u32 = 400_000;

/// What many estimates came to, and their lookups in the mean.
fn run(sigma: impl Fn(f64) -> f64, length: f64, steps: u32) -> (Moments, f64) {
    let span = Span::new(0.0, length);
    let mut effort = Effort::default();
    let estimates = (0..SAMPLES)
        .map(|sample| {
            let stream = Stream::new(11, 0, sample);
            let uniform = uniform_numbers(&stream, 0, Purpose::Tracking);
            unbiased_ray_marching(&sigma, span, steps, uniform, &mut effort)
        })
        .collect();
    assert_eq!(effort.violations, 0);
    (estimates, effort.lookups as f64 / f64::from(SAMPLES))
}

#[track_caller]
fn has_mean(what: &str, estimates: &Moments, mean: f64) {
    let error = estimates.variance_of_mean().unwrap().sqrt();
    let off = estimates.mean() - mean;
    println!("{what}: mean off by {:.2} standard errors", off / error);
    assert!(off.abs() <= 4.0 * error, "{what}");
}

/// Lookups are `M (1 + N)`. `E[N] = 0.05 (e² − 1)`, and `E[N²] = Σ (2k − 1) P(N ≥ k) =
/// 0.05 (3e² + 1)`, so the variance of `N` is 1.0563.
#[track_caller]
fn costs(what: &str, lookups: f64, steps: u32) {
    let e_squared = exp(2.0);
    let order = 0.05 * (e_squared - 1.0);
    let variance = 0.05 * (3.0 * e_squared + 1.0) - order * order;
    let error = f64::from(steps) * (variance / f64::from(SAMPLES)).sqrt();
    let expected = f64::from(steps) * MEAN_MARCHES;
    println!("{what}: {lookups} lookups of {expected}, standard error {error:.4}");
    assert!((lookups - expected).abs() <= 4.0 * error, "{what}");
}

/// Mean of `e^X` over the offset: what plain marching comes to.
fn marched_mean(steps: u32) -> f64 {
    let step = LENGTH / f64::from(steps);
    integral(0.0, 1.0, 64, |offset| {
        let depth: f64 = (0..steps)
            .map(|index| step * smooth((f64::from(index) + offset) * step))
            .sum();
        exp(-depth)
    })
}

/// No bias with any number of steps, where plain marching with few of them has much.
#[test]
fn the_smooth_ray() {
    for steps in [1, 2, 3, 7, 15, 40] {
        let (found, lookups) = run(smooth, LENGTH, steps);
        let what = format!("{steps} steps");
        println!(
            "{what}: variance {:e}, plain marching off by {:.1} standard errors",
            found.variance().unwrap(),
            (marched_mean(steps) - TRANSMITTANCE) / found.variance_of_mean().unwrap().sqrt()
        );
        has_mean(&what, &found, TRANSMITTANCE);
        costs(&what, lookups, steps);
    }
    // Of plain marching, the bias with two steps and with seven.
    assert!(marched_mean(2) > 1.4 * TRANSMITTANCE);
    assert!(marched_mean(7) > 1.03 * TRANSMITTANCE);
}

#[test]
fn edges() {
    let edge = 0.731_415;
    let step = |t: f64| if t > edge { 2.0 } else { 0.2 };
    let transmittance = exp(-0.2 * edge - 2.0 * (LENGTH - edge));
    for steps in [1, 4, 13] {
        let (found, lookups) = run(step, LENGTH, steps);
        has_mean("one edge", &found, transmittance);
        costs("one edge", lookups, steps);
    }

    // A layer much thinner than a step: most marches miss it.
    let layer = |t: f64| if (1.0..1.01).contains(&t) { 100.0 } else { 0.0 };
    let (found, _) = run(layer, LENGTH, 8);
    has_mean("a thin layer", &found, exp(-1.0));
}

/// Nothing in the way: exactly 1, and the price is that of the fewest steps, 1.32 lookups.
#[test]
fn nothing() {
    let steps = march_steps(0.0);
    assert_eq!(steps, 1);
    let (found, lookups) = run(|_| 0.0, LENGTH, steps);
    assert_eq!((found.mean(), found.variance()), (1.0, Some(0.0)));
    costs("nothing", lookups, steps);
    let (found, _) = run(smooth, 0.0, 3);
    assert_eq!((found.mean(), found.variance()), (1.0, Some(0.0)));
}

#[test]
fn a_constant_extinction_is_free_of_noise() {
    for (sigma, length) in [(1.3, 2.0), (1e-9, 3.0), (40.0, 0.7), (1e-300, 1e300)] {
        for steps in [1, 3, 7, 10] {
            let (found, _) = run(|_| sigma, length, steps);
            assert_eq!(found.variance(), Some(0.0), "{sigma} {steps}");
            // A rounding each of sum, quotient and product, and one of the product here; exp
            // makes of them relative errors, times the depth, and adds an ulp on either side.
            let depth = sigma * length;
            let expected = exp(-depth);
            let bound = expected * (2.0 * depth + 2.0) * f64::EPSILON;
            assert!((found.mean() - expected).abs() <= bound, "{sigma} {steps}");
        }
    }
}

/// One segment with one majorant.
struct MarchedCurve {
    span: Option<Span>,
    high: f64,
}

impl Iterator for MarchedCurve {
    type Item = MajorantSegment;

    fn next(&mut self) -> Option<MajorantSegment> {
        Some(MajorantSegment {
            span: self.span.take()?,
            minorant: DVec3::ZERO,
            majorant: DVec3::splat(self.high),
            emission: DVec3::ZERO,
        })
    }
}

impl Majorants for MarchedCurve {
    fn extinction(&mut self, t: f64) -> DVec3 {
        DVec3::splat(smooth(t))
    }
}

/// Ratio tracking with the best of bounds looks the extinction up 9.6 times. Marches of seven
/// steps do it less often, and their noise is less than a hundredth.
#[test]
fn less_noise_than_ratio_tracking_at_the_same_cost() {
    let high = smooth(LENGTH);
    let mut effort = Effort::default();
    let ratio: Moments = (0..SAMPLES)
        .map(|sample| {
            let mut sampler = Sampler::new(Stream::new(11, 0, sample));
            let mut numbers = sampler.tentative(NumberRow::Transmittance);
            let mut curve = MarchedCurve {
                span: Some(Span::new(0.0, LENGTH)),
                high,
            };
            let nothing = Control::None;
            ratio_tracking(&mut curve, nothing, Small::Kept, &mut numbers, &mut effort).x
        })
        .collect();
    let ratio_lookups = effort.lookups as f64 / f64::from(SAMPLES);
    has_mean("ratio tracking", &ratio, TRANSMITTANCE);
    let predicted = ratio_tracking_variance(DEPTH, 12.725_548_890_177_333 / high);
    let (march, lookups) = run(smooth, LENGTH, 7);
    let [ratio, march] = [ratio, march].map(|found| found.variance().unwrap());
    println!(
        "ratio tracking: {ratio_lookups} lookups, variance {ratio:e} of {predicted:e}\n\
         marching:       {lookups} lookups, variance {march:e}"
    );
    assert!(lookups < ratio_lookups);
    assert!(march < predicted / 100.0);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Against the products of all subsets.
    ///
    /// With `B` the largest of 1 and the values, no mean of order `k` passes `B^k`. A step of the
    /// recursion makes five roundings of numbers no larger than `2B^k`, and hands on earlier
    /// errors in proportions that sum to 1: `10n` units after `n` values. The subsets' products
    /// round `k` times, their sum and mean three times.
    #[test]
    fn symmetric_means_of_all_subsets(values in prop::collection::vec(-2.0..2.0, 0..=10)) {
        let n = values.len();
        let mut sums = vec![(Sum::default(), 0_u32); n + 1];
        for subset in 0_u32..1 << n {
            let chosen = (0..n).filter(|index| subset >> index & 1 == 1);
            let product: f64 = chosen.map(|index| values[index]).product();
            let (sum, count) = &mut sums[subset.count_ones() as usize];
            sum.add(product);
            *count += 1;
        }
        let largest = values.iter().map(|value: &f64| value.abs()).fold(1.0, f64::max);
        let mut power = 1.0;
        let found = elementary_symmetric_means(&values);
        prop_assert_eq!(found.len(), n + 1);
        for (found, (sum, count)) in found.into_iter().zip(sums) {
            let expected = sum.value() / f64::from(count);
            let bound = (11.0 * n as f64 + 3.0) * power * f64::EPSILON / 2.0;
            prop_assert!((found - expected).abs() <= bound, "{found} {expected}");
            power *= largest;
        }
    }
}
