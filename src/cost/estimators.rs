//! Stochastic estimators of a ray's transmittance: theory and measurement.

use super::profile::{BoundedSegment, Profile};
use super::results::{
    EstimatorRow, EstimatorTable, ThicknessCurve, ThicknessPoint, ThicknessSweep, Times,
};
use super::timing::{Clock, Task};
use super::unbiased_ray_marching;
use crate::math::rng::{Purpose, Stream};
use crate::math::{Moments, exp};
use crate::optics::collocation::{Collocation, LocalProperties};
use crate::optics::estimators::{delta_tracking_variance, ratio_tracking_variance};
use crate::render::radiative::sampler::{NumberRow, Sampler};
use crate::render::radiative::tracking::{
    Control, Effort, Small, TentativeNumbers, delta_tracking, ratio_tracking,
};
use glam::DVec3;
use rayon::prelude::*;

/// An unbiased estimator of transmittance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TransmittanceEstimator {
    /// 1 for a flight that gets through, 0 for one that does not.
    Delta,
    /// Product of the shares of tentative collisions that are null.
    Ratio,
    /// Ratio tracking relative to the lower bound of each segment: that of the fast renderer.
    ResidualRatio,
    /// A series around a marched depth, ended by chance.
    UnbiasedMarching,
}

/// One estimate and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EstimatorSample {
    /// The estimate.
    pub value: f64,
    /// Lookups.
    pub lookups: u64,
    /// Random numbers drawn.
    pub draws: u64,
}

impl TransmittanceEstimator {
    /// All estimators.
    pub const ALL: [TransmittanceEstimator; 4] = [
        TransmittanceEstimator::Delta,
        TransmittanceEstimator::Ratio,
        TransmittanceEstimator::ResidualRatio,
        TransmittanceEstimator::UnbiasedMarching,
    ];

    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            TransmittanceEstimator::Delta => "delta tracking",
            TransmittanceEstimator::Ratio => "ratio tracking",
            TransmittanceEstimator::ResidualRatio => "residual ratio tracking",
            TransmittanceEstimator::UnbiasedMarching => "unbiased ray marching",
        }
    }

    /// One estimate for `profile`, with the random numbers of `stream`.
    pub fn sample(self, profile: &Profile<'_>, stream: &Stream) -> EstimatorSample {
        let mut sampler = Sampler::new(*stream);
        let mut numbers = sampler.tentative(NumberRow::Transmittance);
        let mut walk = profile.walk();
        let mut effort = Effort::default();
        let mut ratio = |control, numbers: &mut _| {
            ratio_tracking(&mut walk, control, Small::Kept, numbers, &mut effort).x
        };
        let value = match self {
            TransmittanceEstimator::UnbiasedMarching => {
                return by_unbiased_marching(profile, stream);
            }
            TransmittanceEstimator::Ratio => ratio(Control::None, &mut numbers),
            TransmittanceEstimator::ResidualRatio => ratio(Control::Minorant, &mut numbers),
            TransmittanceEstimator::Delta => {
                let first = numbers.next();
                let mut survived = DVec3::ONE;
                let end = delta_tracking(
                    &mut walk,
                    0,
                    first,
                    &mut numbers,
                    &mut survived,
                    &mut effort,
                );
                if end.is_break() { 0.0 } else { 1.0 }
            }
        };
        EstimatorSample {
            value,
            lookups: walk.lookups,
            draws: sampler.given(),
        }
    }

    /// Variance and mean lookups of one estimate by theory, where there is one.
    fn predicted(self, known: &Known) -> (Option<f64>, Option<f64>) {
        let depth = known.depth;
        let (variance, lookups) = match self {
            TransmittanceEstimator::Delta => {
                (Some(delta_tracking_variance(depth)), known.delta_lookups)
            }
            TransmittanceEstimator::Ratio => (
                Some(ratio_tracking_variance(depth, known.ratio)),
                known.majorant,
            ),
            TransmittanceEstimator::ResidualRatio => (
                Some(ratio_tracking_variance(depth, known.residual)),
                known.residual_majorant,
            ),
            TransmittanceEstimator::UnbiasedMarching => {
                (known.is_constant.then_some(0.0), known.marching_lookups)
            }
        };
        (variance, known.lookups_are_known.then_some(lookups))
    }
}

/// Integrals along a ray that predict variances and lookups.
struct Known {
    depth: f64,
    /// `∫ σ̄ e^(−τ) dt`.
    delta_lookups: f64,
    /// `∫ σ²/σ̄ dt`.
    ratio: f64,
    /// `∫ (σ − c)²/(σ̄ − c) dt`.
    residual: f64,
    /// `∫ σ̄ dt`.
    majorant: f64,
    /// `∫ (σ̄ − c) dt`.
    residual_majorant: f64,
    /// Lookups of unbiased ray marching.
    marching_lookups: f64,
    /// True if the extinction is constant.
    is_constant: bool,
    /// True if the number of lookups is the same everywhere.
    lookups_are_known: bool,
}

