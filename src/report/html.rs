//! Results as one offline page: which cases are wrong, where, by how much, and what to change.

mod case;
mod pictures;
pub(super) mod pixels;
pub(super) mod words;

use super::template::{Template, rendered};
use crate::judging::{CaseResult, Evidence, Verdict};
use crate::naming::Diagnosis;
use minijinja::{Value, context};
use rayon::prelude::*;

/// Contents of a page.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// The command that made it.
    pub command: &'a str,
    /// What loosens the judgements, in one line; empty where nothing does.
    pub judged_with: &'a str,
    /// Results of the cases.
    pub results: &'a [CaseResult],
    /// Evidence for each of them, in the same order; it may be shorter.
    pub evidence: &'a [Evidence],
    /// Findings of the search for the mistakes behind the failures.
    pub found: &'a Diagnosis,
}

const TEMPLATE: Template = Template {
    blocks: include_str!("html/template.html"),
    style: include_str!("html/page.css"),
    script: include_str!("html/page.js"),
};

/// The page as a complete HTML file. It loads nothing else and works from `file://`.
pub fn results_html(page: &Page<'_>) -> String {
    let none = Evidence::default();
    let mut order: Vec<usize> = (0..page.results.len()).collect();
    let rank = |verdict: Verdict| ORDER.iter().position(|&other| other == verdict);
    order.sort_by_key(|&index| rank(page.results[index].verdict));
    let view = |(position, &index): (usize, &usize)| {
        let evidence = page.evidence.get(index).unwrap_or(&none);
        case::view(position, &page.results[index], evidence, &page.found.likely)
    };
    let cases: Vec<Value> = order.par_iter().enumerate().map(view).collect();
    let results = page.results.iter();
    let mut families: Vec<&str> = results.map(|result| result.family.as_str()).collect();
    families.sort_unstable();
    families.dedup();
    let is_there = |verdict: &Verdict| verdict.count(page.results) > 0;
    // An empty suite has passed nothing.
    let overall = ORDER.into_iter().find(is_there).unwrap_or(Verdict::Missing);
    let counts = ORDER.map(|verdict| {
        context! {
            verdict => verdict.name(),
            symbol => words::symbol(verdict),
            count => verdict.count(page.results),
        }
    });
    rendered(
        &TEMPLATE,
        context! {
            title => page.title,
            command => page.command,
            judged_with => page.judged_with,
            headline => words::headline(page.results, page.found),
            verdict => overall.name(),
            symbol => words::symbol(overall),
            likely => page.found.likely,
            conventions => conventions(page.results),
            counts,
            families,
            cases,
            palettes => palettes(),
        },
    )
}

/// Order of the cases: failures before undecided cases, and both before passes.
const ORDER: [Verdict; 6] = [
    Verdict::Fail,
    Verdict::Convention,
    Verdict::Inconclusive,
    Verdict::Missing,
    Verdict::Error,
    Verdict::Pass,
];

/// The conventions behind images, with the number of cases; those of most cases first.
fn conventions(results: &[CaseResult]) -> Vec<Value> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for words in results.iter().flat_map(|result| &result.conventions) {
        match counts.iter_mut().find(|(known, _)| known == words) {
            Some((_, count)) => *count += 1,
            None => counts.push((words, 1)),
        }
    }
    counts.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    let view = |(words, count): (&str, usize)| context! { words, count };
    counts.into_iter().map(view).collect()
}

/// The palettes of the maps: of FLIP as in [`crate::compare::flip`], as many colours as it
/// has steps here, and of signed differences, from blue to red, 255 colours so that the one of 0 is in the middle.
fn palettes() -> Value {
    let steps = usize::from(pixels::WHOLE) + 1;
    let magma = (0..steps).map(|i| colorous::MAGMA.eval_rational(i, steps).into_array());
    let signed = (0..255).map(|i| colorous::RED_BLUE.eval_rational(254 - i, 255).into_array());
    context! {
        magma => magma.collect::<Vec<_>>(),
        signed => signed.collect::<Vec<_>>(),
    }
}
