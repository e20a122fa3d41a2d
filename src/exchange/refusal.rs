//! Scenes that a format cannot express.

use super::Format;
use std::fmt::Display;
use thiserror::Error;

/// A scene that a format cannot express without changing it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{format} cannot represent {}", faults.join("; "))]
pub struct Refusal {
    /// The format.
    pub format: Format,
    /// All features it cannot express, at least one: the key in the scene, such as `radiative.medium[2]`, counted from 0,
    /// and what is wrong, with a way around it if there is one.
    pub faults: Vec<String>,
}

impl Refusal {
    /// A refusal for a single reason.
    pub fn of(format: Format, key: &str, what: &str) -> Refusal {
        let faults = vec![format!("{key}: {what}")];
        Refusal { format, faults }
    }
}

/// Collects all faults of a scene before it is refused.
#[derive(Default)]
pub(super) struct Faults(Vec<String>);

impl Faults {
    /// Records one.
    pub(super) fn add(&mut self, key: impl Display, what: impl Display) {
        self.0.push(format!("{key}: {what}"));
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
