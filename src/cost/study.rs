//! Sweeps of a parameter: every setting is tried once for its error and its work, then all are timed
//! by turns.

use super::norms::{norms, norms_of_channels};
use super::order::{ExpectedOrder, order};
use super::results::{Level, MeanWork, Norms, Offer, Parameter, Price, Reference, Study, Sweep};
use super::timing::{Clock, Task};
use crate::render::Counters;
use crate::render::counters::Work;
use rayon::prelude::*;

/// Outcome of one setting.
#[derive(Clone, Debug, Default)]
pub struct SettingOutcome {
    /// Signed errors, in a fixed order: ray by ray and channel by channel.
    pub errors: Vec<f64>,
    /// Work done for them.
    pub work: Counters,
    /// Rays or pixels that share the work.
    pub rays: usize,
    /// Errors in a row that belong to one place: those of red, green and blue.
    pub channels: usize,
}

impl SettingOutcome {
    /// The outcome of `rays` rays: `error` returns the errors of one by channel, or nothing where
    /// it is left out, and counts its work.
    pub(crate) fn of_rays<const CHANNELS: usize>(
        rays: usize,
        error: &(dyn Fn(usize, &mut Counters) -> Option<[f64; CHANNELS]> + Sync),
    ) -> SettingOutcome {
        let found: Vec<(Option<[f64; CHANNELS]>, Counters)> = (0..rays)
            .into_par_iter()
            .map(|ray| {
                let mut work = Counters::default();
                (error(ray, &mut work), work)
            })
            .collect();
        let mut outcome = SettingOutcome {
            rays,
            channels: CHANNELS,
            ..SettingOutcome::default()
        };
        for (errors, work) in found {
            outcome.work.add(&work);
            outcome.errors.extend(errors.into_iter().flatten());
        }
        outcome
    }
}

/// Run of one setting: the same outcome on every call.
pub(crate) type SettingRun<'a> = Box<dyn Fn() -> SettingOutcome + Send + Sync + 'a>;

/// One setting of a sweep.
pub struct Setting<'a> {
    /// The setting in words.
    pub name: String,
    /// The setting as a number.
    pub value: f64,
    /// The run.
    pub run: SettingRun<'a>,
    /// The same in single precision.
    pub single: Option<SettingRun<'a>>,
}

impl<'a> Setting<'a> {
    /// A setting that is not tried in single precision.
    pub fn new(name: String, value: f64, run: SettingRun<'a>) -> Setting<'a> {
        Setting {
            name,
            value,
            run,
            single: None,
        }
    }
}

/// A sweep before it is run.
pub struct PlannedSweep<'a> {
    /// Name of the approximation.
    pub estimator: String,
    /// True if it is volref's own method.
    pub is_ours: bool,
    /// The parameter that is varied.
    pub parameter: Parameter,
    /// The order that theory expects.
    pub expected: ExpectedOrder,
    /// Settings, from coarse to fine.
    pub settings: Vec<Setting<'a>>,
}

/// Reference of a study, with the unit of its errors.
pub struct Truth<'a> {
    /// Method of the reference.
    pub method: String,
    /// The unit of errors.
    pub scale: f64,
    /// Error of the reference itself at most, in those units.
    pub bound: f64,
    /// By error, true if orders are judged by it; `None` for all.
    pub judged: Option<&'a [bool]>,
}

/// `first`, and after each number its half.
pub(super) const fn halved<const N: usize>(first: f64) -> [f64; N] {
    let mut numbers = [first; N];
    let mut at = 1;
    while at < N {
        numbers[at] = 0.5 * numbers[at - 1];
        at += 1;
    }
    numbers
}

