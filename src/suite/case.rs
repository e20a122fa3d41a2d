//! The suite: every manifest in its folder is a case.

use super::outline::{self, Outline};
use super::{Answer, EmbeddedSuite, Store};
use crate::compare::{Gate, Promise};
use crate::files::misspelling::nearest;
use crate::files::regular_file::identity_of;
use crate::film::Depth;
use crate::known_answers::{self, Footprint, Formula};
use crate::scene::format::{Key, Kind, Range, Table};
use crate::scene::reader::Reader;
use crate::scene::{Scene, SceneError, SceneResult};
use crate::variations::mistakes;
use glam::DVec3;
use miette::Diagnostic;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Folder of scenes, manifests and their files, relative to the root of the suite.
const FIXTURES: &str = "fixtures";
/// Folder of the manifests, relative to the root of the suite.
const CASES: &str = "fixtures/cases";
/// Folder of the goldens.
const GOLDEN: &str = "golden";
/// Folder for results until they are joined.
pub(crate) const CACHE: &str = ".volref";

/// The default of `mean_resolution` in [`MANIFEST`]: bias of the mean of an image that a case must
/// detect, relative to that mean plus [`DARK`](crate::compare::stochastic::DARK). Wrong factors are
/// larger.
pub const MEAN_RESOLUTION: f64 = 0.02;

/// The class of cases that are rendered without random numbers.
const DETERMINISTIC: &str = "deterministic";
/// The class of cases whose picture is an integral without samples.
const LIMIT: &str = "limit";
/// The class of cases whose pixels are Monte Carlo estimates.
const STOCHASTIC: &str = "stochastic";

/// The declaration of a manifest, `fixtures/cases/<family>/<name>.toml`.
pub const MANIFEST: Table = Table::new("A case: a scene, its source, and how images of it are compared.").keys(&[
    Key::derived("scene", Kind::Text, "../../scenes/<family>/<name>.toml")
        .doc("Scene file, relative to the folder of the manifest."),
    Key::required("source", Kind::Text)
        .doc("Document and figure that is reproduced."),
    Key::required("shows", Kind::Text)
        .doc("Features of a correct image."),
    Key::required("computes", Kind::Text)
        .doc("The exact computation, where the source has gaps or mistakes."),
    Key::required("class", Kind::Choice(&[DETERMINISTIC, LIMIT, STOCHASTIC]))
        .doc("Deterministic: rendered without random numbers. Limit: likewise, and an integral without samples, to which renderers converge as their steps become short. Stochastic: each pixel is a Monte Carlo estimate."),
    Key::optional("converged_samples", Kind::Count(64, 1 << 24))
        .doc("Stochastic cases without a `truth`, and required there: samples per pixel of the golden image."),
    Key::or("quick_samples", Kind::Count(2, 1 << 16), "4")
        .doc("Stochastic cases: samples per pixel of the rendering that `volref verify` repeats."),
    Key::or("resolution", Kind::Number(Range::open(0.0, 1.0)), "0.02")
        .doc("Stochastic cases: how well the golden is known in blocks of 8 by 8 pixels. Four standard errors of nine tenths of the blocks are below this, relative to their mean radiance plus 0.001."),
    Key::or("mean_resolution", Kind::Number(Range::open(0.0, 1.0)), "0.02")
        .doc("Stochastic cases: bias of the mean of the whole image that the gate must be able to detect, relative to that mean plus 0.001. Images too noisy for that are neither passed nor failed."),
    Key::optional("truth", Kind::Choice(&known_answers::NAMES))
        .doc("Formula for the radiance of every pixel, which is then the golden; `volref verify` evaluates it again. Coefficients, shapes and lights are those of the scene."),
    Key::optional("answer", Kind::Colour(Range::NOT_NEGATIVE))
        .doc("Radiance that every pixel has, where it is known beforehand. `volref verify` compares the image with it, beside the golden; of a stochastic case the golden itself, in the mean of the whole image, to four standard errors. `volref validate` compares images that state their noise with it, in place of the golden."),
    Key::optional("answer_within", Kind::Number(Range::open(0.0, 1.0)))
        .doc("Deterministic cases with an `answer`, and required there: how far from it a pixel may be, relative to it."),
    Key::or("opacity", Kind::Flag, "false")
        .doc("Whether opacity is asked for as a result: an image whose fourth channel is 1 or 0 everywhere is judged by it, too. Without this, such a channel is taken for one that nobody wrote, and any other is compared."),
    Key::optional("depth", Kind::Choice(&Depth::NAMES))
        .doc("Deterministic cases: depth is asked for as a result, in world units: the mean distance of what a pixel shows, weighed by opacity, or the one at which opacity reaches one half; along the ray, or along the view as in a depth buffer. An image that brings depths is judged by them."),
    Key::optional("mistakes", Kind::Words)
        .doc("Mistakes that the case must catch, by their names in the catalogue (volref selftest)."),
    Key::or("exposure", Kind::Number(Range::closed(-64.0, 64.0)), "0.0")
        .doc("Exposure, in stops, at which 8-bit images are made and compared: radiance times 2^exposure."),
]);

