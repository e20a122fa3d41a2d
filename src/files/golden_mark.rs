//! Recognises goldens by the provenance beside them. Only `volref accept` changes goldens, in whatever folder they are.

use super::file_kind::stand_in;
use super::regular_file;
use std::io;
use std::path::{Path, PathBuf};

/// Longest provenance read: 1 MiB, as of any manifest.
const MOST_BYTES: u64 = 1 << 20;

/// Beginning of a line in every provenance.
const MARK: &str = "schema = \"volref/golden/";

/// Folder of the sensitivities among the goldens, whose provenance is that of the image.
const SENSITIVITIES: &str = "sensitivities";

/// Fails if the file at `path` is a golden: an image, its preview, its provenance or its sensitivities.
pub(crate) fn check(path: &Path) -> io::Result<()> {
    if path.exists() && (has_mark(&path.with_extension("toml")) || is_sensitivity(path)) {
        return Err(io::Error::other(
            "it is a golden, and only `volref accept` changes goldens: choose another place",
        ));
    }
    Ok(())
}

/// A golden in `folder` or in a folder of it, if there is one: outputs written there would be taken for goldens.
pub(crate) fn golden_within(folder: &Path) -> Option<PathBuf> {
    let entries = |folder: &Path| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path())
    };
    let families = entries(folder).filter(|path| path.is_dir());
    let mut files = entries(folder).chain(families.flat_map(|family| entries(&family)));
    files.find(|path| path.extension().is_some_and(|it| it == "toml") && has_mark(path))
}

fn has_mark(provenance: &Path) -> bool {
    // Not as an input, which nothing replaces: it may be a scene that is saved again.
    regular_file::read_unnoted(provenance, MOST_BYTES).is_ok_and(|bytes| {
        let text = String::from_utf8_lossy(&bytes);
        // What stands in for a file that is elsewhere may stand in for a provenance.
        text.lines().any(|line| line.starts_with(MARK)) || stand_in(&bytes).is_some()
    })
}

/// `sensitivities/FAMILY/CASE.exr` beside `FAMILY/CASE.toml`.
fn is_sensitivity(path: &Path) -> bool {
    let Some(family) = path.parent() else {
        return false;
    };
    let is_in_theirs = |folder: &&Path| folder.ends_with(SENSITIVITIES);
    let goldens = family.parent().filter(is_in_theirs).and_then(Path::parent);
    let inner = family.file_name().zip(path.file_stem());
    goldens.zip(inner).is_some_and(|(goldens, (family, name))| {
        let mut file = goldens.join(family).join(name).into_os_string();
        file.push(".toml");
        has_mark(Path::new(&file))
    })
}
