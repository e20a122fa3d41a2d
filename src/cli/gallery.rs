//! `volref gallery DIR… -o FILE.html`

use super::failure::{Exit, Failure, bad_input};
use super::output::check_not_golden;
use super::suite::Selection;
use super::{Outcome, output, progress};
use crate::compare::Picture;
use crate::files::regular_file::{self, note_input};
use crate::film::{Alpha, Bits};
use crate::judging::{CaseResult, before_background, declared};
use crate::report::{
    GalleryCase, GalleryCell, GalleryRenderer, GalleryRow, gallery_html, gallery_row,
};
use crate::suite::{Case, Golden, Output, Outputs, Store, Suite};
use rayon::prelude::*;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Layout of a folder, for `--help`.
const LAYOUT: &str = "Each DIR is the run of one renderer, and holds results.json and the images that were judged, as \
    `volref validate --run CMD --keep DIR --json=DIR/results.json` leaves them, or `volref validate --outputs DIR \
    --json=DIR/results.json`. A file renderer.toml may state name, version, date and command; otherwise the name is that \
    of the folder, and the command that of volref validate.";

/// Make one page of many renderers, judged case by case
#[derive(Debug, clap::Args)]
#[command(after_help = LAYOUT)]
pub struct Arguments {
    /// Folders of the renderers, in the order of the columns
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
    seconds: BTreeMap<String, f64>,
}

/// `renderer.toml`.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct About {
    name: Option<String>,
    version: Option<String>,
    date: Option<String>,
    command: Option<String>,
}

/// The run of a renderer.
struct RendererRun {
    renderer: GalleryRenderer,
    outputs: Outputs,
    bits: Option<Bits>,
    alpha: Option<Alpha>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.selection.open()?;
    check_not_golden(&arguments.output, &suite)?;
    output::check(&[Some(&arguments.output)], &[])?;
    let folders = arguments.folders.iter();
    let runs: Vec<RendererRun> = folders
        .map(|folder| RendererRun::read(folder, &suite))
        .collect::<Result<_, _>>()?;
    // Now that the inputs are known.
    output::check(&[Some(&arguments.output)], &[])?;
    let has = |run: &RendererRun, case: &Case| run.result(case).is_some();
    let cases: Vec<&Case> = suite
        .cases()
        .iter()
        .filter(|case| runs.iter().any(|run| has(run, case)))
        .collect();
    let store = suite.store();
    let bar = progress::counted("cases", cases.len());
    let row = |case: &&Case| {
        let row = row(case, &store, &runs);
        bar.inc(1);
        row
    };
    let rows: Vec<GalleryRow> = cases.par_iter().map(row).collect();
    bar.finish_and_clear();
    let renderers: Vec<GalleryRenderer> = runs.into_iter().map(|run| run.renderer).collect();
    let page = gallery_html(&renderers, &rows);
    output::write(&arguments.output, page.as_bytes())?;
    Ok(Outcome::from(format!(
        "{}: {}, {}, {:.1} MB\n",
        arguments.output.display(),
        output::number_of(renderers.len() as u64, "renderer"),
        output::number_of(rows.len() as u64, "case"),
        page.len() as f64 / 1e6,
    )))
}

fn row(case: &Case, store: &Store, runs: &[RendererRun]) -> GalleryRow {
    let golden = Golden::read(store, case).map(|golden| golden.film);
    let of_case = GalleryCase {
        name: &case.name,
        exposure: case.exposure,
        golden: golden.map_err(|error| error.to_string()),
    };
    let cells = runs.iter().map(|run| run.cell(case));
    gallery_row(&of_case, &cells.collect::<Vec<_>>())
}

impl RendererRun {
    fn read(folder: &Path, suite: &Suite) -> Result<RendererRun, Failure> {
        let file = folder.join(RESULTS);
        if !file.exists() {
            let message = format!("there is no {}", file.display());
            let help = "let `volref validate` write it: --json=DIR/results.json, with --keep DIR or --outputs DIR";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let results: Results = read(&file, |text| {
            serde_json::from_str(text).map_err(|error| error.to_string())
        })?;
        if results.schema != SCHEMA {
            let message = format!("{}: its schema is {:?}", file.display(), results.schema);
            let help = "a gallery is made of results of `volref validate`";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let names: Vec<&str> = suite.cases().iter().map(|case| &*case.name).collect();
        if let Some(unknown) = results.cases.iter().find(|of| !names.contains(&&*of.name)) {
            let message = format!(
                "{}: the suite has no case {:?}",
                file.display(),
                unknown.name
            );
            let help = "name the suite by which it was judged: --suite DIR";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        let about_file = folder.join(ABOUT);
        let about: About = match about_file.exists() {
            true => read(&about_file, |text| {
                toml::from_str(text).map_err(|error| error.to_string())
            })?,
            false => About::default(),
        };
        let outputs = Outputs::list(folder, &names).map_err(bad_input)?;
        outputs.files().for_each(note_input);
        let absolute = std::path::absolute(folder).map_err(bad_input)?;
        let own_name = absolute.file_name().unwrap_or(absolute.as_os_str());
        let in_file = |error| bad_input(format!("{}: {error}", file.display()));
        let bits = results.origin.bits.map(|bits| bits.parse());
        let alpha = results.origin.alpha.map(|alpha| alpha.parse());
        Ok(RendererRun {
            renderer: GalleryRenderer {
                name: about
                    .name
                    .unwrap_or_else(|| own_name.to_string_lossy().into_owned()),
                version: about.version,
                date: about.date,
                command: about.command.or(results.origin.command),
                profile: results.origin.profile,
                results: results.cases,
                seconds: results.origin.seconds,
            },
            outputs,
            bits: bits.transpose().map_err(in_file)?,
            alpha: alpha.transpose().map_err(in_file)?,
        })
    }

    fn result(&self, case: &Case) -> Option<&CaseResult> {
        let mut results = self.renderer.results.iter();
        results.find(|result| result.name == case.name)
    }

    /// The result for a case, and its image: of several steps, that with the shortest.
    fn cell(&self, case: &Case) -> Option<GalleryCell<'_>> {
        let result = self.result(case)?;
        let output = declared(self.outputs.output(&case.name), self.bits, case);
        let picture: Option<Picture> = match before_background(output, self.alpha, case) {
            Output::Picture(picture) => Some(*picture),
            Output::Refined(mut pictures) => pictures.pop(),
            Output::Missing(_) | Output::Unusable(_) => None,
        };
        let seconds = self.renderer.seconds.get(&case.name).copied();
        Some(GalleryCell {
            result,
            picture,
            seconds,
        })
    }
}

/// Files of a folder.
const RESULTS: &str = "results.json";
const ABOUT: &str = "renderer.toml";

/// Schema of the results.
const SCHEMA: &str = "volref/validate/1";

/// Longest of these files: 64 MiB.
const MOST_BYTES: u64 = 1 << 26;

/// The value that `parse` makes of the text of a file.
fn read<T: DeserializeOwned>(
    file: &Path,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<T, Failure> {
    note_input(file);
    let in_file = |error: String| bad_input(format!("{}: {error}", file.display()));
    let bytes = regular_file::read(file, MOST_BYTES).map_err(|error| in_file(error.to_string()))?;
    let text = String::from_utf8(bytes).map_err(|_| in_file("it is no UTF-8 text".to_owned()))?;
    parse(&text).map_err(in_file)
}
