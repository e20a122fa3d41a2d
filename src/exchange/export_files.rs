//! Files of an exported scene.

use crate::files::partial_file;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// A scene in another format: files by names relative to one folder.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// The main file, for the command line of the other renderer; one of `files`.
    pub main: String,
    /// Every file with its contents. No name leads out of the folder.
    pub files: Vec<(String, Vec<u8>)>,
}

impl Export {
    /// All files or none: they are written under temporary names in `folder`, then renamed, the main one
    /// last. A folder made for them stays, empty, if this fails.
    pub fn write_into(&self, folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let mut files = self.files.iter();
        if let Some((name, _)) = files.find(|(name, _)| folder.join(name).is_dir()) {
            return Err(io::Error::other(format!("{name} is a folder")));
        }
        let mut aside = Vec::new();
        for (name, bytes) in &self.files {
            let mut file = partial_file::create(folder)?;
            file.as_file_mut().write_all(bytes)?;
            file.as_file().sync_all()?;
            aside.push((name, file));
        }
        aside.sort_by_key(|(name, _)| **name == self.main);
        for (name, file) in aside {
            file.persist(folder.join(name))?;
        }
        Ok(())
    }
}
