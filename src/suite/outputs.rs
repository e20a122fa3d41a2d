//! The images of another renderer in a folder, by case.
//!
//! The image of the case `fog/forward` is one of
//!
//! - `fog/forward.exr`, `.pfm`, `.npy` or `.png`, or
//! - `fog/forward.0.exr`, `fog/forward.1.exr`, …: replicates, renderings with seeds of their own,
//!   numbered without a gap from 0 or 1, or
//! - of a case without a step, `limit/blob.exr` with the step of its scene, `limit/blob@0.5.exr` with
//!   half of it, `limit/blob@0.25.exr` with a quarter, and so on without a gap,
//!
//! or the same without `fog/`, if no other family has a case `forward`. A single image may have a
//! second file, `fog/forward.variance.exr`: the variance of the mean as its colours, and the number
//! of samples as its channel `samples.Y`; and `fog/forward.depth.npy`, its depth, of the shape (height, width).

use crate::compare::{Picture, PictureError};
use crate::files::misspelling::nearest;
use crate::film::{Film, FilmFormat};
use crate::math;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The files of a folder, sorted by case.
#[derive(Clone, Debug, Default)]
pub struct Outputs {
    folder: PathBuf,
    by_case: BTreeMap<String, BTreeSet<(Role, PathBuf)>>,
    unknown_files: Vec<UnknownFile>,
}

/// Beginning of the reason where a renderer or a format has no words for a scene.
pub(crate) const NOT_RENDERED: &str = "not rendered: ";

/// What a renderer says of a scene that it cannot draw, if that is the `reason` of a missing image.
pub(crate) fn refusal(reason: &str) -> Option<&str> {
    reason.strip_prefix(NOT_RENDERED)
}

/// The output of another renderer for a case.
#[derive(Clone, Debug)]
pub enum Output {
    /// An image.
    Picture(Box<Picture>),
    /// Images with the step of the scene, half of it, a quarter and so on: at least three.
    Refined(Vec<Picture>),
    /// None; with the reason, in words.
    Missing(String),
    /// An unusable image, or a renderer that failed; with the reason, in words.
    Unusable(String),
}

impl Output {
    /// The output with `edit` made to its images, if it has any; unusable where that fails.
    pub(crate) fn edited(self, edit: impl Fn(Picture) -> Result<Picture, String>) -> Output {
        let edited = match self {
            Output::Picture(it) => edit(*it).map(|it| Output::Picture(Box::new(it))),
            Output::Refined(all) => {
                let all: Result<_, String> = all.into_iter().map(edit).collect();
                all.map(Output::Refined)
            }
            other => Ok(other),
        };
        edited.unwrap_or_else(Output::Unusable)
    }
}

/// The image of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// One file, or one for each replicate, in order.
    pub files: Vec<PathBuf>,
    /// The variance of the mean of a single image.
    pub variance: Option<PathBuf>,
    /// The depth of a single image.
    pub depth: Option<PathBuf>,
    /// True for images with smaller and smaller steps: the files have the step of the scene, half
    /// of it, a quarter and so on.
    pub is_refined: bool,
}

/// A file that looks like an image and belongs to no case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownFile {
    /// Path.
    pub file: PathBuf,
    /// Reason why it is not used, with a suggestion: a sentence without its subject.
    pub reason: String,
}

/// A folder that cannot be read, or files of a case that do not say which image is meant.
#[derive(Debug, Error)]
#[error("{0}")]
pub struct OutputError(String);

/// Role of a file in its case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Role {
    /// The image with the step of the scene, halved this often: with 0 the only image, or the first of these.
    Step(u32),
    Replicate(u32),
    Variance,
    Depth,
}

/// The name of the image of `case` with the step of the scene halved `halvings` times, without its
/// extension.
pub(crate) fn step_name(case: &str, halvings: u32) -> String {
    match halvings {
        0 => case.to_owned(),
        _ => format!("{case}@{}", math::exp2(-f64::from(halvings))),
    }
}

