//! Films that one process keeps for another.

use crate::files::kept_file;
use crate::files::kept_file::KeepError;
use crate::film::Film;
use serde::Serialize;
use std::path::Path;

/// The film of `size`, columns and rows, in the contents of such a file.
///
/// # Errors
///
/// Fault of a file: a sentence without its subject.
pub(crate) fn film_of(exr: &[u8], size: [usize; 2]) -> Result<Film, String> {
    // Radiance, opacity, variance and samples, of four bytes each.
    let most = size
        .iter()
        .fold(8 * 4, |bytes, &side| side.saturating_mul(bytes));
    let film = Film::from_exr_within(exr, most as u64).map_err(|error| error.to_string())?;
    let [width, height] = [film.width(), film.height()];
    if [width, height] != size {
        return Err(format!(
            "its image has {width} × {height} pixels in place of {} × {}",
            size[0], size[1]
        ));
    }
    Ok(film)
}

/// Keeps `film` as the file `inner` of the folder `root`, behind a head; how many bytes that takes.
///
/// # Errors
///
/// If it cannot be written.
pub(crate) fn write(
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
