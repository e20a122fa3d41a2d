//! Ray marching whose mean is the transmittance.
//!
//! Marching a ray in `M` equal steps, all shifted by one random offset, estimates the optical
//! depth `τ` without bias. Call minus such an estimate `X`: its mean is `−τ`. But `e^X` is too
//! large in the mean, for the exponential is convex. The estimator keeps `e^X` and repairs it by
//! terms of higher order, which are seldom evaluated.
//!
//! **The series.** Take `N + 1` independent estimates, and one of them, `X₀`, as *pivot*. For a
//! given pivot
//!
//! ```text
//! e^(−τ) = e^X₀ · Σ_k (−τ − X₀)^k / k!
//! ```
//!
//! The deviations `X_i − X₀` of the others are independent with mean `−τ − X₀`, so a product of
//! any `k` of them has mean `(−τ − X₀)^k`. So has the mean over all choices of `k` among the `N`,
//! `m_k`: the elementary symmetric mean.
//!
//! **The roulette.** `N` is random, independent of the offsets, and the term of order `k` is
//! divided by the probability that it is there at all:
//!
//! ```text
//! e^X₀ · Σ_{k ≤ N} m_k / (k! P(N ≥ k))
//! P(N ≥ 0) = 1,  P(N ≥ 1) = P(N ≥ 2) = 0.1,  P(N ≥ k) = P(N ≥ k − 1) · 2/k
//! ```
//!
//! Nine times in ten it is plain ray marching. From order 1 on `P(N ≥ k) = 0.1 · 2^(k−1)/k!`, so
//! the factorials cancel and the weight of `m_k` is `20/2^k`. The mean over `N` restores each term,
//! that over the offsets gives the series: the mean is `e^(−τ)`, whatever `M`. (Sum and mean may
//! change places where the extinction is bounded, for then the deviations are, and `Σ |d|^k/k!`
//! converges.) Every estimate serves as pivot in turn, and the mean of the results is taken. It
//! has the same mean and less noise. The mean of all estimates would not do as pivot: it depends
//! on each of them, and the products would no longer have the means above.
//!
//! **The cost.** `E[N] = Σ_{k ≥ 1} P(N ≥ k) = 0.05 (e² − 1)`: `M (1 + (e² − 1)/20) = 1.31945 M`
//! lookups in the mean. Where the extinction is constant all `X` are the same number, all
//! deviations are 0, and the result is `e^(−τ)` without noise.
//!
//! An estimate may be negative, or above 1. No bound on the extinction is needed, and so none can
//! be violated. The paper's matching of the ends of the ray, which subtracts a straight line from
//! the extinction, is left out.
//!
//! Source: Kettunen, d'Eon, Pantaleoni & Novák 2021, "An unbiased ray-marching transmittance
//! estimator", ACM TOG 40(4), 137. The roulette is after Bhanot & Kennedy 1985, Phys. Lett. B 157,
//! with `K = c = 2`.

use crate::geometry::Span;
use crate::math::rng::{Purpose, Stream};
use crate::math::{Moments, Sum, cbrt, exp};
use crate::render::radiative::tracking::Effort;

/// Mean lookups of an estimate for each lookup of one march: `1 + (e² − 1)/20`.
pub const MEAN_MARCHES: f64 = 1.319_452_804_946_532_5;

/// Probability of a term beyond the first.
const BEYOND_FIRST: f64 = 0.1;

/// Number of steps of a march by the authors' rule, at least 1, where the optical depth is at most
/// `depth_bound ≥ 0`, finite: the extinction's bound times the length of the ray.
///
/// `∛((0.015 + τ̄)(0.65 + τ̄)(60.3 + τ̄))`, rounded up, is a fit to what a tracking estimator with
/// that bound looks up. The march is as long as makes the mean lookups the same:
/// that, divided by [`MEAN_MARCHES`]. About `0.76 τ̄ + 15` where the bound is large; 1 up to a
/// bound of 0.01. The rule steers noise and cost; there is no bias with any number of steps.
pub fn march_steps(depth_bound: f64) -> u32 {
    let product = (0.015 + depth_bound) * (0.65 + depth_bound) * (60.3 + depth_bound);
    let lookups = cbrt(product).ceil();
    // Saturates where the quotient passes the largest u32.
    ((lookups / MEAN_MARCHES + 0.5) as u32).max(1)
}

