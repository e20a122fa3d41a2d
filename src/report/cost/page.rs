//! The cost of accuracy as one page that needs no network and no script.

use super::pictures::{ErrorMaps, pictures};
use super::plot::{self, Plot, Theme};
use super::table::ReportTable;
use super::tables;
use super::words::{self, Mark};
use crate::cost::results::{Cost, Machine, RayTrace, Recommendation, Study};
use minijinja::{Environment, context};
use serde::Serialize;

/// Contents of a page.
#[derive(Clone, Copy, Debug)]
pub struct CostPage<'a> {
    /// Of the page.
    pub title: &'a str,
    /// The command that made it.
    pub command: &'a str,
    /// What was found out, scene by scene.
    pub costs: &'a [Cost],
    /// Where times were taken; none if there are none.
    pub machine: Option<&'a Machine>,
}

/// The page as HTML, a whole file. It asks for nothing outside of itself, runs no script, and works
/// from `file://`.
pub fn cost_html(page: &CostPage<'_>) -> String {
    let costs: Vec<CostView> = page.costs.iter().enumerate().map(CostView::new).collect();
    let judgement = words::judgement(page.costs);
    let faults: Vec<PageFault> = judgement
        .faults
        .into_iter()
        .map(|(mark, text)| PageFault { mark, text })
        .collect();
    let mut environment = Environment::new();
    // Text is escaped because the name ends like this.
    environment
        .add_template("cost.html", include_str!("page/template.html"))
        .expect("the template is well-formed");
    let template = environment.get_template("cost.html");
    template
        .and_then(|template| {
            template.render(context! {
                title => page.title,
                command => page.command,
                version => env!("CARGO_PKG_VERSION"),
                headline => judgement.headline,
                mark => judgement.mark,
                faults,
                costs,
                machine => page.machine.map(words::machine),
                machine_warning => page.machine.and_then(words::machine_warning),
                style => include_str!("page/page.css"),
            })
        })
        .expect("the template asks only for what it is given")
}

#[derive(Serialize)]
struct PageFault {
    mark: Mark,
    text: String,
}

/// One scene or panel, as the template asks for it.
#[derive(Serialize)]
struct CostView<'a> {
    index: usize,
    name: String,
    advice: &'a [Recommendation],
    studies: Vec<StudyView<'a>>,
    orders: Option<Plot>,
    estimators: Option<ReportTable>,
    thickness: Option<Drawn>,
    jitter: Option<JitterView>,
    effects: Option<ReportTable>,
    notes: &'a [String],
}

/// A plot with its numbers.
#[derive(Serialize)]
struct Drawn {
    about: String,
    plot: Plot,
    table: ReportTable,
}

#[derive(Serialize)]
struct JitterView {
    about: String,
    plot: Option<Plot>,
    orders: ReportTable,
    table: ReportTable,
}

#[derive(Serialize)]
struct StudyView<'a> {
    name: &'static str,
    quantity: &'a str,
    method: &'a str,
    bound: String,
    known: String,
    judged_on: Option<&'a str>,
    work: Plot,
    prices: Option<ReportTable>,
    orders: ReportTable,
    sweeps: Vec<ReportTable>,
    pictures: Option<ErrorMaps>,
    worst: Option<WorstView<'a>>,
}

#[derive(Serialize)]
struct WorstView<'a> {
    trace: &'a RayTrace,
    value: String,
    reference: String,
    difference: String,
    samples: usize,
    plot: Plot,
}

impl<'a> CostView<'a> {
    fn new((index, cost): (usize, &'a Cost)) -> CostView<'a> {
        CostView {
            index,
            name: words::scene(cost),
            advice: &cost.recommendations,
            studies: cost.studies.iter().map(StudyView::new).collect(),
            orders: plot::orders(cost, Theme::Page),
            estimators: cost.estimators.as_ref().map(tables::estimators),
            thickness: cost.thickness.as_ref().map(|sweep| Drawn {
                about: sweep.ray.clone(),
                plot: plot::thickness(sweep, Theme::Page),
                table: tables::thickness(sweep),
            }),
            jitter: cost.jitter.as_ref().map(|split| JitterView {
                about: split.ray.clone(),
                plot: plot::jitter(split, Theme::Page),
                orders: tables::jitter_orders(split),
                table: tables::jitter(split),
            }),
            effects: (!cost.effects.is_empty()).then(|| tables::effects(&cost.effects)),
            notes: &cost.notes,
        }
    }
}

impl<'a> StudyView<'a> {
    fn new(study: &'a Study) -> StudyView<'a> {
        let sweeps = study.sweeps.iter();
        StudyView {
            name: study.name,
            quantity: &study.quantity,
            method: &study.reference.method,
            bound: words::error(study.reference.bound),
            known: words::error(words::least_known(study)),
            judged_on: study.judged_on.as_deref(),
            work: plot::work_precision(study, Theme::Page),
            prices: (!study.prices.is_empty()).then(|| tables::prices(study)),
            orders: tables::orders(study),
            sweeps: sweeps.map(|sweep| tables::sweep(study, sweep)).collect(),
            pictures: pictures(&study.pictures),
            worst: study.worst_ray.as_ref().map(WorstView::new),
        }
    }
}

impl<'a> WorstView<'a> {
    fn new(trace: &'a RayTrace) -> WorstView<'a> {
        WorstView {
            trace,
            value: format!("{:.6}", trace.value),
            reference: format!("{:.6}", trace.reference),
            difference: words::error(trace.value - trace.reference),
            samples: trace.samples.len(),
            plot: plot::ray(trace, Theme::Page),
        }
    }
}
