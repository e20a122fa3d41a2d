//! Another renderer: called or asked for a case, once, or once for each of three steps.

use super::call::{Call, not_run, shown};
use super::printed::quoted_words;
use super::process::{Ran, run};
use super::staying::Called;
use super::{CallSettings, CommandTemplate, Keeper, StayingRenderers};
use crate::compare::Picture;
use crate::files::atomic_file::{directory_of, write_in_place_of};
use crate::files::{own_file, regular_file};
use crate::film::Film;
use crate::suite::{Case, Output, Outputs, image_path, step_name};
use std::error::Error;
use std::io;
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
    /// Folder in which images are kept.
    pub keep: Option<PathBuf>,
    /// Keeper of its processes.
    pub keeper: Option<Keeper>,
}

/// Another renderer.
#[derive(Debug)]
pub(crate) struct OtherRenderer {
    /// Its options.
    pub options: RendererOptions,
    /// Its programs, if it stays.
    staying: Option<StayingRenderers>,
    /// Images are written here.
    folder: PathBuf,
    /// Holds exports, and the images unless they are to be kept; removed at the end.
    temporary: TempDir,
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

impl From<Ran> for Called {
    fn from(ran: Ran) -> Called {
        let words = |reason: String| reason + &quoted_words(&ran.printed);
        Called {
            failure: ran.failure.map(words).map(Output::Unusable),
            notes: ran.notes,
            printed: ran.printed,
        }
    }
}

impl OtherRenderer {
    /// Formats of images.
    pub const FORMATS: [&str; 4] = ["exr", "pfm", "npy", "png"];

    /// A renderer with its folders, which are created; the error is a sentence.
    pub fn new(options: RendererOptions) -> Result<OtherRenderer, String> {
        let temporary = tempfile::Builder::new().prefix("volref-").tempdir();
        let temporary =
            temporary.map_err(|error| format!("cannot create a temporary folder: {error}"))?;
        let images = temporary.path().join("images");
        let folder = options.keep.as_ref().unwrap_or(&images);
        let folder = std::fs::create_dir_all(folder)
            .and_then(|()| absolute(folder))
            .map_err(|error| format!("cannot create the folder for images: {error}"))?;
        let staying = options.stays.then(|| {
            let words = options.template.words_alone();
            StayingRenderers::new(words, options.timeout, options.keeper.clone())
        });
        Ok(OtherRenderer {
            options,
            staying,
            folder,
            temporary,
        })
    }

    /// Folder of temporary files.
    pub fn temporary(&self) -> &Path {
        self.temporary.path()
    }

    /// Its programs, if it stays.
    pub fn staying(&self) -> Option<&StayingRenderers> {
        self.staying.as_ref()
    }

    /// The output for `case`: of a case without a step, images with three steps, if the command takes
    /// its step from here.
    pub fn output(&self, case: &Case, settings: CallSettings) -> Rendered {
        self.called(case, settings).unwrap_or_else(Rendered::of)
    }

    /// Outcome of the calls for `case`; the error is the output where it was not called.
    fn called(&self, case: &Case, settings: CallSettings) -> Result<Rendered, Output> {
        let options = &self.options;
        let exports = self.temporary().join("exports");
        let mut call = Call::new(&options.template, case, settings, &exports)?;
        let has_steps = case.is_limit() && options.template.takes_step();
        let (mut printed, mut notes, mut calls) = (String::new(), Vec::new(), Vec::new());
        let mut failure = None;
        for halvings in 0..=if has_steps { 2 } else { 0 } {
            let output = self.place_for(&step_name(&case.name, halvings))?;
            let called = match &self.staying {
                Some(staying) => {
                    let request = call.request(&output, halvings);
                    calls.push(staying.call(&request));
                    staying.ask(&request, &shown(&output))
                }
                None => {
                    let words = call.words(&output, halvings);
                    calls.push(shell_words::join(&words));
                    run(&words, options.timeout, options.keeper.as_ref()).into()
                }
            };
            printed.push_str(&called.printed);
            notes.extend(called.notes);
            failure = called.failure;
            if failure.is_some() {
                break;
            }
        }
        let written = || self.written(case, has_steps, settings);
        let output = failure.unwrap_or_else(written);
        notes.extend(self.fewer_samples(&output, settings));
        Ok(Rendered {
            output,
            printed: Some(printed),
            notes,
            call: Some(calls.join("\n")),
        })
    }