/// Path of the image `name` in a folder of images.
pub fn image_path(folder: &Path, name: &str, extension: &str) -> PathBuf {
    folder.join(format!("{name}.{extension}"))
}

/// Halvings that a name may ask for: a step that is a thousandth of the scene's shows nothing new.
const MOST_HALVINGS: u32 = 10;

impl Outputs {
    /// Lists the images in `folder` and in the folders within it, for the cases with these names
    /// (`family/name`). No file is opened.
    pub fn list(folder: &Path, cases: &[&str]) -> Result<Outputs, OutputError> {
        let mut outputs = Outputs {
            folder: folder.to_owned(),
            ..Outputs::default()
        };
        for (file, is_folder) in entries(folder)? {
            if !is_folder {
                outputs.sort_in(file, "", cases);
                continue;
            }
            let family = last_name(&file);
            for (file, is_folder) in entries(&file)? {
                if !is_folder {
                    outputs.sort_in(file, &format!("{family}/"), cases);
                }
            }
        }
        Ok(outputs)
    }

    /// The image of `case`; nothing where there is none.
    pub fn find(&self, case: &str) -> Result<Option<Found>, OutputError> {
        let Some(files) = self.by_case.get(case) else {
            return Ok(None);
        };
        let unclear = |why: String| Err(OutputError(format!("{case}: {why}")));
        let files: Vec<_> = files.iter().collect();
        // Steps stand before replicates.
        let contradict = |pair: &&[&(Role, PathBuf)]| match (pair[0].0, pair[1].0) {
            (Role::Step(_), Role::Replicate(_)) => true,
            (one, other) => one == other,
        };
        if let Some(two) = files.windows(2).find(contradict) {
            let [one, other] = [0, 1].map(|i| two[i].1.display());
            return unclear(format!(
                "both {one} and {other} could be its image: keep one of them"
            ));
        }
        let mut roles = files.iter().map(|(role, _)| role);
        let is_refined = roles.any(|role| matches!(role, Role::Step(1..)));
        let (mut images, mut beside) = (Vec::new(), Vec::new());
        for (role, file) in files {
            match role {
                Role::Step(number) | Role::Replicate(number) => images.push((*number, file)),
                Role::Variance | Role::Depth => beside.push((*role, file)),
            }
        }
        if is_refined && let Some((last, file)) = images.last() {
            let has = |step: u32| images.iter().any(|(number, _)| *number == step);
            if let Some(missing) = (0..=*last.max(&2)).find(|step| !has(*step)) {
                return unclear(format!(
                    "there is {}, but no {}: at least {case}.exr, {case}@0.5.exr and {case}@0.25.exr are needed",
                    file.display(),
                    step_name(case, missing)
                ));
            }
        } else if let Some((first, _)) = images.first() {
            let mut numbered = images.iter().zip(*first.min(&1)..);
            let gap = numbered.find(|((number, _), expected)| number != expected);
            if let Some(((_, file), missing)) = gap {
                return unclear(format!(
                    "there is the rendering {} but none with the number {missing}: number them from 0 or 1 without gaps",
                    file.display()
                ));
            }
        }
        if let Some((_, file)) = beside.first()
            && images.len() != 1
        {
            return unclear(format!(
                "{} belongs to a single image, but there are {}",
                file.display(),
                images.len()
            ));
        }
        let file_of = |role: Role| {
            let found = beside.iter().find(|(other, _)| *other == role);
            found.map(|(_, file)| file.to_path_buf())
        };
        Ok(Some(Found {
            variance: file_of(Role::Variance),
            depth: file_of(Role::Depth),
            files: images.iter().map(|(_, file)| (*file).clone()).collect(),
            is_refined,
        }))
    }

