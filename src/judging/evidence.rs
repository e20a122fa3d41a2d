//! Contents of a report on a case beside its result.

use crate::compare::Picture;
use crate::film::Film;
use crate::suite::Case;
use serde::{Deserialize, Serialize};

/// The images behind a result, and their origin.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Evidence {
    /// The golden; `None` if there is no trustworthy one.
    #[serde(skip)]
    pub golden: Option<Film>,
    /// The image that was judged; `None` if it is missing or unreadable.
    #[serde(skip)]
    pub test: Option<Picture>,
    /// The image with the step of the scene, if that which was judged has a smaller one.
    #[serde(skip)]
    pub at_step: Option<Film>,
    /// Initial exposure of the images, in stops.
    pub exposure: f64,
    /// Document and figure that the case reproduces.
    pub source: String,
    /// Features of a correct image.
    pub shows: String,
    /// Exactly what is computed.
    pub computes: String,
    /// Facts about the golden and the image, name and value, for people.
    pub provenance: Vec<(String, String)>,
    /// Commands that repeat the judgement, one to a line.
    pub reproduce: Vec<String>,
    /// Command line of the other renderer, if it was run.
    pub call: Option<String>,
    /// Standard output and error of the other renderer, if it was run.
    pub output: Option<String>,
    /// Wall time of the other renderer, if it was run.
    #[serde(default)]
    pub rendering_seconds: Option<f64>,
    /// True if the search for conventions, or for what is plainer, ended at the limit of its work.
    #[serde(default)]
    pub conventions_are_open: bool,
    /// Work of the search for conventions, in events of kernels.
    #[serde(default)]
    pub work_of_search: u64,
}

impl Evidence {
    /// The evidence on `case` before anything is rendered or read.
    pub fn of(case: &Case) -> Evidence {
        Evidence {
            exposure: case.exposure,
            source: case.source.clone(),
            shows: case.shows.clone(),
            computes: case.computes.clone(),
            ..Evidence::default()
        }
    }

    /// Radiance of the image with the step of the scene; `None` if there is no image.
    pub fn image(&self) -> Option<Film> {
        let test = self.test.as_ref();
        let of_test = || test.map(|picture| picture.film(self.exposure));
        self.at_step.clone().or_else(of_test)
    }
}

/// A likely mistake, over all the cases that failed.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct LikelyMistake {
    /// Its name in the catalogue; two joined by ` + ` for a combination.
    pub mistake: String,
    /// Description and advice for the author of the image.
    pub advice: String,
    /// Failed cases that it explains.
    pub explains: usize,
    /// Failed cases that it was compared with.
    pub of: usize,
    /// Names of the cases that it explains.
    pub cases: Vec<String>,
}
