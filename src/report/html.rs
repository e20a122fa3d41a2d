//! Results as one page that needs no network: is it wrong, where, by how much, and what to change.

mod case;
mod measures;
mod pictures;
mod pixels;
mod words;

use crate::suite::{CaseResult, Evidence, Likeness, Summary, Verdict};
use case::CaseView;
use minijinja::{Environment, context};
use rayon::prelude::*;

/// Contents of a page.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Of the page.
    pub title: &'a str,
    /// The command that made it.
    pub command: &'a str,
    /// What came of the cases.
    pub results: &'a [CaseResult],
    /// What belongs to each of them, in the same order; none where there is less of it.
    pub evidence: &'a [Evidence],
    /// Mistakes that explain the failures, most likely first.
    pub likely: &'a [Likeness],
}

/// The page as HTML, a whole file. It asks for nothing outside of itself and works from
/// `file://`.
pub fn results_html(page: &Page<'_>) -> String {
    let none = Evidence::default();
    let mut order: Vec<usize> = (0..page.results.len()).collect();
    order.sort_by_key(|&index| rank(page.results[index].verdict));
    let cases: Vec<CaseView> = order
        .par_iter()
        .enumerate()
        .map(|(position, &index)| {
            let evidence = page.evidence.get(index).unwrap_or(&none);
            CaseView::new(position, &page.results[index], evidence, page.likely)
        })
        .collect();
    let mut families: Vec<&str> = cases
        .iter()
        .map(|case| case.result.family.as_str())
        .collect();
    families.sort_unstable();
    families.dedup();

    let mut environment = Environment::new();
    // Text is escaped because the name ends like this.
    environment
        .add_template("page.html", include_str!("html/template.html"))
        .expect("the template is well-formed");
    let template = environment.get_template("page.html");
    template
        .and_then(|template| {
            template.render(context! {
                title => page.title,
                command => page.command,
                version => env!("CARGO_PKG_VERSION"),
                headline => words::headline(page.results, page.likely),
                verdict => overall(page.results).name(),
                symbol => words::symbol(overall(page.results)),
                likely => page.likely,
                counts => counts(page.results),
                families,
                cases,
                palettes => palettes(),
                style => include_str!("html/page.css"),
                script => include_str!("html/page.js"),
            })
        })
        .expect("the template asks only for what it is given")
}

/// Which cases come first: what is wrong before what is not known, and both before what is right.
fn rank(verdict: Verdict) -> usize {
    match verdict {
        Verdict::Fail => 0,
        Verdict::Inconclusive => 1,
        Verdict::Missing => 2,
        Verdict::Error => 3,
        Verdict::Pass => 4,
    }
}

/// The first verdict in that order that any case has; an empty suite has passed nothing.
fn overall(results: &[CaseResult]) -> Verdict {
    let verdicts = results.iter().map(|result| result.verdict);
    verdicts
        .min_by_key(|&verdict| rank(verdict))
        .unwrap_or(Verdict::Missing)
}

#[derive(serde::Serialize)]
struct Count {
    verdict: &'static str,
    symbol: &'static str,
    count: usize,
}

fn counts(results: &[CaseResult]) -> Vec<Count> {
    let summary = Summary::of(results);
    [
        (Verdict::Fail, summary.fail),
        (Verdict::Inconclusive, summary.inconclusive),
        (Verdict::Missing, summary.missing),
        (Verdict::Error, summary.error),
        (Verdict::Pass, summary.pass),
    ]
    .into_iter()
    .filter(|(_, count)| *count > 0)
    .map(|(verdict, count)| Count {
        verdict: verdict.name(),
        symbol: words::symbol(verdict),
        count,
    })
    .collect()
}

/// The palettes of the maps: of FLIP as in [`crate::compare::flip`], as many colours as it
/// has steps here, and of signed differences, from blue to red, 255 colours so that the one of 0 is in the middle.
#[derive(serde::Serialize)]
struct Palettes {
    magma: Vec<[u8; 3]>,
    signed: Vec<[u8; 3]>,
}

fn palettes() -> Palettes {
    let steps = usize::from(pixels::WHOLE) + 1;
    let magma = (0..steps).map(|i| colorous::MAGMA.eval_rational(i, steps).into_array());
    let signed = (0..255).map(|i| colorous::RED_BLUE.eval_rational(254 - i, 255).into_array());
    Palettes {
        magma: magma.collect(),
        signed: signed.collect(),
    }
}
