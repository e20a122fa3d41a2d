//! Plots by which a reader can check the noise of an image: p-values of its blocks against the
//! uniform distribution, and its standard error against its samples.

use crate::compare::BlockMap;
use crate::math;
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

/// Room around a plot, in pixels.
const MARGIN: f64 = 12.0;

/// Standard errors against samples, both on logarithmic scales, beside the line with slope −1/2 through the
/// first point: two looks or more.
pub(super) fn by_samples(looks: &[[f64; 2]]) -> Option<Value> {
    let is_positive = |[samples, error]: &&[f64; 2]| *samples > 0.0 && *error > 0.0;
    let logs: Vec<[f64; 2]> = looks
        .iter()
        .filter(is_positive)
        .map(|look| look.map(math::ln))
        .collect();
    let (first, last) = (logs.first()?, logs.last()?);
    let decades = last[0] - first[0];
    if logs.len() < 2 || decades <= 0.0 {
        return None;
    }
    // The line ends within the plot, and so does noise that does not fall at all.
    let end = first[1] - decades / 2.0;
    let errors = || logs.iter().map(|look| look[1]).chain([end]);
    let low = errors().fold(f64::INFINITY, f64::min);
    let high = errors().fold(f64::NEG_INFINITY, f64::max);
    let [width, height] = SIZE;
    let x = |log: f64| MARGIN + (width - 2.0 * MARGIN) * (log - first[0]) / decades;
    let y = |log: f64| MARGIN + (height - 2.0 * MARGIN) * (high - log) / (high - low).max(1e-3);
    let at = |log: [f64; 2]| {
        context! { x => format!("{:.1}", x(log[0])), y => format!("{:.1}", y(log[1])) }
    };
    let slope = (last[1] - first[1]) / decades;
    Some(context! {
        points => logs.iter().map(|&log| at(log)).collect::<Vec<_>>(),
        from => at(*first),
        to => at([last[0], end]),
        samples => [first, last].map(|log| format!("{:.0}", math::exp(log[0]))),
        slope => format!("{slope:.2}").replace('-', "−"),
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

    #[test]
    fn slopes_are_those_of_the_points() {
        let slope = |looks: &[[f64; 2]]| {
            let drawn = by_samples(looks).unwrap();
            drawn.get_attr("slope").unwrap().to_string()
        };
        assert_eq!(slope(&[[64.0, 0.1], [256.0, 0.05]]), "−0.50");
        assert_eq!(slope(&[[64.0, 0.1], [128.0, 0.3], [256.0, 0.1]]), "0.00");
        for looks in [
            &[][..],
            &[[64.0, 0.1]],
            &[[64.0, 0.1], [64.0, 0.1]],
            &[[64.0, 0.0], [128.0, 0.1]],
        ] {
            assert!(by_samples(looks).is_none(), "{looks:?}");
        }
    }
}
