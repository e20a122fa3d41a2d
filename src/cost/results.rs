//! Results for a scene, ready to be printed and drawn.

use crate::render::Counters;
pub use crate::render::Event;
use crate::render::counters::PerEvent;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;

/// The cost of accuracy in one scene, or in one panel of it.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Cost {
    /// The scene, as named by the user: a file, or a case.
    pub scene: String,
    /// Title of the panel, where the scene has several.
    pub panel: Option<String>,
    /// The quantities approximated, and the cost of each approximation.
    pub studies: Vec<Study>,
    /// Estimators of one ray's transmittance, predicted and measured.
    pub estimators: Option<EstimatorTable>,
    /// The same estimators in thinner and denser media.
    pub thickness: Option<ThicknessSweep>,
    /// Jittered marching along one ray: bias and variance.
    pub jitter: Option<JitterSplit>,
    /// The cost of each effect by itself.
    pub effects: Vec<EffectPrice>,
    /// Recommended settings.
    pub recommendations: Vec<Recommendation>,
    /// Quantities not measured, with reasons.
    pub notes: Vec<String>,
}

/// One quantity, approximated in several ways.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Study {
    /// The quantity approximated: `image`, `transmittance`, …; a word for files and links.
    pub name: String,
    /// The quantity in a sentence.
    pub quantity: String,
    /// The reference of the errors.
    pub reference: Reference,
    /// The part on which orders are judged, if it is not the whole.
    pub judged_on: Option<String>,
    /// A sweep for every way to approximate it.
    pub sweeps: Vec<Sweep>,
    /// The cheapest setting of each sweep for a wanted error.
    pub prices: Vec<Price>,
    /// Pictures of signed errors.
    pub pictures: Vec<ErrorPicture>,
    /// The ray with the largest error of the default setting.
    pub worst_ray: Option<RayTrace>,
}

/// The reference of errors.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Reference {
    /// Method of the reference.
    pub method: String,
    /// Its own error, relative as in [`Norms`], is at most this: errors not far above it are not
    /// called errors of a setting.
    pub bound: f64,
}

/// Settings of one parameter, from coarse to fine.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Sweep {
    /// The way to approximate: `midpoint`, `delta tracking`, …
    pub estimator: String,
    /// True if it is volref's own method.
    pub is_ours: bool,
    /// The parameter that is varied.
    pub parameter: Parameter,
    /// The settings.
    pub levels: Vec<Level>,
    /// Its order of convergence, expected and measured.
    pub order: ConvergenceOrder,
    /// Reason for ending early, if it did.
    pub cut: Option<String>,
}

/// A parameter that is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Parameter {
    /// Distance between samples along a ray.
    Step,
    /// Distance between samples along a shadow ray.
    ShadowStep,
    /// Distance between the nodes of the grid.
    Spacing,
    /// Edge of a pixel.
    Pixel,
    /// Samples per pixel, or estimates per ray.
    Samples,
    /// Nothing: there is one setting, and it is exact.
    None,
}

/// One setting.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Level {
    /// The setting in words: "0.25 voxels", "16 samples".
    pub setting: String,
    /// The setting as a number: a length, or a number of samples.
    pub value: f64,
    /// Work for each ray (or pixel), mean over them.
    pub work: MeanWork,
    /// Error, relative to the root mean square of the reference.
    pub error: Norms,
    /// The same over those rays alone on which theory expects an order, where these are not all.
    pub error_of_order: Option<Norms>,
    /// Difference of the same setting in single precision, if tried.
    pub single_precision: Option<Norms>,
    /// Time for each ray.
    pub time: Option<Times>,
}

/// Work of a ray, mean over all rays, by event.
pub type MeanWork = PerEvent<f64>;

impl MeanWork {
    /// The events that are reported; studies of single integrals count no others.
    pub const REPORTED: [Event; 8] = [
        Event::DensityLookup,
        Event::GradientLookup,
        Event::CellWalked,
        Event::ShadowRay,
        Event::PhaseEvaluation,
        Event::NullCollision,
        Event::SurfaceTest,
        Event::RandomDraw,
    ];

    /// The counts of `rays` rays, for each of them.
    pub(crate) fn per_ray(counters: &Counters, rays: usize) -> MeanWork {
        counters.map(|count| count as f64 / rays as f64)
    }

    /// The number by which settings are compared: lookups of densities and gradients, or random
    /// numbers where nothing is looked up.
    pub fn price(&self) -> f64 {
        match self.counted() {
            Counted::Lookups => self.lookups(),
            _ => self[Event::RandomDraw],
        }
    }

