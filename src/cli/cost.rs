//! `volref cost SCENE…`

use super::command_line::command_line;
use super::failure::{Failure, bad_input};
use super::output::{self, Json};
use super::renderer::seconds;
use super::suite::{NamedScene, named_scene};
use super::{Outcome, progress};
use crate::cost::timing::{Clock, Machine, RUNS};
use crate::cost::{Cost, Options, cost};
use crate::report;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Measure what accuracy costs: error against lookups and time
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Errors and work counts are the same on every run; only times differ. \
    Times are measured on one thread, with the settings interleaved."
)]
pub struct Arguments {
    /// Scene files (TOML), or cases of the suite
    #[arg(value_name = "SCENE", required = true)]
    scenes: Vec<PathBuf>,
    /// Time limit for all scenes together: no new setting is started after it, and the report states
    /// which were left out; a setting in progress is completed [default: no limit]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    budget: Option<f64>,
    /// Timed runs of each setting, 2 or more; 0 for no timings
    #[arg(long, value_name = "N", default_value_t = RUNS, value_parser = runs)]
    runs: usize,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Write an offline HTML page, DIR/index.html, with its tables as CSV and its plots of error
    /// against work and time as SVG
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let named = arguments.scenes.iter().map(|scene| named_scene(scene));
    let named: Vec<NamedScene> = named.collect::<Result<_, _>>()?;
    let inputs: Vec<&Path> = named.iter().map(|scene| scene.file.as_path()).collect();
    output::check(&[arguments.json.file()], &inputs)?;
    let mut scenes = Vec::new();
    for NamedScene { file, name, .. } in &named {
        scenes.push((name, Scene::load(file)?));
    }
    if let Some(folder) = &arguments.report {
        output::make_folder(folder)?;
    }
    let page_path = (arguments.report.as_ref()).map(|folder| folder.join("index.html"));
    page_path.as_deref().map_or(Ok(()), output::check_own)?;
    output::check(&[arguments.json.file(), page_path.as_deref()], &[])?;
    let options = Options {
        clock: Clock {
            runs: arguments.runs,
            deadline: arguments
                .budget
                .map(|budget| Instant::now() + Duration::from_secs_f64(budget)),
        },
        seed: arguments.seed,
    };
    let bar = progress::counted(scenes.len());
    let mut costs: Vec<Cost> = Vec::new();
    for (name, scene) in &scenes {
        let report = |what: &str| bar.set_message(format!("{name}: {what}"));
        let found = cost(scene, name, &options, &report);
        costs.extend(found.map_err(|error| bad_input(format!("{name}: {error}")))?);
        bar.end_part();
    }
    drop(bar);
    let machine = (arguments.runs > 0).then(|| Machine::here(1));
    let mut text = report::cost_text(&costs, machine.as_ref());
    if let Some(folder) = &arguments.report {
        let page = report::cost_html(&command_line(), &costs, machine.as_ref());
        let mut files = vec![("index.html".to_owned(), page)];
        let tables = report::cost_csv(&costs).into_iter();
        files.extend(tables.map(|(name, text)| (name.to_owned(), text)));
        files.extend(pictures(&costs));
        let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
        let mut outputs = vec![arguments.json.file()];
        outputs.extend(paths.iter().map(|path| Some(path.as_path())));
        output::check(&outputs, &[])?;
        paths.iter().try_for_each(|path| output::check_own(path))?;
        for (name, text) in &files {
            output::write_within(folder, Path::new(name), text.as_bytes())?;
        }
        text.push_str(&format!("\nreport: {}\n", paths[0].display()));
    }
    let value = report::cost_json(&costs, machine.as_ref());
    arguments.json.instead_of(text, &value).map(Outcome::from)
}

/// The plot of each scene, by the name of its file.
fn pictures(costs: &[Cost]) -> impl Iterator<Item = (String, String)> {
    costs.iter().enumerate().map(|(index, cost)| {
        let mut name = stem(cost).to_owned();
        // Another panel, or another scene of the same name.
        let same = |other: &&Cost| stem(other) == name;
        let before = costs[..index].iter().filter(same).count();
        if before > 0 {
            name.push_str(&format!("-{}", before + 1));
        }
        (format!("{name}.svg"), report::cost_plot(cost))
    })
}

/// Name of the scene without its folder or family, for files.
fn stem(cost: &Cost) -> &str {
    let name = cost.scene.rsplit(['/', '\\']).next().unwrap_or_default();
    // The point in the name of a case, such as threshold-1.25, begins no extension.
    name.strip_suffix(".toml").unwrap_or(name)
}

/// Number of timed runs.
fn runs(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(1) => Err("one run has no spread: give 2 or more, or 0 for no timings".to_owned()),
        Ok(runs @ 0..=1000) => Ok(runs),
        _ => Err("a number of runs from 2 to 1000, or 0 for no timings".to_owned()),
    }
}
