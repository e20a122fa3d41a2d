//! `volref validate (--outputs DIR | --run CMD) [FILTER…]`

use super::decide::LookAgain;
use super::export::write_all;
use super::failure::{EXIT_CODES, Exit, Failure, bad_input};
use super::keep::keeper;
use super::kept::{KeepArgument, keep, run_of};
use super::made::{Ask, Made};
use super::partition::PartitionArgument;
use super::results::{Findings, ResultFiles, check_not_golden};
use super::suite::{Selection, exit};
use super::verdicts::{PrintedVerdicts, named};
use super::{Outcome, compare, ctest, decide, interrupt, output, progress};
use crate::compare::{Picture, Promise};
use crate::conventions::Profile;
use crate::exchange::{self, Format};
use crate::files::atomic_file::{directory_of, write_in_place_of};
use crate::files::own_file;
use crate::files::regular_file;
use crate::files::regular_file::note_input;
use crate::film::Film;
use crate::judging::{CaseResult, Evidence, Judged, Output, validate, validate_at};
use crate::math::exp2;
use crate::naming::{ConventionSearch, Search};
use crate::renderers::{CommandTemplate, run as run_process, stop_all};
use crate::report;
use crate::scene::{Classified, Panel, Scene};
use crate::suite::{Case, Outputs, Store, Suite, step_name, telling_case};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf, absolute};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Default arguments for a renderer, as text.
const TIMEOUT: &str = "600";
const SPP: &str = "64";
const SEED: &str = "1";
const BUDGET: &str = "10m";
const FORMAT: &str = "exr";
/// Formats of images.
const FORMATS: [&str; 4] = ["exr", "pfm", "npy", "png"];

/// Images and placeholders, for `--help`.
const IMAGES: &str = "Images are named after the cases, family/name or just name, and end in .exr, \
    .pfm, .npy (linear radiance) or .png (8-bit sRGB). The noise of a Monte Carlo image is taken from \
    several independent renderings, name.0.exr, name.1.exr, ..., or from a file name.variance.exr \
    with the variances of the means; otherwise it is estimated.\n\n\
    The images of a case of the family limit are name.exr, with the step of its scene, \
    name@0.5.exr, with half of it, and name@0.25.exr; a single image is judged less strictly.\n\n\
    In CMD, {scene} stands for the scene file, {output} for the image to write, {width}, {height}, \
    {spp}, {seed} for the image size, samples per pixel and seed, {case} for the name of the case, {step} for the distance between samples in world units, {rate} \
    for samples per voxel, and {export:mitsuba}, \
    {export:pbrt}, {export:bundle} for a copy of the scene in that format (see volref export). With {step} or {rate}, CMD is run three times for a case of the family limit.\n\n\
    Each verdict is printed as soon as it is known; then failing images are tested against a \
    catalogue of known mistakes. Ctrl-C ends that search and keeps the verdicts. Images rendered during the search are \
    cached in the folder that VOLREF_CACHE names (empty: no cache), or else in the user's cache \
    folder, such as ~/.cache/volref; the cache holds at most 256 MB and can be deleted at any time.";

