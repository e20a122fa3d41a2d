//! New goldens, on purpose and with a reason.

#[cfg(test)]
mod tests;

use super::finding::MARGIN;
use super::golden::{Golden, GoldenImage, Reasons, input_hashes, plan_hash, scene_hash};
use super::rendering::{CaseRendering, ReferenceRenderer, Renderer, check_class, render_case};
use super::truth::judge_by_truth;
use super::verify::judge_quick;
use super::{Cache, Case, ConvergedSampling, GoldenError, Quick, Store, StoreError};
use crate::compare::{Conditions, Exact, Picture, judge, stochastic};
use crate::film::Film;
use crate::known_answers::Formula;
use crate::render::{self, plans};
use crate::scene::Scene;
use miette::Diagnostic;
use thiserror::Error;

/// The outcome for the golden of one case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// `family/name`.
    pub case: String,
    /// How it changed.
    pub change: Change,
    /// Whether a rendering from an earlier run was used.
    pub resumed: bool,
}

/// How a golden changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// There was no golden, or no trustworthy one.
    New {
        /// Whether some files of a golden existed.
        damaged: bool,
    },
    /// Same image, scene and plan: unchanged, with its old reason.
    Unchanged,
    /// Same image, but of a changed scene or plan.
    SamePicture,
    /// Another image, with its difference from the old one.
    Replaced(String),
}

/// Reason why nothing was accepted. All goldens are unchanged.
#[derive(Debug, Diagnostic, Error)]
pub enum AcceptError {
    /// Nobody looks at images in CI.
    #[error("goldens are not accepted where CI is set: nobody looks at the images there")]
    #[diagnostic(help("accept on your own machine, look at the images, commit them"))]
    Ci,
    /// An empty reason.
    #[error("a golden changes only with a reason, and none was given")]
    #[diagnostic(help(
        "state what was wrong before, or what a first golden is for: --reason \"…\""
    ))]
    NoReason,
    /// A case could not be rendered.
    #[error("{case}: {reason}")]
    #[diagnostic(help("nothing was accepted, not even the other cases"))]
    Incomplete {
        /// `family/name`.
        case: String,
        /// What went wrong.
        reason: String,
    },
    /// A converged image with too much noise.
    #[error(
        "{case}: the golden would be too noisy: the standard error of a block is {error:.2e} of \
         its mean, and a resolution of {resolution} needs a quarter of the resolution or less"
    )]
    #[diagnostic(help("in the manifest: converged_samples = {enough}; nothing was accepted"))]
    TooNoisy {
        /// `family/name`.
        case: String,
        /// Relative standard error of a block that nine tenths do not exceed.
        error: f64,
        /// The bias that the case must detect.
        resolution: f64,
        /// Samples that would suffice.
        enough: u64,
    },
    /// Two renderings of one scene that differ.
    #[error(
        "{case}: the quick rendering and the converged one differ by more than noise: {reason}"
    )]
    #[diagnostic(help(
        "where light arrives rarely, few samples are far from normal: more quick_samples help; \
         otherwise the renderer is wrong. Nothing was accepted"
    ))]
    Contradiction {
        /// `family/name`.
        case: String,
        /// How they differ.
        reason: String,
    },
    /// An image that differs from the known answer.
    #[error("{case}: the image differs from the known answer: {reason}")]
    #[diagnostic(help(
        "either the `answer` or the `truth` of the manifest is wrong, or the scene, or the \
         renderer. Nothing was accepted"
    ))]
    WrongAnswer {
        /// `family/name`.
        case: String,
        /// Where it is farthest off.
        reason: String,
    },
    /// The files could not be written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Progress of an accept, called from any thread; that of a picture within it as a
/// [`Watch`](render::Watch). Work is counted in pixels times samples.
pub trait AcceptWatch: render::Watch {
    /// Announces the amount of work, without renderings kept by earlier runs.
    fn begin_all(&self, work: u64);
    /// A picture of a case begins: this much of the work.
    fn begin_picture(&self, case: &str, work: u64);
}

/// Renders `cases` and accepts the images as their goldens, all at once or none. Finished
/// renderings of stochastic cases are kept in `cache` until then, so that an interrupted run
/// resumes after the last of them. `in_ci` tells whether the environment variable CI is set.
pub fn accept(
    cases: &[&Case],
    store: &Store,
    cache: &Cache,
    reason: &str,
    in_ci: bool,
    watch: &dyn AcceptWatch,
) -> Result<Vec<Accepted>, AcceptError> {
    accept_with(
        &ReferenceRenderer,
        cases,
        store,
        cache,
        reason,
        in_ci,
        watch,
    )
}

