//! A result with its evidence, and the golden that a case is compared with.

use super::nothing_drawn::shows_nothing;
use super::{CaseResult, Cause, Evidence, Verdict};
use crate::compare::{Conditions, Judgement, Picture, Sensitivity};
use crate::conventions::Profile;
use crate::render::{plans, render};
use crate::scene::{Panel, Precision, Sampling, Scene};
use crate::suite::golden::{accept_advice, plan_hash, scene_hash, short};
use crate::suite::rendering::check_class;
use crate::suite::sensitivities;
use crate::suite::{Case, Golden, GoldenError, Quick, Store};

/// A result, and the images behind it.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The result of the case.
    pub result: CaseResult,
    /// Evidence for a report.
    pub evidence: Evidence,
}

impl Judged {
    /// True if the image differs from its golden, and can be compared with it pixel by pixel, so
    /// that a search for the cause makes sense.
    pub fn differs(&self) -> bool {
        let comparable = || match (&self.evidence.golden, &self.evidence.test) {
            (Some(golden), Some(Picture::Radiance(test))) => golden.is_comparable(test),
            (Some(golden), Some(codes)) => codes.size() == (golden.width(), golden.height()),
            _ => false,
        };
        let is_open = self.result.cause == Cause::Mismatch && !self.result.cause_is_said;
        is_open && comparable()
    }
}

impl From<Judgement> for CaseResult {
    fn from(judgement: Judgement) -> CaseResult {
        let (verdict, cause) = match (judgement.passed, judgement.undecided) {
            (true, None) => (Verdict::Pass, Cause::None),
            (true, Some(_)) => (Verdict::Inconclusive, Cause::Undecided),
            (false, _) => (Verdict::Fail, Cause::Mismatch),
        };
        CaseResult {
            metrics: judgement.metrics,
            gate: judgement.gate,
            changes: judgement.changes,
            detectable: judgement.detectable,
            ..CaseResult::new(verdict, cause, judgement.reason)
        }
    }
}

/// The scene of a case, and its golden, which was checked against it.
#[derive(Debug)]
pub(crate) struct CheckedGolden {
    pub scene: Scene,
    pub golden: Golden,
    /// Name of the profile under which the image was rendered, in place of the golden.
    pub profile: Option<String>,
    /// Derivatives of the image by the numbers of the scene, where they are kept and were asked for.
    pub sensitivities: Vec<Sensitivity>,
    /// Cases among which the false alarms are divided.
    pub cases: usize,
}

impl CheckedGolden {
    /// Loads scene and golden of `case`; an error in either is a finding.
    pub fn load(case: &Case, store: &Store) -> Result<CheckedGolden, CaseResult> {
        let bad_input = |reason| CaseResult::new(Verdict::Error, Cause::BadInput, reason);
        let bad_golden = |reason| CaseResult::new(Verdict::Error, Cause::Golden, reason);
        let scene = case.load_scene();
        let scene = scene.map_err(|error| bad_input(error.to_string()))?;
        check_class(case, &plans(&scene)).map_err(bad_input)?;
        let mut golden = Golden::read(store, case).map_err(|error| match error {
            GoldenError::Missing(_) => {
                CaseResult::new(Verdict::Missing, Cause::Golden, error.to_string())
            }
            error => bad_golden(error.to_string()),
        })?;
        if let Some(reason) = stale(case, &scene, &golden) {
            return Err(bad_golden(reason));
        }
        if case.truth.is_some() && case.sampling.is_some() {
            // Means of samples are compared with the mean of their distribution.
            golden.film = golden.film.known();
        }
        Ok(CheckedGolden {
            scene,
            golden,
            sensitivities: Vec::new(),
            cases: MOST_CASES,
            profile: None,
        })
    }

    /// [Loads](Self::load) also the kept sensitivities of a stochastic `case`, by which images of other renderers are
    /// judged.
    pub fn load_with_sensitivities(
        case: &Case,
        store: &Store,
    ) -> Result<CheckedGolden, CaseResult> {
        let mut checked = CheckedGolden::load(case, store)?;
        let kept = checked.golden.sensitivities.as_deref();
        if let Some(bytes) = kept.filter(|_| case.sampling.is_some()) {
            let sensitivities = sensitivities::decoded(bytes, &checked.scene);
            checked.sensitivities = sensitivities.map_err(|fault| {
                let reason = GoldenError::sensitivities(case, fault).to_string();
                CaseResult::new(Verdict::Error, Cause::Golden, reason)
            })?;
        }
        Ok(checked)
    }

    /// The scene under the conventions of `profile`, with its image in place of the golden; unchanged
    /// where there is no classified volume. Refused where nothing of the scene is left to see.
    pub fn under(mut self, profile: &Profile) -> Result<CheckedGolden, CaseResult> {
        let failed = |reason| CaseResult::new(Verdict::Error, Cause::BadInput, reason);
        let Some(scene) = profile.applied_to(&self.scene).map_err(failed)? else {
            return Ok(self);
        };
        let rendering = render(&plans(&scene), Sampling::default(), &|| ());
        let film = rendering.map_err(|error| failed(error.to_string()))?.film;
        if shows_nothing(&film, &scene) && !shows_nothing(&self.golden.film, &scene) {
            return Err(failed(format!(
                "the profile {} leaves nothing of this scene to see: an image of the background alone would pass; correct \
                 the profile, or leave out the case",
                profile.name
            )));
        }
        self.golden.film = film;
        self.scene = scene;
        self.profile = Some(profile.name.clone());
        Ok(self)
    }

