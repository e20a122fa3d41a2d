//! The names a golden may have.

use serde::{Deserialize, Serialize};
use std::path::{Component, Path, PathBuf};

/// The lock file, under the golden root.
pub(super) const LOCK: &str = ".lock";
/// The journal of an accept that has been decided but not completed.
pub(super) const JOURNAL: &str = "accept.journal";
/// The journal of an accept that has not been decided.
pub(super) const DRAFT: &str = ".accept.journal.new";
/// Ends the names of staged files.
const STAGED: &str = ".volref-new";

/// A file under the golden root: a relative path in one spelling, with `/` on every platform,
/// that does not leave the root and is not one of the store's own files.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
#[serde(try_from = "String")]
pub(super) struct StoreName(String);

impl TryFrom<String> for StoreName {
    type Error = String;

    fn try_from(path: String) -> Result<StoreName, String> {
        let name = StoreName::new(Path::new(&path));
        name.map_err(|problem| format!("the path {path:?} is not allowed: {problem}"))
    }
}

impl StoreName {
    /// The name, or why the path cannot be one.
    pub(super) fn new(path: &Path) -> Result<StoreName, &'static str> {
        let mut parts = Vec::new();
        for component in path.components() {
            let part = match component {
                Component::Normal(part) => part.to_str().ok_or("it is not UTF-8")?,
                Component::CurDir => continue,
                Component::ParentDir => return Err("`..` could lead out of the golden directory"),
                Component::RootDir | Component::Prefix(_) => {
                    return Err("it is absolute, not relative to the golden directory");
                }
            };
            // A line of the journal is one name, and means the same path on every platform.
            if part.contains(|letter: char| letter.is_control() || letter == '\\') {
                return Err("it contains a control character or a backslash");
            }
            parts.push(part);
        }
        match parts[..] {
            [] => Err("it is empty"),
            [LOCK | JOURNAL | DRAFT] => Err("this name is one of the store's own"),
            [.., last] if last.ends_with(STAGED) => Err("this name is one of the store's own"),
            _ => Ok(StoreName(parts.join("/"))),
        }
    }

    /// The path relative to the golden root, with `/`.
    pub(super) fn as_str(&self) -> &str {
        &self.0
    }

    /// Path of the file.
    pub(super) fn under(&self, root: &Path) -> PathBuf {
        root.join(&self.0)
    }

    /// Path where the accept with this tag writes the file aside: `.figure-3.exr.TAG.volref-new` in
    /// the same directory.
    pub(super) fn staged_under(&self, root: &Path, tag: &str) -> PathBuf {
        let (directory, file) = self.0.rsplit_once('/').unwrap_or(("", &self.0));
        root.join(directory).join(format!(".{file}.{tag}{STAGED}"))
    }

    /// The directories from the file's own up to and including the root.
    pub(super) fn directories(&self, root: &Path) -> impl Iterator<Item = PathBuf> {
        Path::new(&self.0)
            .ancestors()
            .skip(1)
            .map(move |directory| {
                if directory.as_os_str().is_empty() {
                    root.into()
                } else {
                    root.join(directory)
                }
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_spelling_for_one_file() {
        assert_eq!(
            StoreName::new(Path::new("./a//b/./c.exr"))
                .unwrap()
                .as_str(),
            "a/b/c.exr"
        );
    }

    #[test]
    fn refuses_what_leaves_the_root_or_is_the_stores_own() {
        for path in [
            "",
            ".",
            "..",
            "a/../b",
            "../a",
            "/a",
            "a\nb",
            "a\\b",
            ".lock",
            "accept.journal",
            ".accept.journal.new",
            "./.lock",
            "a/.b.exr.1-2.volref-new",
        ] {
            assert!(StoreName::new(Path::new(path)).is_err(), "{path:?}");
        }
    }

    #[test]
    fn staged_beside_the_file() {
        let staged = |path| {
            StoreName::new(Path::new(path))
                .unwrap()
                .staged_under(Path::new("r"), "t")
        };
        assert_eq!(staged("a/b.exr"), Path::new("r/a/.b.exr.t.volref-new"));
        assert_eq!(staged("b.exr"), Path::new("r/.b.exr.t.volref-new"));
    }

    #[test]
    fn directories_reach_up_to_the_root() {
        let name = StoreName::new(Path::new("a/b/c.exr")).unwrap();
        let directories: Vec<PathBuf> = name.directories(Path::new("r")).collect();
        assert_eq!(directories, ["r/a/b", "r/a", "r"].map(PathBuf::from));
    }
}
