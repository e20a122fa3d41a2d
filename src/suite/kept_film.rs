//! Films that one process keeps for another.

use super::kept_file::{self, KeepError};
use crate::film::Film;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::Path;

/// The film that was kept at `path`, and the head of its file.
///
/// # Errors
///
/// Fault of a file: a sentence without its subject.
pub(super) fn read<H: DeserializeOwned>(path: &Path) -> Result<(H, Film), String> {
    let (head, exr) = kept_file::read(path)?;
    let film = Film::from_exr(&exr).map_err(|error| error.to_string())?;
    Ok((head, film))
}

/// Keeps `film` as the file `inner` of the folder `root`, behind a head; how many bytes that takes.
///
/// # Errors
///
/// If it cannot be written.
pub(super) fn write(
    root: &Path,
    inner: &Path,
    head: &impl Serialize,
    film: &Film,
) -> Result<u64, KeepError> {
    let exr = film
        .to_exr()
        .map_err(|error| KeepError::encode(&root.join(inner), error))?;
    kept_file::write(root, inner, head, &exr)
}
