//! The user's folder for caches.

use std::path::PathBuf;

/// Environment variable for the folder of the cache; empty for no cache.
pub(crate) const CACHE_VARIABLE: &str = "VOLREF_CACHE";

/// The folder that the environment variable [`VOLREF_CACHE`](CACHE_VARIABLE) names, else the one in the
/// user's folder for caches; `None` if there is none.
pub(crate) fn cache_of_the_user() -> Option<PathBuf> {
    folder_of_the_user(&|name| std::env::var_os(name).map(PathBuf::from))
}

/// The folder of caches of this user, by the variables of the environment.
fn folder_of_the_user(variable: &dyn Fn(&str) -> Option<PathBuf>) -> Option<PathBuf> {
    if let Some(named) = variable(CACHE_VARIABLE) {
        return (!named.as_os_str().is_empty()).then_some(named);
    }
    // A relative path is to be ignored, as the XDG Base Directory Specification has it.
    let absolute = |name| variable(name).filter(|path: &PathBuf| path.is_absolute());
    let folder = if let Some(folder) = absolute("XDG_CACHE_HOME") {
        folder
    } else if cfg!(windows) {
        absolute("LOCALAPPDATA")?
    } else if cfg!(target_os = "macos") {
        absolute("HOME")?.join("Library/Caches")
    } else {
        absolute("HOME")?.join(".cache")
    };
    Some(folder.join("volref"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_folder_is_named_or_the_users() {
        let with = |names: &[(&str, &str)]| {
            let found = |name: &str| names.iter().find(|(known, _)| *known == name);
            folder_of_the_user(&|name| found(name).map(|(_, path)| PathBuf::from(path)))
        };
        let home = if cfg!(windows) {
            "C:\\home"
        } else {
            "/home/me"
        };
        let named = [(CACHE_VARIABLE, "here"), ("XDG_CACHE_HOME", home)];
        assert_eq!(with(&named), Some(PathBuf::from("here")));
        assert_eq!(with(&[(CACHE_VARIABLE, ""), ("HOME", home)]), None);
        let xdg = Path::new(home).join("volref");
        assert_eq!(with(&[("XDG_CACHE_HOME", home)]), Some(xdg));
        assert_eq!(with(&[]), None);
        #[cfg(all(unix, not(target_os = "macos")))]
        assert_eq!(
            with(&[("XDG_CACHE_HOME", "relative"), ("HOME", home)]),
            Some(PathBuf::from("/home/me/.cache/volref"))
        );
    }
}
