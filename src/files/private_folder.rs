//! Private folders: only the user or root can change them, so that a file is still the checked one
//! when it is read.

use super::own_file;
use std::io;
use std::path::Path;

/// Creates the folder `inner` of `root` where it is missing, for the user alone. `root` itself may be a link: it is the
/// user's, and keeps its rights.
///
/// # Errors
///
/// A sentence with a remedy, if others could change the folder, or put another into its place: by being
/// the owner of a folder or link on the way to it, or by a right to write there. Links below `root` are refused.
#[cfg(unix)]
pub(crate) fn make(root: &Path, inner: &Path) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    const MOST_LINKS: u32 = 40; // as Linux
    own_file::check_folder(root, inner)?;
    let folder = std::path::absolute(root.join(inner))?;
    let found = unix::way_to(&folder, MOST_LINKS)?;
    // On the way, the sticky bit keeps others from replacing what is not theirs; here they could add files.
    if found.mode() & unix::WRITABLE != 0 {
        return Err(unix::writable(&folder));
    }
    // Files in it may have been made with the right to write for others.
    if found.uid() == unix::user() && found.mode() & 0o077 != 0 {
        std::fs::set_permissions(&folder, PermissionsExt::from_mode(0o700))?;
    }
    Ok(())
}

/// Creates the folder `inner` of `root` where it is missing. On other systems access control lists make the folders of
/// a user private.
#[cfg(not(unix))]
pub(crate) fn make(root: &Path, inner: &Path) -> io::Result<()> {
    own_file::make_folder(root, inner)?;
    Ok(())
}

#[cfg(unix)]
mod unix {
    use crate::files::atomic_file::directory_of;
    use std::fs::{self, DirBuilder, Metadata};
    use std::io::{self, ErrorKind};
    use std::os::unix::fs::{DirBuilderExt, MetadataExt};
    use std::path::{Path, PathBuf};

    /// Rights of the group and of everybody.
    pub(crate) const WRITABLE: u32 = 0o022;
    const STICKY: u32 = 0o1000;

    pub(crate) fn user() -> u32 {
        nix::unistd::geteuid().as_raw()
    }

    /// Checks every folder and link on the way to `path`, links followed, and creates missing
    /// folders.
    pub(crate) fn way_to(path: &Path, links: u32) -> io::Result<Metadata> {
        let mut place = PathBuf::new();
        let mut last = fs::symlink_metadata("/")?;
        for part in path.components() {
            place.push(part);
            let found = match fs::symlink_metadata(&place) {
                Err(error) if error.kind() == ErrorKind::NotFound => {
                    match DirBuilder::new().mode(0o700).create(&place) {
                        Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                            return Err(error);
                        }
                        _ => fs::symlink_metadata(&place)?,
                    }
                }
                found => found?,
            };
            if found.uid() != 0 && found.uid() != user() {
                let place = place.display();
                return Err(io::Error::other(format!("{place} is another user's")));
            }
            last = if found.is_symlink() {
                let links = links.checked_sub(1);
                let links = links.ok_or_else(|| io::Error::other("too many symbolic links"))?;
                way_to(&directory_of(&place).join(fs::read_link(&place)?), links)?
            } else {
                found
            };
            if !last.is_dir() {
                let place = place.display();
                return Err(io::Error::other(format!("{place} is not a folder")));
            }
            if last.mode() & WRITABLE != 0 && last.mode() & STICKY == 0 {
                return Err(writable(&place));
            }
        }
        Ok(last)
    }

    pub(crate) fn writable(place: &Path) -> io::Error {
        let place = place.display();
        io::Error::other(format!(
            "others can write in {place}: take that right from them (chmod go-w)"
        ))
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    fn make(folder: &Path) -> io::Result<()> {
        super::make(folder, Path::new(""))
    }

    #[test]
    fn a_link_below_the_root_is_not_followed() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        make(&at("cache")).unwrap();
        fs::create_dir(at("mine")).unwrap();
        fs::set_permissions(at("mine"), PermissionsExt::from_mode(0o755)).unwrap();
        symlink(at("mine"), at("cache/suite")).unwrap();
        let inner = Path::new("suite/new");
        let error = super::make(&at("cache"), inner).unwrap_err().to_string();
        assert!(
            error.contains("cache/suite: this is a symbolic link"),
            "{error}"
        );
        assert_eq!(mode(&at("mine")), 0o755);
        assert!(!at("mine/new").exists());
    }

    #[test]
    fn new_folders_are_private_and_open_ones_refused() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        make(&at("a/b")).unwrap();
        assert_eq!((mode(&at("a")), mode(&at("a/b"))), (0o700, 0o700));
        let refused = |name: &str, words: &str| {
            let error = make(&at(name)).unwrap_err().to_string();
            assert!(error.contains(words), "{name}: {error}");
        };
        let change = |name: &str, mode| {
            fs::set_permissions(at(name), PermissionsExt::from_mode(mode)).unwrap();
        };
        for open in [0o777, 0o720, 0o702] {
            change("a", open);
            refused("a", "chmod go-w");
            refused("a/b", "chmod go-w");
            refused("a/new", "chmod go-w");
            assert!(!at("a/new").exists());
        }
        // As /tmp: others can add to it, but not replace what is the user's.
        change("a", 0o1777);
        make(&at("a/b")).unwrap();
        refused("a", "others can write");
        change("a", 0o755);
        make(&at("a")).unwrap();
        assert_eq!(mode(&at("a")), 0o700);
        fs::write(at("file"), "").unwrap();
        refused("file/a", "is not a folder");
    }

    #[test]
    fn links_are_as_good_as_what_they_lead_to_and_by() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        make(&at("open/inner")).unwrap();
        make(&at("closed")).unwrap();
        fs::set_permissions(at("open"), PermissionsExt::from_mode(0o777)).unwrap();
        symlink("closed", at("good")).unwrap();
        make(&at("good")).unwrap();
        make(&at("good/new")).unwrap();
        assert!(at("closed/new").is_dir());
        symlink("open/inner", at("to")).unwrap();
        symlink("../closed", at("open/by")).unwrap();
        symlink("open/by", at("twice")).unwrap();
        symlink("ring", at("ring")).unwrap();
        for bad in ["to", "open/by", "twice", "ring"] {
            make(&at(bad)).unwrap_err();
        }
    }
}
