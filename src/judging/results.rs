//! Results of cases.

use super::known::{Known, KnownStatus};
use crate::compare::{self, Detectable, Gate, Metric, NumberChange};
use crate::suite::OF_TOLERANCE;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The metric of a stochastic case beside those of the gate.
pub(crate) const SAME_BITS: Metric = (
    "same_bits",
    "1 if every bit is that of the reference's own quick rendering, else 0.",
);

/// The verdict on a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Compared, and right.
    #[default]
    Pass,
    /// Compared, and wrong.
    Fail,
    /// Compared, and right under other conventions.
    Convention,
    /// Compared, and not decided.
    Inconclusive,
    /// There is nothing to compare with.
    Missing,
    /// The comparison could not be made.
    Error,
}

impl Verdict {
    /// All of them, with the word used in JSON and on the terminal, and the one after a number of cases.
    pub(crate) const ALL: [(Verdict, &str, &str); 6] = [
        (Verdict::Pass, "pass", "passed"),
        (Verdict::Fail, "fail", "failed"),
        (Verdict::Convention, "convention", "by convention"),
        (Verdict::Inconclusive, "inconclusive", "inconclusive"),
        (Verdict::Missing, "missing", "missing"),
        (Verdict::Error, "error", "errors"),
    ];

    /// The word used in JSON and on the terminal.
    pub fn name(self) -> &'static str {
        Verdict::ALL[self as usize].1
    }

    /// The number of `results` with this verdict.
    pub(crate) fn count(self, results: &[CaseResult]) -> usize {
        results.iter().filter(|it| it.verdict == self).count()
    }
}

/// Cause of a verdict other than `pass`. Later ones take precedence, as exit codes do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Cause {
    /// No cause: the case passed.
    #[default]
    None,
    /// The images are too noisy to decide.
    Undecided,
    /// The other renderer: its image is missing or unreadable, or it failed.
    OtherRenderer,
    /// The images differ by conventions.
    Convention,
    /// The images differ.
    Mismatch,
    /// The golden is missing, stale or changed.
    Golden,
    /// The scene or its files are invalid.
    BadInput,
}

/// The outcome of one case.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CaseResult {
    /// `family/name`.
    pub name: String,
    /// Family.
    pub family: String,
    /// Class of the case.
    pub class: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Numbers by name, all finite.
    pub metrics: BTreeMap<String, f64>,
    /// The rule applied.
    pub gate: Gate,
    /// Reason in words.
    pub reason: String,
    /// Notes beside the verdict.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Conventions of the other renderer under which the image is right, in words.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub conventions: Vec<String>,
    /// A profile of these conventions, TOML for `--as`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// Likely mistakes, most likely first.
    pub looks_like: Vec<String>,
    /// Measurements of a difference that no known mistake explains, in sentences.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub difference: Vec<String>,
    /// The scene, rendered with the change of parameters that `difference` states, agrees with the image.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub change_agrees: bool,
    /// Changes of numbers of the scene that the difference looks like.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<NumberChange>,
    /// Changes of numbers of the scene that the images would have shown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detectable: Vec<Detectable>,
    /// The reason says the cause, such as codes read in another way or an image without anything drawn: none is looked for.
    #[serde(skip)]
    pub cause_is_said: bool,
    /// True if the search for the cause of a difference came to its end, so that nothing else that is known explains it;
    /// false if there was none, or if a limit or Ctrl-C ended it. `None` where there was no cause to look for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search_ended: Option<bool>,
    /// Wall time, for information.
    pub seconds: f64,
    /// Units of work by name, where they were counted.
    pub work: BTreeMap<String, u64>,
    /// What a file of known failures says of it.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub known: Option<Known>,
    /// Cause of the verdict.
    #[serde(skip)]
    pub cause: Cause,
}

impl CaseResult {
    /// A result without numbers, of no case yet.
    pub fn new(verdict: Verdict, cause: Cause, reason: impl Into<String>) -> CaseResult {
        CaseResult {
            verdict,
            cause,
            reason: reason.into(),
            ..CaseResult::default()
        }
    }

    /// This result as that of a case of this name and class, judged by `gate`.
    pub(crate) fn of_case(self, name: &str, class: &str, gate: Gate) -> CaseResult {
        CaseResult {
            family: name.split('/').next().unwrap_or_default().to_owned(),
            name: name.to_owned(),
            class: class.to_owned(),
            gate,
            ..self
        }
    }

    /// The cause that counts for a run: none of a known failure, and a mismatch where the file of known failures is no
    /// longer right.
    pub fn counted_cause(&self) -> Cause {
        match &self.known {
            Some(known) if known.status == KnownStatus::Known => Cause::None,
            Some(known) if known.is_outdated() => self.cause.max(Cause::Mismatch),
            _ => self.cause,
        }
    }
}

/// Meaning of a metric of results, in a sentence; empty for an unknown one.
pub fn metric_meaning(name: &str) -> &'static str {
    let mut of_suite = [OF_TOLERANCE, SAME_BITS].into_iter();
    let found = of_suite.find(|(known, _)| *known == name);
    let meaning = found.map(|(_, meaning)| meaning);
    let meaning = meaning.or_else(|| compare::metric_meaning(name));
    meaning.unwrap_or_default()
}
