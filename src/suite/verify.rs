//! The reference against its own goldens.

use super::golden::{input_hashes, plan_hash, scene_hash, short};
use super::rendering::{Reference, Renderer, Shot, check_class, render_case};
use super::{
    Case, CaseResult, Cause, Golden, GoldenError, Quick, Sampling, Store, Suite, SuiteError,
    Verdict,
};
use crate::compare::{Gate, Judgement, Picture, judge, stochastic};
use crate::film::Film;
use crate::render::{self, Plan};
use crate::scene::Scene;
use std::collections::BTreeMap;
use std::time::Instant;

/// What a case came to, before time and names are added.
struct Finding {
    verdict: Verdict,
    cause: Cause,
    reason: String,
    metrics: BTreeMap<String, f64>,
}

impl Finding {
    fn new(verdict: Verdict, cause: Cause, reason: impl Into<String>) -> Finding {
        Finding {
            verdict,
            cause,
            reason: reason.into(),
            metrics: BTreeMap::new(),
        }
    }
}

/// Cases among which the false alarms of a suite are divided: as many as any suite has, so that
/// no verdict depends on what other cases there are. It costs little: in place of one case, a
/// thousand move the limit of a block of a 192 × 192 image from 6.4 to 7.4 standard errors.
const MOST_CASES: usize = 1000;

/// How much smaller than the promised resolution the standard error of a golden must be: then a
/// bias of that size is four of them, and the noise of the golden adds to that of a test image
/// of as many samples hardly more than it has itself.
pub(super) const MARGIN: f64 = 4.0;

/// Renders `case` and compares every bit with its golden; of a stochastic case the quick
/// rendering, which must also agree with the converged image. Reads goldens, never writes them.
/// `progress` is told of each finished row of pixels.
pub fn verify(case: &Case, store: &Store, progress: render::Progress<'_>) -> CaseResult {
    verify_with(&Reference, case, store, progress)
}

pub(super) fn verify_with(
    renderer: &dyn Renderer,
    case: &Case,
    store: &Store,
    progress: render::Progress<'_>,
) -> CaseResult {
    let start = Instant::now();
    let finding = examine(renderer, case, store, progress);
    CaseResult {
        name: case.name.clone(),
        family: case.family.clone(),
        class: case.class.clone(),
        verdict: finding.verdict,
        metrics: finding.metrics,
        gate: case.sampling.map_or(Gate::Exact, |_| Gate::Stochastic),
        reason: finding.reason,
        looks_like: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
        work: BTreeMap::new(),
        cause: finding.cause,
    }
}

fn examine(
    renderer: &dyn Renderer,
    case: &Case,
    store: &Store,
    progress: render::Progress<'_>,
) -> Finding {
    let scene = match case.load_scene() {
        Ok(scene) => scene,
        Err(error) => return Finding::new(Verdict::Error, Cause::BadInput, error.to_string()),
    };
    let plans: Vec<Plan> = scene.panels.iter().map(Plan::new).collect();
    if let Err(reason) = check_class(renderer, case, &plans) {
        return Finding::new(Verdict::Error, Cause::BadInput, reason);
    }
    let golden = match Golden::read(store, case) {
        Ok(golden) => golden,
        Err(GoldenError::Missing) => {
            let reason = GoldenError::Missing.to_string();
            return Finding::new(Verdict::Missing, Cause::Golden, reason);
        }
        Err(error) => return Finding::new(Verdict::Error, Cause::Golden, error.to_string()),
    };
    if let Some(reason) = stale(case, &scene, &plans, &golden) {
        return Finding::new(Verdict::Error, Cause::Golden, reason);
    }
    let quick = golden.provenance.quick.clone();
    let shot = quick
        .as_ref()
        .map_or(Shot::Only, |quick| Shot::Quick(quick.samples));
    let film = match render_case(renderer, &scene, &plans, shot, progress) {
        Ok(film) => film,
        Err(reason) => return Finding::new(Verdict::Fail, Cause::Mismatch, reason),
    };
    match quick {
        None => compare(&scene, &plans, golden, film),
        Some(quick) => compare_sampled(&scene, &plans, &golden, &quick, &film),
    }
}

/// A result for each golden that belongs to no case: a case that disappears must not go
/// unnoticed.
pub fn without_case(suite: &Suite) -> Result<Vec<CaseResult>, SuiteError> {
    let names = suite.golden_names()?;
    let unknown = names
        .into_iter()
        .filter(|name| suite.cases().iter().all(|c| c.name != *name));
    let result = |name: String| CaseResult {
        family: name.split('/').next().unwrap_or_default().to_owned(),
        class: String::new(),
        verdict: Verdict::Error,
        metrics: BTreeMap::new(),
        gate: Gate::Exact,
        reason:
            "this golden belongs to no case: restore the manifest, or remove the golden with it"
                .to_owned(),
        looks_like: Vec::new(),
        seconds: 0.0,
        work: BTreeMap::new(),
        cause: Cause::Golden,
        name,
    };
    Ok(unknown.map(result).collect())
}

