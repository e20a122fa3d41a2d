//! What a report shows of a case beside its result.

use super::Case;
use crate::compare::Picture;
use crate::film::Film;

/// The images behind a result, and where they came from.
#[derive(Clone, Debug, Default)]
pub struct Evidence {
    /// What the image had to be; none where there is no golden that can be trusted.
    pub golden: Option<Film>,
    /// The image that was judged; none where there is none, or none that can be read.
    pub test: Option<Picture>,
    /// Whether there is an image at all: a row of the catalogue of hard cases has none.
    pub without_image: bool,
    /// Stops at which the images are shown first.
    pub exposure: f64,
    /// Document and figure that the case reproduces.
    pub source: String,
    /// What one should see in a right image.
    pub shows: String,
    /// Exactly what is computed.
    pub computes: String,
    /// Facts about the golden and the image, name and value, to be read by people.
    pub provenance: Vec<(String, String)>,
    /// Commands that repeat the judgement, one to a line.
    pub reproduce: Vec<String>,
    /// How the other renderer was called, if it was run.
    pub call: Option<String>,
    /// What the other renderer wrote to its standard output and error, if it was run.
    pub output: Option<String>,
}

impl Evidence {
    /// What is known of `case` before anything was rendered or read.
    pub fn of(case: &Case) -> Evidence {
        Evidence {
            exposure: case.exposure,
            source: case.source.clone(),
            shows: case.shows.clone(),
            computes: case.computes.clone(),
            ..Evidence::default()
        }
    }
}

/// A mistake that images look like, over all the cases that failed.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Likeness {
    /// Its name in the catalogue; two joined by ` + ` for a combination.
    pub mistake: String,
    /// What is wrong and where to look, for whoever made the image.
    pub advice: String,
    /// Failed cases that it explains.
    pub explains: usize,
    /// Failed cases that it was held against.
    pub of: usize,
    /// Names of those that it explains.
    pub cases: Vec<String>,
    /// How likely it is beside the next one, where both explain the same cases: a sentence without
    /// its subject, for people.
    #[serde(skip)]
    pub beside_the_next: Option<String>,
}
