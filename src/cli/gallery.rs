//! `volref gallery DIR… -o FILE.html`

use super::failure::{Exit, Failure, bad_input};
use super::suite::Selection;
use super::{Outcome, output, progress};
use crate::conventions::Profile;
use crate::files::regular_file::{self, note_input};
use crate::film::{Alpha, Bits};
use crate::judging::{
    CaseResult, Cause, Evidence, Judged, KnownFailures, Verdict, before_background, declared,
    validate_at,
};
use crate::report::{
    GalleryAbout, GalleryRenderer, GalleryRow, gallery_html, gallery_row, number_of,
};
use crate::suite::{Case, Golden, Outputs, Store, Suite};
use rayon::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Layout of a folder, for `--help`.
const LAYOUT: &str = "Each DIR is the run of one renderer, and holds results.json and the images that were judged, as \
    `volref validate --run CMD --keep DIR --json=DIR/results.json` leaves them, or `volref validate --outputs DIR \
    --json=DIR/results.json`. The images are judged again. A file renderer.toml may state name, version, date, command, \
    machine, and as_judged = false of images that cannot be judged again; otherwise the name is that of the folder, and the command that of volref validate. A file known.toml lists \
    known failures, as for volref validate --known.";

/// Make one page of many renderers, judged case by case
#[derive(Debug, clap::Args)]
#[command(after_help = LAYOUT)]
pub struct Arguments {
    /// Folders of the renderers; the page lists them in this order
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// Page to write: one HTML file, which loads nothing
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    selection: Selection,
}

/// Results of `volref validate`.
#[derive(Deserialize)]
struct Results {
    schema: String,
    cases: Vec<CaseResult>,
    #[serde(default)]
    origin: Origin,
}

/// Judging of the images: the command, and how they were read.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Origin {
    command: Option<String>,
    profile: Option<String>,
    bits: Option<String>,
    alpha: Option<String>,
    machine: Option<String>,
    seconds: BTreeMap<String, f64>,
}

/// The run of a renderer.
struct RendererRun {
    renderer: GalleryRenderer,
    results: Vec<CaseResult>,
    outputs: Outputs,
    profile: Option<Profile>,
    bits: Option<Bits>,
    alpha: Option<Alpha>,
    known: Option<KnownFailures>,
    /// Folder of the page.
    page: PathBuf,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.selection.open()?;
    output::check(&[Some(&arguments.output)], &[])?;
    let folders = arguments.folders.iter();
    let runs: Vec<RendererRun> = folders
        .map(|folder| RendererRun::read(folder, &suite, &arguments.output))
        .collect::<Result<_, _>>()?;
    // Now that the inputs are known.
    output::check(&[Some(&arguments.output)], &[])?;
    let has_result = |case: &&Case| runs.iter().any(|run| run.result(&case.name).is_some());
    let cases: Vec<&Case> = suite.cases().iter().filter(has_result).collect();
    let families = suite.families(&cases);
    let cases: Vec<&Case> = families.iter().flat_map(|it| it.cases.clone()).collect();
    let store = suite.store();
    let bar = progress::counted(cases.len());
    let row = |case: &&Case| {
        let row = row(case, &store, &runs);
        bar.end_part();
        row
    };
    let (rows, changes): (Vec<GalleryRow>, Vec<String>) = cases.par_iter().map(row).unzip();
    drop(bar);
    let renderers: Vec<GalleryRenderer> = runs.into_iter().map(|run| run.renderer).collect();
    let page = gallery_html(&renderers, &families, &rows);
    output::write(&arguments.output, page.as_bytes())?;
    Ok(Outcome::from(format!(
        "{}: {}, {}, {:.1} MB\n{}",
        arguments.output.display(),
        number_of(renderers.len(), "renderer"),
        number_of(rows.len(), "case"),
        page.len() as f64 / 1e6,
        changes.concat(),
    )))
}

