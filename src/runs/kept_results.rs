//! Results of the parts of a run, kept in files until they are joined.
//!
//! A *run* is one request, `verify`, `validate` or `selftest` with its settings, for a list of cases; its parts are
//! judged by any process anywhere. A result is kept with the run that it belongs to, and in two files:
//! what was found, and the images behind it, which only a report and the search for mistakes need.

use crate::compare::flip::SrgbImage;
use crate::compare::{FitMap, Picture};
use crate::files::kept_file;
use crate::files::kept_file::KeepError;
use crate::files::own_file;
use crate::files::program_hash::hash;
use crate::film::{Film, Quantisation};
use crate::judging::{CaseResult, CaseTrials, Cause, Evidence, Judged};
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io::{Read, Write};
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
        hash(&[text]).chars().take(12).collect()
    }

    /// First difference of `other`, with both values: short words.
    pub fn difference(&self, other: &Run) -> (String, [String; 2]) {
        let both = [self, other];
        if self.command != other.command {
            return (
                "the command".to_owned(),
                both.map(|run| run.command.clone()),
            );
        }
        let names =
            |run: &Run| -> Vec<String> { run.cases.iter().map(|(name, _)| name.clone()).collect() };
        if names(self) != names(other) {
            let words = both.map(|run| format!("{} cases", run.cases.len()));
            return ("the list of cases".to_owned(), words);
        }
        let changed = self
            .cases
            .iter()
            .zip(&other.cases)
            .find(|(one, other)| one != other);
        if let Some(((name, one), (_, other))) = changed {
            let what = format!("the scene, manifest or golden of {name}");
            return (what, [one, other].map(|hash| shortened(hash)));
        }
        let names = self.settings.keys().chain(other.settings.keys());
        let value = |run: &Run, name: &String| run.settings.get(name).cloned();
        let mut others = names.filter(|name| value(self, name) != value(other, name));
        let Some(name) = others.next() else {
            return Default::default();
        };
        let values = both.map(|run| value(run, name).unwrap_or("none".to_owned()));
        (name.clone(), where_they_differ(&values))
    }
}

/// Both values, cut to begin shortly before the first different letter.
fn where_they_differ(values: &[String; 2]) -> [String; 2] {
    const BEFORE: usize = 20;
    let [one, other] = values;
    let alike = one.chars().zip(other.chars());
    let alike = alike.take_while(|(a, b)| a == b).count();
    values.each_ref().map(|value| {
        let skipped = alike.saturating_sub(BEFORE);
        let rest: String = value.chars().skip(skipped).collect();
        if skipped < 2 * BEFORE {
            shortened(value)
        } else {
            format!("… {}", shortened(&rest))
        }
    })
}

/// The beginning of the first line: of a hash, twelve letters.
fn shortened(value: &str) -> String {
    let is_hash = value.len() >= 64
        && value
            .bytes()
            .all(|byte| byte.is_ascii_hexdigit() || byte == b' ');
    let most = if is_hash { 12 } else { 60 };
    let line = value.lines().next().unwrap_or_default();
    match line.char_indices().nth(most) {
        Some((end, _)) => format!("{} …", &line[..end]),
        None => line.to_owned(),
    }
}

/// Name of a folder of results.
pub const RESULTS: &str = "results";

/// A folder of results, hidden from version control.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    /// The folder `.volref`.
    root: PathBuf,
}

/// State of a case.
#[derive(Debug)]
pub enum KeptResult {
    /// Judged; with the result.
    Judged(Box<Judged>),
    /// It was passed over, since it has no image and none was required.
    PassedOver,
    /// A file that cannot be used, with the reason.
    Damaged(String),
    /// There is no file.
    Missing,
}

/// The head of a file.
#[derive(Serialize, Deserialize)]
struct Head {
    run: String,
    case: String,
    /// Bytes of the contents, unpacked.
    unpacked: u64,
}

