//! Files in formats that are not read, and those whose name belongs to another format.

use super::file::volume_format;
use crate::files::file_kind::{FileKind, by_bytes, by_name};
use crate::files::regular_file;
use std::path::Path;

/// The remedy for the file at `path`, whose ending no format has: by its name, else by its first bytes.
pub(super) fn remedy(path: &Path) -> Option<String> {
    if let Some(remedy) = by_name(path).and_then(|kind| kind.as_volume) {
        return Some(remedy.to_owned());
    }
    let kind = by_bytes(&regular_file::first_bytes_of(path)?)?;
    Some(format!("it begins like {}: {}", kind.name, way_out(kind)))
}

/// The fault of the file at `path`, which the format of its name cannot read, if its `first` bytes
/// are those of another format.
pub(super) fn misnamed(path: &Path, first: &[u8]) -> Option<String> {
    let kind = by_bytes(first).filter(|kind| !kind.is_name(path))?;
    let way_out = way_out(kind);
    let remedy = match path.extension() {
        Some(nii) if nii.eq_ignore_ascii_case("nii") && first.starts_with(&[0x1f, 0x8b]) => {
            rename(".nii.gz")
        }
        _ => way_out,
    };
    Some(format!(
        "the file begins like {}, which its name does not say: {remedy}",
        kind.name
    ))
}

/// What to do with a file of that kind to have a volume.
fn way_out(kind: &FileKind) -> String {
    let is_read = |ending: &&&str| volume_format(Path::new(&format!("a{ending}"))).is_some();
    let ending = kind.endings.iter().find(is_read);
    match (kind.as_volume, ending) {
        (Some(remedy), _) => remedy.to_owned(),
        (None, Some(ending)) => rename(ending),
        (None, None) => "it holds no volume; give the file that does".to_owned(),
    }
}

fn rename(ending: &str) -> String {
    format!("rename it, so that it ends in {ending}")
}
