//! Errors for invalid parameters.

use glam::DVec3;
use std::fmt;
use thiserror::Error;

/// A parameter outside its domain.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{message}")]
pub struct InvalidParameter {
    /// The parameter, by its key in a scene.
    pub name: &'static str,
    /// Its domain, and the value given.
    pub message: String,
}

impl InvalidParameter {
    /// A mistake in the parameter `name`.
    pub(crate) fn new(name: &'static str, message: impl Into<String>) -> InvalidParameter {
        let message = message.into();
        InvalidParameter { name, message }
    }
}

/// Refuses the parameter `name`, with a message, unless its condition holds.
pub(crate) fn require(
    holds: bool,
    name: &'static str,
    message: fmt::Arguments,
) -> Result<(), InvalidParameter> {
    match holds {
        true => Ok(()),
        false => Err(InvalidParameter::new(name, message.to_string())),
    }
}

/// Refuses the parameter `name` if `vector`, which the message calls `what`, is not finite.
pub(crate) fn require_finite(
    name: &'static str,
    what: &str,
    vector: DVec3,
) -> Result<(), InvalidParameter> {
    let message = format_args!("{what} must be finite, got {vector}");
    require(vector.is_finite(), name, message)
}
