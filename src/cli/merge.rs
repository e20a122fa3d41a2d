//! `volref merge DIR…`

use super::failure::{EXIT_CODES, Exit, Failure, bad_input, exit};
use super::kept::NAME;
use super::merged_runs::{NO_RESULT, cases_of, profile_of, side_by_side, without_result};
use super::merged_units::joined_units;
use super::output::check_not_golden;
use super::results::{Findings, ResultFiles};
use super::selftest::{self, SELF_TEST};
use super::suite::{KEPT, Selection};
use super::verdicts::{CauseSearch, ExplainArgument, PrintedVerdicts};
use super::verify;
use super::{Outcome, progress};
use crate::judging;
use crate::judging::{
    CaseResult, CaseTrials, Judged, JudgedWith, SelfTest, SelfTestCases, Verdict,
};
use crate::naming::Likenesses;
use crate::report;
use crate::runs::{KeptResult, RESULTS, ResultFolder, Run, UnitFolder};
use crate::suite::{Case, Suite};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Join what several machines computed: results, units of goldens
///
/// The results of verify, validate or selftest of all parts become one, with one exit code, as if one machine had judged all cases. Units
/// are copied to .volref of the suite, where volref accept finds them. Missing parts are listed, exit code 5. Runs with
/// names (volref validate --named) are put beside each other, with the causes that each found.
#[derive(Debug, clap::Args)]
#[command(after_help = EXIT_CODES)]
pub struct Arguments {
    /// Folders that parts wrote: .volref, that of --results, or a folder with a .volref
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// Run to join, if there are several: start of its identifier
    #[arg(long = "run", value_name = "ID")]
    run: Option<String>,
    #[command(flatten)]
    selection: Selection,
    /// List every case, including those that passed
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    explain: ExplainArgument,
    #[command(flatten)]
    files: ResultFiles,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let roots = arguments.folders.iter().map(|folder| root_of(folder));
    let roots: Vec<PathBuf> = roots.collect::<Result<_, _>>()?;
    let folders: Vec<ResultFolder> = roots.iter().map(ResultFolder::open).collect();
    let runs = runs_of(&arguments, &folders)?;
    if !runs.is_empty()
        && runs
            .values()
            .all(|(run, _)| run.settings.contains_key(NAME))
    {
        let suite = arguments.selection.open()?;
        arguments.files.check(&suite)?;
        return side_by_side(&runs, &suite, &arguments.files);
    }
    let run = the_run(&runs)?;
    let files = roots.iter().flat_map(|root| UnitFolder::open(root).files());
    let files: Vec<PathBuf> = files.collect();
    let has_units = !files.is_empty();
    if run.is_none() && !has_units {
        let message = "there are neither results nor units in these folders";
        let help = "parts write them below .volref: volref verify --partition, volref validate --partition, \
                    volref selftest --partition, volref units --compute";
        return Err(Failure::new(Exit::Undecided, message, Some(help)));
    }
    let suite = if has_units {
        arguments.selection.open_to_change()?
    } else {
        arguments.selection.open()?
    };
    arguments.files.check(&suite)?;
    for root in &roots {
        check_not_golden(root, &suite)?;
    }
    let units = has_units
        .then(|| joined_units(&files, &suite, &arguments.selection))
        .transpose()?;
    let Some(run) = run else {
        arguments.files.check_no_results()?;
        let units = units.unwrap_or_default();
        let value = json!({ "schema": "volref/merge/1", "units": units.json() });
        return Ok(Outcome {
            exit: units.exit(),
            text: arguments.files.write_json(units.text(), &value)?,
        });
    };
    let of_units = units.as_ref().map(|units| units.json());
    let results = ResultsOfRun {
        id: run.id(),
        run,
        folders,
    };
    let mut outcome = joined_results(&arguments, &suite, &results, of_units)?;
    if let Some(units) = units {
        if !arguments.files.prints_json() {
            outcome.text.push_str(&format!("\n{}", units.text()));
        }
        outcome.exit = Exit::first_of([outcome.exit, units.exit()]);
    }
    Ok(outcome)
}

/// A run, and the folders with results of it.
struct ResultsOfRun {
    run: Run,
    id: String,
    folders: Vec<ResultFolder>,
}

/// The folder of units and results: `folder` itself or one in it.
fn root_of(folder: &Path) -> Result<PathBuf, Failure> {
    let is_root = |root: &Path| {
        let (units, results) = (UnitFolder::open(root), ResultFolder::open(root));
        units.path().is_dir() || results.path().is_dir()
    };
    if is_root(folder) {
        return Ok(folder.to_owned());
    }
    let within = folder.join(KEPT);
    if is_root(&within) {
        return Ok(within);
    }
    // The folder of a run, which a part names at its end, or that of all results.
    let mut above = folder.ancestors().take(2);
    let results = above.find(|above| above.file_name().is_some_and(|name| name == RESULTS));
    if let Some(root) = results.and_then(Path::parent)
        && folder.is_dir()
    {
        return Ok(root.to_owned());
    }
    let folder = folder.display();
    if !within.parent().is_some_and(Path::is_dir) {
        return Err(bad_input(format!("{folder} is not a folder")));
    }
    let message = format!("{folder} has neither results nor units");
    let help =
        "give folders that parts wrote: .volref, that of --results, or a folder with a .volref";
    Err(Failure::new(Exit::Undecided, message, Some(help)))
}

