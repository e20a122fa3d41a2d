//! The repository's own suite, one named trial for each case: `cargo test --test golden
//! figure-3` verifies the case `figures/figure-3`.

use libtest_mimic::{Arguments, Failed, Trial};
use std::path::Path;
use volref::film::Film;
use volref::judging::{Verdict, verify};
use volref::suite::{Case, Store, Suite};

fn main() {
    let arguments = Arguments::from_args();
    // Found out by the sentinel, not here: a suite that cannot be opened must be a named failure.
    let suite = Suite::open(Path::new(env!("CARGO_MANIFEST_DIR")));
    let mut trials = vec![Trial::test("the-suite-has-cases", {
        let found = match &suite {
            Ok(suite) => suite
                .select(&[])
                .map(|cases| cases.len())
                .map_err(|error| error.to_string()),
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
    trials.push(Trial::test("scaled-scenes-have-the-same-bits", || {
        SAME_BITS.iter().try_for_each(|names| same_bits(names))
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

/// Cases of one picture: effects that are null, and all lengths times a power of two.
const SAME_BITS: [&[&str]; 4] = [
    &["s7-one-scattering", "a6-null-effects"],
    &["d13-narrow-peak", "a6-null-shading"],
    &["g8-two-bodies", "g8-scaled-up", "g8-scaled-down"],
    &["g8-shaded-hill", "g8-shaded-hill-up", "g8-shaded-hill-down"],
];

/// Whether the goldens of these cases of the family `hard`, each of which is verified by a trial of
/// its own, have the same pixels.
fn same_bits(names: &[&str]) -> Result<(), Failed> {
    let pixels = |name: &str| -> Result<String, Failed> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("golden/hard/{name}.exr"));
        let bytes = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Film::from_exr(&bytes)
            .map_err(|error| error.to_string())?
            .pixel_hash())
    };
    let first = pixels(names[0])?;
    for name in &names[1..] {
        if pixels(name)? != first {
            return Err(format!("hard/{name} has other pixels than hard/{}", names[0]).into());
        }
    }
    Ok(())
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
