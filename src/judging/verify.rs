//! Comparison of volref's images with its own goldens.

use super::finding::{CheckedGolden, MOST_CASES};
use super::results::SAME_BITS;
use super::truth::judge_by_truth;
use super::{CaseResult, Cause, Evidence, Judged, Verdict};
use crate::compare::{Conditions, Gate, Judgement, Picture, judge, stochastic};
use crate::film::Film;
use crate::known_answers::Formula;
use crate::render::{self, plans};
use crate::suite::ERROR_OF_TOLERANCE;
use crate::suite::golden::{input_hashes, short};
use crate::suite::rendering::{CaseRendering, Render, check_class, render_case};
use crate::suite::{Answer, Case, Golden, Quick, Store, Suite, SuiteError};
use std::time::Instant;

/// Renders `case` and compares every bit with its golden; of a stochastic case the quick
/// rendering, which must also agree with the converged image. A known answer is evaluated again, and
/// the rendering held to it. Reads goldens, never writes them.
/// `progress` is called for each step of the image.
pub fn verify(case: &Case, store: &Store, progress: render::Progress<'_>) -> Judged {
    verify_with(&render::render, case, store, progress)
}

pub(crate) fn verify_with(
    render: &Render<'_>,
    case: &Case,
    store: &Store,
    progress: render::Progress<'_>,
) -> Judged {
    let start = Instant::now();
    let mut evidence = Evidence::of(case);
    let finding = CheckedGolden::load(case, store).and_then(|checked| {
        evidence.provenance = checked.provenance();
        evidence.golden = Some(checked.golden.film.clone());
        let quick = checked.golden.provenance.quick.as_ref();
        let rendering = match (case.sampling, quick) {
            (Some(_), Some(quick)) => CaseRendering::Quick(quick.samples),
            _ => CaseRendering::Only,
        };
        let film = render_case(render, &checked.plans(), rendering, progress)
            .map_err(|reason| CaseResult::new(Verdict::Fail, Cause::Mismatch, reason))?
            .film;
        let mut finding = match (case.truth, quick) {
            (_, None) => compare(&checked, &film),
            (None, Some(quick)) => compare_sampled(&checked, quick, &film),
            (Some(formula), Some(quick)) => {
                compare_with_truth(case, formula, &checked, quick, &film)
            }
        };
        if let Some(answer) = &case.answer {
            // More random samples say more.
            let known = ("known answer".to_owned(), answer.to_string());
            evidence.provenance.push(known);
            let sure = quick.map_or(&film, |_| &checked.golden.film);
            hold_to(answer, sure, &mut finding);
        }
        evidence.test = Some(Picture::Radiance(film));
        Ok(finding)
    });
    let finding = finding.unwrap_or_else(|finding| finding);
    let gate: Gate = match (case.sampling, case.truth) {
        (Some(_), _) => Gate::Stochastic,
        (None, Some(_)) => Gate::Deterministic,
        (None, None) => Gate::Exact,
    };
    Judged {
        result: CaseResult {
            seconds: start.elapsed().as_secs_f64(),
            ..finding.of_case(&case.name, case.class(), gate)
        },
        evidence,
    }
}

/// Adds what there is to look at where a case has no golden for its scene: the golden as it is, if its files are whole,
/// and the image of the scene now.
pub(crate) fn show_unjudged(
    case: &Case,
    store: &Store,
    evidence: &mut Evidence,
    progress: render::Progress<'_>,
) {
    let Ok(scene) = case.load_scene() else { return };
    let plans = plans(&scene);
    if check_class(case, &plans).is_err() {
        return;
    }
    evidence.golden = Golden::read(store, case).ok().map(|golden| golden.film);
    let rendering = match case.sampling {
        Some(sampling) => CaseRendering::Quick(sampling.quick),
        None => CaseRendering::Only,
    };
    let image = render_case(&render::render, &plans, rendering, progress);
    evidence.test = image.ok().map(|image| Picture::Radiance(image.film));
}

/// Judges by the known answer, which outranks the golden.
fn hold_to(answer: &Answer, film: &Film, finding: &mut CaseResult) {
    let margin = answer.margin(film);
    let share = margin.share();
    if share.is_finite() {
        finding.metrics.insert(ERROR_OF_TOLERANCE.to_owned(), share);
    }
    if margin.passed() {
        finding.reason.push_str(&format!(
            "; {share:.4} of the tolerance of its known answer"
        ));
        return;
    }
    finding.reason = format!(
        "not the known answer: {}\neither `answer` or `answer_within` of the \
         manifest is wrong, or the scene, or the renderer\n{}",
        margin.worst(),
        finding.reason
    );
    finding.verdict = Verdict::Fail;
    finding.cause = finding.cause.max(Cause::Mismatch);
}

/// A result for each golden that belongs to no case: a case that disappears must not go
/// unnoticed.
pub(crate) fn without_case(suite: &Suite) -> Result<Vec<Judged>, SuiteError> {
    let names = suite.golden_names()?;
    let unknown = names.into_iter().filter(|name| !suite.has_manifest(name));
    let reason =
        "this golden belongs to no case: restore the manifest, or remove the golden with it";
    let judged = |name: String| Judged {
        result: CaseResult::new(Verdict::Error, Cause::Golden, reason).of_case(
            &name,
            "",
            Gate::Exact,
        ),
        evidence: Evidence::default(),
    };
    Ok(unknown.map(judged).collect())
}