fn damaged_run(reason: String) -> Failure {
    let help = "the other results in its folder cannot be trusted: remove the folder, and run its parts again";
    Failure::new(Exit::Undecided, reason, Some(help))
}

/// The runs with results, by their identifiers, each with a folder that holds results of it.
fn runs_of(
    arguments: &Arguments,
    folders: &[ResultFolder],
) -> Result<BTreeMap<String, (Run, ResultFolder)>, Failure> {
    let mut runs: BTreeMap<String, (Run, ResultFolder)> = BTreeMap::new();
    for folder in folders {
        for (id, run) in folder.runs().map_err(damaged_run)? {
            runs.entry(id).or_insert((run, folder.clone()));
        }
    }
    if let Some(id) = &arguments.run {
        runs.retain(|name, _| name.starts_with(id));
        if runs.is_empty() {
            return Err(bad_input(format!("there are no results of a run {id}")));
        }
    }
    Ok(runs)
}

/// The run whose results are to be joined; `None` where there are only units.
fn the_run(runs: &BTreeMap<String, (Run, ResultFolder)>) -> Result<Option<Run>, Failure> {
    let mut found = runs.values();
    match (found.next(), found.next()) {
        (None, _) => Ok(None),
        (Some((run, _)), None) => Ok(Some(run.clone())),
        (Some((one, here)), Some((other, there))) => {
            let (what, [one_value, other_value]) = one.difference(other);
            let message = format!(
                "these are results of {} different runs: {what} differs, {one_value} in {} and {other_value} in {}",
                runs.len(),
                here.path().join(one.id()).display(),
                there.path().join(other.id()).display(),
            );
            let help = "remove the folders of the other runs, or name the one to join with --run ID, its folder's name";
            Err(Failure::new(Exit::BadInput, message, Some(help)))
        }
    }
}

/// Results of all parts, in the order of the cases; a missing one is a result that says so.
fn joined_results(
    arguments: &Arguments,
    suite: &Suite,
    results: &ResultsOfRun,
    units: Option<Value>,
) -> Result<Outcome, Failure> {
    let run = &results.run;
    let cases = cases_of(run, suite)?;
    if run.command == SELF_TEST {
        return joined_self_test(arguments, results, &cases);
    }
    let profile = profile_of(run)?;
    let is_explained = run.command == "validate" && arguments.explain.seconds(false) > 0.0;
    let wants_images = |result: &CaseResult| {
        arguments.files.wants_evidence() || is_explained && result.verdict != Verdict::Missing
    };
    let joined = progress::during("joining", || {
        let cases = run.cases.par_iter();
        let found = cases.map(|(name, _)| of_case(name, results, &wants_images));
        found.collect::<Result<Vec<KeptResult>, Failure>>()
    })?;
    let (mut judged, mut missing, mut skipped) = (Vec::new(), Vec::new(), Vec::new());
    for ((name, _), found) in run.cases.iter().zip(joined) {
        match found {
            KeptResult::Judged(found) => judged.push(*found),
            KeptResult::PassedOver => skipped.push((name.clone(), String::new())),
            KeptResult::Damaged(reason) => missing.push((name, reason)),
            KeptResult::Missing => missing.push((name, NO_RESULT.to_owned())),
        }
    }
    let is_verified = run.command == "verify";
    if is_verified && run.is_everything {
        judged.extend(judging::without_case(suite)?);
    }
    let found: Vec<CaseResult> = judged.iter().map(|of| of.result.clone()).collect();
    let judged_with = JudgedWith::of(&run.settings, profile.as_ref(), skipped, &found);
    let (found, text) = if is_verified {
        let text = verify::in_words(&found, arguments.verbose, suite);
        (Likenesses::default(), text)
    } else {
        let said = PrintedVerdicts {
            speaks: !arguments.files.prints_json(),
            widest: report::widest(found.iter().map(|result| &result.name)),
            folds_missing: !arguments.verbose,
            waits: false,
        };
        found.iter().for_each(|result| said.verdict(result));
        said.print(&(said.without_image(&found) + &report::summary_text(&found)));
        said.print(&report::judged_with_text(&judged_with));
        CauseSearch::run(&arguments.explain, false, |search| {
            search.mistakes(suite, &cases, profile.as_ref(), &mut judged)
        })
    };
    let text = text + &missing_text(&missing, run.cases.len());
    let missing = missing.into_iter();
    judged.extend(missing.map(|(name, reason)| without_result(name, suite.case(name), &reason)));
    let findings = Findings {
        command: if is_verified { "verify" } else { "validate" },
        judged,
        found,
        judged_with,
        has_known: false,
        units,
        origin: None,
    };
    let exit = exit(&findings.results());
    let text = arguments.files.write(findings, text)?;
    Ok(Outcome { text, exit })
}