/// Compare the images of another renderer with the goldens, and name its mistakes
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("images").required(true))]
#[command(
    after_help = format!("{IMAGES}\n\n{EXIT_CODES}"),
)]
pub struct Arguments {
    /// Families, cases, or patterns over them such as 'figures/*' [default: all cases]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    #[command(flatten)]
    selection: Selection,
    #[command(flatten)]
    partition: PartitionArgument,
    #[command(flatten)]
    kept: KeepArgument,
    /// Folder with finished images
    #[arg(long, value_name = "DIR", group = "images")]
    outputs: Option<PathBuf>,
    /// Command that renders a case; run once for each, without a shell
    #[arg(long, value_name = "CMD", group = "images")]
    run: Option<String>,
    /// Skip cases that have no image or cannot be exported to the renderer's format
    #[arg(long)]
    only_present: bool,
    /// List every case without an image
    #[arg(long)]
    verbose: bool,
    /// Conventions of the renderer: classified volumes are judged by the right image under them. One
    /// of the profiles that volref brings, or a file (volref schema profile)
    #[arg(long = "as", value_name = "PROFILE")]
    profile: Option<String>,
    /// Accept images that are right under other conventions than the golden's, and say which
    #[arg(long)]
    accept_conventions: bool,
    /// Time limit for finding the mistake behind each failing image; 0 for no search
    #[arg(long, value_name = "SECONDS", default_value_t = Search::BUDGET.into(), allow_negative_numbers = true, value_parser = search_time)]
    explain: f64,
    /// With --run: time limit, after which the renderer and all its child processes are
    /// killed
    #[arg(long, value_name = "SECONDS", default_value = TIMEOUT, allow_negative_numbers = true, value_parser = seconds)]
    timeout: f64,
    /// With --run: number of cases rendered at the same time
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: u16,
    /// With --run: samples per pixel, {spp}
    #[arg(long, value_name = "N", default_value = SPP, value_parser = crate::scene::samples)]
    spp: u32,
    /// With --run: seed, {seed}
    #[arg(long, value_name = "N", default_value = SEED)]
    seed: u64,
    /// With --run: image format of {output}: exr, pfm, npy or png
    #[arg(long, value_name = "EXT", default_value = FORMAT, value_parser = FORMATS)]
    format: String,
    /// With --run: render cases that noise leaves open again, with other seeds and more samples, until
    /// each passes or fails, or the budget is spent; all these looks together raise a false alarm no more
    /// often than one
    #[arg(long, requires = "run", conflicts_with = "outputs")]
    decide: bool,
    /// With --decide: time for the further renderings of all cases, such as 90s, 10m or 2h
    #[arg(long, value_name = "TIME", default_value = BUDGET, allow_hyphen_values = true, requires = "decide", value_parser = decide::budget)]
    budget: Duration,
    /// A stochastic image passes only if a bias this large would have been detected, in percent of (image
    /// mean + 0.001); noisier images are inconclusive [default: from the case, else 2]
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = compare::percent)]
    resolution: Option<f64>,
    /// With --run: keep the images in DIR; with --decide those of the last look: put
    /// together as .exr, or numbered
    #[arg(long, value_name = "DIR", requires = "run", conflicts_with = "outputs")]
    keep: Option<PathBuf>,
    /// Print metrics and pictures as lines that CTest collects, with the pictures in DIR
    #[arg(long, value_name = "DIR")]
    ctest: Option<PathBuf>,
    #[command(flatten)]
    files: ResultFiles,
}

/// A time limit: positive and finite.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 1e9 => Ok(seconds),
        _ => Err("a time limit is a positive number of seconds".to_owned()),
    }
}

