//! Images of a renderer that are kept in a folder of the user: those of a case as the last call wrote them.

use crate::files::atomic_file::directory_of;
use crate::files::{golden_mark, own_file, partial_file, regular_file};
use crate::suite::{OutputError, Outputs, entries};
use std::error::Error;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A folder in which images are kept.
#[derive(Debug)]
pub(crate) struct KeptImages {
    /// Path of the folder, absolute.
    pub folder: PathBuf,
    /// `family/name` of all cases of the suite, which decide what case a file belongs to.
    pub cases: Vec<String>,
}

impl KeptImages {
    /// Makes the folder for the image `name`, `family/name`; fails where a link leads elsewhere.
    pub fn make_folder(&self, name: &Path) -> io::Result<PathBuf> {
        own_file::make_folder(&self.folder, directory_of(name))
    }

    /// Copies all that was written into the folder `written`, and removes what else there was of `case`. Files
    /// behind links are copied, too, for they need not stay.
    pub fn replace_by_folder(&self, case: &str, written: &Path) -> Result<(), Box<dyn Error>> {
        let files = files_in(written)?;
        let read = files.into_iter().filter_map(|file| {
            // The verdict tells an image that cannot be read.
            let bytes = regular_file::read_any(&file, regular_file::MOST_BYTES).ok()?;
            Some((file.strip_prefix(written).ok()?.to_owned(), bytes))
        });
        self.replace(case, read)
    }

    /// Replaces the images of `case` by `files`, whose paths are relative to the folder. All are written aside
    /// before any is replaced: on a full disk nothing is lost, and whoever is killed meanwhile leaves too few images,
    /// never those of two runs.
    pub fn replace(
        &self,
        case: &str,
        files: impl IntoIterator<Item = (PathBuf, Vec<u8>)>,
    ) -> Result<(), Box<dyn Error>> {
        let mut aside = Vec::new();
        for (name, bytes) in files {
            let folder = self.make_folder(&name)?;
            let target = folder.join(name.file_name().unwrap_or_default());
            if regular_file::is_input(&target) {
                return Err(format!("{} is an input", target.display()).into());
            }
            golden_mark::check(&target)?;
            let mut file = partial_file::create(directory_of(&target))?;
            file.write_all(&bytes)?;
            file.as_file().sync_all()?;
            aside.push((file, target));
        }
        for old in self.of_case(case)? {
            own_file::remove(&old)?;
        }
        for (file, target) in aside {
            file.persist(target)?;
        }
        Ok(())
    }

    /// The files of `case` that are there, and links in their place.
    fn of_case(&self, case: &str) -> Result<Vec<PathBuf>, Box<dyn Error>> {
        let cases: Vec<&str> = self.cases.iter().map(String::as_str).collect();
        let outputs = Outputs::list(&self.folder, &cases)?;
        let is_removed = |file: &&Path| {
            let kind = fs::symlink_metadata(file).map(|found| found.file_type());
            kind.is_ok_and(|kind| kind.is_file() || kind.is_symlink())
                && !regular_file::is_input(file)
        };
        let files = outputs.files_of(case).filter(is_removed);
        Ok(files.map(Path::to_owned).collect())
    }
}

/// The files in `folder`, and in the folders in it.
pub(crate) fn files_in(folder: &Path) -> Result<Vec<PathBuf>, OutputError> {
    let mut files = Vec::new();
    for (entry, is_folder) in entries(folder)? {
        if !is_folder {
            files.push(entry);
        } else if !entry.is_symlink() {
            let within = entries(&entry)?.into_iter();
            files.extend(within.filter_map(|(file, is_folder)| (!is_folder).then_some(file)));
        }
    }
    Ok(files)
}
