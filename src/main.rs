//! The `volref` command, with the suite that it holds: here rather than in the library, so that a changed scene
//! or golden compiles this file again, and nothing else.

use include_dir::{Dir, DirEntry, include_dir};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

static FIXTURES: Dir = include_dir!("$CARGO_MANIFEST_DIR/fixtures");
static GOLDEN: Dir = include_dir!("$CARGO_MANIFEST_DIR/golden");

fn main() -> ExitCode {
    volref::cli::main(suite_files)
}

/// The files of the suite, with their paths relative to its root.
fn suite_files() -> Vec<(PathBuf, &'static [u8])> {
    let mut files = Vec::new();
    for (name, folder) in [("fixtures", &FIXTURES), ("golden", &GOLDEN)] {
        add_files(Path::new(name), folder, &mut files);
    }
    files
}

fn add_files(root: &Path, folder: &Dir<'static>, files: &mut Vec<(PathBuf, &'static [u8])>) {
    for entry in folder.entries() {
        match entry {
            DirEntry::Dir(folder) => add_files(root, folder, files),
            DirEntry::File(file) => files.push((root.join(file.path()), file.contents())),
        }
    }
}