/// A case of the suite.
#[derive(Clone, Debug)]
pub struct Case {
    /// `family/name`.
    pub name: String,
    /// The first half of the name.
    pub family: String,
    /// Scene file.
    pub scene: PathBuf,
    /// The arguments that name its suite in a command, with a blank before them; none where it is the current folder or
    /// the embedded one.
    pub(crate) suite_option: String,
    /// Document and figure that the case reproduces.
    pub source: String,
    /// Features of a correct image.
    pub shows: String,
    /// The exact computation.
    pub computes: String,
    /// Formula of every pixel of the golden, if that is a known answer.
    pub truth: Option<&'static Formula>,
    /// Radiance of every pixel, if it is known beforehand.
    pub answer: Option<Answer>,
    /// Opacity is asked for as a result.
    pub opacity: bool,
    /// The depth that is asked for as a result.
    pub depth: Option<Depth>,
    /// Mistakes that the case must catch, by name.
    pub mistakes: Vec<String>,
    /// Exposure of 8-bit images, in stops.
    pub exposure: f64,
    /// True if the picture is the integral that renderers approximate by steps.
    limit: bool,
    /// Sampling, for a stochastic case.
    pub sampling: Option<CaseSampling>,
    /// Biases that an image with noise must show if it has them: in a case without random numbers, any.
    pub promise: Promise,
    /// Keys of the manifest that change how images are judged, with their values, where these are no defaults: the golden
    /// records them beside `exposure` and `truth`, so that no edit loosens a judgement unseen.
    pub(crate) judged_by: BTreeMap<String, String>,
}

/// Sampling of a stochastic case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaseSampling {
    /// Samples per pixel of the rendering that `verify` repeats.
    pub quick: u32,
    /// Sampling of the golden image; `None` where it is a known answer.
    pub converged: Option<ConvergedSampling>,
}

/// Sampling of the golden of a stochastic case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvergedSampling {
    /// Samples per pixel.
    pub samples: u32,
    /// Four standard errors of a block of the golden are below this, relative to the mean of the
    /// block plus [`DARK`](crate::compare::stochastic::DARK).
    pub resolution: f64,
}

impl Case {
    /// `stochastic` for a case that is sampled, `limit` for an integral without samples, else
    /// `deterministic`, as in manifests and results.
    pub fn class(&self) -> &'static str {
        match self.sampling {
            Some(_) => STOCHASTIC,
            None if self.limit => LIMIT,
            None => DETERMINISTIC,
        }
    }

    /// The part of a pixel that its radiance is averaged over.
    pub(crate) fn footprint(&self) -> Footprint {
        match self.sampling {
            Some(_) => Footprint::Square,
            None => Footprint::Centre,
        }
    }

    /// The gate for images of other renderers.
    pub fn gate(&self) -> Gate {
        match self.sampling {
            Some(_) => Gate::Stochastic,
            None => Gate::Deterministic,
        }
    }

    /// True if the image is a limit, to which renderings converge with their step.
    pub fn is_limit(&self) -> bool {
        self.limit
    }

    /// The scene of the case.
    pub fn load_scene(&self) -> SceneResult<Scene> {
        Scene::load(&self.scene)
    }
}

/// A folder with `fixtures/cases` and `golden`.
#[derive(Clone, Debug)]
pub struct Suite {
    root: PathBuf,
    cases: Vec<Case>,
    /// Places of the cases, by name.
    by_name: HashMap<String, usize>,
    /// `family/name` of manifests that cannot be read, with the files.
    unreadable: Vec<(String, PathBuf)>,
    /// Files of the suite, relative to the root; `None` if every file there is one.
    own: Option<BTreeSet<PathBuf>>,
    pub(super) outline: Outline,
}

