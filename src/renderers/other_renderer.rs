//! Another renderer: called or asked for a case, once, or once for each of three steps.

use super::call::{Call, not_run, shown};
use super::kept_images::files_in;
use super::process::run;
use super::{CallSettings, CommandTemplate, KeptImages, StayingRenderers};
use crate::compare::Picture;
use crate::files::atomic_file::directory_of;
use crate::files::{own_file, regular_file};
use crate::film::Film;
use crate::suite::{Case, Output, Outputs, image_path, step_name};
use std::error::Error;
use std::path::{Path, PathBuf, absolute};
use std::time::Duration;
use tempfile::TempDir;

/// Options of another renderer.
#[derive(Debug)]
pub(crate) struct RendererOptions {
    /// Its command.
    pub template: CommandTemplate,
    /// It stays, and is asked for one image after the other; else it is called for each.
    pub stays: bool,
    /// Samples and seed of the first call for a case.
    pub first: CallSettings,
    /// Extension of the image: one of [`OtherRenderer::FORMATS`].
    pub format: String,
    /// Time limit of a call.
    pub timeout: Duration,
    /// Folder in which images are kept, and the names of all cases of the suite.
    pub keep: Option<(PathBuf, Vec<String>)>,
}

/// Another renderer.
#[derive(Debug)]
pub(crate) struct OtherRenderer {
    /// Its options.
    pub options: RendererOptions,
    /// Its programs, if it stays.
    pub staying: Option<StayingRenderers>,
    /// Images are copied into it.
    kept: Option<KeptImages>,
    /// Holds exports, and a folder for each call, in which it writes images; removed at the end.
    pub temporary: TempDir,
}

/// Output for a case, and its origin.
#[derive(Debug)]
pub(crate) struct Rendered {
    /// The image, or the reason why there is none.
    pub output: Output,
    /// Output of the renderer, if one was run.
    pub printed: Option<String>,
    /// Notes beside the verdict.
    pub notes: Vec<String>,
    /// Command lines of the renderer, if one was run.
    pub call: Option<String>,
}

impl Rendered {
    /// An output without a renderer.
    pub fn of(output: Output) -> Rendered {
        Rendered {
            output,
            printed: None,
            notes: Vec::new(),
            call: None,
        }
    }
}

impl OtherRenderer {
    /// Formats of images.
    pub const FORMATS: [&str; 4] = ["exr", "pfm", "npy", "png"];

    /// A renderer with its folders, which are created; the error is a sentence.
    pub fn new(options: RendererOptions) -> Result<OtherRenderer, String> {
        let temporary = tempfile::tempdir()
            .map_err(|error| format!("cannot create a temporary folder: {error}"))?;
        let kept = options.keep.as_ref().map(|(folder, cases)| {
            own_file::make_folder(folder, Path::new(""))?;
            Ok(KeptImages {
                folder: absolute(folder)?,
                cases: cases.clone(),
            })
        });
        let kept = kept
            .transpose()
            .map_err(|error: std::io::Error| error.to_string())?;
        let staying = options.stays.then(|| {
            let words = options.template.words_alone();
            StayingRenderers::new(words, options.timeout)
        });
        Ok(OtherRenderer {
            options,
            staying,
            kept,
            temporary,
        })
    }

    /// The output for `case`: of a case without a step, images with three steps, if the command takes
    /// its step from here.
    pub fn output(&self, case: &Case, settings: CallSettings) -> Rendered {
        self.called(case, settings).unwrap_or_else(Rendered::of)
    }