/// A time limit for the search: not negative, and finite.
pub fn search_time(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=1e9).contains(&seconds) => Ok(seconds),
        _ => Err(
            "the time for a search is a number of seconds up to 1e9; 0 means no search".to_owned(),
        ),
    }
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.selection.open()?;
    let selected = suite.select(&arguments.filters)?.into_iter().cloned();
    let selected: Vec<Case> = selected
        .map(|case| with_promise(case, &arguments))
        .collect();
    let mut cases: Vec<&Case> = selected.iter().collect();
    let store = suite.store();
    let names: Vec<&str> = suite
        .cases()
        .iter()
        .map(|case| case.name.as_str())
        .collect();
    if let Some(folder) = &arguments.keep {
        for case in &cases {
            let path = image_of(folder, case, &arguments.format);
            check_not_golden(&path, &suite)?;
            output::check_no_input(&path)?;
        }
    }
    let profile = arguments
        .profile
        .as_deref()
        .map(Profile::named)
        .transpose()?;
    if arguments.decide && arguments.format == "png" {
        let message = "--decide needs linear radiance, and an 8-bit image has none: its noise counts as a difference";
        return Err(Failure::new(
            Exit::BadInput,
            message,
            Some("ask for --format exr, pfm or npy"),
        ));
    }
    let source = Source::of(&arguments, &names)?;
    // Now that the images to be judged are known as inputs.
    arguments.files.check(&suite)?;
    if let Some(folder) = &arguments.ctest {
        check_not_golden(folder, &suite)?;
        output::make_folder(folder)?;
    }

    source.end_with_us();

    let kept = &arguments.kept;
    let folder = kept.folder(&arguments.partition, &arguments.selection, &suite)?;
    let to_keep = folder.map(|folder| {
        let (cases, filters) = (cases.iter().copied(), &arguments.filters);
        let settings = source.settings(&arguments, profile.as_ref());
        (
            folder,
            run_of("validate", &suite, filters, cases, [], settings),
        )
    });
    let mut passed_over = Vec::new();
    if arguments.only_present {
        cases.retain(|case| {
            let may_have = source.may_have(case);
            if !may_have {
                passed_over.push(case.name.clone());
            }
            may_have
        });
    }
    arguments
        .partition
        .retain(&mut cases, "cases", |case| case.name.clone())?;
    let said = PrintedVerdicts {
        speaks: !arguments.files.prints_json(),
        widest: cases.iter().map(|case| case.name.len()).max().unwrap_or(0),
        folds_missing: !arguments.verbose && matches!(source, Source::Finished(..)),
        waits: arguments.decide,
    };
    let judge = Judge {
        suite: &suite,
        store: &store,
        source: &source,
        arguments: &arguments,
        profile: profile.as_ref(),
        conventions: ConventionSearch::default(),
    };
    let mut judged = judge.all(&cases, &said);
    if let Source::Renderer(renderer) = &source
        && arguments.decide
    {
        let were_open = judged.iter().map(decide::is_open);
        let were_open: Vec<bool> = were_open.collect();
        let judge = &judge;
        let again = Again { judge, renderer };
        interrupt::can_be_cut_short(|| {
            decide::decide(&again, &cases, &mut judged, arguments.budget);
        });
        for (judged, _) in judged
            .iter()
            .zip(were_open)
            .filter(|(_, was_open)| *was_open)
        {
            said.verdict(&judged.result);
        }
    }
    if let Some((folder, run)) = &to_keep {
        let part = cases.iter().map(|case| case.name.clone());
        let part: Vec<String> = part.chain(passed_over).collect();
        keep(folder, run, &part, &judged)?;
    }
    if judged.is_empty() {
        let message = "no image of these cases was found: nothing was compared";
        let help = format!(
            "images are named family/name.exr or name.exr; `volref list` shows the cases{}",
            source.unknown_files().trim_end()
        );
        return Err(Failure::new(Exit::Undecided, message, Some(&help)));
    }
    let results: Vec<CaseResult> = judged.iter().map(|judged| judged.result.clone()).collect();
    said.print(&(said.without_image(&results) + &report::summary_text(&results)));
    said.print(&source.unknown_files());

    let explain = arguments.explain;
    let (found, text) = named(explain, &suite, &cases, profile.as_ref(), &mut judged);
    if let Some(folder) = &arguments.ctest {
        let measurements = ctest::measurements(&judged, folder)?;
        if said.speaks {
            output::print_measurements(&measurements);
        }
    }
    if !arguments.files.wants_evidence() {
        for judged in &mut judged {
            judged.evidence = Evidence::default();
        }
    }
    let findings = Findings {
        command: "validate",
        judged,
        found,
        units: None,
    };
    Ok(Outcome {
        text: arguments.files.write(&findings, text)?,
        exit: exit(&findings.results()),
    })
}

/// `case` with the biases that an image must be able to show by these arguments.
fn with_promise(mut case: Case, arguments: &Arguments) -> Case {
    if arguments.decide {
        case.promise = case.promise.decisive();
    }
    if let (Some(percent), true) = (arguments.resolution, case.sampling.is_some()) {
        let promise = Promise::of_mean(percent / 100.0);
        case.promise = if arguments.decide {
            promise.with_blocks()
        } else {
            promise
        };
    }
    case
}

/// Source of the images.
enum Source<'a> {
    /// A folder of finished images.
    Finished(&'a Path, Outputs),
    /// A renderer to run.
    Renderer(RendererRun<'a>),
}

struct RendererRun<'a> {
    arguments: &'a Arguments,
    template: CommandTemplate,
    /// Images are written here.
    folder: PathBuf,
    /// Holds exports, and the images unless they are to be kept; removed at the end.
    temporary: TempDir,
}

