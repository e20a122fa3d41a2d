//! What a format has no words for.

use super::Format;
use std::fmt;
use thiserror::Error;

/// One thing that a format cannot say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportFault {
    /// Where it stands in the scene, such as `radiative.medium[2]`, counted from 0.
    pub key: String,
    /// What it is, and where there is a way around it, which.
    pub what: String,
}

impl fmt::Display for ExportFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.what)
    }
}

/// A scene that a format cannot say without changing it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{format} cannot say {}", listed(faults))]
pub struct Refusal {
    /// The format.
    pub format: Format,
    /// Everything it has no words for, at least one thing.
    pub faults: Vec<ExportFault>,
}

impl Refusal {
    /// A refusal for a single reason.
    pub fn of(format: Format, key: impl Into<String>, what: impl Into<String>) -> Refusal {
        let (key, what) = (key.into(), what.into());
        Refusal {
            format,
            faults: vec![ExportFault { key, what }],
        }
    }
}

fn listed(faults: &[ExportFault]) -> String {
    let faults: Vec<String> = faults.iter().map(ExportFault::to_string).collect();
    faults.join("; ")
}

/// Collects all faults of a scene before it is refused.
#[derive(Default)]
pub(super) struct Faults(Vec<ExportFault>);

impl Faults {
    /// Notes one.
    pub(super) fn add(&mut self, key: impl Into<String>, what: impl Into<String>) {
        let (key, what) = (key.into(), what.into());
        self.0.push(ExportFault { key, what });
    }

    /// `result`, unless there was a fault.
    pub(super) fn none<T>(self, format: Format, result: T) -> Result<T, Refusal> {
        if self.0.is_empty() {
            return Ok(result);
        }
        let faults = self.0;
        Err(Refusal { format, faults })
    }
}