/// Errors in finding a suite or its cases.
#[derive(Debug, Diagnostic, Error)]
pub enum SuiteError {
    /// The folder cannot be read.
    #[error("cannot read {}: {error}", path.display())]
    Read {
        /// File or folder.
        path: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// A manifest with a mistake.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Manifest(Box<SceneError>),
    /// Something else in the suite or the filters that must be mended first.
    #[error("{message}")]
    Refused {
        /// The fault, and its place.
        message: String,
        /// Remedy.
        #[help]
        help: String,
    },
    /// A filter that matches no case.
    #[error("no case matches {filter:?}")]
    NoMatch {
        /// The filter as given.
        filter: String,
        /// The nearest names.
        #[help]
        help: String,
    },
}

impl SuiteError {
    pub(super) fn refused(message: String, help: impl Into<String>) -> SuiteError {
        let help = help.into();
        SuiteError::Refused { message, help }
    }
}

impl Suite {
    /// The suite in the folder `root`: reads every manifest, renders nothing. A mistake in a manifest
    /// is an error of whoever [selects](Suite::select) its case.
    pub fn open(root: &Path) -> Result<Suite, SuiteError> {
        Suite::open_with(root, None)
    }

    /// As [`open`](Self::open), of an embedded suite that was unpacked into `root`: other files there are no
    /// cases and no goldens.
    pub(crate) fn open_unpacked(
        root: &Path,
        embedded: &EmbeddedSuite,
    ) -> Result<Suite, SuiteError> {
        let own = embedded.paths().map(Path::to_owned);
        Suite::open_with(root, Some(own.collect()))
    }

    fn open_with(root: &Path, own: Option<BTreeSet<PathBuf>>) -> Result<Suite, SuiteError> {
        let shown = root;
        // Not ./fixtures: shown in messages, the short way reads better.
        let root = if root == Path::new(".") {
            Path::new("")
        } else {
            root
        };
        let folder = root.join(CASES);
        if !folder.is_dir() {
            let message = format!(
                "{} contains no suite: there is no folder {CASES}",
                shown.display()
            );
            let help = "run volref in the suite's folder, or give the folder with --suite DIR";
            return Err(SuiteError::refused(message, help));
        }
        let mut suite = Suite {
            root: root.to_owned(),
            cases: Vec::new(),
            by_name: HashMap::new(),
            unreadable: Vec::new(),
            own,
            outline: Outline::default(),
        };
        let manifests = suite.records(CASES)?;
        check_names(&manifests)?;
        for path in manifests {
            match read_manifest(&path) {
                Ok(mut case) => {
                    if suite.own.is_some() {
                        case.suite_option = String::new();
                    }
                    suite.by_name.insert(case.name.clone(), suite.cases.len());
                    suite.cases.push(case);
                }
                Err(_) => suite.unreadable.push((name_of(&path), path)),
            }
        }
        let file = Path::new(outline::FILE);
        let path = suite.root.join(file);
        if suite.own.as_ref().is_none_or(|own| own.contains(file)) && path.exists() {
            let outline = Outline::read(&path, |name| suite.has_manifest(name));
            suite.outline = outline.map_err(SuiteError::Manifest)?;
        }
        Ok(suite)
    }

    /// The cases whose manifests can be read, by family and name.
    pub fn cases(&self) -> &[Case] {
        &self.cases
    }

    /// The case of this name.
    pub fn case(&self, name: &str) -> Option<&Case> {
        self.by_name.get(name).map(|&index| &self.cases[index])
    }

    /// True if there is a manifest of this case, with or without a mistake.
    pub(crate) fn has_manifest(&self, name: &str) -> bool {
        let is_unreadable = self.unreadable.iter().any(|(other, _)| other == name);
        is_unreadable || self.case(name).is_some()
    }

    /// Folder of the goldens.
    pub fn golden_folder(&self) -> PathBuf {
        self.root.join(GOLDEN)
    }

    /// The goldens.
    pub fn store(&self) -> Store {
        Store::open(self.golden_folder())
    }

    /// Every file of the suite: all files below its fixtures and goldens, and the targets of links
    /// there.
    pub fn files(&self) -> Vec<PathBuf> {
        let mut files = Vec::new();
        let mut folders = vec![self.root.join(FIXTURES), self.golden_folder()];
        let mut seen = HashSet::new();
        while let Some(folder) = folders.pop() {
            // By way of a link a folder may be within itself.
            let is_new = identity_of(&folder).is_some_and(|identity| seen.insert(identity));
            let Ok(entries) = std::fs::read_dir(&folder) else {
                continue;
            };
            for entry in entries.flatten().filter(|_| is_new) {
                let path = entry.path();
                if path.is_dir() {
                    folders.push(path)
                } else {
                    files.push(path)
                }
            }
        }
        files
    }