impl<'a> Source<'a> {
    /// `names` are the names of all cases of the suite.
    fn of(arguments: &'a Arguments, names: &[&str]) -> Result<Source<'a>, Failure> {
        if let Some(folder) = &arguments.outputs {
            if !folder.is_dir() {
                let message = format!("there is no folder {}", folder.display());
                let help = "--outputs takes the folder of the images";
                return Err(Failure::new(Exit::BadInput, message, Some(help)));
            }
            let outputs = Outputs::list(folder, names).map_err(bad_input)?;
            outputs.files().for_each(note_input);
            return Ok(Source::Finished(folder, outputs));
        }
        let command = arguments.run.as_deref().unwrap_or_default();
        let template = CommandTemplate::parse(command).map_err(|error| {
            let help = "for example: --run 'my-renderer {scene} --out {output} --spp {spp}'";
            Failure::new(Exit::BadInput, error.to_string(), Some(help))
        })?;
        let temporary = tempfile::Builder::new()
            .prefix("volref-")
            .tempdir()
            .map_err(|error| bad_input(format!("cannot create a temporary folder: {error}")))?;
        let images = temporary.path().join("images");
        let folder = arguments.keep.as_ref().unwrap_or(&images);
        let folder = std::fs::create_dir_all(folder)
            .and_then(|()| absolute(folder))
            .map_err(|error| bad_input(format!("cannot create the folder for images: {error}")))?;
        Ok(Source::Renderer(RendererRun {
            arguments,
            template,
            folder,
            temporary,
        }))
    }

    /// Whether there may be an image of `case`: a renderer has to be run to know.
    fn may_have(&self, case: &Case) -> bool {
        match self {
            Source::Finished(_, outputs) => !matches!(outputs.find(&case.name), Ok(None)),
            Source::Renderer(_) => true,
        }
    }

    /// The output for `case`, and its origin.
    fn output(&self, case: &Case) -> Made {
        match self {
            Source::Finished(folder, outputs) => Made::of(read(outputs, folder, case)),
            Source::Renderer(renderer) => renderer.output(case, renderer.first()),
        }
    }

    /// Settings that verdicts depend on beside the suite, by name.
    fn settings(
        &self,
        arguments: &Arguments,
        profile: Option<&Profile>,
    ) -> BTreeMap<String, String> {
        let mut settings = match self {
            Source::Finished(..) => [("images", "finished".to_owned())].into(),
            Source::Renderer(renderer) => renderer.settings(),
        };
        settings.extend(profile.map(|profile| ("profile", profile.text.clone())));
        settings.extend(
            arguments
                .resolution
                .map(|percent| ("resolution", percent.to_string())),
        );
        settings.insert(
            "accept conventions",
            arguments.accept_conventions.to_string(),
        );
        let named = settings.into_iter();
        named
            .map(|(name, value)| (name.to_owned(), value))
            .collect()
    }

    /// The arguments for the source of the images.
    fn arguments(&self) -> Vec<String> {
        match self {
            Source::Finished(folder, _) => {
                vec!["--outputs".to_owned(), folder.display().to_string()]
            }
            Source::Renderer(renderer) => renderer.arguments(),
        }
    }

    /// Ends renderers and removes temporary files when this process is ended, for example by
    /// Ctrl-C. Renderers have their own process groups, so the signal does not reach them; without
    /// such a handler they end by their time limit.
    fn end_with_us(&self) {
        let temporary = match self {
            Source::Finished(..) => None,
            Source::Renderer(renderer) => Some(renderer.temporary.path().to_owned()),
        };
        interrupt::before_the_end(move || {
            stop_all();
            if let Some(temporary) = &temporary {
                let _ = std::fs::remove_dir_all(temporary);
            }
        });
    }

    /// A warning about images that belong to no case.
    fn unknown_files(&self) -> String {
        let Source::Finished(_, outputs) = self else {
            return String::new();
        };
        let mut text = String::new();
        for unknown in outputs.unknown_files() {
            text.push_str(&format!("\n{} {}", unknown.file.display(), unknown.reason));
        }
        if !text.is_empty() {
            text.push('\n');
        }
        text
    }
}

/// Path at which a renderer is to write the image of `case`.
fn image_of(folder: &Path, case: &Case, extension: &str) -> PathBuf {
    folder.join(format!("{}.{extension}", case.name))
}

/// The image of `case` among `outputs`.
fn read(outputs: &Outputs, folder: &Path, case: &Case) -> Output {
    match outputs.find(&case.name) {
        Ok(None) => Output::Missing(format!(
            "no image of this case in {}: name it {}.exr (or .pfm, .npy, .png)",
            folder.display(),
            case.name
        )),
        Ok(Some(found)) => {
            let output = if found.is_refined {
                found.read_refined().map(Output::Refined)
            } else {
                found
                    .read()
                    .map(|picture| Output::Picture(Box::new(picture)))
            };
            output.unwrap_or_else(|error| Output::Unusable(error.to_string()))
        }
        Err(error) => Output::Unusable(error.to_string()),
    }
}

/// The last lines of a renderer's output, with its errors, as the end of a message.
fn last_words(printed: &str) -> String {
    const LINES: usize = 3;
    const LETTERS: usize = 400;
    let lines: Vec<&str> = printed
        .lines()
        .filter(|line| !line.trim().is_empty())
        .collect();
    let last = &lines[lines.len().saturating_sub(LINES)..];
    if last.is_empty() {
        return String::new();
    }
    let mut text = String::from("; its last output:");
    for line in last {
        // It may hold anything, escape sequences too.
        let plain = line.chars().filter(|letter| !letter.is_control());
        text.push('\n');
        text.extend(plain.take(LETTERS));
    }
    text
}

/// Longest file of a renderer that is hashed: 1 GiB.
const MOST_HASHED_BYTES: u64 = 1 << 30;

/// Hash of a file, if there is one.
fn file_hash(path: &Path) -> Option<String> {
    let bytes = regular_file::read(path, MOST_HASHED_BYTES).ok()?;
    Some(blake3::hash(&bytes).to_hex().to_string())
}

/// A call of the renderer for a case.
struct Call {
    /// Placeholders with what stands for them.
    values: BTreeMap<&'static str, String>,
    /// Distance between samples, and the length of a voxel, world units; if the command takes a step.
    step: Option<[f64; 2]>,
}

fn shown(path: &Path) -> String {
    path.display().to_string()
}

fn not_run(error: std::io::Error) -> Output {
    Output::Unusable(format!("the renderer could not be run: {error}"))
}

impl RendererRun<'_> {
    /// Request of the command line.
    fn first(&self) -> Ask {
        Ask {
            spp: self.arguments.spp,
            seed: self.arguments.seed,
        }
    }