/// Result of a case without its images.
#[derive(Serialize, Deserialize)]
struct Found {
    result: CaseResult,
    cause: Cause,
    fit: Option<Box<FitMap>>,
    #[serde(default)]
    as_if: Option<String>,
    #[serde(default)]
    cause_is_said: bool,
    evidence: Evidence,
}

/// The images behind a result.
#[derive(Serialize, Deserialize)]
struct Images {
    golden: Option<Film>,
    test: Option<StoredPicture>,
}

#[derive(Serialize, Deserialize)]
enum StoredPicture {
    Radiance(Film),
    /// Radiance that was rounded.
    Quantised(Film, Quantisation),
    /// 8-bit codes, as PNG.
    Codes(Vec<u8>),
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
    pub fn check(&self) -> Result<(), KeepError> {
        let (root, name) = kept_file::in_its_folder(&self.root);
        Ok(own_file::check_folder(root, &name.join(RESULTS))?)
    }

    /// Writes a file of the run with this identifier.
    fn write(
        &self,
        run: &str,
        file: &str,
        head: &impl Serialize,
        body: &[u8],
    ) -> Result<(), KeepError> {
        let (root, name) = kept_file::in_its_folder(&self.root);
        let inner = name.join(RESULTS).join(run).join(file);
        kept_file::write(root, &inner, head, body)?;
        Ok(())
    }

    /// Writes a file of a case in the run with this identifier.
    fn write_packed(
        &self,
        run: &str,
        case: &str,
        extension: &str,
        value: &impl Serialize,
    ) -> Result<(), KeepError> {
        let file = format!("{case}.{extension}");
        let (head, body) = packed(Path::new(&file), run, case, value)?;
        self.write(run, &file, &head, &body)
    }

    /// The file of a case in a run with this identifier.
    fn file(&self, run: &str, case: &str, extension: &str) -> PathBuf {
        self.path().join(run).join(format!("{case}.{extension}"))
    }

