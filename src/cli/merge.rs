//! `volref merge DIR…`

use super::Outcome;
use super::failure::{EXIT_CODES, Exit, Failure, bad_input, exit};
use super::kept::NAME;
use super::results::{Findings, ResultFiles};
use super::selftest::{self, SELF_TEST};
use super::suite::Selection;
use super::verdicts::PrintedVerdicts;
use super::verify;
use crate::compare::Gate;
use crate::conventions::Profile;
use crate::judging;
use crate::judging::{
    CaseResult, CaseTrials, Cause, Evidence, Judged, JudgedWith, KeptResult, Part, ResultFolder,
    Run, SelfTest, SelfTestCases, Verdict,
};
use crate::naming::Diagnosis;
use crate::report;
use crate::suite::{CACHE, Case, Golden, Suite};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Join the results of several machines
///
/// The results of verify, validate or selftest of all parts become one, with one exit code, as if one machine had judged all
/// cases. Missing parts are listed, exit code 5. Runs with names (volref validate --named) are put beside each other.
#[derive(Debug, clap::Args)]
#[command(after_help = EXIT_CODES)]
pub struct Arguments {
    /// Folders that parts wrote: .volref, that of --results, or a folder with a .volref
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    #[command(flatten)]
    selection: Selection,
    /// List every case, including those that passed
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    files: ResultFiles,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let roots = arguments.folders.iter().map(|folder| root_of(folder));
    let roots: Vec<PathBuf> = roots.collect::<Result<_, _>>()?;
    let folders: Vec<ResultFolder> = roots.iter().map(ResultFolder::open).collect();
    let runs = runs_of(&folders)?;
    let suite = arguments.selection.open()?;
    arguments.files.check()?;
    match &runs[..] {
        [of] if of.run.command == SELF_TEST => joined_self_test(&arguments, &suite, of),
        _ => joined_results(&arguments, &suite, &runs),
    }
}

/// A run, and its parts, each with its folder.
struct Parts<'f> {
    id: String,
    run: Run,
    parts: Vec<(Part, &'f ResultFolder)>,
    /// Reason of a case without a result.
    missing: String,
}

impl<'f> Parts<'f> {
    fn of(id: String, run: Run, folders: &'f [ResultFolder]) -> Parts<'f> {
        let mut parts = Vec::new();
        let mut missing = NO_RESULT.to_owned();
        for folder in folders {
            for part in folder.parts(&id) {
                match part {
                    Ok(part) => parts.push((part, folder)),
                    Err(reason) => missing.push_str(&format!("; {reason}")),
                }
            }
        }
        Parts {
            id,
            run,
            parts,
            missing,
        }
    }

    /// Its name among runs side by side.
    fn name(&self) -> &str {
        self.run.settings.get(NAME).map_or("", String::as_str)
    }
}

/// The folder of results: `folder` itself, or one in it.
fn root_of(folder: &Path) -> Result<PathBuf, Failure> {
    if !folder.is_dir() {
        return Err(bad_input(format!("{} is not a folder", folder.display())));
    }
    let places = [folder.to_owned(), folder.join(CACHE)];
    let has_results = |root: &PathBuf| ResultFolder::open(root).path().is_dir();
    let root = places.into_iter().find(has_results);
    root.ok_or_else(|| no_results(&format!("{} has no results", folder.display())))
}

fn no_results(message: &str) -> Failure {
    let help = "parts keep results below .volref, or in the folder that --results names: volref verify --partition, \
                volref validate --partition, volref selftest --partition";
    Failure::new(Exit::Undecided, message, Some(help))
}

/// The runs whose results are to be joined: one, or several that have names.
fn runs_of(folders: &[ResultFolder]) -> Result<Vec<Parts<'_>>, Failure> {
    let mut runs: BTreeMap<String, (Run, PathBuf)> = BTreeMap::new();
    for folder in folders {
        let found = folder.runs().map_err(|reason| {
            let help = "the other results in its folder cannot be trusted: remove the folder, and run its parts again";
            Failure::new(Exit::Undecided, reason, Some(help))
        })?;
        for (id, run) in found {
            let place = folder.path().join(&id);
            runs.entry(id).or_insert((run, place));
        }
    }
    if runs.is_empty() {
        return Err(no_results("there are no results in these folders"));
    }
    let has_name = |(run, _): &(Run, PathBuf)| run.settings.contains_key(NAME);
    if runs.len() > 1 && !runs.values().all(has_name) {
        let places = runs.values().map(|(_, place)| place.display().to_string());
        let mut places: Vec<String> = places.collect();
        places.sort();
        let message = format!("these are results of different runs: {}", places.join(", "));
        let help =
            "the file run.json of each says what it judged; remove the folders of the other runs";
        return Err(Failure::new(Exit::BadInput, message, Some(help)));
    }
    let parts = |(id, (run, _))| Parts::of(id, run, folders);
    Ok(runs.into_iter().map(parts).collect())
}