    /// The files `*/*.toml` of a part of the suite, sorted.
    fn records(&self, part: &str) -> Result<Vec<PathBuf>, SuiteError> {
        let families = sorted_entries(&self.root.join(part))?.into_iter();
        let mut records = Vec::new();
        for family in families.filter(|path| path.is_dir()) {
            records.extend(sorted_entries(&family)?);
        }
        records.retain(|path| {
            let inner = path.strip_prefix(&self.root);
            let is_own = |own: &BTreeSet<PathBuf>| inner.is_ok_and(|path| own.contains(path));
            let is_record = path.extension().is_some_and(|ending| ending == "toml");
            is_record && self.own.as_ref().is_none_or(is_own)
        });
        Ok(records)
    }

    /// The manifest of a case.
    pub(crate) fn manifest_of(&self, case: &Case) -> PathBuf {
        self.root.join(CASES).join(format!("{}.toml", case.name))
    }

    /// Folder for results until they are joined.
    pub(crate) fn cache_folder(&self) -> PathBuf {
        self.root.join(CACHE)
    }

    /// `family/name` of every golden, by its provenance file.
    pub(crate) fn golden_names(&self) -> Result<Vec<String>, SuiteError> {
        let root = self.golden_folder();
        if !root.is_dir() {
            return Ok(Vec::new());
        }
        let records = self.records(GOLDEN)?.into_iter();
        let names = records.filter_map(|path| {
            let path = path.with_extension("");
            let name = path.strip_prefix(&root).ok()?;
            Some(name.display().to_string())
        });
        Ok(names.collect())
    }

    /// The cases that any of the filters matches; all cases without filters. A filter is a family,
    /// a case (`family/name` or just `name`), or a glob over either. A filter that begins with `!` excludes what
    /// the rest of it matches; where all do, they leave the others of all cases. A filter without a match, or
    /// filters that leave nothing, are an error: a check that silently checks nothing is worse than none.
    pub fn select(&self, filters: &[String]) -> Result<Vec<&Case>, SuiteError> {
        let no_match = |filter: &str, help| SuiteError::NoMatch {
            filter: filter.to_owned(),
            help,
        };
        let filters = &self.outline.with_core(filters)[..];
        for filter in filters {
            let pattern = pattern_of(filter);
            let reason = match fast_glob::validate(pattern) {
                Err(error) => error.to_string(),
                // The crate would take a second `!` for "all but".
                Ok(()) if filter == "!" || pattern.starts_with('!') => {
                    "one ! stands before what it excludes".to_owned()
                }
                Ok(()) => continue,
            };
            let help = "a filter is a family, a case, or a pattern over them such as 'figures/*'; with ! before it, it \
                        excludes";
            let message = format!("{filter:?} is not a pattern: {reason}");
            return Err(SuiteError::refused(message, help));
        }
        let mut unreadable = self.unreadable.iter();
        if let Some((_, path)) = unreadable.find(|(name, _)| is_chosen(filters, name)) {
            read_manifest(path).map_err(SuiteError::Manifest)?;
        }
        if filters.is_empty() && self.cases.is_empty() {
            return Err(no_match("*", format!("{CASES} is empty")));
        }
        for filter in filters {
            let unreadable = self.unreadable.iter().map(|(name, _)| name);
            let mut names = self.names().chain(unreadable);
            if !names.any(|name| matches(pattern_of(filter), name)) {
                return Err(no_match(filter, self.nearest(filter)));
            }
        }
        let cases = self.cases.iter();
        let chosen: Vec<&Case> = cases.filter(|it| is_chosen(filters, &it.name)).collect();
        if chosen.is_empty() {
            let help = "what the filters name is excluded by those that begin with !";
            return Err(no_match(&filters.join(" "), help.to_owned()));
        }
        Ok(chosen)
    }

    fn names(&self) -> impl Iterator<Item = &String> {
        self.cases.iter().map(|case| &case.name)
    }

