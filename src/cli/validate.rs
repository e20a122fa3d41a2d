//! `volref validate (--outputs DIR | --run CMD | --serve CMD) [FILTER…]`

use super::command_line::command_line;
use super::failure::{EXIT_CODES, Exit, Failure, bad_input, exit};
use super::help::EXAMPLE_FIRST;
use super::kept::{KeptResults, NAME, PartArguments};
use super::known::{KnownArgument, KnownFile};
use super::renderer::{Command, RendererArguments};
use super::results::{Findings, ResultFiles};
use super::verdicts::{CauseSearch, ExplainArgument, PrintedVerdicts};
use super::{Outcome, compare, ctest, interrupt, output, progress};
use crate::compare::Promise;
use crate::conventions::Profile;
use crate::cost::timing::Machine;
use crate::files::regular_file::note_input;
use crate::film::{Alpha, Bits, FilmFormat};
use crate::judging::{
    CaseResult, Judged, JudgedWith, MoreSamples, before_background, declared, is_open, validate_at,
};
use crate::renderers::{ImageSource, Rendered, in_order, stop_all};
use crate::report;
use crate::suite::{Case, Output, Outputs, Store, Suite};
use clap::ArgAction;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

/// Images and placeholders, for `--help`.
const IMAGES: &str = "Images are named after the cases, family/name or just name, and end in .exr, \
    .pfm, .npy (linear radiance) or .png (8-bit sRGB). The noise of a Monte Carlo image is taken from \
    several independent renderings, name.0.exr, name.1.exr, ..., or from a file name.variance.exr \
    with the variances of the means; otherwise it is estimated.\n\n\
    The images of a case of the family limit are name.exr, with the step of its scene, \
    name@0.5.exr, with half of it, and name@0.25.exr; a single image is judged less strictly.\n\n\
    In CMD, {scene} stands for the scene file, {output} for the image to write, {width}, {height}, \
    {spp}, {seed} for the image size, samples per pixel and seed, {case} for the name of the case, {step} for the distance between samples in world units, {rate} \
    for samples per voxel, {exposure} for the exposure of 8-bit images in stops (radiance times 2^exposure), and {export:mitsuba}, \
    {export:pbrt}, {export:bundle} for a copy of the scene in that format (see volref export). With {step} or {rate}, CMD is run three times for a case of the family limit.\n\n\
    With --serve, placeholders are words of their own, and no part of the command line: they name what requests hold. A \
    request is a line of JSON on standard input, with \"case\", \"output\" and these. The answer is a line on standard output: \
    {\"image\": output}, {\"error\": \"reason\"}, or {\"cannot\": \"reason\"} if the renderer does not \
    support the scene.\n\n\
    Each verdict is printed as soon as it is known. Then volref searches the conventions or the known mistakes \
    that explain the failing images. An image that conventions explain gets a second verdict, which counts. Ctrl-C ends \
    the search and keeps the verdicts.";

/// Headings of options.
const WHERE: &str = "Where the images are";
const RIGHT: &str = "What counts as right";
const REPORTED: &str = "Reports";
const WHICH: &str = "Which cases, and on which machine";

/// An example, for `--help`.
const EXAMPLE: &str = "\
For example:
  volref validate core --run 'my-renderer {scene} {output}' --report report
  volref validate sampled --outputs my-images --only-present";