/// The quick rendering of a case against its converged image.
pub(crate) fn judge_quick(converged: &Film, quick: &Film) -> Judgement {
    stochastic::judge(converged, quick, MOST_CASES).expect("both images state their noise")
}

fn compare(checked: &CheckedGolden, film: &Film) -> CaseResult {
    let golden = &checked.golden;
    if film.pixel_hash() == golden.provenance.pixels {
        let reason = format!(
            "the same bits as the golden ({})",
            short(&golden.provenance.pixels),
        );
        let mut finding = CaseResult::new(Verdict::Pass, Cause::None, reason);
        finding.notes.extend(checked.omissions());
        return finding;
    }
    let pictures = [&golden.film, film].map(|film| Picture::Radiance(film.clone()));
    let gates: [Gate; 2] = [Gate::Exact, Gate::Deterministic];
    let [exact, tolerant] = gates.map(|gate| {
        let judgement = judge(gate, &pictures[0], &pictures[1], &Conditions::default());
        judgement.expect("both images are radiance")
    });
    let reason = format!(
        "{} ({} the tolerance for other renderers){}",
        exact.reason,
        if tolerant.passed { "within" } else { "beyond" },
        moved_inputs(checked),
    );
    let mut finding = CaseResult::new(Verdict::Fail, Cause::Mismatch, reason);
    finding.notes.extend(checked.omissions());
    finding.metrics = tolerant.metrics;
    finding.metrics.extend(exact.metrics);
    finding
}

/// Names the input files that differ from those of the golden, as the end of a sentence.
fn moved_inputs(checked: &CheckedGolden) -> String {
    let inputs = input_hashes(&checked.scene);
    let moved: Vec<_> = inputs
        .iter()
        .filter(|(path, hash)| checked.golden.provenance.inputs.get(*path) != Some(hash))
        .map(|(path, _)| path.as_str())
        .collect();
    if moved.is_empty() {
        return String::new();
    }
    let moved = moved.join(", ");
    format!("; input changed since the golden was made: {moved}")
}

/// The rendering against the hash of its bits and against the answer, and the golden against the
/// formula, evaluated again.
fn compare_with_truth(
    case: &Case,
    formula: &Formula,
    checked: &CheckedGolden,
    quick: &Quick,
    film: &Film,
) -> CaseResult {
    let known = match formula.image(&checked.scene, case.footprint()) {
        Ok(known) => known,
        Err(reason) => return CaseResult::new(Verdict::Error, Cause::BadInput, reason),
    };
    let pixels = &checked.golden.provenance.pixels;
    let is_evaluated = known.film.pixel_hash() == *pixels;
    let against = judge_by_truth(case, &known, film);
    let has_bits = film.pixel_hash() == quick.pixels;
    let evaluated = if is_evaluated {
        "which gives the bits of the golden"
    } else {
        "which does not give the bits of the golden"
    };
    let reason = format!(
        "{}; against the known answer {:?}, {evaluated}: {}",
        bits(quick, film, "its rendering"),
        formula.name,
        against.reason,
    );
    let passed = has_bits && is_evaluated && against.passed;
    pinned(checked, passed, has_bits, reason, against)
}

/// Bits against the hash of the quick rendering, and noise against the converged image: a
/// renderer that is wrong on purpose has the bits, one that was merely rearranged the noise.
fn compare_sampled(checked: &CheckedGolden, quick: &Quick, film: &Film) -> CaseResult {
    let golden = &checked.golden;
    let judgement = judge_quick(&golden.film, film);
    let has_bits = film.pixel_hash() == quick.pixels;
    let however = ["but", "and"][usize::from(has_bits == judgement.passed)];
    let rendering = format!("the quick rendering of {} samples", quick.samples);
    let reason = format!(
        "{}, {however} against {} samples: {}",
        bits(quick, film, &rendering),
        golden.provenance.samples,
        judgement.reason,
    );
    let passed = has_bits && judgement.passed;
    pinned(checked, passed, has_bits, reason, judgement)
}

/// The bits of `film` beside those of the `rendering` that the golden records.
fn bits(quick: &Quick, film: &Film, rendering: &str) -> String {
    let (found, recorded) = (film.pixel_hash(), &quick.pixels);
    if found == *recorded {
        format!("the same bits as {rendering} ({})", short(recorded))
    } else {
        format!(
            "other bits than {rendering} ({}, the golden says {})",
            short(&found),
            short(recorded)
        )
    }
}

/// The finding on a rendering whose bits are pinned, with the numbers of `judgement`.
fn pinned(
    checked: &CheckedGolden,
    passed: bool,
    has_bits: bool,
    mut reason: String,
    judgement: Judgement,
) -> CaseResult {
    if !passed {
        reason.push_str(&moved_inputs(checked));
    }
    let mut finding = if passed {
        CaseResult::new(Verdict::Pass, Cause::None, reason)
    } else {
        CaseResult::new(Verdict::Fail, Cause::Mismatch, reason)
    };
    finding.notes.extend(checked.omissions());
    finding.metrics = judgement.metrics;
    let same_bits = f64::from(u8::from(has_bits));
    finding.metrics.insert(SAME_BITS.0.to_owned(), same_bits);
    finding
}