/// The row of a case, and a line for each result that is no longer what the files of its run say.
fn row(case: &Case, store: &Store, runs: &[RendererRun]) -> (GalleryRow, String) {
    let golden = Golden::read(store, case).map(|golden| golden.film);
    let golden = golden.map_err(|error| error.to_string());
    let judged: Vec<_> = runs.iter().map(|run| run.judged(case, store)).collect();
    let changes = runs.iter().zip(&judged);
    let changes = changes.filter_map(|(run, judged)| run.change(judged.as_ref()?));
    let changes = changes.collect();
    (gallery_row(case, golden, judged), changes)
}

impl RendererRun {
    fn read(folder: &Path, suite: &Suite, page: &Path) -> Result<RendererRun, Failure> {
        let file = folder.join(RESULTS);
        let refused = |what: String, help| {
            let message = format!("{}: {what}", file.display());
            Err(Failure::new(Exit::BadInput, message, Some(help)))
        };
        if !file.exists() {
            let help = "let `volref validate` write it: --json=DIR/results.json, with --keep DIR or --outputs DIR";
            return refused("there is no such file".to_owned(), help);
        }
        let results: Results = read(&file, |text| serde_json::from_str(text))?;
        if results.schema != SCHEMA {
            let what = format!("its schema is {:?}", results.schema);
            return refused(what, "a gallery is made of results of `volref validate`");
        }
        let mut kept = results.cases.iter();
        if let Some(unknown) = kept.find(|of| suite.case(&of.name).is_none()) {
            let what = format!("the suite has no case {:?}", unknown.name);
            return refused(what, "name the suite by which it was judged: --suite DIR");
        }
        let about_file = folder.join(ABOUT);
        let mut about: GalleryAbout = match about_file.exists() {
            true => read(&about_file, |text| toml::from_str(text))?,
            false => GalleryAbout::default(),
        };
        let names: Vec<&str> = suite.cases().iter().map(|case| &*case.name).collect();
        let outputs = Outputs::list(folder, &names).map_err(bad_input)?;
        outputs.files().for_each(note_input);
        let absolute = std::path::absolute(folder).map_err(bad_input)?;
        let own_name = absolute.file_name().unwrap_or(absolute.as_os_str());
        let own_name = || own_name.to_string_lossy().into_owned();
        let in_file = |error| bad_input(format!("{}: {error}", file.display()));
        let known_file = folder.join(KNOWN);
        let known = match known_file.exists() {
            true => {
                let (text, shown) = (text_of(&known_file)?, known_file.display().to_string());
                Some(KnownFailures::parse(&text, &shown, suite, false)?)
            }
            false => None,
        };
        let profile = results.origin.profile.as_deref().map(Profile::named);
        let bits = results.origin.bits.map(|bits| bits.parse());
        let alpha = results.origin.alpha.map(|alpha| alpha.parse());
        about.name.get_or_insert_with(own_name);
        about.command = about.command.or(results.origin.command);
        about.machine = about.machine.or(results.origin.machine);
        Ok(RendererRun {
            renderer: GalleryRenderer {
                about,
                profile: results.origin.profile,
                seconds: results.origin.seconds,
            },
            results: results.cases,
            outputs,
            profile: profile.transpose()?,
            known,
            page: page.parent().map(Path::to_owned).unwrap_or_default(),
            bits: bits.transpose().map_err(in_file)?,
            alpha: alpha.transpose().map_err(in_file)?,
        })
    }

    fn result(&self, case: &str) -> Option<&CaseResult> {
        self.results.iter().find(|result| result.name == case)
    }

    /// The result for a case: what is said of its image today, with the causes that were found by the run.
    fn judged(&self, case: &Case, store: &Store) -> Option<Judged> {
        let kept = self.result(&case.name)?;
        let mut judged = match kept.verdict {
            Verdict::Missing | Verdict::Error => Judged {
                result: as_kept(kept),
                evidence: Evidence::of(case),
            },
            _ => self.judged_again(case, store, kept),
        };
        if self.renderer.about.as_judged == Some(false) {
            judged.result = as_kept(kept);
        }
        let seconds = self.renderer.seconds.get(&case.name).copied();
        judged.evidence.rendering_seconds = seconds;
        judged.result.known = self.known.as_ref().and_then(|of| of.of(&judged.result));
        if let Some(known) = &mut judged.result.known {
            known.link.take_if(|link| !self.leads(link));
        }
        Some(judged)
    }