    fn nearest(&self, filter: &str) -> String {
        let given = filter;
        let filter = pattern_of(given);
        if self.cases.is_empty() {
            return format!("{CASES} is empty");
        }
        let option = match self.own {
            Some(_) => String::new(),
            None => suite_option(&self.root),
        };
        let all = format!("`volref list{option}` shows all cases");
        let names = self.names().flat_map(|name| parts(name));
        match nearest(filter, names) {
            Some(name) => {
                let mark = given.strip_suffix(filter).unwrap_or_default();
                let meant = format!("{mark}{name}");
                format!("did you mean {meant:?}? {all}")
            }
            None => all,
        }
    }
}

/// The arguments that name the suite in the folder `root` in a command, with a blank before them; none where it is the
/// current folder.
fn suite_option(root: &Path) -> String {
    match root.to_string_lossy() {
        root if root.is_empty() => String::new(),
        root => format!(" --suite {}", shell_words::quote(&root)),
    }
}

/// True if the filters choose the case of this name: each one where none names any, but for those that are excluded.
fn is_chosen(filters: &[String], name: &str) -> bool {
    let is_match = |filter: &&String| matches(pattern_of(filter), name);
    let (excluding, naming): (Vec<_>, Vec<_>) =
        filters.iter().partition(|filter| filter.starts_with('!'));
    let is_named = naming.is_empty() || naming.iter().any(is_match);
    is_named && !excluding.iter().any(is_match)
}

/// The pattern of a filter, without the `!` of one that excludes.
fn pattern_of(filter: &str) -> &str {
    filter.strip_prefix('!').unwrap_or(filter)
}

/// True if a pattern names a case. Its `*` stands for slashes, too, unlike that of the crate.
fn matches(pattern: &str, name: &str) -> bool {
    let without_slashes = |text: &str| text.replace('/', ":");
    let is_match = |text| fast_glob::glob_match(without_slashes(pattern), without_slashes(text));
    parts(name).into_iter().any(is_match)
}

/// A name, its family, and the name without it.
fn parts(name: &str) -> [&str; 3] {
    let (family, own) = name.split_once('/').unwrap_or((name, name));
    [name, family, own]
}

fn sorted_entries(folder: &Path) -> Result<Vec<PathBuf>, SuiteError> {
    let failed = |error| SuiteError::Read {
        path: folder.to_owned(),
        error,
    };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        paths.push(entry.map_err(failed)?.path());
    }
    paths.sort();
    Ok(paths)
}

/// Fails where two manifests have one name.
fn check_names(manifests: &[PathBuf]) -> Result<(), SuiteError> {
    let mut files: BTreeMap<String, &Path> = BTreeMap::new();
    for path in manifests {
        let name = name_of(path);
        if let Some(other) = files.insert(name.to_lowercase(), path) {
            let [file, other] = [path, other].map(Path::display);
            let message = format!(
                "two cases are called {name}, or differ in capitals alone: {file} and {other}"
            );
            let help = "rename one of them, with its scene and its golden";
            return Err(SuiteError::refused(message, help));
        }
    }
    Ok(())
}

/// `family/name` of a manifest.
fn name_of(path: &Path) -> String {
    let part = |path: Option<&Path>| {
        let name = path
            .and_then(Path::file_stem)
            .and_then(|name| name.to_str());
        name.unwrap_or("?").to_owned()
    };
    format!("{}/{}", part(path.parent()), part(Some(path)))
}

fn read_manifest(path: &Path) -> SceneResult<Case> {
    outline::read_file(path, &MANIFEST, |reader| case_of(path, reader))
}

/// The case that the manifest at `path` declares.
fn case_of(path: &Path, reader: &Reader) -> SceneResult<Case> {
    let full_name = name_of(path);
    let (family, name) = full_name.split_once('/').unwrap_or_default();
    let family = family.to_owned();
    let folder = path.parent().unwrap_or(Path::new(""));
    let scene = match reader.get::<Option<String>>("scene")? {
        Some(scene) => folder.join(scene),
        // Not folder/../../scenes: shown in messages, the short way reads better.
        None => {
            let fixtures = folder.parent().and_then(Path::parent);
            let fixtures = fixtures.unwrap_or(Path::new(""));
            fixtures.join(format!("scenes/{family}/{name}.toml"))
        }
    };
    let class: String = reader.get("class")?;
    let is_stochastic = class == STOCHASTIC;
    let truth: Option<String> = reader.get("truth")?;
    let truth = truth.and_then(|name| Formula::named(&name));
    let sampling = read_sampling(reader, is_stochastic, truth.is_some())?;
    let answer = read_answer(reader, is_stochastic)?;
    if truth.is_some() && answer.is_some() {
        let message = "the `truth` is the answer: leave one of them out";
        return Err(reader.error("answer", message));
    }
    let depth = read_depth(reader, &class)?;
    let (opacity, promise): (bool, f64) = (reader.get("opacity")?, reader.get("mean_resolution")?);
    let (radiance, within): (Option<DVec3>, Option<f64>) =
        (reader.get("answer")?, reader.get("answer_within")?);
    let changed = [
        ("class", (class == LIMIT).then(|| class.clone())),
        (
            "mean_resolution",
            (promise != MEAN_RESOLUTION).then(|| promise.to_string()),
        ),
        ("opacity", opacity.then(|| opacity.to_string())),
        ("depth", depth.map(|depth| depth.to_string())),
        ("answer", radiance.map(|radiance| radiance.to_string())),
        ("answer_within", within.map(|within| within.to_string())),
    ];
    let changed = changed.into_iter();
    let suite = folder.ancestors().nth(3).unwrap_or(Path::new(""));
    Ok(Case {
        suite_option: suite_option(suite),
        judged_by: changed
            .filter_map(|(key, value)| Some((key.to_owned(), value?)))
            .collect(),
        scene,
        source: reader.get("source")?,
        shows: reader.get("shows")?,
        computes: reader.get("computes")?,
        truth,
        answer,
        opacity,
        depth,
        mistakes: read_mistakes(reader)?,
        exposure: reader.get("exposure")?,
        limit: class == LIMIT,
        sampling,
        promise: Promise::of_mean(promise),
        family,
        name: full_name,
    })
}