/// The random numbers of one estimate: uniform in [0, 1), for one purpose at one bounce of a path,
/// from the first on.
pub fn uniform_numbers(stream: &Stream, bounce: u32, purpose: Purpose) -> impl FnMut() -> f64 {
    let stream = *stream;
    let (mut index, mut pair) = (0_u32, [0.0; 2]);
    move || {
        if index % 2 == 0 {
            pair = stream.pair(bounce, purpose, index / 2);
        }
        let number = pair[(index % 2) as usize];
        index += 1;
        number
    }
}

/// An estimate of the transmittance of `span` (finite) by marches of `steps ≥ 1` lookups each;
/// its mean is the transmittance.
///
/// `extinction` is that at a distance along the ray within `span`, per length, finite. `uniform`
/// returns random numbers, uniform in [0, 1): the first decides how many marches there are, then
/// one shifts each march. Lookups are counted in `effort`.
pub fn unbiased_ray_marching(
    mut extinction: impl FnMut(f64) -> f64,
    span: Span,
    steps: u32,
    mut uniform: impl FnMut() -> f64,
    effort: &mut Effort,
) -> f64 {
    let order = expansion_order(uniform());
    effort.lookups += u64::from(steps) * (order as u64 + 1);
    let mut march = || marched_depth(&mut extinction, span, steps, uniform());
    if order == 0 {
        return exp(-march());
    }
    let depths: Vec<f64> = (0..=order).map(|_| march()).collect();
    let mut deviations = Vec::with_capacity(order);
    let by_pivot = (0..depths.len()).map(|pivot| {
        let others = (0..depths.len()).filter(|&other| other != pivot);
        deviations.clear();
        deviations.extend(others.map(|other| depths[pivot] - depths[other]));
        exp(-depths[pivot]) * weighted_series(&deviations)
    });
    // The running mean of equal numbers is exactly that number.
    by_pivot.collect::<Moments>().mean()
}

/// The optical depth of `span`, by `steps` equal steps that share the offset `offset` in [0, 1).
fn marched_depth(
    extinction: &mut impl FnMut(f64) -> f64,
    span: Span,
    steps: u32,
    offset: f64,
) -> f64 {
    let step = span.length() / f64::from(steps);
    // Rounding must not lead out of the span.
    let point = |index| (span.near + (f64::from(index) + offset) * step).min(span.far);
    let sum: Sum = (0..steps).map(|index| extinction(point(index))).collect();
    sum.value() / f64::from(steps) * span.length()
}

/// The largest `N` with `u < P(N ≥ N)`: the order of the expansion that `u`, uniform in [0, 1),
/// chooses. At most 203, and that for `u = 0` only, where the probabilities run out of numbers.
fn expansion_order(u: f64) -> usize {
    let (mut order, mut next) = (0, BEYOND_FIRST);
    while u < next {
        order += 1;
        // c/(N + 1) with c = 2; from order 1 to order 2 that is 1.
        next *= 2.0 / (order as f64 + 1.0);
    }
    order
}

/// `Σ_k m_k/(k! P(N ≥ k))` with the elementary symmetric means of `deviations`.
fn weighted_series(deviations: &[f64]) -> f64 {
    let means = elementary_symmetric_means(deviations);
    let mut weight = 2.0 / BEYOND_FIRST;
    let mut series = means[0];
    for mean in &means[1..] {
        weight *= 0.5;
        series += weight * mean;
    }
    series
}

