//! Named runs of `validate` beside each other, such as those of the tests of one session.

use super::Outcome;
use super::failure::{Exit, Failure, bad_input, exit};
use super::kept::NAME;
use super::results::{Findings, ResultFiles};
use super::verdicts::PrintedVerdicts;
use crate::compare::{Exact, Gate};
use crate::conventions::Profile;
use crate::judging::{CaseFinding, CaseResult, Cause, Evidence, Judged, JudgedWith, Verdict};
use crate::naming::Likenesses;
use crate::report;
use crate::runs::{KeptResult, ResultFolder, Run};
use crate::suite::{Case, Suite};
use std::collections::BTreeMap;
use std::time::Instant;

/// The results of all `runs`, each with its name and its folder, as each run left them: no cause is looked for again.
/// A case that several runs judged has the name of its run behind its own.
pub fn side_by_side(
    runs: &BTreeMap<String, (Run, ResultFolder)>,
    suite: &Suite,
    files: &ResultFiles,
) -> Result<Outcome, Failure> {
    let mut found: Vec<(&str, Judged)> = Vec::new();
    let mut loosened = Vec::new();
    for (id, (run, folder)) in runs {
        let profile = profile_of(run)?;
        cases_of(run, suite)?;
        let name = run.settings.get(NAME).map_or("", String::as_str);
        let (mut judged, mut skipped) = (Vec::new(), Vec::new());
        for (case, _) in &run.cases {
            let without = |reason: &str| Box::new(without_result(case, suite.case(case), reason));
            match folder.get(id, case, |_| files.wants_evidence()) {
                KeptResult::Judged(found) => judged.push(found),
                KeptResult::PassedOver => skipped.push((case.clone(), String::new())),
                KeptResult::Damaged(reason) => judged.push(without(&reason)),
                KeptResult::Missing => judged.push(without(NO_RESULT)),
            }
        }
        let results: Vec<CaseResult> = judged.iter().map(|of| of.result.clone()).collect();
        let settings = &run.settings;
        loosened.push(JudgedWith::of(
            settings,
            profile.as_ref(),
            skipped,
            &results,
        ));
        found.extend(judged.into_iter().map(|judged| (name, *judged)));
    }
    let judged = in_order(found, suite);
    let results: Vec<CaseResult> = judged.iter().map(|of| of.result.clone()).collect();
    let said = PrintedVerdicts {
        speaks: !files.prints_json(),
        widest: report::widest(results.iter().map(|result| &result.name)),
        folds_missing: false,
        waits: false,
    };
    results.iter().for_each(|result| said.verdict(result));
    said.print(&report::summary_text(&results));
    let judged_with = JudgedWith::of_runs(loosened);
    said.print(&report::judged_with_text(&judged_with));
    let causes = Likenesses::of_results(&results);
    let text = report::likely_text(&causes, false, 0.0);
    let findings = Findings {
        command: "validate",
        has_known: results.iter().any(|result| result.known.is_some()),
        judged,
        found: causes,
        judged_with,
        units: None,
        origin: None,
    };
    Ok(Outcome {
        text: files.write(findings, text)?,
        exit: exit(&results),
    })
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

/// The profile under which `run` judged.
pub fn profile_of(run: &Run) -> Result<Option<Profile>, Failure> {
    let text = run.settings.get("profile");
    let profile = text.map(|text| Profile::parse(text, "the profile of the results"));
    Ok(profile.transpose()?)
}

/// The cases of `run`, if this program and this `suite` judged them.
pub fn cases_of<'s>(run: &Run, suite: &'s Suite) -> Result<Vec<&'s Case>, Failure> {
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

/// Reason of a case without a result.
pub const NO_RESULT: &str = "no result: its part was not run, did not end, or wrote elsewhere";

/// The verdict on a case without a result.
pub fn without_result(name: &str, case: Option<&Case>, reason: &str) -> Judged {
    let finding = CaseFinding::new(Verdict::Missing, Cause::Undecided, reason);
    let (class, gate): (_, &'static dyn Gate) = match case {
        Some(case) => (case.class(), case.gate()),
        None => ("", &Exact),
    };
    Judged {
        result: CaseResult {
            seconds: 0.0,
            ..finding.result(name, class, gate, Instant::now())
        },
        evidence: Evidence {
            without_image: true,
            ..case.map(Evidence::of).unwrap_or_default()
        },
    }
}
