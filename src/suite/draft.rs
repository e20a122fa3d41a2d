//! The manifest of a scene that has none.

use super::case::{CASES, DETERMINISTIC, SCENES, STOCHASTIC, check_names};
use super::{Case, Suite, SuiteError};
use crate::render::{Plan, plans};
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// Samples of the golden of a stochastic case where nobody gave them. If they are too few, `accept` refuses the golden
/// and says how many suffice.
const CONVERGED_SAMPLES: u32 = 1024;

/// The cases of a scene file.
#[derive(Clone, Debug)]
pub(crate) enum CasesOfScene {
    /// Names of the cases that show it.
    Known(Vec<String>),
    /// There is none: this manifest makes one.
    New(Draft),
}

/// A manifest that is not written yet.
#[derive(Clone, Debug)]
pub(crate) struct Draft {
    /// `family/name`.
    pub case: String,
    /// Its place, relative to the root of the suite.
    pub file: PathBuf,
    /// Its text.
    pub text: String,
}

impl Suite {
    /// Root of the suite.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// The cases of the scene in `file`, or the manifest that makes one of it.
    pub(crate) fn cases_of_scene(&self, file: &Path) -> Result<CasesOfScene, SuiteError> {
        let real = file.canonicalize().ok();
        let shows_it = |case: &&Case| real.is_some() && case.scene.canonicalize().ok() == real;
        let known = self.cases().iter().filter(shows_it);
        let known: Vec<String> = known.map(|case| case.name.clone()).collect();
        if !known.is_empty() {
            return Ok(CasesOfScene::Known(known));
        }
        let folder = self.root.join(SCENES);
        let inner = real.as_deref().zip(folder.canonicalize().ok());
        let inner = inner.and_then(|(real, folder)| real.strip_prefix(folder).ok()?.to_str());
        let inner = inner.map(|name| name.replace('\\', "/"));
        let Some(inner) = inner.filter(|name| name.matches('/').count() == 1) else {
            let (file, place) = (file.display(), folder.join("FAMILY/NAME.toml"));
            return Err(SuiteError::refused(
                format!(
                    "no manifest can be written for {file}: it is not among the scenes of the suite"
                ),
                format!("scenes of this suite are {}", place.display()),
            ));
        };
        let case = inner.trim_end_matches(".toml").to_owned();
        if self.has_manifest(&case) {
            return Ok(CasesOfScene::Known(vec![case]));
        }
        let file_of_case = Path::new(CASES).join(&inner);
        let mut manifests = self.records(CASES)?;
        manifests.push(self.root.join(&file_of_case));
        check_names(&manifests)?;
        let scene = Scene::load(file).map_err(SuiteError::Manifest)?;
        let plans = plans(&scene);
        if plans.iter().any(Plan::is_continuous) {
            let message = format!("{} is an integral without samples", file.display());
            let help = format!("write {} with class = \"limit\"", file_of_case.display());
            return Err(SuiteError::refused(message, help));
        }
        let class = match plans.iter().any(Plan::is_sampled) {
            true => format!(
                "{STOCHASTIC:?}\nconverged_samples = {CONVERGED_SAMPLES}   # per pixel of the golden"
            ),
            false => format!("{DETERMINISTIC:?}"),
        };
        let source = toml::Value::from(format!("{SCENES}/{inner}"));
        let text = format!(
            "# Written by `volref accept`, from then on yours; `volref schema case` lists all keys.\n\
             class = {class}\n\
             source = {source}\n\
             shows = \"What volref rendered when the golden was accepted; nobody has described it yet.\"\n\
             computes = \"What the scene file says; `volref plan` explains it.\"\n"
        );
        Ok(CasesOfScene::New(Draft {
            case,
            file: file_of_case,
            text,
        }))
    }
}