    /// The path at which the image `name` is to be written: its folder is there, and no image is.
    fn place_for(&self, name: &str) -> Result<PathBuf, Output> {
        // In a folder that a link leads to, an image of an earlier run might be a file of the user's.
        own_file::make_folder(&self.folder, directory_of(Path::new(name))).map_err(not_run)?;
        let output = image_path(&self.folder, name, &self.options.format);
        // An image of an earlier run would be taken for one of this.
        match std::fs::remove_file(&output) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(not_run(error)),
            _ => Ok(output),
        }
    }

    /// A note on an image that states half the samples it was asked for or fewer: the gate takes them
    /// as they are, and allows for the more noise. More are no surprise: renderings add up.
    fn fewer_samples(&self, output: &Output, settings: CallSettings) -> Option<String> {
        let Output::Picture(picture) = output else {
            return None;
        };
        let film = picture.radiance().filter(|_| self.asks_for_samples())?;
        let (stated, asked) = (film.samples()?, u64::from(settings.spp));
        (2 * stated <= asked).then(|| {
            format!("the image states {stated} samples per pixel, where {{spp}} asked for {asked}")
        })
    }

    /// The image that the renderer wrote, or those with several steps.
    fn written(&self, case: &Case, has_steps: bool, settings: CallSettings) -> Output {
        let outputs = match Outputs::list(&self.folder, &[&case.name]) {
            Ok(outputs) => outputs,
            Err(error) => return Output::Unusable(error.to_string()),
        };
        if self.options.keep.is_some() {
            self.keep_files(case, &outputs);
        }
        let format = self.options.format.as_str();
        let unwritten = |name: &str, rest: &str| {
            Output::Missing(format!(
                "the renderer succeeded, but did not write {name}.{format}, the file that {{output}} stood for {rest}"
            ))
        };
        match outputs.output(&case.name) {
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
            Output::Picture(picture) if self.asks_for_samples() => {
                Output::Picture(Box::new(picture.with_samples(settings.spp)))
            }
            output => output,
        }
    }

    /// The command passes the number of samples.
    fn asks_for_samples(&self) -> bool {
        self.options.template.uses("spp")
    }

    /// Puts files in the place of links that the renderer left in the folder of the case: what they lead to need
    /// not stay. Of one that leads nowhere the verdict says so.
    fn keep_files(&self, case: &Case, outputs: &Outputs) {
        let image = image_path(&self.folder, &case.name, &self.options.format);
        let is_in_it = |file: &&Path| file.parent() == image.parent() && file.is_symlink();
        for file in outputs.files().filter(is_in_it) {
            if let Ok(bytes) = regular_file::read(file, Picture::MOST_BYTES) {
                let _ = write_in_place_of(file, &bytes);
            }
        }
    }

    /// Replaces the image of the last call by these, if images are kept: one image, or several renderings.
    pub fn keep(&self, case: &Case, films: &[Film]) -> Result<(), Box<dyn Error>> {
        if self.options.keep.is_none() {
            return Ok(());
        }
        let last = image_path(&self.folder, &case.name, &self.options.format);
        let mut is_replaced = false;
        for (number, film) in films.iter().enumerate() {
            let extension = match films.len() {
                1 => "exr".to_owned(),
                _ => format!("{number}.exr"),
            };
            let path = image_path(&self.folder, &case.name, &extension);
            own_file::write(&path, &film.to_exr()?)?;
            is_replaced |= path == last;
        }
        if !is_replaced {
            std::fs::remove_file(&last)?;
        }
        Ok(())
    }
}