/// Judge the images of another renderer, and name its mistakes
#[derive(Debug, clap::Args)]
#[command(group = clap::ArgGroup::new("images").required(true))]
#[command(
    help_template = EXAMPLE_FIRST,
    before_help = EXAMPLE,
    disable_help_flag = true,
    after_help = format!("{IMAGES}\n\n{EXIT_CODES}"),
)]
pub struct Arguments {
    /// Families, cases, patterns over them such as 'figures/*', or core; those with ! before them are left out
    /// [default: all cases]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    /// Folder with finished images
    #[arg(long, value_name = "DIR", group = "images", help_heading = WHERE)]
    outputs: Option<PathBuf>,
    /// Command that renders a case; run once for each, without a shell
    #[arg(long, value_name = "CMD", groups = ["images", "renderer"], help_heading = WHERE)]
    run: Option<String>,
    /// Command of a renderer that stays: started once (or once for each of --jobs), and asked for one image after
    /// the other, by lines of JSON
    #[arg(long, value_name = "CMD", groups = ["images", "renderer"], help_heading = WHERE)]
    serve: Option<String>,
    /// Skip cases that have no image or cannot be exported to the renderer's format
    #[arg(long, help_heading = WHERE)]
    only_present: bool,
    /// Conventions of the renderer: classified volumes are judged by the right image under them. One
    /// of the profiles that volref brings, or a file (volref schema profile)
    #[arg(long = "as", value_name = "PROFILE", help_heading = RIGHT)]
    profile: Option<String>,
    /// Bits of a channel in the images: 8, 8-linear or 8-srgb. Differences up to half a code agree then, in
    /// every case, and values are cut off at the largest code. A PNG holds codes of radiance at the exposure of its
    /// case, sRGB unless it is 8-linear; for other formats the encoding is detected [default: as
    /// in the profile]
    #[arg(long, value_name = "BITS", help_heading = RIGHT)]
    bits: Option<Bits>,
    /// Colours of .exr and .npy images with opacity leave out the background of the scene: premultiplied by opacity, or
    /// straight [default: as in the profile, else they contain it]
    #[arg(long, value_name = "ALPHA", help_heading = RIGHT)]
    alpha: Option<Alpha>,
    /// Accept images that are right under other conventions than the golden's, and say which
    #[arg(long, help_heading = RIGHT)]
    accept_conventions: bool,
    /// List every case without an image
    #[arg(long, help_heading = REPORTED)]
    verbose: bool,
    #[command(flatten, next_help_heading = RIGHT)]
    known: KnownArgument,
    #[command(flatten, next_help_heading = REPORTED)]
    explain: ExplainArgument,
    #[command(
        flatten,
        next_help_heading = "How the renderer is run, with --run or --serve"
    )]
    renderer: RendererArguments,
    /// A stochastic image passes only if a bias this large would have been detected, in percent of (image
    /// mean + 0.001); noisier images are inconclusive [default: from the case, else 2]
    #[arg(long, value_name = "PERCENT", help_heading = RIGHT, allow_negative_numbers = true, value_parser = compare::percent)]
    resolution: Option<f64>,
    /// With --run or --serve: keep the images in DIR; with --decide those of the last look: put
    /// together as .exr, or numbered
    #[arg(
        long,
        value_name = "DIR",
        help_heading = WHERE,
        requires = "renderer",
        conflicts_with = "outputs"
    )]
    keep: Option<PathBuf>,
    /// Print metrics and pictures as lines that CTest collects, with the pictures in DIR
    #[arg(long, value_name = "DIR", help_heading = REPORTED)]
    ctest: Option<PathBuf>,
    #[command(flatten, next_help_heading = REPORTED)]
    files: ResultFiles,
    #[command(flatten, next_help_heading = WHICH)]
    part: PartArguments,
    /// Name of the run whose results are kept: volref merge puts runs that have one beside each other
    #[arg(long, value_name = "TEXT", requires = "results", help_heading = WHICH)]
    named: Option<String>,
    /// Print help
    // Not by clap itself, which would show it before all else.
    #[arg(id = "help", short = 'h', long = "help", action = ArgAction::Help, help_heading = WHICH)]
    _help: Option<bool>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.part.selection.open()?;
    let selected = suite.select(&arguments.filters)?.into_iter().cloned();
    let with_promise = |case| with_promise(case, &arguments);
    let selected: Vec<Case> = selected.map(with_promise).collect();
    let mut cases: Vec<&Case> = selected.iter().collect();
    let keep = arguments.keep.as_deref();
    keep.map_or(Ok(()), output::check_no_goldens_in)?;
    let profile = arguments.profile.as_deref().map(Profile::named);
    let judge = Judge {
        profile: profile.transpose()?,
        known: arguments.known.read(&suite)?,
        source: arguments.source(&suite)?,
        suite: &suite,
        store: suite.store(),
        arguments: &arguments,
    };
    // Now that the images to be judged are known as inputs.
    arguments.files.check()?;
    let folder = arguments.ctest.as_deref();
    folder.map_or(Ok(()), output::make_folder)?;
    judge.ends_with_us();

    let to_keep = judge.results_to_keep(&cases)?;
    let passed_over = judge.pass_over(&mut cases);
    let name = |case: &&Case| case.name.clone();
    arguments.part.partition.retain(&mut cases, name)?;
    let said = judge.printed(&cases);
    let mut skipped = passed_over.clone();
    let mut judged = judge.all(&cases, &said, &mut skipped);
    judge.decide(&cases, &mut judged, &said);
    // The search for mistakes needs no renderer.
    if let Some(staying) = judge.source.renderer().and_then(|it| it.staying.as_ref()) {
        staying.end();
    }
    let (judged_with, (found, text)) =
        CauseSearch::run(&arguments.explain, arguments.accept_conventions, |search| {
            search.announce(&judged);
            let profile = judge.profile.as_ref();
            if profile.is_none() {
                let accepted = arguments.accept_conventions;
                search.conventions(&suite, &cases, &mut judged, accepted, &said);
            }
            let passed_over = passed_over.into_iter().map(|(name, _)| name);
            let part: Vec<String> = cases.iter().map(name).chain(passed_over).collect();
            let keep = |judged: &[Judged]| {
                let kept = to_keep.as_ref();
                kept.map_or(Ok(()), |kept| kept.keep(&part, judged, &[]))
            };
            if judged.is_empty() {
                keep(&judged)?;
                return Err(judge.nothing_compared());
            }
            let results: Vec<CaseResult> = judged.iter().map(|it| it.result.clone()).collect();
            let settings = arguments.settings(profile);
            let judged_with = JudgedWith::of(&settings, profile, skipped, &results);
            said.summary(&results, &judged_with);
            said.print(&judge.unknown_files());
            let (found, mut text) = search.mistakes(&cases, profile, &mut judged);
            if let Some(known) = &judge.known {
                text.push_str(&known.finish(&mut judged)?);
            }
            keep(&judged)?;
            Ok((judged_with, (found, text)))
        })?;
    arguments.measure(&judged, &said)?;
    let origin = judge.origin(&judged);
    let findings = Findings {
        command: "validate",
        judged,
        found,
        judged_with,
        has_known: judge.known.is_some(),
        origin: Some(origin),
    };
    let results = findings.results();
    let exit = match &judge.known {
        Some(known) => known.exit(&results),
        None => exit(&results),
    };
    let text = arguments.files.write(findings, text)?;
    Ok(Outcome { text, exit })
}

