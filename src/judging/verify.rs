//! Comparison of volref's images with its own goldens.

use super::finding::{CheckedGolden, MOST_CASES};
use super::results::SAME_BITS;
use super::truth::judge_by_truth;
use super::{CaseResult, Cause, Evidence, Judged, Verdict};
use crate::compare::{Conditions, Gate, Judgement, Picture, judge, stochastic};
use crate::film::Film;
use crate::render::{self, plans};
use crate::suite::golden::{input_hashes, short};
use crate::suite::rendering::{CaseRendering, Render, render_case};
use crate::suite::{Answer, Case, ERROR_OF_TOLERANCE, Quick, Store, Suite, SuiteError};
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
        let film = render_case(render, &plans(&checked.scene), rendering, progress)
            .map_err(|reason| CaseResult::new(Verdict::Fail, Cause::Mismatch, reason))?
            .film;
        let mut finding = match quick {
            None => compare(&checked, &film),
            Some(quick) => compare_pinned(case, &checked, quick, &film),
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
    let judged = |name: String| {
        let result = CaseResult::new(Verdict::Error, Cause::Golden, reason);
        Judged {
            result: result.of_case(&name, "", Gate::Exact),
            evidence: Evidence::default(),
        }
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
        return CaseResult::new(Verdict::Pass, Cause::None, reason);
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

/// Bits against the hash of the quick rendering, and the rendering against the converged image or the known answer, which
/// is evaluated again: a renderer that is wrong on purpose has the bits, one that was merely rearranged agrees.
fn compare_pinned(case: &Case, checked: &CheckedGolden, quick: &Quick, film: &Film) -> CaseResult {
    let provenance = &checked.golden.provenance;
    let (against, mut judgement) = match case.truth {
        None => {
            let judgement = judge_quick(&checked.golden.film, film);
            (format!("{} samples", provenance.samples), judgement)
        }
        Some(formula) => {
            let known = match formula.image(&checked.scene, case.footprint()) {
                Ok(known) => known,
                Err(reason) => return CaseResult::new(Verdict::Error, Cause::BadInput, reason),
            };
            let mut judgement = judge_by_truth(case, &known, film);
            if known.film.pixel_hash() != provenance.pixels {
                judgement.passed = false;
                let fault = "it does not give the bits of the golden; ";
                judgement.reason.insert_str(0, fault);
            }
            (format!("the known answer {:?}", formula.name), judgement)
        }
    };
    let found = film.pixel_hash();
    let has_bits = found == quick.pixels;
    let bits = match has_bits {
        true => "the same bits as the quick rendering".to_owned(),
        false => format!("other bits ({}) than the quick rendering", short(&found)),
    };
    let however = ["but", "and"][usize::from(has_bits == judgement.passed)];
    let mut reason = format!(
        "{bits} of {} samples ({}), {however} against {against}: {}",
        quick.samples,
        short(&quick.pixels),
        judgement.reason,
    );
    let same_bits = f64::from(u8::from(has_bits));
    judgement.metrics.insert(SAME_BITS.0.to_owned(), same_bits);
    let (verdict, cause) = match has_bits && judgement.passed {
        true => (Verdict::Pass, Cause::None),
        false => {
            reason.push_str(&moved_inputs(checked));
            (Verdict::Fail, Cause::Mismatch)
        }
    };
    CaseResult {
        metrics: judgement.metrics,
        ..CaseResult::new(verdict, cause, reason)
    }
}
