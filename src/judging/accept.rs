//! New goldens, on purpose and with a reason.

#[cfg(test)]
mod tests;

use super::Step;
use super::finding::MARGIN;
use super::truth::judge_by_truth;
use super::verify::judge_quick;
use crate::compare::{Conditions, Gate, Picture, judge, stochastic};
use crate::film::Film;
use crate::known_answers::Formula;
use crate::render::{self, Watch, plans};
use crate::scene::Scene;
use crate::suite::golden::{
    Golden, GoldenImage, Reasons, input_hashes, plan_hash, scene_hash, sensitivities_file,
};
use crate::suite::rendering::{CaseRendering, Render, check_class, render_case};
use crate::suite::{Case, ConvergedSampling, GoldenError, Quick, Store, StoreError, sensitivities};
use miette::Diagnostic;
use std::fmt::Display;
use std::path::PathBuf;
use thiserror::Error;

/// The outcome for the golden of one case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// `family/name`.
    pub case: String,
    /// Change of the golden.
    pub change: Change,
    /// Why, or the difference from the old image.
    pub detail: String,
}

/// Change of a golden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// There was no golden, or no trustworthy one.
    New,
    /// Another image.
    Replaced,
    /// The same image of a changed scene, plan or manifest.
    Recorded,
    /// Nothing changed.
    Unchanged,
}

impl Change {
    /// Word for it, as in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Change::New => "new",
            Change::Replaced => "replaced",
            Change::Recorded => "recorded",
            Change::Unchanged => "unchanged",
        }
    }
}

/// Reason why nothing was accepted. All goldens are unchanged.
#[derive(Debug, Diagnostic, Error)]
pub enum AcceptError {
    /// An image that cannot be a golden, or no images at all.
    #[error("{reason}")]
    #[diagnostic(help("{help}"))]
    Refused {
        /// Reason.
        reason: String,
        /// Remedy.
        help: String,
    },
    /// The files could not be written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// A request for new goldens.
#[derive(Clone, Copy, Debug)]
pub struct Request<'r> {
    /// Fault of the old goldens, or use of the new ones.
    pub reason: &'r str,
    /// The images of sampled cases stay, and only the bits of their quick renderings are recorded
    /// anew: for a renderer that samples in another way what it sampled before.
    pub keep_images: bool,
    /// The environment variable CI is set.
    pub in_ci: bool,
}

impl Request<'_> {
    /// Fails where no golden may change.
    fn check(&self) -> Result<(), AcceptError> {
        let fault = if self.in_ci {
            [
                "goldens are not accepted where CI is set: nobody looks at the images there",
                "accept on your own machine, look at the images, commit them",
            ]
        } else if self.reason.trim().is_empty() {
            [
                "a golden changes only with a reason, and none was given",
                "state what was wrong before, or what a first golden is for: --reason \"…\"",
            ]
        } else {
            return Ok(());
        };
        let [reason, help] = fault.map(str::to_owned);
        Err(AcceptError::Refused { reason, help })
    }
}