/// The elementary symmetric means of `values`, of order 0 to their number `n`: that of order `k`
/// is the mean of the products of `k` of them, over all choices of `k` among `n`.
///
/// A value more makes of the sum of products `e_k` the sum `e_k + x e_(k−1)`. Divided by the
/// number of choices, with `C(n−1, k)/C(n, k) = (n − k)/n` and `C(n−1, k−1)/C(n, k) = k/n`,
/// that is `m_k + (k/n)(x m_(k−1) − m_k)`, which never leaves the size of the result.
///
/// Source: algorithm 1 of the paper.
pub fn elementary_symmetric_means(values: &[f64]) -> Vec<f64> {
    let mut means = vec![0.0; values.len() + 1];
    means[0] = 1.0;
    for (before, &value) in values.iter().enumerate() {
        let count = before + 1;
        for k in (1..=count).rev() {
            let share = k as f64 / count as f64;
            means[k] += share * (value * means[k - 1] - means[k]);
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_come_with_their_probabilities() {
        // P(N ≥ k) = 0.1 · 2^(k−1)/k!, on either side.
        let mut probability = 0.1;
        for order in 1..=12_usize {
            if order > 1 {
                probability *= 2.0 / order as f64;
            }
            assert!(expansion_order(probability * (1.0 - 1e-12)) >= order);
            assert!(expansion_order(probability * (1.0 + 1e-12)) < order);
        }
        assert_eq!(expansion_order(0.1), 0);
        assert_eq!(expansion_order(1.0 - f64::EPSILON / 2.0), 0);
        // Never order 1: whoever passes the first roulette has passed the second.
        assert_eq!(expansion_order(0.1_f64.next_down()), 2);
        assert!(expansion_order(0.0) <= 203);
    }

    #[test]
    fn mean_marches_is_the_sum_of_the_probabilities() {
        let e_squared = exp(2.0);
        assert!((MEAN_MARCHES - (1.0 + (e_squared - 1.0) / 20.0)).abs() <= 2.0 * f64::EPSILON);
        let (mut sum, mut probability) = (1.0, 0.1);
        for k in 1..=30 {
            sum += probability;
            probability *= 2.0 / f64::from(k + 1);
        }
        assert!((MEAN_MARCHES - sum).abs() <= 4.0 * f64::EPSILON);
    }

    /// `1/(k! P(N ≥ k))` from its definition. Powers of two: exact but for the 0.1.
    #[test]
    fn weights_undo_the_roulette() {
        let (mut probability, mut factorial) = (0.1, 1.0);
        for k in 1..=12_usize {
            factorial *= k as f64;
            if k > 1 {
                probability *= 2.0 / k as f64;
            }
            let weight = 20.0 / exp2(k);
            // A rounding for each factor on either side.
            let roundings = 3.0 * k as f64 + 2.0;
            assert!((factorial * probability * weight - 1.0).abs() <= roundings * f64::EPSILON);
        }
        // With one deviation of 0 among two: m₁ = d/2, m₂ = 0.
        assert_eq!(weighted_series(&[0.0, 0.5]), 1.0 + 10.0 * 0.25);
        assert_eq!(weighted_series(&[0.5, 0.5]), 1.0 + 10.0 * 0.5 + 5.0 * 0.25);
        assert_eq!(weighted_series(&[]), 1.0);
    }

    fn exp2(k: usize) -> f64 {
        (1_u64 << k) as f64
    }

    #[test]
    fn steps_by_the_rule() {
        assert_eq!(march_steps(0.0), 1);
        // (0.015)(0.65)(60.3) = 0.588: one lookup. At 9.597 the cube root is 19.02: 20/1.319.
        assert_eq!(march_steps(9.597), 15);
        assert_eq!((march_steps(0.01), march_steps(0.011)), (1, 2));
        assert_eq!(march_steps(1e300), u32::MAX);
        let steps: Vec<u32> = (0..1000).map(|i| march_steps(f64::from(i) * 0.1)).collect();
        assert!(steps.is_sorted());
    }

    #[test]
    fn symmetric_means_of_few_values() {
        assert_eq!(elementary_symmetric_means(&[]), [1.0]);
        assert_eq!(elementary_symmetric_means(&[3.0]), [1.0, 3.0]);
        assert_eq!(elementary_symmetric_means(&[3.0, 5.0]), [1.0, 4.0, 15.0]);
        assert_eq!(elementary_symmetric_means(&[0.0; 5])[1..], [0.0; 5]);
    }

    #[test]
    fn places_of_a_march() {
        let mut points = Vec::new();
        let span = Span::new(1.0, 3.0);
        let mut note = |t| {
            points.push(t);
            1.0
        };
        assert_eq!(marched_depth(&mut note, span, 4, 0.5), 2.0);
        assert_eq!(points, [1.25, 1.75, 2.25, 2.75]);
    }

    #[test]
    fn numbers_are_those_of_the_stream() {
        let stream = Stream::new(3, 5, 7);
        let mut numbers = uniform_numbers(&stream, 2, Purpose::Tracking);
        for index in 0..5 {
            assert_eq!(numbers(), stream.uniform(2, Purpose::Tracking, index));
        }
    }
}