/// Results of all parts, in the order of the cases; a missing one is a result that says so. Causes are those that the
/// parts found. A case that several runs judged has the name of its run behind its own.
fn joined_results(
    arguments: &Arguments,
    suite: &Suite,
    runs: &[Parts<'_>],
) -> Result<Outcome, Failure> {
    let (mut found, mut missing, mut loosened) = (Vec::new(), Vec::new(), Vec::new());
    for of in runs {
        cases_of(&of.run, suite)?;
        let profile = of.run.settings.get("profile");
        let profile = profile.map(|text| Profile::parse(text, "the profile of the results"));
        let profile = profile.transpose()?;
        let mut of_cases = by_case(of)?;
        let (mut results, mut skipped) = (Vec::new(), Vec::new());
        for (name, _) in &of.run.cases {
            match of_cases.remove(name.as_str()) {
                Some(Some((kept, folder))) => {
                    let mut judged = kept.clone().judged();
                    if arguments.files.page.is_asked() {
                        add_images(&mut judged, (kept, folder), &of.id, suite);
                    }
                    results.push(judged.result.clone());
                    found.push((of.name(), judged));
                }
                Some(None) => skipped.push((name.clone(), String::new())),
                None => missing.push((name, &of.missing)),
            }
        }
        let (settings, profile) = (&of.run.settings, profile.as_ref());
        loosened.push(JudgedWith::of(settings, profile, skipped, &results));
    }
    let mut judged = in_order(found, suite);
    let is_verified = runs[0].run.command == "verify";
    if is_verified && runs[0].run.is_everything {
        judged.extend(judging::without_case(suite)?);
    }
    let results: Vec<CaseResult> = judged.iter().map(|of| of.result.clone()).collect();
    let found = Diagnosis::of_results(&results);
    let judged_with = JudgedWith::of_runs(loosened);
    let text = if is_verified {
        verify::in_words(&results, arguments.verbose)
    } else {
        let said = PrintedVerdicts {
            speaks: !arguments.files.json.is_printed(),
            widest: report::widest(results.iter().map(|result| &result.name)),
            folds_missing: !arguments.verbose,
            waits: false,
        };
        results.iter().for_each(|result| said.verdict(result));
        said.summary(&results, &judged_with);
        report::likely_text(&found, 0.0)
    };
    let all = runs.iter().map(|of| of.run.cases.len()).sum();
    let text = text + &missing_text(&missing, all);
    for (name, reason) in missing {
        judged.push(without_result(name, suite.case(name), reason));
    }
    let findings = Findings {
        command: if is_verified { "verify" } else { "validate" },
        judged,
        found,
        judged_with,
        ..Findings::default()
    };
    let exit = exit(&findings.results());
    let text = arguments.files.write(findings, text)?;
    Ok(Outcome { text, exit })
}

/// Adds its images to a result that is `kept` in a folder. The verdict holds without them.
fn add_images(
    judged: &mut Judged,
    (kept, folder): (&KeptResult, &ResultFolder),
    run: &str,
    suite: &Suite,
) {
    if judged.result.cause != Cause::Golden {
        let case = suite.case(&judged.result.name);
        let golden = case.and_then(|case| Golden::read(&suite.store(), case).ok());
        judged.evidence.golden = golden.map(|golden| golden.film);
    }
    match folder.image(run, kept) {
        Ok(image) => judged.evidence.test = image,
        Err(reason) => {
            let note = format!("its image is missing: {reason}");
            judged.result.notes.push(note);
        }
    }
}

/// Results of runs in the order of the suite, and by the names of runs; a case of several is named with its run.
fn in_order(mut found: Vec<(&str, Judged)>, suite: &Suite) -> Vec<Judged> {
    let cases = suite.cases().iter().enumerate();
    let places: BTreeMap<&str, usize> = cases.map(|(at, case)| (&*case.name, at)).collect();
    found.sort_by_cached_key(|(run, judged)| {
        (places.get(&*judged.result.name).copied(), (*run).to_owned())
    });
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for (_, judged) in &found {
        *counts.entry(judged.result.name.clone()).or_default() += 1;
    }
    let named = found.into_iter().map(|(run, mut judged)| {
        if counts[&judged.result.name] > 1 {
            judged.result.name = format!("{} ({run})", judged.result.name);
        }
        judged
    });
    named.collect()
}

/// The result of a case and its folder; `None` of one that was passed over.
type OfCase<'p> = Option<(&'p KeptResult, &'p ResultFolder)>;

/// The result of each case that a part judged or passed over, the first of several.
///
/// # Errors
///
/// If two have other verdicts.
fn by_case<'p>(of: &'p Parts<'_>) -> Result<BTreeMap<&'p str, OfCase<'p>>, Failure> {
    let mut of_cases: BTreeMap<&str, OfCase<'p>> = BTreeMap::new();
    for (part, folder) in &of.parts {
        for name in &part.cases {
            of_cases.entry(name).or_default();
        }
        for kept in &part.results {
            let name = &kept.result.name;
            let found = of_cases.entry(name).or_default();
            let (one, here) = *found.get_or_insert((kept, folder));
            if one.result.verdict != kept.result.verdict {
                let said = [(one, here), (kept, *folder)].map(|(it, folder)| {
                    let verdict = it.result.verdict.name();
                    format!("{verdict} in {}", folder.path().display())
                });
                let message = format!("two results of {name} differ: {}", said.join(", "));
                let help = "the renderer, the images or the machine were not the same: leave out, or remove, the older \
                            results";
                return Err(Failure::new(Exit::BadInput, message, Some(help)));
            }
        }
    }
    Ok(of_cases)
}