/// `case` with the biases that an image must be able to show by these arguments.
fn with_promise(mut case: Case, arguments: &Arguments) -> Case {
    let decides = arguments.renderer.decide;
    let resolution = arguments.resolution;
    case.promise = match resolution.map(|percent| Promise::of_mean(percent / 100.0)) {
        Some(promise) if decides => promise.with_blocks(),
        Some(promise) => promise,
        None if decides => case.promise.decisive(),
        None => case.promise,
    };
    case
}

impl Arguments {
    /// The source of the images.
    fn source(&self, suite: &Suite) -> Result<ImageSource, Failure> {
        let format = FilmFormat::with_extension(self.renderer.format.as_ref());
        if self.renderer.decide && format.is_some_and(FilmFormat::is_of_codes) {
            let message = "--decide needs linear radiance, and an 8-bit image has none: its noise counts as a difference";
            let help = "ask for --format exr, pfm or npy";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let Some(folder) = &self.outputs else {
            let names = || suite.cases().iter().map(|case| case.name.clone()).collect();
            let keep = self.keep.clone().map(|folder| (folder, names()));
            let renderer = self.renderer.renderer(self.command(), keep)?;
            return Ok(ImageSource::Renderer(Box::new(renderer)));
        };
        if !folder.is_dir() {
            let message = format!("there is no folder {}", folder.display());
            let help = "--outputs takes the folder of the images";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let names: Vec<&str> = suite.cases().iter().map(|case| &*case.name).collect();
        let outputs = Outputs::list(folder, &names).map_err(bad_input)?;
        outputs.files().for_each(note_input);
        Ok(ImageSource::Finished(outputs))
    }

    /// The command of the renderer.
    fn command(&self) -> Command<'_> {
        let text = self.run.as_deref().or(self.serve.as_deref());
        Command {
            text: text.unwrap_or_default(),
            stays: self.serve.is_some(),
        }
    }

    /// Settings that verdicts depend on beside the suite, by name.
    fn settings(&self, profile: Option<&Profile>) -> BTreeMap<String, String> {
        let mut settings = match &self.outputs {
            Some(_) => vec![("images", "finished".to_owned())],
            None => self.renderer.settings(self.command()),
        };
        settings.push(("accept conventions", self.accept_conventions.to_string()));
        settings.extend(profile.map(|profile| ("profile", profile.text.clone())));
        settings.extend(self.declared());
        let named = |(name, value): (&str, String)| (name.to_owned(), value);
        settings.into_iter().map(named).collect()
    }

    /// Options that say how the images are meant, with their values where they are given.
    fn declared(&self) -> impl Iterator<Item = (&'static str, String)> {
        let options = [
            ("bits", self.bits.map(|bits| bits.to_string())),
            ("alpha", self.alpha.map(|alpha| alpha.to_string())),
            (
                "resolution",
                self.resolution.map(|percent| percent.to_string()),
            ),
        ];
        options
            .into_iter()
            .filter_map(|(name, value)| Some((name, value?)))
    }

    /// The command that repeats the judgement of a case.
    fn again(&self, case: &Case) -> String {
        let mut words = match &self.outputs {
            Some(folder) => vec!["--outputs".to_owned(), folder.display().to_string()],
            None => self.renderer.words(self.command()),
        };
        if let Some(profile) = &self.profile {
            words.extend(["--as".to_owned(), profile.clone()]);
        }
        if self.accept_conventions {
            words.push("--accept-conventions".to_owned());
        }
        for (name, value) in self.declared() {
            words.extend([format!("--{name}"), value]);
        }
        self.part.selection.again("validate", &case.name, &words)
    }

    /// Writes the pictures for CTest and prints its lines, if that was asked for.
    fn measure(&self, judged: &[Judged], said: &PrintedVerdicts) -> Result<(), Failure> {
        if let Some(folder) = &self.ctest {
            let measurements = ctest::measurements(judged, folder)?;
            if said.speaks {
                output::write_out(&measurements);
            }
        }
        Ok(())
    }
}

/// The name of a case without an image that is skipped, and the reason.
type SkippedCase = (String, String);

/// Everything that images are judged by.
struct Judge<'a> {
    suite: &'a Suite,
    store: Store,
    source: ImageSource,
    arguments: &'a Arguments,
    profile: Option<Profile>,
    known: Option<KnownFile<'a>>,
}

