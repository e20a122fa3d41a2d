//! Jittered marching: bias and variance separately, without sampling.
//!
//! A step looked at in a random place gives the right depth on average, `E τ̂ = τ`, but
//! `E e^(−τ̂) > e^(−τ)`: the transmittance has a bias, about `½ T Var τ̂`. With one offset for all
//! steps of a ray (a comb) the standard deviation of the depth falls as `h` and the bias as `h²`;
//! with one for each step as `h^(3/2)` and `h³`.
//!
//! Offsets here take one of 64 equally likely values, `(k + ½)/64` of a step. All expectations are
//! then finite sums, and exact: a linear extinction has `1 − 64^(−2)` of the variance that
//! continuous offsets give it.

use super::order::{ExpectedOrder, order};
use super::profile::Profile;
use super::results::{JitterCurve, JitterPoint, Norms};
use crate::geometry::Span;
use crate::math::{Sum, exp_m1, ln_1p};
use crate::render::classified::steps::Steps;

/// Values that an offset may take.
const OFFSETS: usize = 64;

/// Kind of jitter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jitter {
    /// One offset for all steps of a ray.
    Comb,
    /// One for each step.
    Stratified,
}

impl Jitter {
    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Jitter::Comb => "one offset per ray (comb)",
            Jitter::Stratified => "one offset a step (stratified)",
        }
    }

    /// Orders of the standard deviation of the depth and of the bias of the transmittance.
    pub fn orders(self) -> [f64; 2] {
        match self {
            Jitter::Comb => [1.0, 2.0],
            Jitter::Stratified => [1.5, 3.0],
        }
    }

    /// Bias and variance of the transmittance of `profile` with steps of `step`.
    pub fn split(self, profile: &Profile<'_>, step: f64) -> JitterPoint {
        let steps = Steps::over(profile.span(), step);
        // How far the depth is off, by offset, of one step or of all.
        let mut comb = [0.0; OFFSETS];
        let (mut variance, mut first, mut second) =
            (Sum::default(), Sum::default(), Sum::default());
        for index in 0..steps.count() {
            let (middle, length) = steps.sample(index);
            let near = middle - 0.5 * length;
            let mut off: [f64; OFFSETS] = std::array::from_fn(|k| {
                length * profile.at(near + length * (k as f64 + 0.5) / OFFSETS as f64)
            });
            let mean = off.iter().sum::<f64>() / OFFSETS as f64;
            off.iter_mut().for_each(|off| *off -= mean);
            match self {
                Jitter::Comb => comb.iter_mut().zip(off).for_each(|(all, off)| *all += off),
                Jitter::Stratified => {
                    let [own, once, twice] = expectations(&off);
                    variance.add(own);
                    first.add(ln_1p(once));
                    second.add(ln_1p(twice));
                }
            }
        }
        // E e^(−δ) − 1 and E e^(−2δ) − 1, δ being how far the depth is off.
        let [variance, once, twice] = match self {
            Jitter::Comb => expectations(&comb),
            Jitter::Stratified => [
                variance.value(),
                exp_m1(first.value()),
                exp_m1(second.value()),
            ],
        };
        // E e^(−2δ) − (E e^(−δ))².
        let spread = twice - 2.0 * once - once * once;
        JitterPoint {
            step,
            bias: once,
            deviation: spread.max(0.0).sqrt(),
            depth_deviation: variance.sqrt(),
            predicted_bias: 0.5 * variance,
        }
    }

    /// [`Jitter::split`] for each of `steps`, from coarse to fine, and the orders that follow.
    ///
    /// Of a `rough` ray, with detail finer than any step, no order is expected; nor of a comb on a
    /// ray that ends in the extinction in which it begins: what an offset takes at one end it gives
    /// at the other, and the order is higher.
    pub fn curve(self, profile: &Profile<'_>, steps: &[f64], rough: bool) -> JitterCurve {
        let Span { near, far } = profile.span();
        let (first, last) = (profile.at(near), profile.at(far));
        let is_closed = self == Jitter::Comb
            && (first - last).abs() < 0.2 * first.max(last).max(profile.mean());
        let points: Vec<JitterPoint> = steps
            .iter()
            .map(|&step| self.split(profile, step))
            .collect();
        let orders = self.orders();
        let found = |expected: f64, error: fn(&JitterPoint) -> f64| {
            let norms = points.iter().map(|point| Norms {
                l1: error(point),
                l2: error(point),
                max: error(point),
                uncertainty: 0.0,
            });
            let norms: Vec<Norms> = norms.collect();
            // Sums of some hundred terms: what is far above their rounding is known.
            let expected = if rough || is_closed {
                ExpectedOrder::NOTHING
            } else {
                ExpectedOrder::of_step(expected)
            };
            order(steps, &norms, expected, 1e-15)
        };
        JitterCurve {
            jitter: self.name().to_owned(),
            deviation_order: found(orders[0], |point| point.depth_deviation),
            bias_order: found(orders[1], |point| point.bias),
            points,
        }
    }
}

/// `E δ²`, `E e^(−δ) − 1` and `E e^(−2δ) − 1` of equally likely `δ` whose mean is 0. Since it is,
/// `δ` itself may be added below each mean, and what is left does not cancel.
fn expectations(deltas: &[f64; OFFSETS]) -> [f64; 3] {
    let mean = |f: fn(f64) -> f64| {
        let mut sum = Sum::default();
        deltas.iter().for_each(|&delta| sum.add(f(delta)));
        sum.value() / OFFSETS as f64
    };
    [
        mean(|delta| delta * delta),
        mean(|delta| exp_m1(-delta) + delta),
        mean(|delta| exp_m1(-2.0 * delta) + 2.0 * delta),
    ]
}
