//! A plot by which a reader can check the noise of an image: p-values of its blocks against the
//! uniform distribution.

use crate::compare::BlockMap;
use minijinja::{Value, context};
use statrs::function::erf::erfc;
use std::f64::consts::SQRT_2;

/// Bars of a histogram.
const BARS: usize = 20;

/// Size of a drawing, in pixels.
const SIZE: [f64; 2] = [260.0, 120.0];

/// Blocks for which a histogram says something, at least: five to a bar.
const LEAST_BLOCKS: usize = 5 * BARS;

/// The histogram of the p-values of the blocks, of the green channel alone: channels often share their random
/// numbers. Images that agree have uniform p-values.
///
/// Source: Jung, Hanika & Dachsbacher 2020, "Detecting bias in Monte Carlo renderers using Welch's
/// t-test", JCGT 9(2).
pub(super) fn p_values(map: &BlockMap) -> Option<Value> {
    if map.deviations.len() < LEAST_BLOCKS {
        return None;
    }
    let mut counts = [0_usize; BARS];
    for [_, z, _] in &map.deviations {
        let p = erfc(z.abs() / SQRT_2);
        counts[((p * BARS as f64) as usize).min(BARS - 1)] += 1;
    }
    let expected = map.deviations.len() as f64 / BARS as f64;
    let spread = 2.0 * (expected * (1.0 - 1.0 / BARS as f64)).sqrt();
    let [width, height] = SIZE;
    // A bar may be cut off: that it is too tall shows anyway.
    let full = 3.0 * expected;
    let y = |count: f64| height - height * (count / full).clamp(0.0, 1.0);
    let digits = |length: f64| format!("{length:.1}");
    let bars = counts.iter().enumerate().map(|(bar, &count)| {
        let y = y(count as f64);
        context! {
            x => digits(width * bar as f64 / BARS as f64 + 1.0),
            y => digits(y),
            height => digits(height - y),
        }
    });
    let (low, high) = (y(expected - spread), y(expected + spread));
    let inside = counts
        .iter()
        .filter(|&&count| (count as f64 - expected).abs() <= spread);
    let inside = inside.count();
    Some(context! {
        bars => bars.collect::<Vec<_>>(),
        bar_width => digits(width / BARS as f64 - 2.0),
        expected => digits(y(expected)),
        high => digits(high),
        band => digits(low - high),
        blocks => map.deviations.len(),
        inside,
        of => BARS,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(deviations: impl Iterator<Item = f64>) -> BlockMap {
        let deviations: Vec<[f64; 3]> = deviations.map(|z| [0.0, z, 0.0]).collect();
        BlockMap {
            columns: 20,
            rows: deviations.len() / 20,
            deviations,
        }
    }

    fn inside(map: &BlockMap) -> i64 {
        let drawn = p_values(map).unwrap();
        drawn.get_attr("inside").unwrap().as_i64().unwrap()
    }

    /// Quantiles of the normal distribution have uniform p-values; of twice as wide a distribution 37 % are
    /// below 1/20.
    #[test]
    fn p_values_of_noise_are_uniform_and_of_other_noise_are_not() {
        use statrs::distribution::{ContinuousCDF, Normal};
        let normal = Normal::new(0.0, 1.0).unwrap();
        let quantile = |i: usize| normal.inverse_cdf((i as f64 + 0.5) / 400.0);
        assert_eq!(inside(&map((0..400).map(quantile))), 20);
        assert!(inside(&map((0..400).map(|i| 2.0 * quantile(i)))) < 18);
        assert!(p_values(&map((0..80).map(quantile))).is_none());
    }
}
