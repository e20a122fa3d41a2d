//! The reference against its own goldens.

use super::golden::{input_hashes, plan_hash, scene_hash, short};
use super::{Case, CaseResult, Cause, Golden, GoldenError, Store, Suite, SuiteError, Verdict};
use crate::compare::{Gate, Picture, judge};
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

/// Renders `case` and compares every bit with its golden. Reads goldens, never writes them.
/// `progress` is told of each finished row of pixels.
pub fn verify(case: &Case, store: &Store, progress: render::Progress<'_>) -> CaseResult {
    let start = Instant::now();
    let finding = examine(case, store, progress);
    CaseResult {
        name: case.name.clone(),
        family: case.family.clone(),
        class: case.class.clone(),
        verdict: finding.verdict,
        metrics: finding.metrics,
        gate: Gate::Exact,
        reason: finding.reason,
        looks_like: Vec::new(),
        seconds: start.elapsed().as_secs_f64(),
        work: BTreeMap::new(),
        cause: finding.cause,
    }
}

fn examine(case: &Case, store: &Store, progress: render::Progress<'_>) -> Finding {
    let scene = match case.load_scene() {
        Ok(scene) => scene,
        Err(error) => return Finding::new(Verdict::Error, Cause::BadInput, error.to_string()),
    };
    let plans: Vec<Plan> = scene.panels.iter().map(Plan::new).collect();
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
    match render::render(&scene, &plans, progress) {
        Ok(rendering) => compare(&scene, &plans, golden, rendering.film),
        Err(error) => Finding::new(Verdict::Fail, Cause::Mismatch, error.to_string()),
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
    let inputs = input_hashes(scene);
    let moved: Vec<_> = inputs
        .iter()
        .filter(|(path, hash)| golden.provenance.inputs.get(*path) != Some(hash))
        .map(|(path, _)| path.as_str())
        .collect();
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
    if !moved.is_empty() {
        reason.push_str(&format!(
            "; input changed since the golden was made: {}",
            moved.join(", ")
        ));
    }
    reason.push_str(&without(plans));
    let mut finding = Finding::new(Verdict::Fail, Cause::Mismatch, reason);
    finding.metrics = tolerant.metrics;
    finding.metrics.extend(exact.metrics);
    finding
}
