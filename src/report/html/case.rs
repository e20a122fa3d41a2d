//! What the page shows of one case.

use super::measures::{self, Mean};
use super::pictures::{PackedPictures, Views};
use super::{pixels, words};
use crate::compare::DifferenceScale;
use crate::suite::{CaseResult, Evidence, Likeness, metric_meaning};
use serde::Serialize;

/// One case, as the template asks for it.
#[derive(Serialize)]
pub(super) struct CaseView<'a> {
    /// Position on the page, from 0.
    index: usize,
    pub(super) result: &'a CaseResult,
    symbol: &'static str,
    /// Name of the gate, and how it judges.
    gate: &'static str,
    gate_words: &'static str,
    /// Mistakes that the image looks like, with what to do.
    mistakes: Vec<MistakeView<'a>>,
    numbers: Vec<NumberView<'a>>,
    /// Red, green and blue over the image, where there are both images.
    means: Vec<Mean>,
    /// Where the difference is, in words.
    spread_words: Option<String>,
    /// What is to be said beside the verdict, and what is odd about the images.
    notes: Vec<String>,
    source: &'a str,
    shows: &'a str,
    computes: &'a str,
    provenance: &'a [(String, String)],
    reproduce: String,
    call: Option<&'a str>,
    output: Option<String>,
    /// Thumbnails, of golden and test image.
    small_golden: Option<String>,
    small_test: Option<String>,
    /// For the script; nothing where there is no image at all.
    pictures: Option<PackedPictures>,
}

#[derive(Serialize)]
struct MistakeView<'a> {
    name: &'a str,
    advice: Option<&'a str>,
}

#[derive(Serialize)]
struct NumberView<'a> {
    name: &'a str,
    value: String,
    words: &'static str,
}

impl<'a> CaseView<'a> {
    pub(super) fn new(
        index: usize,
        result: &'a CaseResult,
        evidence: &'a Evidence,
        likely: &'a [Likeness],
    ) -> CaseView<'a> {
        let advice = |name: &str| {
            let known = likely.iter().find(|likeness| likeness.mistake == name);
            known.map(|likeness| likeness.advice.as_str())
        };
        let views = Views::of(evidence);
        let films = views.films();
        let scale = views.difference_scale(result.gate);
        CaseView {
            index,
            result,
            symbol: words::symbol(result.verdict),
            gate_words: result.gate.rule(),
            mistakes: result
                .looks_like
                .iter()
                .map(|name| MistakeView {
                    name,
                    advice: advice(name),
                })
                .collect(),
            numbers: result
                .metrics
                .iter()
                .map(|(name, &value)| NumberView {
                    name,
                    value: words::digits(value),
                    words: metric_meaning(name),
                })
                .collect(),
            means: films.map_or_else(Vec::new, |(golden, test)| measures::means(golden, test)),
            spread_words: match &scale {
                DifferenceScale::StandardErrors(map) => Some(measures::odd_blocks(map)),
                _ => films.and_then(|(golden, test)| measures::spread(golden, test)),
            },
            source: &evidence.source,
            shows: &evidence.shows,
            computes: &evidence.computes,
            provenance: &evidence.provenance,
            reproduce: evidence.reproduce.join("\n"),
            call: evidence.call.as_deref(),
            output: evidence.output.as_deref().map(words::shortened),
            small_golden: views
                .golden
                .map(|film| pixels::thumbnail(&film.srgb_codes(views.exposure), film.width())),
            small_test: views.test.and_then(|picture| {
                let srgb = picture.srgb(views.exposure).ok()?;
                Some(pixels::thumbnail(srgb.pixels(), srgb.width()))
            }),
            pictures: views.packed(&scale),
            notes: result.notes.iter().cloned().chain(views.notes).collect(),
            gate: result.gate.name(),
        }
    }
}
