//! `volref verify [FILTER…]`

use super::failure::{EXIT_CODES, Failure, exit};
use super::kept::PartArguments;
use super::results::{Findings, ResultFiles};
use super::threads::Threads;
use super::{Outcome, output, progress};
use crate::judging;
use crate::judging::{CaseResult, Evidence, Verdict};
use crate::report;
use crate::suite::Case;
use std::collections::BTreeMap;

/// Render the suite and compare it with the goldens, bit for bit
#[derive(Debug, clap::Args)]
#[command(after_help = EXIT_CODES)]
pub struct Arguments {
    /// Families, cases, or patterns over them such as 'figures/*'; those with ! before them are left out
    /// [default: all]
    #[arg(value_name = "FILTER")]
    filters: Vec<String>,
    #[command(flatten)]
    part: PartArguments,
    /// List every case, including those that passed
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    files: ResultFiles,
    #[command(flatten)]
    threads: Threads,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    let (part, filters) = (&arguments.part, &arguments.filters);
    let suite = part.selection.open()?;
    arguments.files.check()?;
    let mut cases = suite.select(filters)?;
    let to_keep = part.kept(&suite, "verify", filters, &cases, BTreeMap::new())?;
    let name = |case: &&Case| case.name.clone();
    part.partition.retain(&mut cases, name)?;
    let store = suite.store();
    let shows = to_keep.is_some() || arguments.files.page.is_asked();
    let mut judged = arguments.threads.run(|| {
        let bar = progress::counted(cases.len());
        let verified = cases.iter().map(|case| {
            bar.set_message(case.name.clone());
            let mut judged = judging::verify(case, &store, &bar);
            if !shows {
                judged.evidence = Evidence::default();
            }
            bar.end_part();
            judged
        });
        verified.collect::<Vec<_>>()
    })?;

    for judged in &mut judged {
        let again = part.selection.again("verify", &judged.result.name, &[]);
        judged.evidence.reproduce = vec![again];
    }
    let names: Vec<String> = cases.iter().map(name).collect();
    let kept = to_keep.map_or(Ok(()), |kept| kept.keep(&names, &judged, &[]));
    if filters.is_empty() && part.partition.is_first() {
        judged.extend(judging::without_case(&suite)?);
    }
    let findings = Findings {
        command: "verify",
        judged,
        ..Findings::default()
    };
    let results = findings.results();
    let text = in_words(&results, arguments.verbose);
    if let Err(failure) = kept {
        // The verdicts hold all the same.
        output::print(&text);
        return Err(failure);
    }
    Ok(Outcome {
        text: arguments.files.write(findings, text)?,
        exit: exit(&results),
    })
}

/// Results for the terminal: every case, or those that passed by their families.
pub fn in_words(results: &[CaseResult], is_verbose: bool) -> String {
    let text = if is_verbose {
        report::results_text(results)
    } else {
        report::families_text(results)
    };
    let failed = |result: &&CaseResult| result.verdict == Verdict::Fail;
    match results.iter().find(failed) {
        Some(failed) => format!(
            "{text}\nTo see what changed:\n  volref verify {} --report report\n",
            failed.name
        ),
        None => text,
    }
}