fn read_depth(reader: &Reader, class: &str) -> SceneResult<Option<Depth>> {
    let name: Option<String> = reader.get("depth")?;
    if name.is_some() && class != DETERMINISTIC {
        let message = format!("depth is judged in deterministic cases, and this one is {class}");
        return Err(reader.error("depth", message));
    }
    Ok(name.and_then(|name| name.parse().ok()))
}

fn read_mistakes(reader: &Reader) -> SceneResult<Vec<String>> {
    let names: Vec<String> = reader.optional("mistakes")?.unwrap_or_default();
    for name in &names {
        if mistakes::named(name).is_none() {
            let message = format!("{name:?} is not a mistake of the catalogue");
            let names = mistakes::catalogue().map(|mistake| mistake.name);
            let meant = nearest(name, names).map(|name| format!("did you mean {name:?}? "));
            let help = format!(
                "{}`volref list --mistakes` shows them all",
                meant.unwrap_or_default()
            );
            return Err(reader.mistake("mistakes", message, help));
        }
    }
    Ok(names)
}

fn read_answer(reader: &Reader, is_stochastic: bool) -> SceneResult<Option<Answer>> {
    let radiance = reader.get("answer")?;
    let within = reader.get("answer_within")?;
    match (radiance, within) {
        (None, None) => Ok(None),
        (None, Some(_)) => {
            let message = "`answer_within` without an `answer`";
            Err(reader.error("answer_within", message))
        }
        (Some(_), Some(_)) if is_stochastic => {
            let message = "volref tests the answer of a stochastic case to four standard errors: remove \
                           `answer_within`";
            Err(reader.error("answer_within", message))
        }
        (Some(radiance), None) if is_stochastic => Ok(Some(Answer::InTheMean(radiance))),
        (Some(_), None) => {
            let message = "a deterministic case with an `answer` needs `answer_within`";
            Err(reader.error("answer", message))
        }
        (Some(radiance), Some(within)) => Ok(Some(Answer::EveryPixel { radiance, within })),
    }
}

fn read_sampling(
    reader: &Reader,
    is_stochastic: bool,
    is_known: bool,
) -> SceneResult<Option<CaseSampling>> {
    if !is_stochastic {
        for name in [
            "converged_samples",
            "quick_samples",
            "resolution",
            "mean_resolution",
        ] {
            if reader.has(name) {
                let message = format!("`{name}` has no effect in a deterministic case");
                return Err(reader.error(name, message));
            }
        }
        return Ok(None);
    }
    let converged = reader.get("converged_samples")?;
    if is_known {
        let unused = ["converged_samples", "resolution"];
        if let Some(name) = unused.into_iter().find(|name| reader.has(name)) {
            let message = format!("`{name}` has no effect with a `truth`: that takes no samples");
            return Err(reader.error(name, message));
        }
    }
    let converged = match converged {
        Some(samples) => Some(ConvergedSampling {
            samples,
            resolution: reader.get("resolution")?,
        }),
        None if is_known => None,
        None => {
            let message = "a stochastic case needs `converged_samples`, or a `truth`";
            return Err(reader.error("converged_samples", message));
        }
    };
    Ok(Some(CaseSampling {
        quick: reader.get("quick_samples")?,
        converged,
    }))
}
