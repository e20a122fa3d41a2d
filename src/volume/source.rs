//! The file that a reader of volumes reads, with that of its data where they are apart.

use super::error::VolumeError;
use super::load_options::LoadOptions;
use crate::regular_file::{self, OpenError};
use std::error::Error;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Component, Path, PathBuf};

/// A file that was read to its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRead {
    /// Path.
    pub path: PathBuf,
    /// BLAKE3 of its bytes: it shows later whether a file is still the one an image was made
    /// from.
    pub hash: String,
}

/// A regular file that is hashed while it is read.
#[derive(Debug)]
pub struct VolumeSource {
    path: PathBuf,
    /// Bytes in the file.
    length: u64,
    reader: BufReader<Hashed>,
    /// The file of the data, if it is another.
    data: Option<Box<VolumeSource>>,
}

#[derive(Debug)]
struct Hashed {
    file: File,
    hasher: blake3::Hasher,
}

impl Read for Hashed {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}

impl VolumeSource {
    pub(super) fn open(path: &Path) -> Result<VolumeSource, VolumeError> {
        let (file, length) = open(path)?;
        let hasher = blake3::Hasher::new();
        Ok(VolumeSource {
            path: path.to_owned(),
            length,
            reader: BufReader::with_capacity(1 << 16, Hashed { file, hasher }),
            data: None,
        })
    }

    /// Bytes in the file.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// The name of the file ends in `ending`, in capitals or not.
    pub(super) fn ends_in(&self, ending: &str) -> bool {
        ends_in(&self.path, ending)
    }

    /// Opens the file `name` of the data, which this file names as its header.
    pub(super) fn open_data(
        &mut self,
        name: &str,
        options: &LoadOptions,
    ) -> Result<&mut VolumeSource, VolumeError> {
        let inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
        if !options.detached_anywhere && !Path::new(name).components().all(inside) {
            return Err(VolumeError::Outside {
                path: self.path.clone(),
                name: name.to_owned(),
            });
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        // By parts, so that `./tooth.raw` becomes `tooth.raw`.
        let below = Path::new(name).components();
        let other = folder.join(
            below
                .filter(|part| *part != Component::CurDir)
                .collect::<PathBuf>(),
        );
        if let Some(elsewhere) = away(&self.path, &other).filter(|_| !options.detached_anywhere) {
            return Err(VolumeError::Outside {
                path: self.path.clone(),
                name: elsewhere.display().to_string(),
            });
        }
        let opened = VolumeSource::open(&other).map_err(|error| VolumeError::Data {
            path: self.path.clone(),
            error: Box::new(error),
        })?;
        Ok(self.data.insert(Box::new(opened)))
    }

    /// All bytes that are left, of a file of at most `most`.
    pub(super) fn bytes(&mut self, most: u64) -> Result<Vec<u8>, VolumeError> {
        let mut bytes = Vec::new();
        let read = (&mut self.reader).take(most).read_to_end(&mut bytes);
        read.map_err(|source| self.trouble(source))?;
        Ok(bytes)
    }

    /// The file does not hold what its name promises. The message stands after the path.
    pub(super) fn fault(&self, error: impl Error + Send + Sync + 'static) -> VolumeError {
        VolumeError::Contents {
            path: self.path.clone(),
            separator: ": ",
            error: Box::new(error),
        }
    }

    /// [`VolumeSource::fault`], where the message begins with a line of the file.
    pub(super) fn fault_in_line(&self, error: impl Error + Send + Sync + 'static) -> VolumeError {
        VolumeError::Contents {
            path: self.path.clone(),
            separator: ":",
            error: Box::new(error),
        }
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads what is left of the files, so that their hashes are those of all their bytes.
    pub(super) fn finish(mut self) -> Result<Vec<FileRead>, VolumeError> {
        let rest = io::copy(&mut self.reader, &mut io::sink());
        rest.map_err(|source| self.trouble(source))?;
        let mut files = vec![FileRead {
            hash: self.reader.get_ref().hasher.finalize().to_hex().to_string(),
            path: self.path,
        }];
        if let Some(data) = self.data {
            files.extend(data.finish()?);
        }
        Ok(files)
    }

    fn trouble(&self, source: io::Error) -> VolumeError {
        VolumeError::Read {
            path: self.path.clone(),
            source,
        }
    }
}

impl Read for VolumeSource {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.reader.read(bytes)
    }
}

impl BufRead for VolumeSource {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
    }
}

/// Where `data` really lie, if a symbolic link leads out of the folder of the `header`: neither
/// into the one in which it is named nor into the one in which it lies itself. Data that are not
/// there lie nowhere.
fn away(header: &Path, data: &Path) -> Option<PathBuf> {
    let data = data.canonicalize().ok()?;
    let named = match header.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let (named, real) = (named.canonicalize().ok()?, header.canonicalize().ok()?);
    let folders = [Some(named.as_path()), real.parent()];
    let inside = folders
        .into_iter()
        .flatten()
        .any(|folder| data.starts_with(folder));
    (!inside).then_some(data)
}

/// A regular file, and its length in bytes.
fn open(path: &Path) -> Result<(File, u64), VolumeError> {
    regular_file::open(path).map_err(|error| match error {
        OpenError::Missing(_) => VolumeError::Missing(path.to_owned()),
        OpenError::NotAFile(what) => VolumeError::NotAFile {
            path: path.to_owned(),
            what,
        },
        OpenError::Refused(source) => VolumeError::Read {
            path: path.to_owned(),
            source,
        },
    })
}

/// The name of the file at `path` ends in `ending`, in capitals or not, after at least one other
/// letter.
pub(super) fn ends_in(path: &Path, ending: &str) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_ascii_lowercase();
    name.len() > ending.len() && name.ends_with(ending)
}