    /// Replaces the image of the last call by these, if images are kept: one image, or several renderings.
    fn keep(&self, case: &Case, films: &[Film]) -> Result<(), Box<dyn Error>> {
        if self.arguments.keep.is_none() {
            return Ok(());
        }
        let last = image_of(&self.folder, case, &self.arguments.format);
        let mut is_replaced = false;
        for (number, film) in films.iter().enumerate() {
            let extension = match films.len() {
                1 => "exr".to_owned(),
                _ => format!("{number}.exr"),
            };
            let path = image_of(&self.folder, case, &extension);
            own_file::write(&path, &film.to_exr()?)?;
            is_replaced |= path == last;
        }
        if !is_replaced {
            std::fs::remove_file(&last)?;
        }
        Ok(())
    }

    /// The output for `case`: of a case without a step, images with three steps, if the command takes
    /// its step from here.
    fn output(&self, case: &Case, ask: Ask) -> Made {
        let mut call = match self.call(case, ask) {
            Ok(call) => call,
            Err(output) => return Made::of(output),
        };
        let has_steps = case.is_limit() && self.takes_step();
        let halvings = if has_steps { 0..=2 } else { 0..=0 };
        let (mut printed, mut notes, mut calls) = (String::new(), Vec::new(), Vec::new());
        let mut failure = None;
        for halvings in halvings {
            let words = match self.words(case, &mut call, halvings) {
                Ok(words) => words,
                Err(output) => return Made::of(output),
            };
            let timeout = Duration::from_secs_f64(self.arguments.timeout);
            let ran = run_process(&words, timeout, keeper().as_ref());
            printed.push_str(&ran.printed);
            notes.extend(ran.notes);
            calls.push(shell_words::join(&words));
            if let Some(reason) = ran.failure {
                failure = Some(reason + &last_words(&ran.printed));
                break;
            }
        }
        let output = match failure {
            Some(failure) => Output::Unusable(failure),
            None => self.written(case, has_steps, ask),
        };
        notes.extend(self.fewer_samples(&output, ask));
        Made {
            output,
            printed: Some(printed),
            notes,
            call: Some(calls.join("\n")),
        }
    }

