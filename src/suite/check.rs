//! The suite from within another renderer's own tests.

use super::validate::{Output, validate};
use super::{CaseResult, Predictions, Search, Suite, SuiteError, likeness};
use crate::compare::Picture;
use crate::film::Film;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Names the folder of a suite other than the one that comes with volref.
pub const SUITE_VARIABLE: &str = "VOLREF_SUITE";

impl Suite {
    /// The suite that comes with volref, or the one that the environment variable
    /// [`VOLREF_SUITE`](SUITE_VARIABLE) names.
    ///
    /// # Errors
    ///
    /// Where the sources of volref are not where it was built from, and no other suite is named.
    pub fn bundled() -> Result<Suite, SuiteError> {
        let named = std::env::var_os(SUITE_VARIABLE).map(PathBuf::from);
        Suite::open(&named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()))
    }
}

/// Judges `image`, linear radiance with the top row first, as an image of `case` of the
/// [bundled](Suite::bundled) suite, as `volref validate` would: verdict, numbers, the reason in
/// words, and the mistakes that a failing image looks like. To find those takes up to
/// [ten seconds](Search::BUDGET).
///
/// ```
/// use volref::film::Film;
/// use volref::suite::{Verdict, check};
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
/// Your image is a [`Film::new`] of the pixels, or, where each is a mean of random samples and you
/// know the variances of those means, a [`Film::with_noise`]; of several renderings with seeds of
/// their own, [`Film::from_replicates`].
///
/// # Errors
///
/// Where there is no suite, or no such case in it. A golden that cannot be trusted is a verdict.
pub fn check(case: &str, image: &Film) -> Result<CaseResult, SuiteError> {
    let suite = Suite::bundled()?;
    let cases = suite.select(&[case.to_owned()])?;
    let store = suite.store();
    let picture = Picture::Radiance(image.clone());
    let mut judged = [validate(
        cases[0],
        &store,
        Output::Picture(Box::new(picture)),
    )];
    let search = Search {
        budget: Some(Duration::from_secs(Search::BUDGET.into())),
        // What calls this is mostly built anew for every run, and finds nothing of the last.
        predictions: &Predictions::nowhere(),
        interrupted: &|| false,
        progress: &|_| (),
    };
    likeness(&cases, &[], &mut judged, &search);
    let [judged] = judged;
    Ok(judged.result)
}
