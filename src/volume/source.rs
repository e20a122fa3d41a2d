//! The file of a volume, with its detached data if any.

use super::error::{VolumeError, VolumeFault, refused};
use super::load_options::LoadOptions;
use crate::files::atomic_file::directory_of;
use crate::files::file_kind::ends_in;
use crate::files::regular_file::{self, ReadError};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Component, Path, PathBuf};

/// A file that was read completely.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRead {
    /// Path.
    pub path: PathBuf,
    /// BLAKE3 hash of its bytes, to detect later changes of the file.
    pub hash: String,
}

/// A file, or bytes in memory, hashed while they are read.
pub(super) struct VolumeSource<'b> {
    path: PathBuf,
    /// Bytes in all.
    pub length: u64,
    /// Bytes that are left.
    pub remaining: u64,
    /// Lines that ended before the next byte, where a reader of text counts them.
    pub line: usize,
    reader: BufReader<Hashed<'b>>,
    /// The file of the data, if it is another.
    data: Option<Box<VolumeSource<'b>>>,
    beside: Beside<'b>,
}

/// The place of the file of samples that a header names.
#[derive(Clone, Copy)]
enum Beside<'b> {
    /// Below the folder of the header.
    Folder,
    /// In memory, as the header; `None` if there is none.
    Memory(Option<&'b [u8]>),
}

struct Hashed<'b> {
    bytes: Box<dyn Read + 'b>,
    hasher: blake3::Hasher,
}

impl Read for Hashed<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.bytes.read(bytes)?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}

impl<'b> VolumeSource<'b> {
    pub fn open(path: &Path) -> Result<VolumeSource<'b>, VolumeError> {
        let (file, length) = regular_file::open(path).map_err(|error| VolumeError {
            path: path.to_owned(),
            fault: match error {
                ReadError::Missing(_) => {
                    format!("there is no such file{}", backslashes(path)).into()
                }
                ReadError::NotAFile(what) => format!("this is {what}, not a volume file").into(),
                ReadError::StandIn(what) => what.into(),
                error => io::Error::from(error).into(),
            },
        })?;
        Ok(VolumeSource::new(path, Box::new(file), length))
    }

    /// The file `name` in memory, with the bytes of the file of samples that it may name.
    pub fn of(name: &str, bytes: &'b [u8], samples: Option<&'b [u8]>) -> VolumeSource<'b> {
        VolumeSource {
            beside: Beside::Memory(samples),
            ..VolumeSource::new(Path::new(name), Box::new(bytes), bytes.len() as u64)
        }
    }

    fn new(path: &Path, bytes: Box<dyn Read + 'b>, length: u64) -> VolumeSource<'b> {
        let hasher = blake3::Hasher::new();
        VolumeSource {
            path: path.to_owned(),
            length,
            remaining: length,
            line: 0,
            reader: BufReader::with_capacity(1 << 16, Hashed { bytes, hasher }),
            data: None,
            beside: Beside::Folder,
        }
    }

    /// True if the name of the file ends in `ending`, in capitals or not.
    pub fn ends_in(&self, ending: &str) -> bool {
        ends_in(&self.path, ending)
    }

    /// Opens the file `name` of the data, which this file names as its header.
    pub fn open_data(
        &mut self,
        name: &str,
        options: &LoadOptions,
    ) -> Result<&mut VolumeSource<'b>, VolumeFault> {
        if let Beside::Memory(samples) = self.beside {
            let samples = samples.ok_or_else(|| {
                format!("the data are in another file, {name:?}: load the header by its path")
            })?;
            return Ok(self
                .data
                .insert(Box::new(VolumeSource::of(name, samples, None))));
        }
        let outside = |name: &str| {
            format!(
                "its data are in {name:?}, outside its folder, which is not allowed: move the \
                file beside the header, or set `detached_anywhere = true` beside `file` in the \
                scene, not in the header (`--detached-anywhere` for `volref info`)"
            )
        };
        let inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
        if !options.detached_anywhere && !Path::new(name).components().all(inside) {
            return Err(outside(name).into());
        }
        let folder = self.path.parent().unwrap_or(Path::new(""));
        // By parts, so that `./tooth.raw` becomes `tooth.raw`.
        let below = Path::new(name).components();
        let below = below.filter(|part| *part != Component::CurDir);
        let other = folder.join(below.collect::<PathBuf>());
        if let Some(elsewhere) = away(&self.path, &other).filter(|_| !options.detached_anywhere) {
            return Err(outside(&elsewhere.display().to_string()).into());
        }
        let opened = VolumeSource::open(&other)
            .map_err(|error| format!("cannot open its data file {error}"))?;
        Ok(self.data.insert(Box::new(opened)))
    }

    /// The error of a mistake in this file.
    pub fn error(&self, fault: impl Into<VolumeFault>) -> VolumeError {
        VolumeError {
            path: self.path.clone(),
            fault: fault.into(),
        }
    }

    /// Reads past `count` bytes, or to the end.
    pub fn skip(&mut self, count: u64) -> io::Result<()> {
        io::copy(&mut self.take(count), &mut io::sink()).map(drop)
    }

    /// All bytes; an error with the `remedy` if they are more than `most`.
    pub fn all(&mut self, most: u64, remedy: &str) -> Result<Vec<u8>, VolumeFault> {
        let length = self.remaining;
        if length > most {
            return refused(format!(
                "the file has {length} bytes, and at most {most} are read: {remedy}"
            ));
        }
        let mut bytes = Vec::new();
        self.take(most).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    /// Reads what is left of the files, so that their hashes are those of all their bytes.
    pub fn finish(mut self) -> Result<Vec<FileRead>, VolumeError> {
        let rest = io::copy(&mut self.reader, &mut io::sink());
        rest.map_err(|error| self.error(error))?;
        let mut files = vec![FileRead {
            hash: self.reader.get_ref().hasher.finalize().to_hex().to_string(),
            path: self.path,
        }];
        if let Some(data) = self.data {
            files.extend(data.finish()?);
        }
        Ok(files)
    }
}

impl Read for VolumeSource<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.reader.read(bytes)?;
        self.remaining = self.remaining.saturating_sub(count as u64);
        Ok(count)
    }
}

impl BufRead for VolumeSource<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, count: usize) {
        self.reader.consume(count);
        self.remaining = self.remaining.saturating_sub(count as u64);
    }
}

/// The remedy for a path of Windows on another system, on which a backslash is a letter of a name.
fn backslashes(path: &Path) -> String {
    let path = path.to_string_lossy();
    match path.contains('\\') {
        true => format!("; write {:?}, with slashes", path.replace('\\', "/")),
        false => String::new(),
    }
}

/// Real path of `data`, if a symbolic link leads out of the folder of the `header`: neither into
/// the one in which it is named nor into the one in which it lies itself. `None` if the data are
/// missing.
fn away(header: &Path, data: &Path) -> Option<PathBuf> {
    let data = data.canonicalize().ok()?;
    let named = directory_of(header).canonicalize().ok()?;
    let real = header.canonicalize().ok()?;
    let inside = data.starts_with(named) || data.starts_with(directory_of(&real));
    (!inside).then_some(data)
}