    /// A note on an image that states half the samples it was asked for or fewer: the gate takes them
    /// as they are, and allows for the more noise. More are no surprise: renderings add up.
    fn fewer_samples(&self, output: &Output, ask: Ask) -> Option<String> {
        let Output::Picture(picture) = output else {
            return None;
        };
        let film = picture.radiance().filter(|_| self.asks_for_samples())?;
        let (stated, asked) = (film.samples()?, u64::from(ask.spp));
        (2 * stated <= asked).then(|| {
            format!("the image states {stated} samples per pixel, where {{spp}} asked for {asked}")
        })
    }

    /// The image that the renderer wrote, or those with several steps.
    fn written(&self, case: &Case, has_steps: bool, ask: Ask) -> Output {
        let outputs = match Outputs::list(&self.folder, &[&case.name]) {
            Ok(outputs) => outputs,
            Err(error) => return Output::Unusable(error.to_string()),
        };
        if self.arguments.keep.is_some() {
            self.keep_files(case, &outputs);
        }
        match read(&outputs, &self.folder, case) {
            Output::Missing(_) => Output::Missing(format!(
                "the renderer succeeded, but did not write {}.{}, the file that {{output}} stood for \
                 (for another format: --format {})",
                case.name,
                self.arguments.format,
                FORMATS
                    .into_iter()
                    .filter(|format| *format != self.arguments.format)
                    .collect::<Vec<_>>()
                    .join(", ")
            )),
            Output::Picture(picture) if has_steps && picture.radiance().is_some() => {
                Output::Missing(format!(
                    "the renderer succeeded, but did not write {}.{}, the file that {{output}} stood for \
                     with a smaller step",
                    step_name(&case.name, 1),
                    self.arguments.format
                ))
            }
            // As far as is known, it did what it was asked for.
            Output::Picture(picture) if self.asks_for_samples() => {
                Output::Picture(Box::new(picture.with_samples(ask.spp)))
            }
            output => output,
        }
    }

    /// Puts files in the place of links that the renderer left in the folder of the case: what they lead to need
    /// not stay. Of one that leads nowhere the verdict says so.
    fn keep_files(&self, case: &Case, outputs: &Outputs) {
        let folder = image_of(&self.folder, case, &self.arguments.format);
        let is_in_it = |file: &&Path| file.parent() == folder.parent() && file.is_symlink();
        for file in outputs.files().filter(is_in_it) {
            if let Ok(bytes) = regular_file::read(file, Picture::MOST_BYTES) {
                let _ = write_in_place_of(file, &bytes);
            }
        }
    }