    /// Lookups of densities and gradients.
    pub fn lookups(&self) -> f64 {
        self[Event::DensityLookup] + self[Event::GradientLookup]
    }

    /// The kind of work that [`MeanWork::price`] counts.
    pub fn counted(&self) -> Counted {
        if self.lookups() > 0.0 {
            Counted::Lookups
        } else if self[Event::RandomDraw] > 0.0 {
            Counted::RandomNumbers
        } else {
            Counted::Nothing
        }
    }
}

/// A map from the keys of the [reported](MeanWork::REPORTED) events to their means.
impl Serialize for MeanWork {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let means = MeanWork::REPORTED.map(|event| (event.key(), self[event]));
        serializer.collect_map(means)
    }
}

impl<'de> Deserialize<'de> for MeanWork {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<MeanWork, D::Error> {
        let means = BTreeMap::<String, f64>::deserialize(deserializer)?;
        let mean = |event: Event| (event, means.get(event.key()).copied().unwrap_or(0.0));
        Ok(MeanWork::from(MeanWork::REPORTED.map(mean)))
    }
}

/// The kind of work that a price counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// Lookups of densities and gradients.
    Lookups,
    /// Random numbers, where nothing is looked up.
    RandomNumbers,
    /// Neither.
    Nothing,
}

/// Sizes of an error over many rays and channels, relative to the root mean square of what is
/// right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Norms {
    /// Mean of the absolute error.
    pub l1: f64,
    /// Root mean square error.
    pub l2: f64,
    /// Largest error.
    pub max: f64,
    /// Relative standard error of the root mean square, as far as these rays stand for others.
    pub uncertainty: f64,
}

/// Wall time for each ray, in seconds, of runs taken by turns with those of the other settings.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Times {
    /// Number of runs.
    pub runs: usize,
    /// Median.
    pub median: f64,
    /// Least.
    pub min: f64,
    /// Most.
    pub max: f64,
    /// Median of the distances from the median.
    pub deviation: f64,
    /// Runs outside of 1.5 interquartile ranges around the quartiles.
    pub outliers: usize,
    /// True if the coefficient of variation is above 5 %.
    pub is_noisy: bool,
}

/// Order of convergence: the error falls as the `order`-th power of the parameter.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ConvergenceOrder {
    /// Order by theory, if there is one; negative for a number of samples.
    pub expected: Option<f64>,
    /// Errors up to this may be those of the reference, and are not counted.
    pub known: f64,
    /// By setting, whether its error is counted.
    pub counted: Vec<bool>,
    /// Order by least squares through the logarithms of the root mean square errors that are
    /// counted.
    pub fitted: Option<f64>,
    /// Order of the largest errors, likewise.
    pub fitted_max: Option<f64>,
    /// Order of the root mean square error from each setting to the next.
    pub local: Vec<Option<f64>>,
    /// Largest distance of `fitted` from `expected`.
    pub tolerance: f64,
    /// Standard error of `fitted`, as far as these rays stand for others.
    pub uncertainty: f64,
    /// The verdict.
    pub verdict: OrderVerdict,
}

/// Verdict on an order of convergence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrderVerdict {
    /// The error falls as expected.
    AsExpected,
    /// Undecided: `fitted` is outside of the tolerance by less than two standard errors.
    TooFewRays,
    /// The error falls otherwise.
    Otherwise,
    /// Too few settings count: too coarse, or below what the reference knows.
    Undecided,
    /// The errors do not fall as a power yet: from setting to setting the order still changes.
    NotYetAPower,
    /// Nothing is expected.
    NothingExpected,
}

/// The cheapest setting of each sweep for a wanted error.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Price {
    /// Wanted root mean square error.
    pub error: f64,
    /// Offers of the sweeps, cheapest first.
    pub offers: Vec<Offer>,
}

/// The price of a sweep for a wanted error.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Offer {
    /// The estimator.
    pub estimator: String,
    /// The parameter that is varied.
    pub parameter: Parameter,
    /// The setting; none if no setting of the sweep reaches the error.
    pub setting: Option<String>,
    /// Lookups for each ray.
    pub lookups: Option<f64>,
    /// Median wall time for each ray, seconds.
    pub seconds: Option<f64>,
    /// Lookups relative to the cheapest.
    pub times_cheapest: Option<f64>,
}

/// Estimators of the transmittance of one ray.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct EstimatorTable {
    /// Description of the ray.
    pub ray: String,
    /// Its optical depth, to the last digits.
    pub depth: f64,
    /// Its transmittance.
    pub transmittance: f64,
    /// Samples of each estimator.
    pub samples: u32,
    /// Estimators, one a row.
    pub rows: Vec<EstimatorRow>,
}

