//! The repository's own suite, one named trial for each case: `cargo test --test golden
//! figure-3` verifies the case `figures/figure-3`.

use libtest_mimic::{Arguments, Failed, Trial};
use std::path::Path;
use volref::suite::{Case, Store, Suite, Verdict, verify};

fn main() {
    let arguments = Arguments::from_args();
    // Found out by the sentinel, not here: a suite that cannot be opened must be a named failure.
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR")));
    let mut trials = vec![Trial::test("the-suite-has-cases", {
        let found = match &suite {
            Ok(suite) => Ok(suite.cases().len()),
            Err(error) => Err(error.to_string()),
        };
        move || has_cases(found)
    })];
    trials.push(Trial::test("an-empty-suite-is-a-failure", || {
        let passed = [Ok(0), Err("no suite".to_owned())].map(|found| has_cases(found).is_ok());
        match passed {
            [false, false] => Ok(()),
            _ => Err("a run without cases passes".into()),
        }
    }));
    if let Ok(suite) = suite {
        let goldens = suite.golden_folder();
        trials.extend(suite.cases().iter().map(|case| {
            let (case, store) = (case.clone(), Store::open(&goldens));
            Trial::test(case.name.clone(), move || passes(&case, &store))
        }));
    }
    libtest_mimic::run(&arguments, trials).exit();
}

/// An empty run of trials would pass, and nobody would notice.
fn has_cases(found: Result<usize, String>) -> Result<(), Failed> {
    match found {
        Ok(0) => Err("fixtures/cases holds no case: nothing was verified".into()),
        Ok(_) => Ok(()),
        Err(message) => Err(message.into()),
    }
}

fn passes(case: &Case, store: &Store) -> Result<(), Failed> {
    let result = verify(case, store, &|| ()).result;
    match result.verdict {
        Verdict::Pass => Ok(()),
        verdict => Err(format!("{}: {}", verdict.name(), result.reason).into()),
    }
}