    /// Longest step of a classified volume of the scene, world units.
    pub fn longest_step(&self) -> f64 {
        let volumes = self.scene.panels.iter().filter_map(Panel::classified);
        volumes.fold(0.0, |longest, volume| longest.max(volume.step))
    }

    /// Conditions under which an image of `case` is judged.
    pub fn conditions(&self, case: &Case) -> Conditions<'_> {
        let mut volumes = self.scene.panels.iter().filter_map(Panel::classified);
        Conditions {
            exposure: case.exposure,
            cases: self.cases,
            promise: Some(case.promise),
            in_single_precision: volumes
                .any(|volume| volume.conventions.precision != Precision::F64),
            opacity: case.opacity,
            sensitivities: &self.sensitivities,
        }
    }

    /// Provenance of the golden, for people.
    pub fn provenance(&self) -> Vec<(String, String)> {
        let of = &self.golden.provenance;
        let mut facts = vec![
            ("golden", short(&of.pixels).to_owned()),
            ("accepted because", of.reason.clone()),
            match &of.truth {
                Some(name) => ("known answer", name.clone()),
                None => ("samples per pixel", of.samples.to_string()),
            },
            ("relative error", format!("{:.2e}", of.error_estimate)),
            ("scene", short(&of.scene).to_owned()),
            ("plan", short(&of.plan).to_owned()),
            ("volref", of.volref.clone()),
            ("libm", of.libm.clone()),
            ("rendered on", of.target.clone()),
        ];
        if !of.record_reason.is_empty() {
            facts.push(("recorded anew because", of.record_reason.clone()));
        }
        if let Some(profile) = &self.profile {
            facts.push(("rendered under the conventions of", profile.clone()));
        }
        if !of.omitted.concat().is_empty() {
            facts.push(("leaves out", of.omitted.concat().join(", ")));
        }
        for (path, hash) in &of.inputs {
            facts.push(("input", format!("{path} ({})", short(hash))));
        }
        let named = |(name, fact): (&str, String)| (name.to_owned(), fact);
        facts.into_iter().map(named).collect()
    }
}

/// Number of cases that share the rate of false alarms of a suite. It is fixed, so that no verdict depends on the other
/// cases of the suite. That costs little: compared with one case, a thousand move the limit of a block of a 192 × 192
/// image from 6.4 to 7.4 standard errors.
pub(crate) const MOST_CASES: usize = 1000;

/// Ratio of the required resolution to the standard error of a golden: a bias of that size is then
/// four standard errors, and the noise of the golden hardly increases that of the comparison.
pub(crate) const MARGIN: f64 = 4.0;

/// Reason why the golden belongs to another case, scene or plan.
fn stale(case: &Case, scene: &Scene, golden: &Golden) -> Option<String> {
    let provenance = &golden.provenance;
    let (width, height) = (scene.width(), scene.height());
    let size = (golden.film.width(), golden.film.height());
    if provenance.case != case.name {
        return Some(format!(
            "the golden is of the case {:?}, not of this one; restore it from version control",
            provenance.case
        ));
    }
    let quick = provenance.quick.as_ref();
    let quick_samples = case.sampling.map(|sampling| sampling.quick);
    let converged = case.sampling.and_then(|sampling| sampling.converged);
    let converged_samples = converged.map(|converged| u64::from(converged.samples));
    let resolution = converged.map_or(f64::INFINITY, |it| it.resolution);
    let changes = [
        (provenance.scene != scene_hash(scene), "scene"),
        (provenance.plan != plan_hash(&plans(scene)), "plan"),
        (
            provenance.truth.as_deref() != case.truth.map(|it| it.name),
            "truth of the case",
        ),
        (is_stale_class(case, quick), "class of the case"),
        (
            quick_samples.is_some_and(|samples| quick.is_some_and(|it| it.samples != samples)),
            "number of quick_samples of the case",
        ),
        (
            converged_samples.is_some_and(|samples| samples != provenance.samples),
            "number of converged_samples of the case",
        ),
        (provenance.exposure != case.exposure, "exposure of the case"),
    ];
    let (recorded, now) = (&provenance.judged_by, &case.judged_by);
    let mut keys = recorded.keys().chain(now.keys());
    let key = keys.find(|key| recorded.get(*key) != now.get(*key));
    let changed = changes.into_iter().find(|(is_changed, _)| *is_changed);
    let changed = changed.map(|(_, what)| what.to_owned());
    let what = match changed.or_else(|| Some(format!("{} of the case", key?))) {
        Some(what) => format!("the {what} has changed since the golden was accepted"),
        None if MARGIN * provenance.error_estimate > resolution => {
            "the golden is too noisy for the resolution that the case requires now".to_owned()
        }
        None if size != (width, height) => {
            return Some(format!(
                "the golden has {} × {} pixels, the scene asks for {width} × {height}; restore it from version control",
                size.0, size.1
            ));
        }
        None => return None,
    };
    Some(format!("stale: {what}; {}", accept_advice(case)))
}

/// True if the renderings that the golden records are those of another class.
fn is_stale_class(case: &Case, quick: Option<&Quick>) -> bool {
    match (case.sampling, case.truth) {
        (Some(_), _) => quick.is_none(),
        (None, Some(_)) => quick.is_none_or(|quick| quick.samples != 1),
        (None, None) => quick.is_some(),
    }
}