/// Accuracy of the predictions: far below the 5 % and the standard errors they are compared with.
const TOLERANCE: f64 = 1e-9;

impl Known {
    fn of(profile: &Profile<'_>, depth: f64) -> Known {
        let collocation = Collocation::new();
        let cuts = profile.cuts();
        let bounds = |t: f64| match profile.segment_at(t) {
            Some(BoundedSegment { low, high, .. }) => (*low, *high),
            None => (0.0, 0.0),
        };
        let share = |squared: f64, bound: f64| if bound > 0.0 { squared / bound } else { 0.0 };
        let attenuated = collocation.light(&cuts, TOLERANCE, |t| LocalProperties {
            extinction: profile.at(t),
            emission: DVec3::new(bounds(t).1, 0.0, 0.0),
        });
        let sums = collocation.light(&cuts, TOLERANCE, |t| {
            let (low, high) = bounds(t);
            let sigma = profile.at(t);
            let above = sigma - low;
            LocalProperties {
                extinction: 0.0,
                emission: DVec3::new(
                    share(sigma * sigma, high),
                    share(above * above, high - low),
                    0.0,
                ),
            }
        });
        let over = |rate: fn(&BoundedSegment) -> f64| -> f64 {
            let segments = profile.segments.iter();
            segments
                .map(|segment| rate(segment) * segment.span.length())
                .sum()
        };
        let each = profile.densities as f64;
        Known {
            depth,
            delta_lookups: each * attenuated.radiance.x,
            ratio: sums.radiance.x,
            residual: sums.radiance.y,
            majorant: each * over(|segment| segment.high),
            residual_majorant: each * over(|segment| segment.high - segment.low),
            marching_lookups: each * marching_lookups(profile),
            lookups_are_known: profile.densities > 0,
            is_constant: profile.segments.iter().all(|segment| {
                let first = profile.segments[0].low;
                segment.low == first && segment.high == first
            }),
        }
    }
}

/// Samples of each estimator in the table, and at each thickness.
const SAMPLES: u32 = 1 << 16;
const SAMPLES_OF_A_SWEEP: u32 = 1 << 14;
/// Samples that are timed.
const SAMPLES_TIMED: u32 = 1 << 12;

/// Statistics of many samples.
struct Measured {
    mean: f64,
    variance: f64,
    /// Standard error of the variance, `√((μ₄ − σ⁴)/n)`.
    variance_error: f64,
    lookups: f64,
}

fn measure(
    estimator: TransmittanceEstimator,
    profile: &Profile<'_>,
    samples: u32,
    seed: u64,
) -> Measured {
    let found: Vec<EstimatorSample> = (0..samples)
        .into_par_iter()
        .map(|number| estimator.sample(profile, &Stream::new(seed, 0, number)))
        .collect();
    let moments: Moments = found.iter().map(|sample| sample.value).collect();
    let (mean, variance) = (moments.mean(), moments.variance().unwrap_or(0.0));
    let fourths = found.iter().map(|sample| {
        let squared = (sample.value - mean) * (sample.value - mean);
        squared * squared
    });
    let count = f64::from(samples);
    let fourth = fourths.sum::<f64>() / count;
    let lookups = found.iter().map(|sample| sample.lookups as f64);
    Measured {
        mean,
        variance,
        variance_error: ((fourth - variance * variance).max(0.0) / count).sqrt(),
        lookups: lookups.sum::<f64>() / count,
    }
}

