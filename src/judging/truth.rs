//! Renderings of volref judged by a known answer, with the gates for other renderers.

use super::finding::MOST_CASES;
use crate::compare::{Conditions, Gate, Judgement, Margin, Picture, judge, stochastic};
use crate::film::Film;
use crate::known_answers::KnownImage;
use crate::suite::{Case, ERROR_OF_TOLERANCE};

/// Largest error of volref against an answer where it draws no random numbers, relative to the
/// brightest channel of a pixel, beside the error of the answer itself: its integrals are within
/// 6e-10, and pixels are stored with 24 binary digits.
const WITHIN: f64 = 1e-7;

/// Judges a rendering of `case` by its answer: in noise by the stochastic gate, without it by the
/// deterministic one and, more strictly, within the error of the answer.
pub(crate) fn judge_by_truth(case: &Case, known: &KnownImage, film: &Film) -> Judgement {
    if case.sampling.is_some() {
        let golden = known.film.clone().known();
        return stochastic::judge(&golden, film, MOST_CASES).expect("the answer has no noise");
    }
    let pictures = [&known.film, film].map(|film| Picture::Radiance(film.clone()));
    let [right, found] = &pictures;
    let judgement = judge(Gate::Deterministic, right, found, &Conditions::default());
    let mut judgement = judgement.expect("both images are radiance");
    let margin = margin(known, film);
    if margin.share().is_finite() {
        let name = ERROR_OF_TOLERANCE.to_owned();
        judgement.metrics.insert(name, margin.share());
    }
    if judgement.passed && !margin.passed() {
        judgement.passed = false;
        judgement.reason = format!("not the known answer: {}", margin.worst());
    }
    judgement
}

fn margin(known: &KnownImage, film: &Film) -> Margin {
    let mut margin = Margin::default();
    let width = film.width();
    let pixels = film.radiance().iter().zip(known.film.radiance());
    for (index, (found, right)) in pixels.enumerate() {
        let brightest = right.iter().copied().fold(0.0, f32::max);
        let allowed = (WITHIN + known.error) * f64::from(brightest);
        for (found, right) in found.iter().zip(right) {
            let what = format_args!("pixel ({}, {})", index % width, index / width);
            margin.within(what, f64::from(*found), f64::from(*right), allowed);
        }
    }
    margin
}
