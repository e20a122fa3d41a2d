//! Errors in loading volumes.

use crate::geometry::{InvalidParameter, ObjFault};
use std::io;
use std::path::PathBuf;
use thiserror::Error;

/// Reason why a volume could not be loaded. The message begins with the path, and with line and
/// column if there are any.
#[derive(Debug, Error)]
#[error("{}:{}{fault}", path.display(), if let VolumeFault::Line(_) = fault { "" } else { " " })]
pub struct VolumeError {
    /// The file.
    pub path: PathBuf,
    /// The fault.
    pub fault: VolumeFault,
}

/// A mistake in a volume file, and how to mend it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum VolumeFault {
    /// In the file as a whole, or in its header.
    #[error("{0}")]
    File(String),
    /// In a line of the file, whose number the message begins with.
    #[error("{0}")]
    Line(String),
}

/// The refusal of a file for a reason.
pub(super) fn refused<T>(reason: impl Into<VolumeFault>) -> Result<T, VolumeFault> {
    Err(reason.into())
}

impl From<String> for VolumeFault {
    fn from(message: String) -> VolumeFault {
        VolumeFault::File(message)
    }
}

impl From<&str> for VolumeFault {
    fn from(message: &str) -> VolumeFault {
        VolumeFault::File(message.to_owned())
    }
}

impl From<ObjFault> for VolumeFault {
    fn from(fault: ObjFault) -> VolumeFault {
        match fault.position {
            Some(_) => VolumeFault::Line(fault.to_string()),
            None => VolumeFault::File(fault.message),
        }
    }
}

impl From<InvalidParameter> for VolumeFault {
    fn from(error: InvalidParameter) -> VolumeFault {
        VolumeFault::File(error.message)
    }
}

impl From<io::Error> for VolumeFault {
    fn from(error: io::Error) -> VolumeFault {
        VolumeFault::File(format!("cannot be read: {error}"))
    }
}
