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
    /// What it says, for people.
    pub said: String,
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
        let no_draft = |why: &str, help: String| {
            let message = format!("no manifest can be written for {}: {why}", file.display());
            SuiteError::refused(message, help)
        };
        let no_scene = |why| {
            let place = folder.join("FAMILY/NAME.toml");
            no_draft(why, format!("scenes of this suite are {}", place.display()))
        };
        let inner = match (&real, folder.canonicalize()) {
            (Some(real), Ok(folder)) => real.strip_prefix(folder).ok().map(Path::to_owned),
            _ => None,
        };
        let inner = inner.ok_or_else(|| no_scene("it is not among the scenes of the suite"))?;
        if inner.components().count() != 2 {
            return Err(no_scene("it is not in the folder of a family"));
        }
        let inner = inner.to_str().map(|name| name.replace('\\', "/"));
        let inner = inner.ok_or_else(|| no_scene("its name is not UTF-8"))?;
        let case = inner.trim_end_matches(".toml").to_owned();
        let manifest = Path::new(CASES).join(&inner);
        if self.has_manifest(&case) {
            return Ok(CasesOfScene::Known(vec![case]));
        }
        let mut manifests = self.records(CASES)?;
        manifests.push(self.root.join(&manifest));
        check_names(&manifests)?;
        let scene = Scene::load(file).map_err(SuiteError::Manifest)?;
        let plans = plans(&scene);
        if plans.iter().any(Plan::is_continuous) {
            let place = self.root.join(&manifest);
            let help = format!("write {} with class = \"limit\"", place.display());
            return Err(no_draft("it is an integral without samples", help));
        }
        let is_sampled = plans.iter().any(Plan::is_sampled);
        let (text, said) = text_of(&inner, is_sampled);
        Ok(CasesOfScene::New(Draft {
            case,
            file: manifest,
            text,
            said,
        }))
    }
}

/// The manifest of the scene in the file `inner` of the scenes, and what it says.
fn text_of(inner: &str, is_sampled: bool) -> (String, String) {
    let scene = toml::Value::from(format!("{SCENES}/{inner}"));
    let (class, why, more) = match is_sampled {
        true => (
            STOCHASTIC,
            "its plan uses random numbers",
            format!("converged_samples = {CONVERGED_SAMPLES}   # per pixel of the golden\n"),
        ),
        false => (
            DETERMINISTIC,
            "its plan uses no random numbers",
            String::new(),
        ),
    };
    let text = format!(
        "# Written by `volref accept`, from then on yours; `volref schema case` lists all keys.\n\
         class = \"{class}\"   # {why}\n\
         {more}\
         source = {scene}\n\
         shows = \"What volref rendered when the golden was accepted; nobody has described it yet.\"\n\
         computes = \"What the scene file says; `volref plan` explains it.\"\n"
    );
    let samples = match is_sampled {
        true => format!(", {CONVERGED_SAMPLES} samples per pixel"),
        false => String::new(),
    };
    let said = format!("class {class}, since {why}{samples}; describe there what the image shows");
    (text, said)
}
