//! Private folders: only the user or root can change them, so that a file is still the checked one
//! when it is read.

use super::own_file;
use std::io;
use std::path::{Path, PathBuf};

/// Creates the folder `inner` of `root` where it is missing, for the user alone. `root` itself may be a link: it is the
/// user's, and keeps its rights. Returns the folder, without links.
///
/// # Errors
///
/// A sentence with a remedy, if others could change the folder, or put another into its place: as owners
/// of a folder on the way to it, or by a right to write there. Links below `root` are refused.
#[cfg(unix)]
pub(crate) fn make(root: &Path, inner: &Path) -> io::Result<PathBuf> {
    use std::fs::{self, DirBuilder, Permissions};
    use std::os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt};
    /// Rights to write of the group and of everybody.
    const WRITABLE: u32 = 0o022;
    const STICKY: u32 = 0o1000;
    let user = nix::unistd::geteuid().as_raw();
    own_file::check_folder(root, inner)?;
    let folder = root.join(inner);
    DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(&folder)?;
    // Without links: nobody can lead it elsewhere from now on.
    let folder = folder.canonicalize()?;
    for place in folder.ancestors() {
        let (found, shown) = (fs::metadata(place)?, place.display());
        if found.uid() != 0 && found.uid() != user {
            return Err(io::Error::other(format!("{shown} is another user's")));
        }
        // On the way, the sticky bit keeps others from replacing what is not theirs; here they could add files.
        let is_safe = found.mode() & STICKY != 0 && place != folder;
        if found.mode() & WRITABLE != 0 && !is_safe {
            return Err(io::Error::other(format!(
                "others can write in {shown}: take that right from them (chmod go-w)"
            )));
        }
    }
    let found = fs::metadata(&folder)?;
    // Files in it may have been made with the right to write for others.
    if found.uid() == user && found.mode() & 0o077 != 0 {
        fs::set_permissions(&folder, Permissions::from_mode(0o700))?;
    }
    Ok(folder)
}

/// Creates the folder `inner` of `root` where it is missing. On other systems access control lists make the folders of
/// a user private.
#[cfg(not(unix))]
pub(crate) fn make(root: &Path, inner: &Path) -> io::Result<PathBuf> {
    own_file::make_folder(root, inner)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    fn make(folder: &Path) -> io::Result<PathBuf> {
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
            fs::remove_dir(at("a/new")).unwrap();
        }
        // As /tmp: others can add to it, but not replace what is the user's.
        change("a", 0o1777);
        make(&at("a/b")).unwrap();
        refused("a", "others can write");
        change("a", 0o755);
        make(&at("a")).unwrap();
        assert_eq!(mode(&at("a")), 0o700);
        fs::write(at("file"), "").unwrap();
        refused("file/a", "");
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
        // A link in an open folder may lead elsewhere tomorrow; what it leads to now is private.
        assert_eq!(
            make(&at("twice")).unwrap(),
            at("closed").canonicalize().unwrap()
        );
        for bad in ["to", "ring"] {
            make(&at(bad)).unwrap_err();
        }
    }
}