impl Study {
    /// Runs all `planned` sweeps, with prices and without pictures.
    pub fn of(
        name: &'static str,
        quantity: String,
        truth: Truth<'_>,
        planned: &[PlannedSweep<'_>],
        clock: &Clock,
    ) -> Study {
        let sweeps = run_sweeps(planned, &truth, clock);
        Study {
            name: name.to_owned(),
            quantity,
            reference: Reference {
                method: truth.method,
                bound: truth.bound,
            },
            judged_on: None,
            prices: WANTED.map(|error| price(&sweeps, error)).to_vec(),
            pictures: vec![],
            worst_ray: None,
            sweeps,
        }
    }
}

/// Runs all `planned` sweeps, level by level so that each gets its share of the time there is.
fn run_sweeps(planned: &[PlannedSweep<'_>], truth: &Truth<'_>, clock: &Clock) -> Vec<Sweep> {
    let scale = truth.scale;
    let mut levels: Vec<Vec<Level>> = planned.iter().map(|_| Vec::new()).collect();
    let mut cuts: Vec<Option<String>> = vec![None; planned.len()];
    // The same for all settings.
    let mut rays = 1;
    let highest = planned.iter().map(|sweep| sweep.settings.len()).max();
    for index in 0..highest.unwrap_or(0) {
        for (at, sweep) in planned.iter().enumerate() {
            let Some(setting) = sweep.settings.get(index) else {
                continue;
            };
            if clock.is_over() {
                let count = sweep.settings.len();
                cuts[at].get_or_insert_with(|| {
                    format!("the budget was used up after {index} of {count} settings")
                });
                continue;
            }
            let outcome = (setting.run)();
            rays = outcome.rays.max(1);
            let single = setting.single.as_ref().map(|run| {
                let errors = run().errors.into_iter().zip(&outcome.errors);
                norms(errors.map(|(a, b)| a - b), scale)
            });
            let errors = outcome.errors.iter().copied();
            let error_of_order = truth.judged.map(|judged| {
                let judged = errors.clone().zip(judged).filter(|(_, judged)| **judged);
                norms_of_channels(judged.map(|(error, _)| error), scale, outcome.channels)
            });
            levels[at].push(Level {
                setting: setting.name.clone(),
                value: setting.value,
                work: MeanWork::per_ray(&outcome.work, rays),
                error: norms_of_channels(errors, scale, outcome.channels),
                error_of_order,
                single_precision: single,
                time: None,
            });
        }
    }
    time(planned, &mut levels, rays, clock);
    let sweeps = planned.iter().zip(levels).zip(cuts);
    let sweeps = sweeps.map(|((sweep, levels), cut)| {
        let values: Vec<f64> = levels.iter().map(|level| level.value).collect();
        let errors = levels.iter();
        let errors: Vec<Norms> = errors
            .map(|level| level.error_of_order.unwrap_or(level.error))
            .collect();
        Sweep {
            estimator: sweep.estimator.clone(),
            is_ours: sweep.is_ours,
            parameter: sweep.parameter,
            order: order(&values, &errors, sweep.expected, truth.bound),
            levels,
            cut,
        }
    });
    sweeps.collect()
}

/// Times all settings that were tried, for each of `rays`.
fn time(planned: &[PlannedSweep<'_>], levels: &mut [Vec<Level>], rays: usize, clock: &Clock) {
    let tried = planned.iter().zip(levels.iter());
    let tried = tried.flat_map(|(sweep, levels)| &sweep.settings[..levels.len()]);
    let tasks = tried.map(|setting| -> Task<'_> {
        Box::new(|| {
            std::hint::black_box((setting.run)());
        })
    });
    let times = clock.by_turns(&tasks.collect::<Vec<_>>(), rays as f64);
    for (level, time) in levels.iter_mut().flatten().zip(times) {
        level.time = time;
    }
}

/// Wanted errors of the price list.
pub const WANTED: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-6];

/// The cheapest setting of each of the `sweeps`, which may be compared with one another. No setting
/// reaches an error below that of the reference.
fn price(sweeps: &[Sweep], error: f64) -> Price {
    let mut offers: Vec<Offer> = sweeps
        .iter()
        .map(|sweep| {
            // A setting counts only if all finer ones do as well: no lucky hits.
            let good = sweep
                .levels
                .iter()
                .rev()
                .take_while(|level| sweep.order.known <= error && level.error.l2 <= error);
            let cheapest = good.min_by(|a, b| a.work.price().total_cmp(&b.work.price()));
            Offer {
                estimator: sweep.estimator.clone(),
                parameter: sweep.parameter,
                setting: cheapest.map(|level| level.setting.clone()),
                lookups: cheapest.map(|level| level.work.price()),
                seconds: cheapest
                    .and_then(|level| level.time)
                    .map(|time| time.median),
                times_cheapest: None,
            }
        })
        .collect();
    let price = |offer: &Offer| offer.lookups.unwrap_or(f64::INFINITY);
    offers.sort_by(|a, b| price(a).total_cmp(&price(b)));
    let cheapest = offers.first().and_then(|offer| offer.lookups);
    for offer in &mut offers {
        offer.times_cheapest = match (offer.lookups, cheapest) {
            (Some(lookups), Some(cheapest)) if cheapest > 0.0 => Some(lookups / cheapest),
            _ => None,
        };
    }
    Price { error, offers }
}