/// Renders `cases` and accepts the images as their goldens, all at once or none.
pub fn accept(
    cases: &[&Case],
    store: &Store,
    request: Request<'_>,
    watch: &dyn Watch,
    step: &dyn Fn(Step<'_>),
) -> Result<Vec<Accepted>, AcceptError> {
    accept_with(&render::render, cases, store, request, watch, step)
}

pub(crate) fn accept_with(
    render: &Render<'_>,
    cases: &[&Case],
    store: &Store,
    request: Request<'_>,
    watch: &dyn Watch,
    step: &dyn Fn(Step<'_>),
) -> Result<Vec<Accepted>, AcceptError> {
    request.check()?;
    let reason = request.reason.trim();
    // All scenes first: a mistake in the last is not to be found after hours.
    let mut tasks = cases
        .iter()
        .map(|case| LoadedCase::of(case))
        .collect::<Result<Vec<_>, _>>()?;
    for task in &mut tasks {
        if request.keep_images {
            task.keep_image(store)?;
        }
        task.sensitivities = sensitivities_of(task, store)?;
    }
    let mut accepted = Vec::new();
    let mut files = Vec::new();
    for task in tasks {
        step(Step::Begins(&task.case.name));
        let image = task.picture(render, watch)?;
        let (change, mut new) = prepare(&task, image, store, reason)?;
        accepted.push(change);
        files.append(&mut new);
        step(Step::Done);
    }
    // Also without files: an accept that was interrupted after it was decided is completed.
    store.publish(&files)?;
    Ok(accepted)
}

impl AcceptError {
    fn refused(case: &Case, reason: impl Display, help: impl Into<String>) -> AcceptError {
        let (reason, help) = (format!("{}: {reason}", case.name), help.into());
        AcceptError::Refused { reason, help }
    }

    fn incomplete(case: &Case, reason: impl Display) -> AcceptError {
        let help = "nothing was accepted, not even the other cases";
        AcceptError::refused(case, reason, help)
    }

    fn wrong_answer(case: &Case, reason: &str) -> AcceptError {
        let reason = format!("the image differs from the known answer: {reason}");
        let help = "either the `answer` or the `truth` of the manifest is wrong, or the scene, or the \
                    renderer. Nothing was accepted";
        AcceptError::refused(case, reason, help)
    }
}

/// A case, loaded.
struct LoadedCase<'c> {
    case: &'c Case,
    scene: Scene,
    /// A stochastic case has the quick one first, then the image of the golden unless that is a known answer.
    renderings: Vec<CaseRendering>,
    /// The image of the golden, where it is kept.
    image: Option<Film>,
    sensitivities: Option<Vec<u8>>,
}

impl<'c> LoadedCase<'c> {
    fn of(case: &'c Case) -> Result<LoadedCase<'c>, AcceptError> {
        let scene = case
            .load_scene()
            .map_err(|error| AcceptError::incomplete(case, error))?;
        check_class(case, &plans(&scene))
            .map_err(|reason| AcceptError::incomplete(case, reason))?;
        let renderings = match case.sampling {
            None => vec![CaseRendering::Only],
            Some(sampling) => {
                let mut renderings = vec![CaseRendering::Quick(sampling.quick)];
                let converged = sampling.converged;
                renderings.extend(converged.map(|of| CaseRendering::Converged(of.samples)));
                renderings
            }
        };
        Ok(LoadedCase {
            case,
            scene,
            renderings,
            image: None,
            sensitivities: None,
        })
    }

    /// Takes the image of the golden in `store` in place of the converged rendering, where it is one.
    fn keep_image(&mut self, store: &Store) -> Result<(), AcceptError> {
        let converged = self.case.sampling.and_then(|sampling| sampling.converged);
        let Some(converged) = converged else {
            return Ok(());
        };
        let nothing = |reason: String| {
            let reason = format!("there is no image to keep: {reason}");
            let help = "without --keep-images it is rendered; nothing was accepted";
            AcceptError::refused(self.case, reason, help)
        };
        let golden = Golden::read_with_any_sensitivities(store, self.case)
            .map_err(|error| nothing(error.to_string()))?;
        let samples = golden.provenance.samples;
        if !is_of(&golden, &self.scene) || samples != u64::from(converged.samples) {
            let reason = "its golden is of another scene, or of another number of samples";
            return Err(nothing(reason.to_owned()));
        }
        self.renderings.pop();
        self.image = Some(golden.film);
        Ok(())
    }

    /// The picture of the golden, with the rendering that `verify` repeats.
    fn picture(&self, render: &Render<'_>, watch: &dyn Watch) -> Result<GoldenImage, AcceptError> {
        let (plans, mut films, mut error_bound) = (plans(&self.scene), Vec::new(), None);
        for rendering in &self.renderings {
            let made = render_case(render, &plans, *rendering, watch)
                .map_err(|reason| AcceptError::incomplete(self.case, reason))?;
            films.push(made.film);
            error_bound = made.error_bound;
        }
        films.extend(self.image.clone());
        self.checked(films, error_bound)
    }

    /// The picture of the golden, of a case of these renderings, if it is what the case promises.
    fn checked(
        &self,
        mut films: Vec<Film>,
        error_bound: Option<f64>,
    ) -> Result<GoldenImage, AcceptError> {
        let golden = films.pop().expect("a case has a picture");
        if let Some(formula) = self.case.truth {
            return self.known(formula, &golden);
        }
        let quick = films.pop();
        if let Some(answer) = &self.case.answer {
            let margin = answer.margin(&golden);
            if !margin.passed() {
                return Err(AcceptError::wrong_answer(self.case, margin.worst()));
            }
        }
        if let (Some(sampling), Some(quick)) = (self.case.sampling, &quick) {
            if let Some(converged) = sampling.converged {
                check_converged(self.case, converged, &golden)?;
            }
            let judgement = judge_quick(&golden, quick);
            if !judgement.passed {
                let reason = format!("{CONTRADICTION}: {}", judgement.reason);
                let help = "where light arrives rarely, few samples are far from normal: more quick_samples \
                            help; otherwise the renderer is wrong. Nothing was accepted";
                return Err(AcceptError::refused(self.case, reason, help));
            }
        }
        let rough = error_bound.filter(|&bound| self.case.is_limit() && bound > LIMIT_KNOWN);
        if let Some(bound) = rough {
            let reason = format!(
                "the integral of a pixel may be off by {bound:.1e} of the brightest pixel; a limit is \
                 known to {LIMIT_KNOWN:e}: does an opacity of 1 make it rough?"
            );
            return Err(AcceptError::incomplete(self.case, reason));
        }
        Ok(GoldenImage {
            film: golden,
            // Half of the spacing of 32-bit numbers besides.
            error: error_bound.map(|bound| bound + f64::from(f32::EPSILON) / 2.0),
            quick: quick.as_ref().map(pinned),
            sensitivities: self.sensitivities.clone(),
        })
    }

    /// The image of the known answer, with which `rendering` must agree.
    fn known(&self, formula: &Formula, rendering: &Film) -> Result<GoldenImage, AcceptError> {
        let known = formula
            .image(&self.scene, self.case.footprint())
            .map_err(|reason| AcceptError::incomplete(self.case, reason))?;
        let judgement = judge_by_truth(self.case, &known, rendering);
        if !judgement.passed {
            return Err(AcceptError::wrong_answer(self.case, &judgement.reason));
        }
        Ok(GoldenImage {
            film: known.film,
            error: Some(known.error),
            quick: Some(pinned(rendering)),
            sensitivities: self.sensitivities.clone(),
        })
    }
}

/// Fault of two renderings of one scene.
const CONTRADICTION: &str = "the quick rendering and the converged one differ by more than noise";

/// A rendering that `verify` is to repeat.
fn pinned(film: &Film) -> Quick {
    Quick {
        samples: film.noise().map_or(1, |noise| noise.samples()),
        pixels: film.pixel_hash(),
    }
}

/// Fails if the noise of a golden would hide a bias that its case must detect.
fn check_converged(
    case: &Case,
    sampling: ConvergedSampling,
    golden: &Film,
) -> Result<(), AcceptError> {
    let error = stochastic::block_error(golden).expect("a converged image states its noise");
    let excess = MARGIN * error / sampling.resolution;
    if excess <= 1.0 {
        return Ok(());
    }
    // Errors fall with the root of the samples. A tenth more, as the error is an estimate too.
    let enough = f64::from(sampling.samples) * excess * excess * 1.1;
    // A float becomes the nearest whole number there is room for.
    let enough = (enough as u64).next_multiple_of(64);
    let reason = format!(
        "the golden would be too noisy: the standard error of a block is {error:.2e} of its mean, and must be at \
         most a quarter of the resolution, {}",
        sampling.resolution
    );
    let help = format!("in the manifest: converged_samples = {enough}; nothing was accepted");
    Err(AcceptError::refused(case, reason, help))
}

/// Largest error of the limit of a case: error of a pixel relative to the brightest.
const LIMIT_KNOWN: f64 = 1e-6;

/// The file of sensitivities that the golden of a case is to record, if there is one. The file
/// itself is not changed, so that it fits the old record or the new one at any moment.
fn sensitivities_of(task: &LoadedCase<'_>, store: &Store) -> Result<Option<Vec<u8>>, AcceptError> {
    let case = task.case;
    let fails = |fault: String| {
        let error = GoldenError::sensitivities(case, fault);
        Err(AcceptError::incomplete(case, error))
    };
    if let Some(bytes) = store.read(&sensitivities_file(case))? {
        return match sensitivities::decoded(&bytes, &task.scene) {
            Ok(_) => Ok(Some(bytes)),
            Err(fault) => fails(fault),
        };
    }
    match Golden::read_with_any_sensitivities(store, case) {
        Ok(old) if old.provenance.sensitivities.is_some() && is_of(&old, &task.scene) => {
            fails("is missing".to_owned())
        }
        _ => Ok(None),
    }
}

/// True if `golden` was made from `scene`, and from the same files.
fn is_of(golden: &Golden, scene: &Scene) -> bool {
    let made_from = &golden.provenance;
    made_from.scene == scene_hash(scene) && made_from.inputs == input_hashes(scene)
}

/// Files to write, with their contents.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// The change of the golden of a case, and the files that make it.
fn prepare(
    task: &LoadedCase<'_>,
    golden: GoldenImage,
    store: &Store,
    reason: &str,
) -> Result<(Accepted, Files), AcceptError> {
    let LoadedCase { case, scene, .. } = task;
    let plans = plans(scene);
    let changed = |change, detail: &str| Accepted {
        case: case.name.clone(),
        change,
        detail: detail.to_owned(),
    };
    let (old, why_new) = match Golden::read_with_any_sensitivities(store, case) {
        Ok(golden) => (Some(golden), ""),
        Err(GoldenError::Store(error)) => return Err(error.into()),
        Err(GoldenError::Missing(_)) => (None, "its first golden"),
        Err(_) => (None, "the old golden was damaged"),
    };
    let same_file = |old: &Golden| {
        old.provenance.case == case.name
            && is_of(old, scene)
            && old.provenance.plan == plan_hash(&plans)
            && old.provenance.exposure == case.exposure
            && old.provenance.judged_by == case.judged_by
            && old.provenance.quick == golden.quick
            && old.provenance.sensitivities == golden.sensitivities_hash()
            && old.provenance.truth.as_deref() == case.truth.map(|formula| formula.name)
    };
    let mut reasons = Reasons {
        picture: reason,
        record: "",
    };
    let change = match &old {
        None => changed(Change::New, why_new),
        Some(old) if old.provenance.pixels != golden.film.pixel_hash() => {
            let [before, after] =
                [&old.film, &golden.film].map(|film| Picture::Radiance(film.clone()));
            let judgement = judge(Gate::Exact, &before, &after, &Conditions::default());
            let judgement = judgement.expect("both images are radiance");
            changed(Change::Replaced, &judgement.reason)
        }
        Some(old) if same_file(old) => {
            let kept = changed(Change::Unchanged, "kept, with its old reason");
            return Ok((kept, Vec::new()));
        }
        Some(old) => {
            // A picture that stays keeps its reason.
            reasons = Reasons {
                picture: &old.provenance.reason,
                record: reason,
            };
            changed(
                Change::Recorded,
                "same image; its record (scene, plan, truth, how it is judged, quick rendering or sensitivities) changed",
            )
        }
    };
    let files = Golden::encode(case, scene, &plans, golden, reasons, old.as_ref())
        .map_err(|error| AcceptError::incomplete(case, error))?;
    Ok((change, files))
}
