//! Files in formats that are not read, and those whose name belongs to another format.

use super::source::ends_in;
use std::path::Path;

/// Remedy for formats of scanners and of medical software.
const CONVERT: &str = "write the volume as one .nii or .nrrd, as by `nibabel.save` or \
                       `SimpleITK.WriteImage`";

/// Remedy for compressed files.
const UNPACK: &str = "unpack the file, as by `gunzip`";

/// Remedy for point clouds.
const POINTS: &str = "write the points to an .obj, each as a line `v x y z`";

/// Endings of files that are not read, and the remedy.
const ENDINGS: [(&str, &str); 13] = [
    (
        ".nrrd.gz",
        "unpack the file, as by `gunzip`; the format compresses by `encoding: gzip`",
    ),
    (".obj.gz", UNPACK),
    (".vol.gz", UNPACK),
    (".hdr", CONVERT),
    (".img", CONVERT),
    (".mha", CONVERT),
    (".mhd", CONVERT),
    (
        ".raw",
        "describe the samples by a .toml with the keys `file`, `type`, `endian` and `nodes`",
    ),
    (
        ".raw.gz",
        "describe the samples by a .toml with the keys `file`, `type`, `endian`, `nodes`, and \
         `encoding = \"gzip\"`",
    ),
    (".dcm", CONVERT),
    (".xyz", POINTS),
    (".ply", POINTS),
    (".pcd", POINTS),
];

/// The remedy for a file at `path`, whose ending no format has.
pub(super) fn remedy(path: &Path) -> Option<&'static str> {
    let found = ENDINGS.iter().find(|(ending, _)| ends_in(path, ending));
    found.map(|(_, remedy)| *remedy)
}

/// The fault of the file at `path`, which the format of its name cannot read, if its `first` bytes
/// are those of another format.
pub(super) fn misnamed(path: &Path, first: &[u8]) -> Option<String> {
    let any = |endings: &[&str]| endings.iter().any(|ending| ends_in(path, ending));
    let rename = |ending| format!("rename it, so that it ends in {ending}");
    let begins = |magic: &[u8]| first.starts_with(magic);
    let (like, remedy) = if begins(&[0x1f, 0x8b, 8]) && !any(&[".nii.gz"]) {
        let nifti = any(&[".nii"]);
        let remedy = if nifti {
            rename(".nii.gz")
        } else {
            UNPACK.to_owned()
        };
        ("gzip", remedy)
    } else if begins(b"NRRD000") && !any(&[".nrrd", ".nhdr"]) {
        ("NRRD", rename(".nrrd"))
    } else if first.get(344..348) == Some(b"n+1\0") && !any(&[".nii"]) {
        ("NIfTI-1", rename(".nii"))
    } else if begins(b"VOL\x03") && !any(&[".vol"]) {
        ("Mitsuba volume", rename(".vol"))
    } else if begins(b"ObjectType") && !any(&[".obj"]) {
        ("MetaImage", CONVERT.to_owned())
    } else if begins(b"\x93NUMPY") && !any(&[".npy"]) {
        ("NumPy", rename(".npy"))
    } else {
        return None;
    };
    Some(format!(
        "the file begins like a {like} file, which its name does not say: {remedy}"
    ))
}
