//! The view of one case.

use super::pictures::Views;
use super::{pixels, words};
use crate::judging::{CaseResult, Evidence, Known, LikelyMistake, Verdict, metric_meaning};
use minijinja::{Value, context};

/// Changes of parameters that are listed, at most: the others have smaller scores.
const MOST_CHANGES: usize = 12;

/// One case, as the template asks for it, at a position on the page from 0.
pub(super) fn view(
    index: usize,
    result: &CaseResult,
    evidence: &Evidence,
    likely: &[LikelyMistake],
) -> Value {
    let mistake = |name: &String| {
        let known = likely.iter().find(|likely| likely.mistake == *name);
        context! {
            name,
            advice => known.map(|likely| &likely.advice),
        }
    };
    let number = |(name, &value): (&String, &f64)| {
        context! {
            name,
            value => words::digits(value),
            words => metric_meaning(name),
        }
    };
    let views = Views::of(evidence);
    let scale = views.difference_scale(result.gate);
    let small = |codes: &[[u8; 3]], width| pixels::thumbnail(codes, width, pixels::THUMBNAIL);
    let golden = views.golden;
    let small_golden = golden.map(|film| small(&film.srgb_codes(views.exposure), film.width()));
    let srgb = views.test.and_then(|it| it.srgb(views.exposure).ok());
    let small_test = srgb.map(|image| small(image.pixels(), image.width()));
    context! {
        index,
        // A browser decodes it again.
        address => result.name.replace('%', "%25"),
        result,
        symbol => words::symbol(result.verdict),
        gate => result.gate.name(),
        gate_words => result.gate.description().rule,
        // Images of other sizes, for one, are not.
        is_compared => result.verdict == Verdict::Pass || !result.metrics.is_empty(),
        known => result.known.as_ref().map(Known::in_words),
        // With what to do.
        mistakes => result.looks_like.iter().map(mistake).collect::<Vec<_>>(),
        numbers => result.metrics.iter().map(number).collect::<Vec<_>>(),
        // The changes that fit best come first.
        changes => result.changes.iter().take(MOST_CHANGES).collect::<Vec<_>>(),
        // Notes beside the verdict, and oddities of the images.
        notes => result.notes.iter().chain(&views.notes).collect::<Vec<_>>(),
        source => evidence.source,
        shows => evidence.shows,
        computes => evidence.computes,
        provenance => evidence.provenance,
        reproduce => evidence.reproduce.join("\n"),
        call => evidence.call,
        output => evidence.output,
        small_golden,
        small_test,
        // For the script; nothing where there is no image at all.
        pictures => views.packed(&scale),
    }
}
