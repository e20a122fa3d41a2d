//! Results of the parts of a run, kept as JSON until they are joined.
//!
//! A *run* is one request, `verify`, `validate` or `selftest` with its settings, for a list of cases; its parts are
//! judged by any process anywhere. A run has a folder, with a file that describes it, one for each part, and the images
//! that were judged.

use super::{CaseResult, CaseTrials, Cause, Evidence, Judged};
use crate::compare::Picture;
use crate::files::atomic_file::directory_of;
use crate::files::program_hash::hash;
use crate::files::{own_file, regular_file};
use crate::film::FilmFormat;
use crate::suite::golden::short;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// A request to judge cases.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Run {
    /// `verify`, `validate` or `selftest`.
    pub command: String,
    /// Everything that verdicts depend on, by name.
    pub settings: BTreeMap<String, String>,
    /// Names of the cases, of all parts, in order, each with a hash of what it is judged by.
    pub cases: Vec<(String, String)>,
    /// True if no filter excludes a case.
    pub is_everything: bool,
}

impl Run {
    /// Identifier: a short hash of everything above.
    pub fn id(&self) -> String {
        let text = serde_json::to_vec(self).unwrap_or_default();
        short(&hash(&[text]))
    }
}

/// Results of a part of a run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Part {
    /// `volref/part/1`.
    pub schema: String,
    /// Identifier of the run.
    pub run: String,
    /// Names of the cases of the part.
    pub cases: Vec<String>,
    /// Results of `verify` or `validate`; a case of the part without one was passed over, since it has no image and none
    /// was required.
    pub results: Vec<KeptResult>,
    /// Findings of `selftest`.
    pub trials: Vec<CaseTrials>,
}

/// Result of a case. The image that was judged is a file in the folder of the run, the golden is that of the suite.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KeptResult {
    /// The result.
    #[serde(flatten)]
    pub result: CaseResult,
    cause: Cause,
    evidence: Evidence,
    /// Ending of the name of the image.
    image: Option<FilmFormat>,
}

impl KeptResult {
    fn of(judged: &Judged) -> KeptResult {
        let Judged { result, evidence } = judged;
        KeptResult {
            cause: result.cause,
            result: result.clone(),
            evidence: evidence.clone(),
            image: None,
        }
    }

    /// The result, without images.
    pub fn judged(self) -> Judged {
        Judged {
            result: CaseResult {
                cause: self.cause,
                ..self.result
            },
            evidence: self.evidence,
        }
    }
}

const SCHEMA: &str = "volref/part/1";

/// Name of a folder of results.
const RESULTS: &str = "results";

/// A folder of results, hidden from version control.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    /// The folder `.volref`.
    root: PathBuf,
}

impl ResultFolder {
    /// The results within the folder `root`, which need not exist.
    pub fn open(root: impl Into<PathBuf>) -> ResultFolder {
        ResultFolder { root: root.into() }
    }

    /// Folder of the results.
    pub fn path(&self) -> PathBuf {
        self.root.join(RESULTS)
    }

    /// Fails where results could not be kept, for a link or something else in the place of a folder.
    ///
    /// # Errors
    ///
    /// The folder, with a remedy.
    pub fn check(&self) -> io::Result<()> {
        let (root, name) = self.in_its_folder();
        own_file::check_folder(root, &name.join(RESULTS))
    }

    /// Hides the folder from version control.
    pub(crate) fn hide(&self) {
        let ignore = self.root.join(".gitignore");
        if !ignore.exists() {
            let _ = own_file::write(&ignore, b"*\n");
        }
    }

    /// The parent of the folder, and its name, which must not be a link.
    fn in_its_folder(&self) -> (&Path, &Path) {
        match (self.root.parent(), self.root.file_name()) {
            (Some(parent), Some(name)) => (parent, Path::new(name)),
            _ => (&self.root, Path::new("")),
        }
    }