impl Judge<'_> {
    /// Ends renderers and removes temporary files when this process is ended, for example by
    /// Ctrl-C. Renderers have their own process groups, so the signal does not reach them; without
    /// such a handler they end by their time limit.
    fn ends_with_us(&self) {
        let renderer = self.source.renderer();
        let temporary = renderer.map(|renderer| renderer.temporary.path().to_owned());
        let staying = renderer.and_then(|renderer| renderer.staying.clone());
        interrupt::before_the_end(move || {
            stop_all();
            if let Some(staying) = &staying {
                staying.end();
            }
            if let Some(temporary) = &temporary {
                let _ = std::fs::remove_dir_all(temporary);
            }
        });
    }

    /// The results that are kept, if any are.
    fn results_to_keep(&self, cases: &[&Case]) -> Result<Option<KeptResults>, Failure> {
        let given = self.arguments;
        let mut settings = given.settings(self.profile.as_ref());
        let name = given.named.iter().cloned();
        settings.extend(name.map(|name| (NAME.to_owned(), name)));
        given
            .part
            .kept(self.suite, "validate", &given.filters, cases, settings)
    }

    /// Takes the cases without an image out of `cases`, if they are to be skipped; returns them.
    fn pass_over(&self, cases: &mut Vec<&Case>) -> Vec<SkippedCase> {
        let is_skipped =
            |case: &mut &Case| self.arguments.only_present && !self.source.may_have(case);
        let passed_over = cases.extract_if(.., is_skipped);
        passed_over
            .map(|case| (case.name.clone(), String::new()))
            .collect()
    }

    /// Output on `cases`.
    fn printed(&self, cases: &[&Case]) -> PrintedVerdicts {
        let is_finished = matches!(self.source, ImageSource::Finished(_));
        PrintedVerdicts {
            speaks: !self.arguments.files.json.is_printed(),
            widest: report::widest(cases.iter().map(|case| &case.name)),
            folds_missing: !self.arguments.verbose && is_finished,
            waits: self.arguments.renderer.decide,
        }
    }

    /// Judges all cases, several at a time if a renderer is run. Results are in the order of the cases,
    /// and printed as soon as those before them are. With `--only-present`, cases without an image are
    /// added to those that are `skipped`.
    fn all(
        &self,
        cases: &[&Case],
        said: &PrintedVerdicts,
        skipped: &mut Vec<SkippedCase>,
    ) -> Vec<Judged> {
        let bar = progress::counted(cases.len());
        let mut in_order_of_cases = Vec::new();
        let jobs = self.arguments.renderer.jobs.into();
        let judge = |index: usize| {
            let case = cases[index];
            bar.set_message(case.name.clone());
            let judged = self.case(case);
            bar.end_part();
            judged
        };
        in_order(cases.len(), jobs, judge, |judged| match judged {
            Ok(judged) => {
                if !(said.waits && is_open(&judged)) {
                    bar.suspend(|| said.verdict(&judged.result));
                }
                in_order_of_cases.push(*judged);
            }
            Err(case) => skipped.push(case),
        });
        in_order_of_cases
    }

    /// Renders cases that noise leaves open with more samples, if that was asked for, and prints them.
    fn decide(&self, cases: &[&Case], judged: &mut [Judged], said: &PrintedVerdicts) {
        let Some(renderer) = self.source.renderer().filter(|_| said.waits) else {
            return;
        };
        let were_open: Vec<bool> = judged.iter().map(is_open).collect();
        let more = MoreSamples {
            renderer,
            judge: &|case, rendered, look| self.judged(case, rendered, Some(look)),
            budget: self.arguments.renderer.budget,
            interrupted: &interrupt::is_cut_short,
            note: &progress::note,
        };
        interrupt::can_be_cut_short(|| more.decide(cases, judged));
        for (judged, _) in judged
            .iter()
            .zip(were_open)
            .filter(|(_, was_open)| *was_open)
        {
            said.verdict(&judged.result);
        }
    }

    /// Judges the image of one case; an error if it has none and is to be skipped.
    fn case(&self, case: &Case) -> Result<Box<Judged>, SkippedCase> {
        let start = Instant::now();
        let rendered = self.source.output(case);
        let rendering = self.source.renderer().map(|_| start.elapsed());
        if let Output::Missing(reason) = &rendered.output
            && self.arguments.only_present
        {
            return Err((case.name.clone(), reason.clone()));
        }
        let look = self.arguments.renderer.decide.then_some(1);
        let mut judged = self.judged(case, rendered, look);
        judged.result.seconds = start.elapsed().as_secs_f64();
        judged.evidence.rendering_seconds = rendering.map(|time| time.as_secs_f64());
        Ok(Box::new(judged))
    }

    /// Judges an image of one case: at the look of this number, from 1, where there may be several.
    fn judged(&self, case: &Case, rendered: Rendered, look: Option<u32>) -> Judged {
        let (store, profile) = (&self.store, self.profile.as_ref());
        let output = declared(rendered.output, self.bits(), case);
        let output = before_background(output, self.alpha(), case);
        let mut judged = validate_at(look, case, store, output, profile);
        judged.result.search_ended = judged.differs().then_some(false);
        judged.result.notes.extend(rendered.notes);
        judged.evidence.output = rendered.printed;
        judged.evidence.call = rendered.call;
        judged.evidence.reproduce = vec![self.arguments.again(case)];
        if let Some(known) = &self.known {
            known.mark(&mut judged.result);
        }
        judged
    }

    /// Bits of a channel in the images.
    fn bits(&self) -> Option<Bits> {
        let of_profile = self.profile.as_ref().and_then(|profile| profile.bits);
        Bits::of(self.arguments.bits, of_profile)
    }

    /// Colours of the images that leave out the background, if declared.
    fn alpha(&self) -> Option<Alpha> {
        let of_profile = self.profile.as_ref().and_then(|profile| profile.alpha);
        self.arguments.alpha.or(of_profile)
    }

    /// The command, how long its images took, and how they were read, for whoever reads them again.
    fn origin(&self, judged: &[Judged]) -> Value {
        let seconds = |of: &Judged| Some((of.result.name.clone(), of.evidence.rendering_seconds?));
        json!({
            "command": command_line(),
            "profile": self.arguments.profile,
            "bits": self.bits().map(|bits| bits.to_string()),
            "alpha": self.alpha().map(|alpha| alpha.to_string()),
            "machine": self.source.renderer().map(|_| Machine::here(1).processor),
            "seconds": judged.iter().filter_map(seconds).collect::<BTreeMap<_, _>>(),
        })
    }

    /// A warning about images that belong to no case.
    fn unknown_files(&self) -> String {
        let ImageSource::Finished(outputs) = &self.source else {
            return String::new();
        };
        let files = outputs.unknown_files().iter();
        let lines = files.map(|it| format!("\n{} {}", it.file.display(), it.reason));
        let text: String = lines.collect();
        if text.is_empty() { text } else { text + "\n" }
    }

    fn nothing_compared(&self) -> Failure {
        let message = "no image of these cases was found: nothing was compared";
        let help = format!(
            "images are named family/name.exr or name.exr; `volref list` shows the cases{}",
            self.unknown_files().trim_end()
        );
        Failure::new(Exit::Undecided, message, Some(&help))
    }
}