/// The estimators on one ray of optical depth `depth`.
pub fn table(
    ray: String,
    profile: &Profile<'_>,
    depth: f64,
    seed: u64,
    clock: &Clock,
) -> EstimatorTable {
    let known = Known::of(profile, depth);
    let transmittance = exp(-depth);
    let tasks = TransmittanceEstimator::ALL.map(|estimator| -> Task<'_> {
        Box::new(move || {
            std::hint::black_box(measure(estimator, profile, SAMPLES_TIMED, seed).lookups);
        })
    });
    let times = clock.by_turns(&tasks, f64::from(SAMPLES_TIMED));
    let row = |(estimator, time): (TransmittanceEstimator, Option<Times>)| {
        let Measured {
            mean,
            variance,
            mut variance_error,
            lookups,
        } = measure(estimator, profile, SAMPLES, seed);
        let (predicted_variance, predicted_lookups) = estimator.predicted(&known);
        // What is rare may not have come up at all: theory knows of it.
        let spread = variance.max(predicted_variance.unwrap_or(0.0));
        let standard_error = (spread / f64::from(SAMPLES)).sqrt();
        if estimator == TransmittanceEstimator::Delta {
            // Of something that happens with a small probability p, μ₄ is p as well.
            variance_error = variance_error.max(standard_error);
        }
        // What rounding makes of an estimate that does not vary: a few hundred products.
        let rounding = 1e-12 * transmittance;
        let is_near = |value: f64, theory: f64, bound: f64| (value - theory).abs() <= bound;
        let doubt = 4.0 * variance_error + rounding * rounding;
        EstimatorRow {
            estimator: estimator.name().to_owned(),
            mean,
            bias: mean - transmittance,
            standard_error,
            variance,
            variance_error,
            predicted_variance,
            lookups,
            predicted_lookups,
            variance_times_lookups: variance * lookups,
            variance_times_seconds: time.map(|time| variance * time.median),
            agrees: is_near(mean, transmittance, 4.0 * standard_error + rounding)
                && predicted_variance.is_none_or(|theory| is_near(variance, theory, doubt))
                && predicted_lookups.is_none_or(|theory| is_near(lookups, theory, 0.05 * theory)),
        }
    };
    let rows = TransmittanceEstimator::ALL.into_iter().zip(times);
    EstimatorTable {
        ray,
        depth,
        transmittance,
        samples: SAMPLES,
        rows: rows.map(row).collect(),
    }
}

/// Largest relative variance that so few samples measure.
const WIDE: f64 = 20.0;

/// Optical thicknesses of a sweep: 1e-2 to 1e2, two for each power of ten.
const THICKNESSES: [f64; 9] = [
    0.01,
    0.031_622_776_601_683_79,
    0.1,
    0.316_227_766_016_837_94,
    1.0,
    3.162_277_660_168_379_5,
    10.0,
    31.622_776_601_683_793,
    100.0,
];

/// The estimators on a ray of optical depth `depth > 0`, made thinner and denser.
pub fn sweep(
    ray: String,
    profile: &Profile<'_>,
    depth: f64,
    seed: u64,
    clock: &Clock,
) -> ThicknessSweep {
    let curve = |estimator: TransmittanceEstimator| {
        let mut points = Vec::new();
        for thickness in THICKNESSES {
            if clock.is_over() {
                break;
            }
            let scaled = profile.scaled(thickness / depth);
            let known = Known::of(&scaled, thickness);
            let measured = measure(estimator, &scaled, SAMPLES_OF_A_SWEEP, seed);
            let (variance, lookups) = estimator.predicted(&known);
            let squared = exp(-2.0 * thickness);
            // Weights of a wide spread have a much wider one of their squares.
            let relative = variance.unwrap_or(0.0).max(measured.variance) / squared;
            let is_known = relative < WIDE && measured.variance_error < 0.3 * measured.variance;
            points.push(ThicknessPoint {
                depth: thickness,
                measured: is_known.then(|| measured.variance / squared * measured.lookups),
                predicted: variance
                    .zip(lookups)
                    .map(|(variance, lookups)| variance / squared * lookups),
            });
        }
        ThicknessCurve {
            estimator: estimator.name().to_owned(),
            points,
        }
    };
    ThicknessSweep {
        ray,
        curves: TransmittanceEstimator::ALL.map(curve).into(),
    }
}

/// Steps of a march by the rule of the authors.
fn march_steps(profile: &Profile<'_>) -> u32 {
    unbiased_ray_marching::march_steps(profile.majorant_depth())
}

/// Lookups of an estimate in the mean: none where a bound says that there is nothing.
fn marching_lookups(profile: &Profile<'_>) -> f64 {
    let filled = profile.segments.iter().filter(|segment| segment.high > 0.0);
    let filled: f64 = filled.map(|segment| segment.span.length()).sum();
    let share = filled / profile.span().length();
    f64::from(march_steps(profile)) * unbiased_ray_marching::MEAN_MARCHES * share
}

fn by_unbiased_marching(profile: &Profile<'_>, stream: &Stream) -> EstimatorSample {
    let mut effort = Effort::default();
    let (mut lookups, mut draws) = (0, 0);
    let mut uniform = unbiased_ray_marching::uniform_numbers(stream, 0, Purpose::Tracking);
    let value = unbiased_ray_marching::unbiased_ray_marching(
        |t| (profile.extinction)(t, &mut lookups),
        profile.span(),
        march_steps(profile),
        || {
            draws += 1;
            uniform()
        },
        &mut effort,
    );
    EstimatorSample {
        value,
        lookups,
        draws,
    }
}