    /// The image of `case`, read.
    pub fn output(&self, case: &str) -> Output {
        let read = |found: Found| -> Result<Output, PictureError> {
            if found.is_refined {
                let files = found.files.iter().map(|file| Picture::read(file));
                return Ok(Output::Refined(files.collect::<Result<_, _>>()?));
            }
            Ok(Output::Picture(Box::new(found.read()?)))
        };
        match self.find(case) {
            Ok(None) => Output::Missing(format!(
                "no image of this case in {}: name it {case}.exr (or .pfm, .npy, .png)",
                self.folder.display(),
            )),
            Ok(Some(found)) => {
                read(found).unwrap_or_else(|error| Output::Unusable(error.to_string()))
            }
            Err(error) => Output::Unusable(error.to_string()),
        }
    }

    /// The files of `case`, in whatever role.
    pub(crate) fn files_of(&self, case: &str) -> impl Iterator<Item = &Path> {
        let files = self.by_case.get(case).into_iter().flatten();
        files.map(|(_, file)| file.as_path())
    }

    /// Every file that is read for some case.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.by_case.values().flatten();
        files.map(|(_, file)| file.as_path())
    }

    /// Files that look like images and belong to no case, by name.
    pub fn unknown_files(&self) -> &[UnknownFile] {
        &self.unknown_files
    }

    /// Takes `file`, which lies in the folder of its `family` (with a slash, or none).
    fn sort_in(&mut self, file: PathBuf, family: &str, cases: &[&str]) {
        match role_of(&file, family, cases) {
            Ok(Some((case, role))) => {
                let files = self.by_case.entry(case.to_owned()).or_default();
                files.insert((role, file));
            }
            Ok(None) => {}
            Err(reason) => self.unknown_files.push(UnknownFile { file, reason }),
        }
    }
}

/// The case of `file`, and its role there; nothing if it is not an image.
fn role_of<'c>(
    file: &Path,
    family: &str,
    cases: &[&'c str],
) -> Result<Option<(&'c str, Role)>, String> {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let Some(format) = FilmFormat::of(file) else {
        return Ok(None);
    };
    let (case, role) = belonging(&format!("{family}{stem}"), cases)?;
    if role == Role::Variance && format != FilmFormat::Exr {
        return Err("is not read: variances are an .exr, with R, G, B and samples.Y".to_owned());
    }
    if role == Role::Depth && format != FilmFormat::Npy {
        return Err("is not read: depths are an .npy of the shape (height, width), or the channel Z of an .exr".to_owned());
    }
    Ok(Some((case, role)))
}

/// Entries of a folder but hidden ones, sorted by name; true for folders.
pub(crate) fn entries(folder: &Path) -> Result<Vec<(PathBuf, bool)>, OutputError> {
    let trouble = |error: std::io::Error| {
        let folder = folder.display();
        OutputError(format!("{folder}: the folder cannot be read: {error}"))
    };
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(trouble)? {
        let path = entry.map_err(trouble)?.path();
        // A link that leads nowhere is a file that cannot be read.
        let is_folder = path.is_dir();
        if !last_name(&path).starts_with('.') {
            entries.push((path, is_folder));
        }
    }
    entries.sort();
    Ok(entries)
}

fn last_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// The case of a file called `stem`, with its family or without; else the reason why it has none. A
/// case may be called `rate-0.1`: the whole name comes before the number of a replicate.
fn belonging<'c>(stem: &str, cases: &[&'c str]) -> Result<(&'c str, Role), String> {
    if let Some(case) = case_called(stem, cases)? {
        return Ok((case, Role::Step(0)));
    }
    if let Some((name, factor)) = stem.rsplit_once('@')
        && let Some(case) = case_called(name, cases)?
    {
        return Ok((case, role_of_step(case, factor)?));
    }
    if let Some((name, last)) = stem.rsplit_once('.') {
        let is_number = !last.is_empty() && last.bytes().all(|byte| byte.is_ascii_digit());
        let role = match last {
            "variance" => Some(Role::Variance),
            "depth" => Some(Role::Depth),
            _ if is_number => last.parse().ok().map(Role::Replicate),
            _ => None,
        };
        if let (Some(role), Some(case)) = (role, case_called(name, cases)?) {
            return Ok((case, role));
        }
    }
    let called = |case: &'c str| if stem.contains('/') { case } else { bare(case) };
    let near = nearest(stem, cases.iter().map(|case| called(case)));
    let case = near.and_then(|name| cases.iter().find(|case| called(case) == name));
    Err(match case {
        Some(case) => format!("does not match any case: did you mean {case}?"),
        None => "does not match any case".to_owned(),
    })
}

