//! Errors for invalid parameters.

use std::fmt;
use thiserror::Error;

/// A parameter outside its domain.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{message}")]
pub struct InvalidParameter {
    /// The parameter.
    pub name: &'static str,
    /// Its domain, and the value given.
    pub message: String,
}

/// Refuses the parameter `name`, with a message, unless its condition holds.
pub(crate) fn require(
    holds: bool,
    name: &'static str,
    message: fmt::Arguments,
) -> Result<(), InvalidParameter> {
    if holds {
        return Ok(());
    }
    let message = message.to_string();
    Err(InvalidParameter { name, message })
}