    /// Writes the description of `run`, and returns its identifier. Every part does so.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn begin(&self, run: &Run) -> Result<String, KeepError> {
        let id = run.id();
        self.write(&id, RUN, run, b"")?;
        Ok(id)
    }

    /// Keeps the result of a case in the run with this identifier; `None` for a case that was
    /// passed over.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub fn keep(&self, run: &str, case: &str, judged: Option<&Judged>) -> Result<(), KeepError> {
        if let Some(judged) = judged {
            let evidence = &judged.evidence;
            let of_case = Images {
                golden: evidence.golden.clone(),
                test: evidence.test.as_ref().map(StoredPicture::of),
            };
            self.write_packed(run, case, IMAGES, &of_case)?;
        }
        let of_case = judged.map(|judged| Found {
            result: judged.result.clone(),
            cause: judged.result.cause,
            fit: judged.result.fit.clone(),
            as_if: judged.result.as_if.clone(),
            cause_is_said: judged.result.cause_is_said,
            evidence: Evidence {
                golden: None,
                test: None,
                ..judged.evidence.clone()
            },
        });
        self.write_packed(run, case, FOUND, &of_case)
    }

    /// Keeps the findings of a self-test in a case.
    ///
    /// # Errors
    ///
    /// If it cannot be written.
    pub(crate) fn keep_trials(&self, run: &str, found: &CaseTrials) -> Result<(), KeepError> {
        self.write_packed(run, &found.case, TRIALS, found)
    }

    /// Findings of a self-test in a case; `None` if none were kept.
    ///
    /// # Errors
    ///
    /// A sentence why what was kept cannot be used.
    pub fn trials(&self, run: &str, case: &str) -> Result<Option<CaseTrials>, String> {
        let path = self.file(run, case, TRIALS);
        if !path.exists() {
            return Ok(None);
        }
        let trials: CaseTrials = unpacked(&path, run, case)?;
        if trials.case != case {
            return Err(format!("{}: {OTHER_CASE}", path.display()));
        }
        Ok(Some(trials))
    }

    /// Runs with results, by their identifiers.
    ///
    /// # Errors
    ///
    /// A sentence about the first file of a run that cannot be used.
    pub fn runs(&self) -> Result<BTreeMap<String, Run>, String> {
        let folders = std::fs::read_dir(self.path())
            .into_iter()
            .flatten()
            .flatten();
        let mut runs = BTreeMap::new();
        for folder in folders {
            let path = folder.path().join(RUN);
            if !path.exists() {
                continue;
            }
            let (run, _) = kept_file::read::<Run>(&path)
                .map_err(|reason| format!("{}: {reason}", path.display()))?;
            // By its name it is found.
            let id = run.id();
            if folder.file_name() == *id {
                runs.insert(id, run);
            }
        }
        Ok(runs)
    }

    /// State of a case, with its images where they are wanted.
    pub fn get(
        &self,
        run: &str,
        case: &str,
        wants_images: impl Fn(&CaseResult) -> bool,
    ) -> KeptResult {
        let [found, images] = [FOUND, IMAGES].map(|extension| self.file(run, case, extension));
        if !found.exists() {
            return KeptResult::Missing;
        }
        let read = || -> Result<Option<Judged>, String> {
            let Some(of_case) = unpacked::<Option<Found>>(&found, run, case)? else {
                return Ok(None);
            };
            if of_case.result.name != case {
                return Err(format!("{}: {OTHER_CASE}", found.display()));
            }
            if !of_case.fit.as_ref().is_none_or(|fit| fit.is_whole()) {
                let fault = "its picture of a difference has not one value per block";
                return Err(format!("{}: {fault}", found.display()));
            }
            let mut judged = Judged {
                result: CaseResult {
                    cause: of_case.cause,
                    fit: of_case.fit,
                    as_if: of_case.as_if,
                    cause_is_said: of_case.cause_is_said,
                    ..of_case.result
                },
                evidence: of_case.evidence,
            };
            if wants_images(&judged.result) {
                let pictures = || {
                    let of_case = unpacked::<Images>(&images, run, case)?;
                    let test = of_case.test.map(StoredPicture::picture).transpose()?;
                    Ok((of_case.golden, test))
                };
                match pictures() {
                    Ok((golden, test)) => {
                        judged.evidence.golden = golden;
                        judged.evidence.test = test;
                    }
                    // The verdict holds without them.
                    Err(reason) => {
                        let reason: String = reason;
                        judged
                            .result
                            .notes
                            .push(format!("its images are missing: {reason}"));
                    }
                }
            }
            Ok(Some(judged))
        };
        match read() {
            Ok(Some(judged)) => KeptResult::Judged(Box::new(judged)),
            Ok(None) => KeptResult::PassedOver,
            Err(reason) => KeptResult::Damaged(reason),
        }
    }
}

impl StoredPicture {
    fn of(picture: &Picture) -> StoredPicture {
        match picture {
            Picture::Radiance(film) => match film.quantisation() {
                Some(quantisation) => StoredPicture::Quantised(film.clone(), quantisation),
                None => StoredPicture::Radiance(film.clone()),
            },
            Picture::Codes(codes) => {
                let png = Film::codes_to_png(codes.pixels(), codes.width(), codes.height());
                StoredPicture::Codes(png)
            }
        }
    }

    fn picture(self) -> Result<Picture, String> {
        match self {
            StoredPicture::Radiance(film) => Ok(Picture::Radiance(film)),
            StoredPicture::Quantised(film, quantisation) => {
                Ok(Picture::Radiance(film.quantised(quantisation)))
            }
            StoredPicture::Codes(png) => {
                let (width, height, codes) =
                    Film::codes_from_png(&png).map_err(|error| error.to_string())?;
                let codes = SrgbImage::new(width, height, codes);
                Ok(Picture::Codes(codes.map_err(|error| error.to_string())?))
            }
        }
    }
}

/// Name of the file that describes a run.
const RUN: &str = "run";
/// Extensions of the files of a case.
const FOUND: &str = "result";
const IMAGES: &str = "images";
const TRIALS: &str = "trials";