pub(super) fn accept_with(
    renderer: &dyn Renderer,
    cases: &[&Case],
    store: &Store,
    cache: &Cache,
    reason: &str,
    in_ci: bool,
    watch: &dyn AcceptWatch,
) -> Result<Vec<Accepted>, AcceptError> {
    if in_ci {
        return Err(AcceptError::Ci);
    }
    let reason = reason.trim();
    if reason.is_empty() {
        return Err(AcceptError::NoReason);
    }
    // All scenes first: a mistake in the last is not to be found after hours.
    let tasks = cases
        .iter()
        .map(|case| Task::new(renderer, case, cache))
        .collect::<Result<Vec<_>, _>>()?;
    watch.begin_all(tasks.iter().map(Task::work).sum());
    let mut accepted = Vec::new();
    let mut files = Vec::new();
    for task in &tasks {
        let pictures = task.pictures(renderer, cache, watch)?;
        let (change, mut new) = prepare(task, pictures, store, reason)?;
        accepted.push(Accepted {
            case: task.case.name.clone(),
            change,
            resumed: task
                .renderings
                .iter()
                .any(|rendering| rendering.kept.is_some()),
        });
        files.append(&mut new);
    }
    // Also without files: an accept that was interrupted after it was decided is completed.
    store.publish(&files)?;
    for case in cases.iter().filter(|case| case.sampling.is_some()) {
        cache.forget(&case.name);
    }
    Ok(accepted)
}

fn incomplete(case: &Case, reason: impl ToString) -> AcceptError {
    AcceptError::Incomplete {
        case: case.name.clone(),
        reason: reason.to_string(),
    }
}

/// A case with everything needed to render it.
struct Task<'c> {
    case: &'c Case,
    scene: Scene,
    /// The picture of the golden, unless that is a known answer, and before it the quick one of a
    /// stochastic case.
    renderings: Vec<RenderTask>,
}

/// One rendering to be made.
struct RenderTask {
    rendering: CaseRendering,
    /// Under what it is kept; deterministic renderings take seconds and are not.
    key: Option<String>,
    /// From an earlier run.
    kept: Option<Film>,
}

impl<'c> Task<'c> {
    fn new(
        renderer: &dyn Renderer,
        case: &'c Case,
        cache: &Cache,
    ) -> Result<Task<'c>, AcceptError> {
        let scene = case.load_scene().map_err(|error| incomplete(case, error))?;
        let plans = plans(&scene);
        check_class(renderer, case, &plans).map_err(|reason| incomplete(case, reason))?;
        let mut renderings = Vec::new();
        match case.sampling {
            None => renderings.push(CaseRendering::Only),
            Some(sampling) => {
                renderings.push(CaseRendering::Quick(sampling.quick));
                let converged = sampling.converged;
                renderings.extend(converged.map(|of| CaseRendering::Converged(of.samples)));
            }
        }
        let render_task = |rendering| {
            let key = match rendering {
                CaseRendering::Only => None,
                _ => cache.key(&scene, &plans, rendering),
            };
            let kept = key.as_ref().and_then(|key| cache.get(&case.name, key));
            RenderTask {
                rendering,
                key,
                kept,
            }
        };
        let renderings = renderings.into_iter().map(render_task).collect();
        Ok(Task {
            case,
            scene,
            renderings,
        })
    }

    fn work_of(&self, rendering: CaseRendering) -> u64 {
        let pixels = (self.scene.width() * self.scene.height()) as u64;
        pixels * u64::from(rendering.samples())
    }

    fn work(&self) -> u64 {
        let left = self
            .renderings
            .iter()
            .filter(|rendering| rendering.kept.is_none());
        left.map(|rendering| self.work_of(rendering.rendering))
            .sum()
    }

    /// The picture of the golden, and the rendering that `verify` repeats.
    fn pictures(
        &self,
        renderer: &dyn Renderer,
        cache: &Cache,
        watch: &dyn AcceptWatch,
    ) -> Result<GoldenImage, AcceptError> {
        let mut films = Vec::new();
        let mut error_bound = None;
        for RenderTask {
            rendering,
            key,
            kept,
        } in &self.renderings
        {
            if let Some(film) = kept {
                films.push(film.clone());
                continue;
            }
            watch.begin_picture(&self.case.name, self.work_of(*rendering));
            let picture = render_case(renderer, &plans(&self.scene), *rendering, watch)
                .map_err(|reason| incomplete(self.case, reason))?;
            let film = picture.film;
            error_bound = picture.error_bound;
            if let Some(key) = key {
                cache.put(&self.case.name, key, &film);
            }
            films.push(film);
        }
        let golden = films.pop().expect("a case has a picture");
        if let Some(formula) = self.case.truth {
            return self.known(formula, &golden);
        }
        let quick = films.pop();
        if let Some(answer) = &self.case.answer {
            let margin = answer.margin(&golden);
            if !margin.passed() {
                return Err(AcceptError::WrongAnswer {
                    case: self.case.name.clone(),
                    reason: margin.worst().to_owned(),
                });
            }
        }
        if let (Some(sampling), Some(quick)) = (self.case.sampling, &quick) {
            if let Some(converged) = sampling.converged {
                check_converged(self.case, converged, &golden)?;
            }
            let judgement = judge_quick(&golden, quick);
            if !judgement.passed {
                return Err(AcceptError::Contradiction {
                    case: self.case.name.clone(),
                    reason: judgement.reason,
                });
            }
        }
        if let Some(bound) =
            error_bound.filter(|&bound| self.case.is_limit() && bound > LIMIT_KNOWN)
        {
            let reason = format!(
                "the integral of a pixel may be off by {bound:.1e} of the brightest pixel; a limit is \
                 known to {LIMIT_KNOWN:e}: does an opacity of 1 make it rough?"
            );
            return Err(incomplete(self.case, reason));
        }
        Ok(GoldenImage {
            film: golden,
            // Half of the spacing of 32-bit numbers besides.
            error: error_bound.map(|bound| bound + f64::from(f32::EPSILON) / 2.0),
            quick: quick.as_ref().map(pinned),
        })
    }

    /// The known answer, which `rendering` has to agree with.
    fn known(&self, formula: &Formula, rendering: &Film) -> Result<GoldenImage, AcceptError> {
        let known = formula
            .image(&self.scene, self.case.footprint())
            .map_err(|reason| incomplete(self.case, reason))?;
        let judgement = judge_by_truth(self.case, &known, rendering);
        if !judgement.passed {
            return Err(AcceptError::WrongAnswer {
                case: self.case.name.clone(),
                reason: judgement.reason,
            });
        }
        Ok(GoldenImage {
            film: known.film,
            error: Some(known.error),
            quick: Some(pinned(rendering)),
        })
    }
}

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
    Err(AcceptError::TooNoisy {
        case: case.name.clone(),
        error,
        resolution: sampling.resolution,
        // A float becomes the nearest whole number there is room for.
        enough: (enough as u64).next_multiple_of(64),
    })
}