/// The image of `case` with the step of the scene times `factor`.
fn role_of_step(case: &str, factor: &str) -> Result<Role, String> {
    let value: f64 = factor.parse().unwrap_or(f64::NAN);
    let halvings = (0..=MOST_HALVINGS).find(|&halvings| value == math::exp2(-f64::from(halvings)));
    match halvings {
        Some(halvings) => Ok(Role::Step(halvings)),
        None => Err(format!(
            "is not read: {factor:?} is no factor of the step (1, 0.5, 0.25, …); name the images {case}.exr, {}.exr, {}.exr",
            step_name(case, 1),
            step_name(case, 2)
        )),
    }
}

/// The case `name`, or the only one that is called so in any family.
fn case_called<'c>(name: &str, cases: &[&'c str]) -> Result<Option<&'c str>, String> {
    if let Some(case) = cases.iter().find(|case| **case == name) {
        return Ok(Some(case));
    }
    let called = cases.iter().copied().filter(|case| bare(case) == name);
    let called: Vec<&str> = called.collect();
    match called[..] {
        [] => Ok(None),
        [case] => Ok(Some(case)),
        _ => Err(format!(
            "may be of {}: put it into the folder of its family",
            called.join(" or ")
        )),
    }
}

/// The name of a case without its family.
fn bare(case: &str) -> &str {
    case.rsplit_once('/').map_or(case, |(_, name)| name)
}

impl Found {
    /// Reads the image: of several replicates their mean, with their spread as noise.
    pub fn read(&self) -> Result<Picture, PictureError> {
        let picture = match (&self.files[..], &self.variance) {
            ([file], None) => Picture::read(file)?,
            ([file], Some(variance)) => with_variance(file, variance)?,
            (files, _) => pooled(files)?,
        };
        match &self.depth {
            Some(depth) => with_depth(picture, depth),
            None => Ok(picture),
        }
    }
}

/// The radiance in `file`, which is to have noise.
fn radiance(file: &Path) -> Result<Film, PictureError> {
    match Picture::read(file)? {
        Picture::Radiance(film) => Ok(film),
        Picture::Codes(_) => Err(PictureError::of(
            file,
            "a PNG has no noise that could be judged; write linear radiance, as .exr, .pfm or .npy; or one .png alone",
        )),
    }
}

fn with_variance(file: &Path, variance: &Path) -> Result<Picture, PictureError> {
    let film = radiance(file)?;
    let bytes = Picture::bytes(variance)?;
    let film = Film::variance_from_exr(&bytes)
        .and_then(|(spread, samples)| film.with_variance_of(&spread, samples))
        .map_err(|error| PictureError::of(variance, error))?;
    Ok(Picture::Radiance(film))
}

/// `picture` with the depths in the file `depth`; a PNG is left without.
fn with_depth(picture: Picture, depth: &Path) -> Result<Picture, PictureError> {
    let Picture::Radiance(film) = picture else {
        return Ok(picture);
    };
    let bytes = Picture::bytes(depth)?;
    let film = Film::from_npy(&bytes).and_then(|depths| film.with_depth_of(&depths));
    let film = film.map_err(|error| PictureError::of(depth, error))?;
    Ok(Picture::Radiance(film))
}

fn pooled(files: &[PathBuf]) -> Result<Picture, PictureError> {
    let films: Result<Vec<Film>, PictureError> = files.iter().map(|file| radiance(file)).collect();
    let first = files.first().map_or(Path::new(""), PathBuf::as_path);
    let film = Film::from_replicates(&films?).map_err(|error| PictureError::of(first, error))?;
    Ok(Picture::Radiance(film))
}
