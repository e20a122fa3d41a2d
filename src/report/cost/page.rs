//! The cost of accuracy as one offline page without scripts.

use super::pictures::pictures;
use super::table::Table;
use super::{plot, tables, words};
use crate::cost::results::{Cost, Machine, Study};
use crate::report::template::rendered;
use minijinja::{Value, context};

/// Contents of a page.
#[derive(Clone, Copy, Debug)]
pub struct CostPage<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// The command that made it.
    pub command: &'a str,
    /// Results by scene.
    pub costs: &'a [Cost],
    /// The machine that measured the times, if any.
    pub machine: Option<&'a Machine>,
}

/// The page as a complete HTML file. It loads nothing else, runs no script, and works from
/// `file://`.
pub fn cost_html(page: &CostPage<'_>) -> String {
    let judgement = words::judgement(page.costs);
    let costs: Vec<Value> = page.costs.iter().map(scene).collect();
    rendered(
        include_str!("page/template.html"),
        context! {
            title => page.title,
            command => page.command,
            version => env!("CARGO_PKG_VERSION"),
            headlines => words::headlines(page.costs),
            verdicts => judgement.counts,
            mark => judgement.mark,
            faults => judgement.faults,
            costs,
            machine => page.machine.map(words::machine),
            machine_warning => page.machine.and_then(words::machine_warning),
            style => include_str!("page/page.css"),
        },
    )
}

/// A scene or panel, as the template asks for it.
fn scene(cost: &Cost) -> Value {
    let studies: Vec<Value> = cost.studies.iter().map(study).collect();
    let table = |table: Table| table.page();
    let effects = (!cost.effects.is_empty()).then(|| tables::effects(&cost.effects).page());
    context! {
        name => words::scene(cost),
        advice => cost.recommendations,
        studies,
        orders => plot::orders(cost),
        estimators => cost.estimators.as_ref().map(tables::estimators).map(table),
        thickness => cost.thickness.as_ref().map(|sweep| context! {
            about => sweep.ray,
            plot => plot::thickness(sweep),
            table => tables::thickness(sweep).page(),
        }),
        jitter => cost.jitter.as_ref().map(|split| context! {
            about => split.ray,
            plot => plot::jitter(split),
            orders => tables::jitter_orders(split).page(),
            table => tables::jitter(split).page(),
        }),
        effects,
        notes => cost.notes,
    }
}

fn study(study: &Study) -> Value {
    let sweeps = study.sweeps.iter();
    let sweeps: Vec<Value> = sweeps
        .map(|sweep| tables::sweep(study, sweep).page())
        .collect();
    context! {
        name => study.name,
        quantity => study.quantity,
        method => study.reference.method,
        bound => words::error(study.reference.bound),
        known => words::error(words::least_known(study)),
        judged_on => study.judged_on,
        work => plot::work_precision(study, plot::Theme::Page),
        prices => (!study.prices.is_empty()).then(|| tables::prices(study).page()),
        orders => tables::orders(study).page(),
        sweeps,
        pictures => pictures(&study.pictures),
        worst => study.worst_ray.as_ref().map(|trace| context! {
            ray => trace.ray,
            setting => trace.setting,
            value => format!("{:.6}", trace.value),
            reference => format!("{:.6}", trace.reference),
            difference => words::error(trace.value - trace.reference),
            samples => trace.samples.len(),
            plot => plot::ray(trace),
        }),
    }
}