    /// Keeps what was found in the `cases` of a part of `run`; returns the folder of the run.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn keep(
        &self,
        run: &Run,
        cases: Vec<String>,
        judged: &[Judged],
        trials: Vec<CaseTrials>,
    ) -> Result<PathBuf, Box<dyn Error>> {
        let (root, name) = self.in_its_folder();
        let inner = name.join(RESULTS).join(run.id());
        let folder = own_file::make_folder(root, &inner)?;
        write(&folder.join(RUN), run)?;
        let mut results: Vec<KeptResult> = judged.iter().map(KeptResult::of).collect();
        for (kept, judged) in results.iter_mut().zip(judged) {
            let (format, bytes) = match &judged.evidence.test {
                Some(Picture::Radiance(film)) => (FilmFormat::Exr, film.to_exr()?),
                Some(Picture::Codes(codes)) => (FilmFormat::Png, codes.to_png()),
                None => continue,
            };
            let name = &judged.result.name;
            own_file::make_folder(root, &inner.join(directory_of(Path::new(name))))?;
            own_file::write(&image_file(&folder, name, format), &bytes)?;
            kept.image = Some(format);
        }
        let part = Part {
            schema: SCHEMA.to_owned(),
            run: run.id(),
            results,
            trials,
            cases,
        };
        let name = format!("{}.json", short(&hash(&part.cases)));
        write(&folder.join(name), &part)?;
        Ok(folder)
    }

    /// The image that was judged, of a result in the run with this identifier; `None` if there was none.
    ///
    /// # Errors
    ///
    /// A sentence why the file cannot be used.
    pub fn image(&self, run: &str, kept: &KeptResult) -> Result<Option<Picture>, String> {
        let Some(format) = kept.image else {
            return Ok(None);
        };
        let path = image_file(&self.path().join(run), &kept.result.name, format);
        let picture = Picture::read(&path).map_err(|error| error.to_string())?;
        Ok(Some(picture))
    }

    /// Runs with results, by their identifiers.
    ///
    /// # Errors
    ///
    /// A sentence about the first file of a run that cannot be used.
    pub fn runs(&self) -> Result<BTreeMap<String, Run>, String> {
        let mut runs = BTreeMap::new();
        for folder in within(&self.path()) {
            let path = folder.join(RUN);
            if !path.exists() {
                continue;
            }
            let run: Run = read(&path)?;
            // By its name it is found.
            let id = run.id();
            if folder.file_name().is_some_and(|name| name == &*id) {
                runs.insert(id, run);
            }
        }
        Ok(runs)
    }

    /// Parts of the run with this identifier; a sentence for a file that cannot be used.
    pub fn parts(&self, run: &str) -> Vec<Result<Part, String>> {
        let is_part = |path: &PathBuf| path.file_name().is_some_and(|name| name != RUN);
        let mut files: Vec<PathBuf> = within(&self.path().join(run)).filter(is_part).collect();
        files.retain(|path| path.extension().is_some_and(|of| of == "json"));
        files.sort();
        let read = |path: &PathBuf| {
            let part: Part = read(path)?;
            match part.schema == SCHEMA && part.run == run {
                true => Ok(part),
                false => Err(format!("{}: it belongs to another run", path.display())),
            }
        };
        files.iter().map(read).collect()
    }
}

/// Name of the file that describes a run.
const RUN: &str = "run.json";

/// Contents of a folder.
fn within(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.path())
}

/// The image of a case in the folder of its run.
fn image_file(folder: &Path, case: &str, format: FilmFormat) -> PathBuf {
    folder.join(format!("{case}.{}", format.extension()))
}

fn write(path: &Path, value: &impl Serialize) -> Result<(), Box<dyn Error>> {
    Ok(own_file::write(path, &serde_json::to_vec(value)?)?)
}

/// The value in the file at `path`; else the reason, a sentence.
fn read<T: DeserializeOwned>(path: &Path) -> Result<T, String> {
    let bytes = regular_file::read(path, regular_file::MOST_BYTES);
    let value = bytes.map_err(|error| error.to_string()).and_then(|bytes| {
        let read = serde_json::from_slice(&bytes);
        read.map_err(|it| format!("it was cut off, or another version of volref wrote it: {it}"))
    });
    value.map_err(|reason| format!("{}: {reason}", path.display()))
}