/// The cases of `run`, if this program and this `suite` judged them.
fn cases_of<'s>(run: &Run, suite: &'s Suite) -> Result<Vec<&'s Case>, Failure> {
    let version = env!("CARGO_PKG_VERSION");
    let theirs = run.settings.get("volref").map_or("unknown", String::as_str);
    if theirs != version {
        let message = format!("these are results of volref {theirs}, and this is volref {version}");
        return Err(bad_input(message));
    }
    let mut cases = Vec::new();
    for (name, hash) in &run.cases {
        let case = suite.case(name);
        if case.map(|case| suite.hash_of(case)).unwrap_or_default() != *hash {
            let message = format!(
                "the parts judged by another suite: the scene, manifest or golden of {name} is not the one here"
            );
            let help = "give the suite that they judged by with --suite DIR";
            return Err(Failure::new(Exit::BadInput, message, Some(help)));
        }
        cases.extend(case);
    }
    Ok(cases)
}

/// The self-test of all parts, as on one machine with all `cases`. Where parts are missing, a
/// mistake that is not caught may be caught by one of them.
fn joined_self_test(
    arguments: &Arguments,
    suite: &Suite,
    of: &Parts<'_>,
) -> Result<Outcome, Failure> {
    arguments.files.check_no_results()?;
    let (run, cases) = (&of.run, cases_of(&of.run, suite)?);
    let mut of_cases: BTreeMap<&str, CaseTrials> = BTreeMap::new();
    for trials in of.parts.iter().flat_map(|(part, _)| &part.trials) {
        let name = trials.case.as_str();
        let both = match of_cases.remove(name) {
            None => trials.clone(),
            Some(one) => one.with(trials.clone()),
        };
        of_cases.insert(name, both);
    }
    let (mut found, mut missing) = (Vec::new(), Vec::new());
    for (name, _) in &run.cases {
        match of_cases.remove(name.as_str()) {
            Some(trials) => found.push(trials),
            None => missing.push((name, &of.missing)),
        }
    }
    let which = SelfTestCases::of(missing.is_empty(), run.is_everything);
    let test = SelfTest::of(&cases, &found, which);
    let mut value = report::self_test_json(&test);
    if !missing.is_empty() {
        let names: Vec<&String> = missing.iter().map(|(name, _)| *name).collect();
        value["missing"] = json!(names);
    }
    let text = report::self_test_text(&test) + &missing_text(&missing, run.cases.len());
    let undecided = (!missing.is_empty()).then_some(Exit::Undecided);
    Ok(Outcome {
        text: arguments.files.json.instead_of(text, &value)?,
        exit: Exit::first_of([selftest::exit_of(&test)].into_iter().chain(undecided)),
    })
}

/// Reason of a case without a result.
const NO_RESULT: &str =
    "no part wrote a result: run its part, or give merge the folder of its --results";

/// List of the cases without a result, and the reasons.
fn missing_text(missing: &[(&String, &String)], all: usize) -> String {
    let Some((_, reason)) = missing.first() else {
        return String::new();
    };
    let count = missing.len();
    let mut text = format!("\nmissing: {count} of {all} cases: {reason}\n");
    for (name, _) in missing {
        text.push_str(&format!("  {name}\n"));
    }
    text
}

/// The verdict on a case without a result.
fn without_result(name: &str, case: Option<&Case>, reason: &str) -> Judged {
    let result = CaseResult::new(Verdict::Missing, Cause::Undecided, reason);
    Judged {
        result: match case {
            Some(case) => result.of_case(name, case.class(), case.gate()),
            None => result.of_case(name, "", Gate::Exact),
        },
        evidence: case.map(Evidence::of).unwrap_or_default(),
    }
}
