//! New goldens, on purpose and with a reason.

use super::golden::{Golden, input_hashes, plan_hash, scene_hash};
use super::{Case, GoldenError, Store, StoreError};
use crate::compare::{Gate, Picture, judge};
use crate::render::{self, Plan};
use miette::Diagnostic;
use thiserror::Error;

/// What became of the golden of one case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// `family/name`.
    pub case: String,
    /// How it changed.
    pub change: Change,
}

/// How a golden changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// There was none, or none that could be trusted.
    New {
        /// Whether there were files of one.
        damaged: bool,
    },
    /// Same picture, scene and plan: left as it is, with its old reason.
    Unchanged,
    /// Same picture, but of a changed scene or plan.
    SamePicture,
    /// Another picture; how it differs from the old one.
    Replaced(String),
}

/// Why nothing was accepted. Every golden is as it was.
#[derive(Debug, Diagnostic, Error)]
pub enum AcceptError {
    /// On a build server nobody looks at pictures.
    #[error("goldens are not accepted where CI is set: nobody looks at the pictures there")]
    #[diagnostic(help("accept on your own machine, look at the pictures, commit them"))]
    Ci,
    /// An empty reason.
    #[error("a golden changes for a reason, and none was given")]
    #[diagnostic(help("say what was wrong before: --reason \"…\""))]
    NoReason,
    /// A case could not be rendered.
    #[error("{case}: {reason}")]
    #[diagnostic(help("nothing was accepted, the other cases neither"))]
    Incomplete {
        /// `family/name`.
        case: String,
        /// What went wrong.
        reason: String,
    },
    /// The files could not be written.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Renders `cases` and makes the results their goldens, all at once or none. `in_ci` is whether
/// the environment variable CI is set.
pub fn accept(
    cases: &[&Case],
    store: &Store,
    reason: &str,
    in_ci: bool,
    progress: render::Progress<'_>,
) -> Result<Vec<Accepted>, AcceptError> {
    if in_ci {
        return Err(AcceptError::Ci);
    }
    let reason = reason.trim();
    if reason.is_empty() {
        return Err(AcceptError::NoReason);
    }
    let mut accepted = Vec::new();
    let mut files = Vec::new();
    for case in cases {
        let (change, mut new) = prepare(case, store, reason, progress)?;
        accepted.push(Accepted {
            case: case.name.clone(),
            change,
        });
        files.append(&mut new);
    }
    // Also without files: an accept that was interrupted after it was decided is completed.
    store.publish(&files)?;
    Ok(accepted)
}

type Files = Vec<(std::path::PathBuf, Vec<u8>)>;

/// How the golden of `case` will change, and the files that change it.
fn prepare(
    case: &Case,
    store: &Store,
    reason: &str,
    progress: render::Progress<'_>,
) -> Result<(Change, Files), AcceptError> {
    let incomplete = |reason: String| AcceptError::Incomplete {
        case: case.name.clone(),
        reason,
    };
    let scene = case
        .load_scene()
        .map_err(|error| incomplete(error.to_string()))?;
    let plans: Vec<Plan> = scene.panels.iter().map(Plan::new).collect();
    let rendering =
        render::render(&scene, &plans, progress).map_err(|error| incomplete(error.to_string()))?;
    let film = rendering.film;
    let mut damaged = false;
    let old = match Golden::read(store, case) {
        Ok(golden) => Some(golden),
        Err(GoldenError::Store(error)) => return Err(error.into()),
        Err(GoldenError::Missing) => None,
        Err(_) => {
            damaged = true;
            None
        }
    };
    let same_file = |old: &Golden| {
        old.provenance.case == case.name
            && old.provenance.scene == scene_hash(&scene)
            && old.provenance.plan == plan_hash(&plans)
            && old.provenance.exposure == case.exposure
            && old.provenance.inputs == input_hashes(&scene)
    };
    let change = match &old {
        None => Change::New { damaged },
        Some(old) if old.provenance.pixels == film.pixel_hash() => {
            if same_file(old) {
                return Ok((Change::Unchanged, Vec::new()));
            }
            Change::SamePicture
        }
        Some(old) => {
            let (before, after) = (
                Picture::Radiance(old.film.clone()),
                Picture::Radiance(film.clone()),
            );
            let judgement = judge(Gate::Exact, &before, &after, 0.0);
            Change::Replaced(judgement.expect("both images are radiance").reason)
        }
    };
    let replaces = old
        .map(|golden| golden.provenance.pixels)
        .unwrap_or_default();
    let files = Golden::encode(case, &scene, &plans, &film, reason, replaces)
        .map_err(|error| incomplete(error.to_string()))?;
    Ok((change, files))
}