/// How well the limit of a case is known, at least: error of a pixel relative to the brightest.
const LIMIT_KNOWN: f64 = 1e-6;

type GoldenFiles = Vec<(std::path::PathBuf, Vec<u8>)>;

/// How the golden of a case will change, and the files that change it.
fn prepare(
    task: &Task<'_>,
    golden: GoldenImage,
    store: &Store,
    reason: &str,
) -> Result<(Change, GoldenFiles), AcceptError> {
    let Task { case, scene, .. } = task;
    let plans = plans(scene);
    let mut damaged = false;
    let old = match Golden::read(store, case) {
        Ok(golden) => Some(golden),
        Err(GoldenError::Store(error)) => return Err(error.into()),
        Err(GoldenError::Missing(_)) => None,
        Err(_) => {
            damaged = true;
            None
        }
    };
    let same_file = |old: &Golden| {
        old.provenance.case == case.name
            && old.provenance.scene == scene_hash(scene)
            && old.provenance.plan == plan_hash(&plans)
            && old.provenance.exposure == case.exposure
            && old.provenance.inputs == input_hashes(scene)
            && old.provenance.quick == golden.quick
            && old.provenance.truth.as_deref() == case.truth.map(|formula| formula.name)
    };
    let change = match &old {
        None => Change::New { damaged },
        Some(old) if old.provenance.pixels == golden.film.pixel_hash() => {
            if same_file(old) {
                return Ok((Change::Unchanged, Vec::new()));
            }
            Change::SamePicture
        }
        Some(old) => {
            let [before, after] =
                [&old.film, &golden.film].map(|film| Picture::Radiance(film.clone()));
            let judgement = judge(&Exact, &before, &after, &Conditions::default());
            Change::Replaced(judgement.expect("both images are radiance").reason)
        }
    };
    // A picture that stays keeps its reason.
    let reasons = match &old {
        Some(old) if change == Change::SamePicture => Reasons {
            picture: &old.provenance.reason,
            record: reason,
        },
        _ => Reasons {
            picture: reason,
            record: "",
        },
    };
    let replaces = old.as_ref().map(|golden| golden.provenance.pixels.clone());
    let replaces = replaces.unwrap_or_default();
    let files = Golden::encode(case, scene, &plans, golden, reasons, replaces)
        .map_err(|error| incomplete(case, error))?;
    Ok((change, files))
}