    /// Outcome of the calls for `case`; the error is the output where it was not called.
    fn called(&self, case: &Case, settings: CallSettings) -> Result<Rendered, Output> {
        let options = &self.options;
        let exports = self.temporary.path().join("exports");
        let mut call = Call::new(&options.template, case, settings, &exports)?;
        let has_steps = case.is_limit() && options.template.takes_step();
        if let Some(kept) = &self.kept {
            // Before the work, not after it: where a link leads elsewhere, nothing can be kept.
            kept.make_folder(Path::new(&case.name)).map_err(not_run)?;
        }
        // Nothing in it can be the image of an earlier run.
        let folder = tempfile::tempdir_in(self.temporary.path()).map_err(not_run)?;
        let folder = folder.path();
        let family = folder.join(directory_of(Path::new(&case.name)));
        std::fs::create_dir_all(family).map_err(not_run)?;
        let (mut printed, mut notes, mut calls) = (String::new(), Vec::new(), Vec::new());
        let mut failure = None;
        for halvings in 0..=if has_steps { 2 } else { 0 } {
            let place = |folder: &Path| {
                image_path(folder, &step_name(&case.name, halvings), &options.format)
            };
            let output = place(folder);
            // Whoever makes the image again finds it where images are kept.
            let seen = place(self.kept.as_ref().map_or(folder, |kept| &kept.folder));
            let called = match &self.staying {
                Some(staying) => {
                    calls.push(staying.call(&call.request(&seen, halvings)));
                    staying.ask(&call.request(&output, halvings), &shown(&output))
                }
                None => {
                    calls.push(shell_words::join(call.words(&seen, halvings)));
                    let words = call.words(&output, halvings);
                    run(&words, options.timeout)
                }
            };
            printed.push_str(&called.printed);
            notes.extend(called.notes);
            failure = called.failure;
            if failure.is_some() {
                break;
            }
        }
        let written = || self.written(case, folder, has_steps, settings);
        let output = by_final_names(failure.unwrap_or_else(written), folder);
        if let Some(kept) = &self.kept
            && let Err(reason) = kept.replace_by_folder(&case.name, folder)
        {
            notes.push(format!("its images cannot be kept: {reason}"));
        }
        for file in files_in(folder).unwrap_or_default() {
            regular_file::forget(&file);
        }
        Ok(Rendered {
            output,
            printed: Some(printed),
            notes,
            call: Some(calls.join("\n")),
        })
    }

    /// The image that the renderer wrote into `folder`, or those with several steps.
    fn written(
        &self,
        case: &Case,
        folder: &Path,
        has_steps: bool,
        settings: CallSettings,
    ) -> Output {
        let outputs = match Outputs::list(folder, &[&case.name]) {
            Ok(outputs) => outputs,
            Err(error) => return Output::Unusable(error.to_string()),
        };
        let read = outputs.output(&case.name);
        let format = self.options.format.as_str();
        let unwritten = |name: &str, rest: &str| {
            Output::Missing(format!(
                "the renderer succeeded, but did not write {name}.{format}, the file that {{output}} stood for {rest}"
            ))
        };
        match read {
            Output::Missing(_) => {
                let others = Self::FORMATS.into_iter().filter(|other| *other != format);
                let others = others.collect::<Vec<_>>().join(", ");
                unwritten(
                    &case.name,
                    &format!("(for another format: --format {others})"),
                )
            }
            Output::Picture(_) if has_steps => {
                unwritten(&step_name(&case.name, 1), "with a smaller step")
            }
            // As far as is known, it did what it was asked for.
            output @ Output::Picture(_) if self.options.template.uses("spp") => {
                output.edited(|picture| match picture {
                    Picture::Radiance(film) => {
                        Ok(Picture::Radiance(film.with_samples(settings.spp)))
                    }
                    codes => Ok(codes),
                })
            }
            output => output,
        }
    }

    /// Replaces the image of the last call by these, if images are kept: one image, or several renderings.
    pub fn keep(&self, case: &Case, films: &[Film]) -> Result<(), Box<dyn Error>> {
        let Some(kept) = &self.kept else {
            return Ok(());
        };
        let mut files = Vec::new();
        for (number, film) in films.iter().enumerate() {
            let extension = match films.len() {
                1 => "exr".to_owned(),
                _ => format!("{number}.exr"),
            };
            let path = image_path(Path::new(""), &case.name, &extension);
            files.push((path, film.to_exr()?));
        }
        kept.replace(&case.name, files)
    }
}

/// `output` without the name of the temporary `folder` in its reason: there, images are called by their cases.
fn by_final_names(output: Output, folder: &Path) -> Output {
    let folder = format!("{}{}", shown(folder), std::path::MAIN_SEPARATOR);
    match output {
        Output::Unusable(reason) => Output::Unusable(reason.replace(&folder, "")),
        output => output,
    }
}
