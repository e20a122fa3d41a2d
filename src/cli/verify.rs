//! `volref verify [FILTER…]`

use super::failure::{Exit, Failure};
use super::suite::{Selection, exit, select, store, suite_failure};
use super::{Outcome, output, progress, render};
use crate::atomic_file::directory_of;
use crate::report;
use crate::suite::{self, Verdict};
use std::path::{Path, PathBuf};

/// Render the suite with the reference and compare every bit with the goldens
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Families, cases, or patterns over them such as 'figures/*' [default: all cases]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    #[command(flatten)]
    selection: Selection,
    /// Write the results as JSON; without FILE, print them instead of the text
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// Write the results as JUnit XML, for build servers
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Threads to use; the images are the same for any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let suite = arguments.selection.open()?;
    if let Some(path) = &arguments.json
        && suite.select(&[path.display().to_string()]).is_ok()
    {
        let message = format!(
            "--json {0}: is {0} a file to write or the cases to verify?",
            path.display()
        );
        let help = "write filters before --json, or a file name that is no case";
        return Err(Failure::new(Exit::BadInput, message, Some(help)));
    }
    for path in [&arguments.json, &arguments.junit].into_iter().flatten() {
        output::check_place(path)?;
        if is_below(path, &suite.golden_folder()) {
            let message = format!("{} lies among the goldens", path.display());
            let help = "goldens change by `volref accept` alone; write the report elsewhere";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
    }
    let cases = select(&suite, &arguments.filters)?;
    let store = store(&suite);
    let mut results: Vec<_> = render::with_threads(arguments.threads, || {
        let bar = progress::cases(cases.len());
        let results = cases
            .iter()
            .map(|case| {
                bar.set_message(case.name.clone());
                let result = suite::verify(case, &store, &|| bar.tick());
                bar.inc(1);
                result
            })
            .collect();
        bar.finish_and_clear();
        results
    })?;

    if arguments.filters.is_empty() {
        results.extend(suite::without_case(&suite).map_err(suite_failure)?);
    }
    let json = report::results_json("verify", &results);
    if let Some(path) = &arguments.junit {
        output::write(path, report::results_junit(&results).as_bytes())?;
    }
    let mut text = report::results_text(&results);
    if let Some(failed) = results
        .iter()
        .find(|result| result.verdict == Verdict::Fail)
    {
        let scene = cases
            .iter()
            .find(|case| case.name == failed.name)
            .map(|case| &case.scene);
        if let Some(scene) = scene {
            text.push_str(&format!(
                "\nTo see what moved:\n  volref render {} -o now.exr\n  volref compare {}.exr now.exr --heatmap moved.png\n",
                scene.display(),
                suite.golden_folder().join(&failed.name).display()
            ));
        }
    }
    match &arguments.json {
        Some(path) if path.as_os_str() == "-" => text = output::pretty(&json),
        Some(path) => output::write(path, output::pretty(&json).as_bytes())?,
        None => {}
    }
    Ok(Outcome {
        text,
        exit: exit(&results),
    })
}

/// Whether `path` names something in `folder`, however either is spelt.
fn is_below(path: &Path, folder: &Path) -> bool {
    let place = directory_of(path).canonicalize();
    matches!((place, folder.canonicalize()), (Ok(place), Ok(folder)) if place.starts_with(&folder))
}