    fn judged_again(&self, case: &Case, store: &Store, kept: &CaseResult) -> Judged {
        let of_profile = self.profile.as_ref().and_then(|profile| profile.bits);
        let bits = Bits::of(self.bits, of_profile);
        let output = declared(self.outputs.output(&case.name), bits, case);
        let output = before_background(output, self.alpha, case);
        // The conventions that were found for this image, or else those of its renderer.
        let found = kept.profile.as_deref();
        let found = found.and_then(|text| Profile::parse(text, &case.name).ok());
        let profile = found.as_ref().or(self.profile.as_ref());
        let mut judged = validate_at(None, case, store, output, profile);
        let result = &mut judged.result;
        if (kept.verdict, result.verdict) == (Verdict::Convention, Verdict::Pass) {
            (result.verdict, result.cause) = (Verdict::Convention, Cause::Convention);
        }
        if result.verdict == kept.verdict {
            result.conventions.clone_from(&kept.conventions);
            result.profile.clone_from(&kept.profile);
            result.looks_like.clone_from(&kept.looks_like);
            result.difference.clone_from(&kept.difference);
            result.changes.clone_from(&kept.changes);
        }
        judged
    }

    /// True if the page may link to it: an address of the web, or a file beside the page.
    fn leads(&self, link: &str) -> bool {
        let (file, _) = link.split_once('#').unwrap_or((link, ""));
        let is_web = link.starts_with("https://") || link.starts_with("http://");
        is_web || (!file.is_empty() && self.page.join(file).exists())
    }

    /// A line where the files of the run say otherwise than `judged`.
    fn change(&self, judged: &Judged) -> Option<String> {
        let result = &judged.result;
        let kept = self.result(&result.name)?;
        let name = self.renderer.name();
        if kept.verdict != result.verdict {
            let (before, now) = (kept.verdict.name(), result.verdict.name());
            return Some(format!(
                "{name}, {}: {now} today, and {RESULTS} says {before}: judge the images again\n",
                result.name
            ));
        }
        let known = result.known.as_ref().filter(|known| known.is_outdated())?;
        Some(format!("{name}: {}\n", known.change.as_ref()?))
    }
}

/// `kept` with the cause that a file does not hold.
fn as_kept(kept: &CaseResult) -> CaseResult {
    let cause = match kept.verdict {
        Verdict::Pass => Cause::None,
        Verdict::Fail => Cause::Mismatch,
        Verdict::Convention => Cause::Convention,
        Verdict::Inconclusive => Cause::Undecided,
        Verdict::Missing | Verdict::Error => Cause::OtherRenderer,
    };
    CaseResult {
        cause,
        ..kept.clone()
    }
}

/// Files of a folder.
const RESULTS: &str = "results.json";
const ABOUT: &str = "renderer.toml";
const KNOWN: &str = "known.toml";

/// Schema of the results.
const SCHEMA: &str = "volref/validate/1";

/// Longest of these files: 64 MiB.
const MOST_BYTES: u64 = 1 << 26;

/// The value that `parse` makes of the text of a file.
fn read<T, E: Display>(file: &Path, parse: impl Fn(&str) -> Result<T, E>) -> Result<T, Failure> {
    let text = text_of(file)?;
    parse(&text).map_err(|error| bad_input(format!("{}: {error}", file.display())))
}

fn text_of(file: &Path) -> Result<String, Failure> {
    note_input(file);
    let in_file = |error: String| bad_input(format!("{}: {error}", file.display()));
    let bytes = regular_file::read(file, MOST_BYTES).map_err(|error| in_file(error.to_string()))?;
    String::from_utf8(bytes).map_err(|_| in_file("it is no UTF-8 text".to_owned()))
}