    /// Settings that its images depend on, by name: the files that the command names are hashed, so that another
    /// build of the renderer makes another run.
    fn settings(&self) -> BTreeMap<&'static str, String> {
        let given = self.arguments;
        let command = given.run.clone().unwrap_or_default();
        let words = shell_words::split(&command).unwrap_or_default();
        let hashes = words.iter().filter_map(|word| file_hash(Path::new(word)));
        let hashes: Vec<String> = hashes.collect();
        [
            ("command of the renderer", command),
            ("files of the renderer", hashes.join(" ")),
            ("samples", given.spp.to_string()),
            ("seed", given.seed.to_string()),
            ("format", given.format.clone()),
            ("decide", given.decide.to_string()),
        ]
        .into()
    }

    /// The arguments that repeat the run, without those that equal their defaults.
    fn arguments(&self) -> Vec<String> {
        let given = self.arguments;
        let mut arguments = vec!["--run".to_owned(), given.run.clone().unwrap_or_default()];
        let mut say = |name: &str, value: String, default: &str| {
            if value != default {
                arguments.extend([name.to_owned(), value]);
            }
        };
        say("--spp", given.spp.to_string(), SPP);
        say("--seed", given.seed.to_string(), SEED);
        say("--format", given.format.clone(), FORMAT);
        say("--timeout", given.timeout.to_string(), TIMEOUT);
        if given.decide {
            arguments.push("--decide".to_owned());
            if given.budget != decide::budget(BUDGET).unwrap_or_default() {
                arguments.extend([
                    "--budget".to_owned(),
                    format!("{}s", given.budget.as_secs()),
                ]);
            }
        }
        arguments
    }

    /// The command passes the number of samples.
    fn asks_for_samples(&self) -> bool {
        self.template.uses("spp")
    }

    /// The command passes the step.
    fn takes_step(&self) -> bool {
        self.template.uses("step") || self.template.uses("rate")
    }

    /// The call for `case`, but for its output and step, after creating the exports.
    fn call(&self, case: &Case, ask: Ask) -> Result<Call, Output> {
        // Read again: a scene that cannot be read is said by whoever judges.
        let scene = case
            .load_scene()
            .map_err(|error| Output::Unusable(error.to_string()))?;
        let mut values = BTreeMap::from([
            ("scene", shown(&absolute(&case.scene).map_err(not_run)?)),
            ("width", scene.width().to_string()),
            ("height", scene.height().to_string()),
            ("spp", ask.spp.to_string()),
            ("seed", ask.seed.to_string()),
            ("case", case.name.clone()),
        ]);
        let mut step = None;
        if self.takes_step() {
            let volume = scene.panels.iter().find_map(Panel::classified);
            let of = |volume: &Classified| [volume.step, volume.grid.lattice().voxel()];
            step = Some(volume.map(of).ok_or_else(|| {
                Output::Missing(
                    "not rendered: the command takes a step, and the scene has no classified volume"
                        .to_owned(),
                )
            })?);
        }
        for name in CommandTemplate::PLACEHOLDERS {
            let format = name.strip_prefix("export:");
            if let Some(format) = format.filter(|_| self.template.uses(name)) {
                let path = self.export(&scene, case, format)?;
                values.insert(name, shown(&path));
            }
        }
        Ok(Call { values, step })
    }

    /// The command for `case` with the step of its scene halved `halvings` times, after creating its
    /// folder.
    fn words(&self, case: &Case, call: &mut Call, halvings: u32) -> Result<Vec<String>, Output> {
        let name = step_name(&case.name, halvings);
        let output = self
            .folder
            .join(format!("{name}.{}", self.arguments.format));
        // In a folder that a link leads to, an image of an earlier run might be a file of the user's.
        own_file::make_folder(&self.folder, directory_of(Path::new(&name)))
            .map_err(|error| Output::Unusable(format!("the renderer could not be run: {error}")))?;
        // An image of an earlier run would be taken for one of this.
        match std::fs::remove_file(&output) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(not_run(error));
            }
            _ => {}
        }
        call.values.insert("output", shown(&output));
        if let Some([step, voxel]) = call.step {
            let step = step * exp2(-f64::from(halvings));
            call.values.insert("step", step.to_string());
            call.values.insert("rate", (voxel / step).to_string());
        }
        Ok(self.template.fill(&call.values))
    }

    /// A copy of the scene in another format; a scene that cannot be exported counts as a missing
    /// image.
    fn export(&self, scene: &Scene, case: &Case, format: &str) -> Result<PathBuf, Output> {
        let format: Format = format.parse().expect("placeholders name formats");
        let exports = self.temporary.path().join("exports");
        let folder = exports.join(format.to_string()).join(&case.name);
        let name = case.name.rsplit('/').next().unwrap_or(&case.name);
        let export = exchange::export(scene, format, name)
            .map_err(|refusal| Output::Missing(format!("not rendered: {refusal}")))?;
        write_all(&folder, &export)
            .map_err(|error| Output::Unusable(format!("the export failed: {error}")))?;
        Ok(folder.join(&export.main))
    }
}

/// Everything that images are judged by.
struct Judge<'a> {
    suite: &'a Suite,
    store: &'a Store,
    source: &'a Source<'a>,
    arguments: &'a Arguments,
    profile: Option<&'a Profile>,
    conventions: ConventionSearch,
}

/// A renderer that is called again, and what judges its images.
struct Again<'a> {
    judge: &'a Judge<'a>,
    renderer: &'a RendererRun<'a>,
}

