//! Files in formats that are not read, and those whose name belongs to another format.

use crate::files::file_kind::{FileKind, by_bytes, by_name};
use crate::files::regular_file;
use std::path::Path;

/// True if files of that name are read as volumes.
type IsRead = fn(&Path) -> bool;

/// The remedy for the file at `path`, whose ending no format has: by its name, else by its first bytes.
pub(super) fn remedy(path: &Path, is_read: IsRead) -> Option<String> {
    if let Some(remedy) = by_name(path).and_then(|kind| kind.as_volume) {
        return Some(remedy.to_owned());
    }
    let kind = by_bytes(&regular_file::first_bytes_of(path)?)?;
    Some(format!(
        "it begins like {}: {}",
        kind.name,
        way_out(kind, is_read)
    ))
}

/// The fault of the file at `path`, which the format of its name cannot read, if its `first` bytes
/// are those of another format.
pub(super) fn misnamed(path: &Path, first: &[u8], is_read: IsRead) -> Option<String> {
    let kind = by_bytes(first).filter(|kind| !kind.is_name(path))?;
    let remedy = match path.extension() {
        Some(nii) if nii.eq_ignore_ascii_case("nii") && first.starts_with(&[0x1f, 0x8b]) => {
            rename(".nii.gz")
        }
        _ => way_out(kind, is_read),
    };
    Some(format!(
        "the file begins like {}, which its name does not say: {remedy}",
        kind.name
    ))
}

/// What to do with a file of that kind to have a volume.
fn way_out(kind: &FileKind, is_read: IsRead) -> String {
    let mut endings = kind.endings.iter();
    let ending = endings.find(|ending| is_read(Path::new(&format!("a{ending}"))));
    match (kind.as_volume, ending) {
        (Some(remedy), _) => remedy.to_owned(),
        (None, Some(ending)) => rename(ending),
        (None, None) => "it holds no volume; give the file that does".to_owned(),
    }
}

fn rename(ending: &str) -> String {
    format!("rename it, so that it ends in {ending}")
}
