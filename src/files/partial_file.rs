//! Files written aside, to be renamed when they are whole.

use std::io;
use std::path::Path;
use tempfile::NamedTempFile;

/// An empty file in `directory`, to be written and renamed; removed when dropped before that. An error does not name the
/// file.
pub(crate) fn create(directory: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".volref-").suffix(".partial");
    // tempfile's own choice is 0600, private to the user; the umask applies to this one.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let file = builder.tempfile_in(directory);
    file.map_err(without_temporary_name)
}

/// The system's own error, where tempfile has put the random name of its file into the message: that name means nothing
/// to the user.
fn without_temporary_name(error: io::Error) -> io::Error {
    let inner = error.get_ref().and_then(|error| error.source());
    let code = inner
        .and_then(|error| error.downcast_ref::<io::Error>())
        .and_then(io::Error::raw_os_error);
    code.map_or(error, io::Error::from_raw_os_error)
}
