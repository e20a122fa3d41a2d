//! Climbing ladders: every setting is tried once for its error and its work, then all are timed
//! by turns.

use super::norms::Errors;
use super::order::{Expected, order};
use super::results::{Knob, Ladder, MeanWork, Norms, Offer, Price, Reference, Rung, Study};
use super::timing::Clock;
use crate::render::Counters;

/// What came of one setting.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Signed errors, in a fixed order: ray by ray and channel by channel.
    pub errors: Vec<f64>,
    /// What was done for them.
    pub work: Counters,
    /// Among how many rays or pixels that is shared.
    pub rays: usize,
    /// How many errors in a row belong to one place: those of red, green and blue.
    pub channels: usize,
}

/// Does what one setting says. The same on every call.
pub type Run<'a> = Box<dyn Fn() -> Outcome + Send + Sync + 'a>;

/// One setting of a ladder.
pub struct Setting<'a> {
    /// In words.
    pub name: String,
    /// As a number.
    pub value: f64,
    /// What is done.
    pub run: Run<'a>,
    /// The same in single precision.
    pub single: Option<Run<'a>>,
}

/// A ladder before it is climbed.
pub struct Climb<'a> {
    /// The way to approximate.
    pub estimator: String,
    /// Whether it is what the reference renderer does.
    pub is_ours: bool,
    /// What is turned.
    pub knob: Knob,
    /// What theory says.
    pub expected: Expected,
    /// From coarse to fine.
    pub settings: Vec<Setting<'a>>,
}

/// Climbs all `climbs`, rung by rung so that each gets its share of the time there is. Errors are
/// in units of `scale`; the reference may be off by `bound` of them. Orders are judged by the errors
/// for which `judged` holds, if it is given.
pub fn climb(
    climbs: &[Climb<'_>],
    scale: f64,
    bound: f64,
    judged: Option<&[bool]>,
    clock: &Clock,
) -> Vec<Ladder> {
    let mut rungs: Vec<Vec<Rung>> = climbs.iter().map(|_| Vec::new()).collect();
    let mut cuts: Vec<Option<String>> = vec![None; climbs.len()];
    // The same for all settings.
    let mut rays = 1;
    let highest = climbs.iter().map(|climb| climb.settings.len()).max();
    for level in 0..highest.unwrap_or(0) {
        for (index, climb) in climbs.iter().enumerate() {
            let Some(setting) = climb.settings.get(level) else {
                continue;
            };
            if clock.is_over() {
                cuts[index].get_or_insert_with(|| {
                    format!(
                        "the time given was over after {level} of {} settings",
                        climb.settings.len()
                    )
                });
                continue;
            }
            let outcome = (setting.run)();
            rays = outcome.rays.max(1);
            let single = setting.single.as_ref().map(|run| {
                let errors = run().errors.into_iter().zip(&outcome.errors);
                norms(&errors.map(|(a, b)| a - b).collect::<Vec<_>>(), scale)
            });
            // Channels are off together: there are fewer errors than numbers.
            let channels = outcome.channels as f64;
            let norms = |errors: &[f64]| {
                let norms = norms(errors, scale);
                Norms {
                    uncertainty: norms.uncertainty * channels.max(1.0).sqrt(),
                    ..norms
                }
            };
            let error_of_order = judged.map(|judged| {
                let errors = outcome.errors.iter().zip(judged);
                let judged = errors.filter(|(_, judged)| **judged);
                norms(&judged.map(|(error, _)| *error).collect::<Vec<_>>())
            });
            rungs[index].push(Rung {
                setting: setting.name.clone(),
                value: setting.value,
                work: MeanWork::per_ray(&outcome.work, rays),
                error: norms(&outcome.errors),
                error_of_order,
                single_precision: single,
                time: None,
            });
        }
    }
    time(climbs, &mut rungs, rays, clock);
    let ladders = climbs.iter().zip(rungs).zip(cuts);
    ladders
        .map(|((climb, rungs), cut)| {
            let values: Vec<f64> = rungs.iter().map(|rung| rung.value).collect();
            let errors = rungs.iter();
            let errors: Vec<Norms> = errors
                .map(|rung| rung.error_of_order.unwrap_or(rung.error))
                .collect();
            Ladder {
                estimator: climb.estimator.clone(),
                is_ours: climb.is_ours,
                knob: climb.knob,
                order: order(&values, &errors, climb.expected, bound),
                rungs,
                cut,
            }
        })
        .collect()
}

fn norms(all: &[f64], scale: f64) -> Norms {
    let mut errors = Errors::default();
    all.iter().for_each(|&error| errors.add(error));
    errors.norms(scale)
}

/// Times all settings that were tried, for each of `rays`.
fn time(climbs: &[Climb<'_>], rungs: &mut [Vec<Rung>], rays: usize, clock: &Clock) {
    let tried = climbs.iter().zip(rungs.iter());
    let tried = tried.flat_map(|(climb, rungs)| &climb.settings[..rungs.len()]);
    let tasks: Vec<Box<dyn Fn() + Sync + '_>> = tried
        .map(|setting| -> Box<dyn Fn() + Sync> {
            Box::new(|| {
                std::hint::black_box((setting.run)());
            })
        })
        .collect();
    let tasks: Vec<&(dyn Fn() + Sync)> = tasks.iter().map(|task| &**task).collect();
    let times = clock.by_turns(&tasks, rays as f64);
    for (rung, time) in rungs.iter_mut().flatten().zip(times) {
        rung.time = time;
    }
}

impl Study {
    /// What came of `ladders`, and their prices; without pictures.
    pub fn of(
        name: &'static str,
        quantity: String,
        reference: Reference,
        ladders: Vec<Ladder>,
    ) -> Study {
        Study {
            name,
            quantity,
            reference,
            judged_on: None,
            prices: prices(&ladders),
            pictures: vec![],
            worst_ray: None,
            ladders,
        }
    }
}

/// Wanted errors of the price list.
pub const WANTED: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-6];

/// The cheapest setting of each of the `ladders` that may be compared with one another, for each
/// wanted error. Nothing is said to reach an error that the reference does not know.
fn prices(ladders: &[Ladder]) -> Vec<Price> {
    WANTED.map(|error| price(ladders, error)).to_vec()
}

fn price(ladders: &[Ladder], error: f64) -> Price {
    let mut offers: Vec<Offer> = ladders
        .iter()
        .map(|ladder| {
            // A setting counts only if all finer ones do as well: no lucky hits.
            let good = ladder
                .rungs
                .iter()
                .rev()
                .take_while(|rung| ladder.order.known <= error && rung.error.l2 <= error);
            let cheapest = good.min_by(|a, b| a.work.price().total_cmp(&b.work.price()));
            Offer {
                estimator: ladder.estimator.clone(),
                knob: ladder.knob,
                setting: cheapest.map(|rung| rung.setting.clone()),
                lookups: cheapest.map(|rung| rung.work.price()),
                seconds: cheapest.and_then(|rung| rung.time).map(|time| time.median),
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