impl LookAgain for Again<'_> {
    fn first(&self) -> Ask {
        self.renderer.first()
    }

    fn time_limit(&self) -> f64 {
        self.renderer.arguments.timeout
    }

    fn rendered(&self, case: &Case, ask: Ask) -> Made {
        self.renderer.output(case, ask)
    }

    fn judged(&self, case: &Case, made: Made, look: u32) -> Judged {
        self.judge.judged(case, made, Some(look))
    }

    fn keep(&self, case: &Case, films: &[Film]) -> Result<(), String> {
        let kept = self.renderer.keep(case, films);
        kept.map_err(|error| error.to_string())
    }
}

impl Judge<'_> {
    /// Judges all cases, several at a time if a renderer is run. Results are in the order of the cases,
    /// and printed as soon as those before them are. With `--only-present`, cases without an image are
    /// skipped.
    fn all(&self, cases: &[&Case], said: &PrintedVerdicts) -> Vec<Judged> {
        let bar = progress::cases(cases.len());
        let next = AtomicUsize::new(0);
        let (sender, judgements) = mpsc::channel();
        let work = |sender: mpsc::Sender<(usize, Option<Judged>)>| {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(case) = cases.get(index) else {
                    return;
                };
                bar.set_message(case.name.clone());
                let judged = self.case(case);
                bar.inc(1);
                sender.send((index, judged)).expect("all are received");
            }
        };
        let mut in_order = Vec::new();
        std::thread::scope(|scope| {
            for _ in 0..usize::from(self.arguments.jobs).min(cases.len()) {
                let sender = sender.clone();
                scope.spawn(|| work(sender));
            }
            drop(sender);
            let mut waiting = BTreeMap::new();
            let mut first_open = 0;
            for (index, judged) in judgements {
                waiting.insert(index, judged);
                while let Some(judged) = waiting.remove(&first_open) {
                    first_open += 1;
                    if let Some(judged) = judged {
                        if !(said.waits && decide::is_open(&judged)) {
                            bar.suspend(|| said.verdict(&judged.result));
                        }
                        in_order.push(judged);
                    }
                }
            }
        });
        bar.finish_and_clear();
        in_order
    }

    /// Note on the case that would tell two numbers apart, where the image of this one cannot.
    fn telling_case(&self, result: &CaseResult) -> Option<String> {
        let best = result.changes.iter().find(|change| change.fits_best)?;
        let other = result.changes.iter().find(|change| change.alike)?;
        let names = [best.name.as_str(), other.name.as_str()];
        let case = telling_case(self.suite.cases(), self.store, names)?;
        let [best, other] = names;
        Some(format!(
            "the image of {} tells {best} and {other} apart",
            case.name
        ))
    }

    /// Judges the image of one case; `None` if it has none and is to be skipped.
    fn case(&self, case: &Case) -> Option<Judged> {
        let start = Instant::now();
        let made = self.source.output(case);
        if self.arguments.only_present && matches!(made.output, Output::Missing(_)) {
            return None;
        }
        let look = self.arguments.decide.then_some(1);
        let mut judged = self.judged(case, made, look);
        judged.result.seconds = start.elapsed().as_secs_f64();
        Some(judged)
    }

    /// Judges an image of one case: at the look of this number, from 1, where there may be several.
    fn judged(&self, case: &Case, made: Made, look: Option<u32>) -> Judged {
        let mut judged = match look {
            Some(look) => validate_at(look, case, self.store, made.output, self.profile),
            None => validate(case, self.store, made.output, self.profile),
        };
        if self.profile.is_none() {
            let (seconds, accepted) = (self.arguments.explain, self.arguments.accept_conventions);
            self.conventions
                .explain_mismatch(case, &mut judged, seconds, accepted);
        }
        judged.result.notes = made.notes;
        judged
            .result
            .notes
            .extend(self.telling_case(&judged.result));
        judged.evidence.output = made.printed;
        judged.evidence.call = made.call;
        let mut words = self.source.arguments();
        if let Some(percent) = self.arguments.resolution {
            words.extend(["--resolution".to_owned(), percent.to_string()]);
        }
        judged.evidence.reproduce = vec![
            self.arguments
                .selection
                .again("validate", &case.name, &words),
        ];
        judged
    }
}
