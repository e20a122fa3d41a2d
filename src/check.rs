//! The suite inside the tests of another renderer.

use crate::compare::Picture;
use crate::film::Film;
use crate::judging::CaseResult;
use crate::judging::validate::validate;
use crate::naming::{ConventionSearch, Predictions, Search, diagnosis};
pub use crate::suite::SUITE_VARIABLE;
use crate::suite::{Output, Suite, SuiteError};
use std::path::{Path, PathBuf};
use std::time::Duration;

impl Suite {
    /// The suite of volref, or the one that the environment variable
    /// [`VOLREF_SUITE`](SUITE_VARIABLE) names.
    ///
    /// # Errors
    ///
    /// If the sources of volref are no longer where it was built, and no other suite is named.
    pub fn bundled() -> Result<Suite, SuiteError> {
        let named = std::env::var_os(SUITE_VARIABLE).map(PathBuf::from);
        Suite::open(&named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()))
    }
}

/// Judges `image`, linear radiance with the top row first, as an image of `case` of the
/// [bundled](Suite::bundled) suite, as `volref validate` would: verdict, numbers, the reason in
/// words, and the conventions or the likely mistakes behind a failing image. The search for these
/// takes up to [ten seconds](Search::BUDGET).
///
/// ```
/// use volref::film::Film;
/// use volref::judging::Verdict;
/// use volref::check::check;
///
/// # fn my_renderer(scene: &str, width: usize, height: usize) -> Film {
/// #     let golden = concat!(env!("CARGO_MANIFEST_DIR"), "/golden/figures/figure-2.exr");
/// #     Film::from_exr(&std::fs::read(golden).unwrap()).unwrap()
/// # }
/// let image: Film = my_renderer("the scene of the case", 256, 192);
/// let result = check("figures/figure-2", &image)?;
/// assert_eq!(result.verdict, Verdict::Pass, "{} {:?}", result.reason, result.looks_like);
/// # Ok::<(), volref::suite::SuiteError>(())
/// ```
///
/// Make your image by [`Film::new`] from the pixels; if each is a mean of random samples and you
/// know the variances of those means, by [`Film::with_noise`]; from several renderings with
/// different seeds by [`Film::from_replicates`].
///
/// # Errors
///
/// If there is no suite, or no such case in it. An untrustworthy golden is a verdict, not an error.
pub fn check(case: &str, image: &Film) -> Result<CaseResult, SuiteError> {
    check_within(case, image, Search::BUDGET.into())
}

/// [`check`], with `seconds` for the search: for conventions and the profiles that volref brings half of them, for mistakes
/// the rest.
///
/// # Errors
///
/// As of [`check`].
pub fn check_within(case: &str, image: &Film, seconds: f64) -> Result<CaseResult, SuiteError> {
    // Less than none, or no number, is none.
    let seconds = seconds.max(0.0);
    let suite = Suite::bundled()?;
    let cases = suite.select(&[case.to_owned()])?;
    let store = suite.store();
    let output = Output::Picture(Box::new(Picture::Radiance(image.clone())));
    let mut judged = [validate(cases[0], &store, output, None)];
    ConventionSearch::default().explain_mismatch(cases[0], &store, &mut judged[0], seconds, false);
    let search = Search {
        // Beyond any time, there is no limit.
        budget: Duration::try_from_secs_f64(seconds).ok(),
        // A test program is mostly built anew for every run, and finds nothing of the last.
        predictions: &Predictions::default(),
        interrupted: &|| false,
        progress: &|_| (),
    };
    diagnosis(&cases, None, &mut judged, &search);
    let [judged] = judged;
    Ok(judged.result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suite::Golden;

    #[test]
    fn any_number_of_seconds_is_a_limit_or_none() {
        let suite = Suite::bundled().unwrap();
        let case = suite.case("figures/figure-2").unwrap();
        let golden = Golden::read(&suite.store(), case).unwrap().film;
        for seconds in [-1.0, f64::INFINITY, f64::NAN] {
            let result = check_within(&case.name, &golden, seconds).unwrap();
            assert!(result.looks_like.is_empty(), "{seconds}: {}", result.reason);
        }
    }
}