/// Fault of a file.
const OTHER_CASE: &str = "it belongs to another case or run";

/// Bytes that `packed` bytes unpack to, at most: 64 MiB, an image of 2000 × 2000 pixels, or 64 times as many.
fn most_unpacked(packed: usize) -> u64 {
    (packed as u64).saturating_mul(64).max(1 << 26)
}

/// `value` as compressed MessagePack, in which every number keeps its bits, for the file at `path`.
fn packed(
    path: &Path,
    run: &str,
    case: &str,
    value: &impl Serialize,
) -> Result<(Head, Vec<u8>), KeepError> {
    let failed = |error: std::io::Error| KeepError::encode(path, error);
    let bytes = rmp_serde::to_vec_named(value).map_err(|error| KeepError::encode(path, error))?;
    let compressed = |how| {
        let mut encoder = DeflateEncoder::new(Vec::new(), how);
        encoder.write_all(&bytes)?;
        encoder.finish()
    };
    let mut body = compressed(Compression::fast()).map_err(failed)?;
    let unpacked = bytes.len() as u64;
    // A large image of one colour.
    if unpacked > most_unpacked(body.len()) {
        body = compressed(Compression::none()).map_err(failed)?;
    }
    let head = Head {
        run: run.to_owned(),
        case: case.to_owned(),
        unpacked,
    };
    Ok((head, body))
}

/// Contents of a file of `case`, written by [`packed`]; else the reason as a sentence.
fn unpacked<T: DeserializeOwned>(path: &Path, run: &str, case: &str) -> Result<T, String> {
    let read = || {
        let (head, body) = kept_file::read::<Head>(path)?;
        if (head.run.as_str(), head.case.as_str()) != (run, case) {
            return Err(OTHER_CASE.to_owned());
        }
        let (stated, packed) = (head.unpacked, body.len());
        if stated > most_unpacked(packed) {
            return Err(format!(
                "it says that its {packed} bytes unpack to {stated}: volref writes none like it"
            ));
        }
        let mut bytes = Vec::new();
        let mut decoder = DeflateDecoder::new(&body[..]).take(stated.saturating_add(1));
        decoder
            .read_to_end(&mut bytes)
            .map_err(|error| error.to_string())?;
        if bytes.len() as u64 != stated {
            return Err("it unpacks to another number of bytes than it says".to_owned());
        }
        rmp_serde::from_slice(&bytes).map_err(|error| error.to_string())
    };
    read().map_err(|reason: String| format!("{}: {reason}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contents that pack to less than a 64th, such as large images of one colour, are written unpacked.
    #[test]
    fn flat_contents_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flat");
        let flat = "a".repeat(70 << 20);
        let write = |value: &str| {
            let (head, body) = packed(Path::new("flat"), "run", "case", &value).unwrap();
            kept_file::write(folder.path(), Path::new("flat"), &head, &body).unwrap();
        };
        write(&flat);
        assert!(std::fs::metadata(&path).unwrap().len() > 70 << 20);
        let read: String = unpacked(&path, "run", "case").unwrap();
        assert!(read == flat);
        write(&flat[..1 << 20]);
        assert!(std::fs::metadata(&path).unwrap().len() < 1 << 16);
        let other = unpacked::<String>(&path, "run", "other").unwrap_err();
        assert!(other.ends_with(OTHER_CASE), "{other}");
    }

    #[test]
    fn pictures_of_differences_have_whole_rows() {
        let fit = |columns, difference, fitted| FitMap {
            columns,
            difference: vec![[0.0; 3]; difference],
            fitted: vec![[0.0; 3]; fitted],
        };
        assert!(fit(3, 6, 6).is_whole());
        for broken in [fit(0, 6, 6), fit(4, 6, 6), fit(3, 6, 5), fit(3, 0, 0)] {
            assert!(!broken.is_whole());
        }
    }
}