/// The self-test of all parts, as on one machine with all `cases`. Where parts are missing, a
/// mistake that is not caught may be caught by one of them.
fn joined_self_test(
    arguments: &Arguments,
    results: &ResultsOfRun,
    cases: &[&Case],
) -> Result<Outcome, Failure> {
    arguments.files.check_no_results()?;
    let run = &results.run;
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    for (name, _) in &run.cases {
        let mut of_case: Option<(CaseTrials, &ResultFolder)> = None;
        let mut reason = NO_RESULT.to_owned();
        for folder in &results.folders {
            match folder.trials(&results.id, name) {
                Err(damage) => reason = damage,
                Ok(None) => {}
                Ok(Some(trials)) => {
                    of_case = match of_case {
                        None => Some((trials, folder)),
                        Some((one, here)) => {
                            let both = one.with(trials);
                            let both =
                                both.ok_or_else(|| contradicting_self_tests(name, [here, folder]));
                            Some((both?, here))
                        }
                    }
                }
            }
        }
        match of_case {
            Some((trials, _)) => found.push(trials),
            None => missing.push((name, reason)),
        }
    }
    let which = match (missing.is_empty(), run.is_everything) {
        (false, _) => SelfTestCases::Part,
        (true, true) => SelfTestCases::Whole,
        (true, false) => SelfTestCases::Selected,
    };
    let test = SelfTest::of(cases, &found, which);
    let mut value = report::self_test_json(&test);
    if !missing.is_empty() {
        let names: Vec<&String> = missing.iter().map(|(name, _)| *name).collect();
        value["missing"] = json!(names);
    }
    let text = report::self_test_text(&test) + &missing_text(&missing, run.cases.len());
    let undecided = (!missing.is_empty()).then_some(Exit::Undecided);
    Ok(Outcome {
        text: arguments.files.write_json(text, &value)?,
        exit: Exit::first_of([selftest::exit_of(&test)].into_iter().chain(undecided)),
    })
}

fn contradicting_self_tests(name: &str, folders: [&ResultFolder; 2]) -> Failure {
    let [one, other] = folders.map(|folder| folder.path().display().to_string());
    let message =
        format!("two self-tests of {name} contradict each other: those in {one} and {other}");
    let help = "one machine computes other images: find out which, and leave its folder out";
    Failure::new(Exit::BadInput, message, Some(help))
}

/// The result of a case; where several agree, always the same one, whatever the order of the
/// folders.
///
/// # Errors
///
/// If two have other verdicts.
fn of_case(
    name: &str,
    results: &ResultsOfRun,
    wants_images: &(dyn Fn(&CaseResult) -> bool + Sync),
) -> Result<KeptResult, Failure> {
    let mut best: Option<(Box<Judged>, &ResultFolder)> = None;
    let mut other = KeptResult::Missing;
    for folder in &results.folders {
        match (folder.get(&results.id, name, wants_images), &other) {
            (KeptResult::Judged(found), _) => {
                if let Some((one, here)) = &best
                    && one.result.verdict != found.result.verdict
                {
                    return Err(contradiction(name, [(one, here), (&found, folder)]));
                }
                if best
                    .as_ref()
                    .is_none_or(|(one, _)| without_time(&found) < without_time(one))
                {
                    best = Some((found, folder));
                }
            }
            (KeptResult::Missing, _) | (KeptResult::PassedOver, KeptResult::Damaged(_)) => {}
            (found, _) => other = found,
        }
    }
    Ok(best.map_or(other, |(found, _)| KeptResult::Judged(found)))
}

/// Text of a result, without its time.
fn without_time(judged: &Judged) -> String {
    let result = CaseResult {
        seconds: 0.0,
        ..judged.result.clone()
    };
    serde_json::to_string(&result).unwrap_or_default()
}

fn contradiction(name: &str, found: [(&Judged, &ResultFolder); 2]) -> Failure {
    let words = found.map(|(judged, folder)| {
        let verdict = judged.result.verdict.name();
        format!("{verdict} in {}", folder.path().display())
    });
    let message = format!(
        "two results of {name} contradict each other: {}",
        words.join(", ")
    );
    let help =
        "the renderer, or the images, were not the same: leave out, or remove, the older results";
    Failure::new(Exit::BadInput, message, Some(help))
}

/// List of the cases without a result, with reasons other than [`NO_RESULT`].
fn missing_text(missing: &[(&String, String)], all: usize) -> String {
    if missing.is_empty() {
        return String::new();
    }
    let count = missing.len();
    let mut text = format!(
        "\nmissing: {count} of {all} cases; their parts were not run, did not end, or wrote elsewhere, if nothing \
         else is said\n"
    );
    for (name, reason) in missing {
        text.push_str(&format!("  {name}\n"));
        if reason != NO_RESULT {
            text.push_str(&format!("      {reason}\n"));
        }
    }
    text
}