/// An estimator, predicted and measured.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct EstimatorRow {
    /// Name of the estimator.
    pub estimator: String,
    /// Mean of the samples.
    pub mean: f64,
    /// Mean minus truth.
    pub bias: f64,
    /// Standard error of the mean.
    pub standard_error: f64,
    /// Variance of one sample.
    pub variance: f64,
    /// Standard error of the variance.
    pub variance_error: f64,
    /// Variance by theory, where there is one.
    pub predicted_variance: Option<f64>,
    /// Lookups of one sample.
    pub lookups: f64,
    /// Lookups by theory.
    pub predicted_lookups: Option<f64>,
    /// Variance times lookups: the smaller, the better.
    pub variance_times_lookups: f64,
    /// Variance times seconds.
    pub variance_times_seconds: Option<f64>,
    /// Mean within four standard errors, lookups within 5 % and variance within four standard
    /// errors of what was predicted.
    pub agrees: bool,
}

/// Variance times lookups by optical thickness.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ThicknessSweep {
    /// Description of the ray, whose extinction is scaled.
    pub ray: String,
    /// By estimator.
    pub curves: Vec<ThicknessCurve>,
}

/// One estimator in thinner and denser media.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ThicknessCurve {
    /// Name of the estimator.
    pub estimator: String,
    /// By rising optical thickness.
    pub points: Vec<ThicknessPoint>,
}

/// An estimator at one optical thickness.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct ThicknessPoint {
    /// Optical thickness of the ray.
    pub depth: f64,
    /// Relative variance, variance/T², times lookups; as measured, if it could be: where almost
    /// no sample gets through, the spread of a few says nothing.
    pub measured: Option<f64>,
    /// Predicted value, where there is a theory.
    pub predicted: Option<f64>,
}

/// Bias and variance of jittered marching.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct JitterSplit {
    /// Description of the ray.
    pub ray: String,
    /// By kind of jitter.
    pub curves: Vec<JitterCurve>,
}

/// One kind of jitter.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct JitterCurve {
    /// `comb`: one offset for all steps; `stratified`: one for each.
    pub jitter: String,
    /// By falling step.
    pub points: Vec<JitterPoint>,
    /// Order of the standard deviation of the optical depth.
    pub deviation_order: ConvergenceOrder,
    /// Order of the bias of the transmittance.
    pub bias_order: ConvergenceOrder,
}

/// Jittered marching at one step.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct JitterPoint {
    /// The step, world units.
    pub step: f64,
    /// Expected transmittance minus truth, relative to the truth.
    pub bias: f64,
    /// Standard deviation of the transmittance, relative to the truth.
    pub deviation: f64,
    /// Standard deviation of the optical depth.
    pub depth_deviation: f64,
    /// Bias by theory to leading order, `½ Var τ̂`.
    pub predicted_bias: f64,
}

/// Cost of one effect.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct EffectPrice {
    /// The effects simulated.
    pub effect: String,
    /// Work for each pixel.
    pub work: MeanWork,
    /// Time for each pixel.
    pub time: Option<Times>,
    /// Lookups relative to the first of the list.
    pub times_lookups: Option<f64>,
}

/// A recommended setting.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Recommendation {
    /// Root mean square error wanted.
    pub error: f64,
    /// Recommendation in words.
    pub text: String,
    /// The command that renders it.
    pub command: Option<String>,
}

/// Signed error of an image.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct ErrorPicture {
    /// The setting.
    pub setting: String,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Value minus reference, relative to the root mean square of the reference; mean of the
    /// channels, row by row from the top.
    #[serde(skip)]
    pub errors: Vec<f64>,
}

/// Extinction along a ray, and the samples of a setting.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct RayTrace {
    /// Description of the ray.
    pub ray: String,
    /// Description of the setting.
    pub setting: String,
    /// Distance and extinction, finely.
    pub extinction: Vec<[f64; 2]>,
    /// Distance and extinction at the samples.
    pub samples: Vec<[f64; 2]>,
    /// Radiance by this setting.
    pub value: f64,
    /// Radiance of the reference.
    pub reference: f64,
}

/// The machine that measured the times.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Processor, as it calls itself.
    pub processor: String,
    /// Threads used for timing.
    pub threads: usize,
    /// Operating system and architecture.
    pub platform: String,
    /// Compiler.
    pub compiler: String,
    /// `release` or `debug`.
    pub profile: &'static str,
    /// Instruction sets the program was compiled for.
    pub target_features: String,
}
