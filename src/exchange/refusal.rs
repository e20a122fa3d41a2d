//! Scenes that a format cannot express.

use super::Format;
use thiserror::Error;

/// One feature that a format cannot express.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{key}: {what}")]
pub struct ExportFault {
    /// Its key in the scene, such as `radiative.medium[2]`, counted from 0.
    pub key: String,
    /// Description, with a way around it if there is one.
    pub what: String,
}

/// A scene that a format cannot express without changing it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{format} cannot represent {}", listed(faults))]
pub struct Refusal {
    /// The format.
    pub format: Format,
    /// All features it cannot express, at least one.
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
    /// Records one.
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