/// Why the golden is one of another case, scene or plan.
fn stale(case: &Case, scene: &Scene, plans: &[Plan], golden: &Golden) -> Option<String> {
    let provenance = &golden.provenance;
    let (width, height) = (scene.width(), scene.height());
    let size = (golden.film.width(), golden.film.height());
    if provenance.case != case.name {
        return Some(format!(
            "the golden is of the case {:?}, not of this one; restore it from version control",
            provenance.case
        ));
    }
    let what = if provenance.scene != scene_hash(scene) {
        "the scene has changed since the golden was accepted"
    } else if provenance.plan != plan_hash(plans) {
        "the plan has changed since the golden was accepted: what is simulated, or by which kernel"
    } else if provenance.quick.is_some() != case.sampling.is_some() {
        "the class of the case has changed since the golden was accepted"
    } else if let Some(sampling) = case.sampling
        && let Some(quick) = &provenance.quick
        && let Some(what) = stale_sampling(sampling, quick, golden)
    {
        what
    } else if provenance.exposure != case.exposure {
        "the exposure of the case has changed since the golden was accepted"
    } else if size != (width, height) {
        return Some(format!(
            "the golden has {} × {} pixels, the scene asks for {width} × {height}; restore it \
             from version control",
            size.0, size.1
        ));
    } else {
        return None;
    };
    Some(format!(
        "stale: {what}; look at the new picture, then accept it"
    ))
}

fn stale_sampling(sampling: Sampling, quick: &Quick, golden: &Golden) -> Option<&'static str> {
    let provenance = &golden.provenance;
    if provenance.samples != u64::from(sampling.converged) {
        Some("the converged_samples of the case have changed since the golden was accepted")
    } else if quick.samples != sampling.quick {
        Some("the quick_samples of the case have changed since the golden was accepted")
    } else if MARGIN * provenance.error_estimate > sampling.resolution {
        Some("the golden is too noisy for the resolution that the case promises now")
    } else {
        None
    }
}

/// The quick rendering of a case against its converged image.
pub(super) fn judge_quick(converged: &Film, quick: &Film) -> Judgement {
    stochastic::judge(converged, quick, MOST_CASES).expect("both images state their noise")
}

/// What the picture is declared to leave out, said with every comparison made with it.
fn without(plans: &[Plan]) -> String {
    let omitted: Vec<_> = plans.iter().map(|plan| plan.omitted().join(", ")).collect();
    match &omitted[..] {
        all if all.iter().all(String::is_empty) => String::new(),
        [one] => format!("; without {one}"),
        panels => {
            let said = panels
                .iter()
                .enumerate()
                .filter(|(_, names)| !names.is_empty());
            let said: Vec<_> = said
                .map(|(index, names)| format!("panel {} without {names}", index + 1))
                .collect();
            format!("; {}", said.join(", "))
        }
    }
}

fn compare(scene: &Scene, plans: &[Plan], golden: Golden, film: Film) -> Finding {
    if film.pixel_hash() == golden.provenance.pixels {
        let mut reason = format!(
            "the same bits as the golden ({})",
            short(&golden.provenance.pixels)
        );
        reason.push_str(&without(plans));
        return Finding::new(Verdict::Pass, Cause::None, reason);
    }
    let moved = moved_inputs(scene, &golden);
    let (golden, film) = (Picture::Radiance(golden.film), Picture::Radiance(film));
    let radiance = "both images are radiance";
    let exact = judge(Gate::Exact, &golden, &film, 0.0).expect(radiance);
    let tolerant = judge(Gate::Deterministic, &golden, &film, 0.0).expect(radiance);
    let mut reason = exact.reason;
    reason.push_str(if tolerant.passed {
        " (within the tolerance for other renderers)"
    } else {
        " (beyond the tolerance for other renderers)"
    });
    reason.push_str(&moved);
    reason.push_str(&without(plans));
    let mut finding = Finding::new(Verdict::Fail, Cause::Mismatch, reason);
    finding.metrics = tolerant.metrics;
    finding.metrics.extend(exact.metrics);
    finding
}

/// Names the input files that are not those of the golden, as the end of a sentence.
fn moved_inputs(scene: &Scene, golden: &Golden) -> String {
    let inputs = input_hashes(scene);
    let moved: Vec<_> = inputs
        .iter()
        .filter(|(path, hash)| golden.provenance.inputs.get(*path) != Some(hash))
        .map(|(path, _)| path.as_str())
        .collect();
    match moved.is_empty() {
        true => String::new(),
        false => format!(
            "; input changed since the golden was made: {}",
            moved.join(", ")
        ),
    }
}

/// Bits against the hash of the quick rendering, and noise against the converged image: a
/// renderer that is wrong on purpose has the bits, one that was merely rearranged the noise.
fn compare_sampled(
    scene: &Scene,
    plans: &[Plan],
    golden: &Golden,
    quick: &Quick,
    film: &Film,
) -> Finding {
    let judgement = judge_quick(&golden.film, film);
    let has_bits = film.pixel_hash() == quick.pixels;
    let bits = if has_bits {
        format!(
            "the same bits as the quick rendering of {} samples ({})",
            quick.samples,
            short(&quick.pixels)
        )
    } else {
        format!(
            "other bits than the quick rendering of {} samples ({}, the golden says {})",
            quick.samples,
            short(&film.pixel_hash()),
            short(&quick.pixels)
        )
    };
    let however = if has_bits == judgement.passed {
        "and"
    } else {
        "but"
    };
    let mut reason = format!(
        "{bits}, {however} against {} samples: {}",
        golden.provenance.samples, judgement.reason
    );
    let passed = has_bits && judgement.passed;
    if !passed {
        reason.push_str(&moved_inputs(scene, golden));
    }
    reason.push_str(&without(plans));
    let mut finding = match passed {
        true => Finding::new(Verdict::Pass, Cause::None, reason),
        false => Finding::new(Verdict::Fail, Cause::Mismatch, reason),
    };
    finding.metrics = judgement.metrics;
    finding
        .metrics
        .insert("same_bits".to_owned(), f64::from(u8::from(has_bits)));
    finding
}
