//! Wavefront OBJ text as statements: one reader for meshes and for point clouds.
//!
//! A line is a keyword and its values, separated by blanks. `#` starts a comment anywhere in a
//! line; a backslash at the end of a line continues it on the next, and counts as a blank, but
//! not from within a comment, where it may end a path. Lines end in LF, CRLF or CR. Only numbers
//! are decoded, so names and comments may be in any encoding that contains ASCII.
//!
//! A last line without a line end is read, since many programs write none: that it lost digits
//! cannot be told.

use crate::files::file_kind::by_bytes;
use std::borrow::Cow;
use thiserror::Error;

/// Mistake in an OBJ file, or in a mesh, and how to mend it.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{}{message}", position.map_or(String::new(), |[line, column]| format!("{line}:{column}: ")))]
pub struct ObjFault {
    /// Line and column, from 1, if it is in a line.
    pub position: Option<[usize; 2]>,
    /// The mistake, and how to mend it.
    pub message: String,
}

impl ObjFault {
    /// A mesh without faces.
    pub(super) fn no_faces() -> ObjFault {
        ObjFault::in_file(
            "the mesh has no faces: export it as polygons; a file of bare points is a point cloud",
        )
    }

    /// A mistake in the file as a whole.
    pub(super) fn in_file(message: impl Into<String>) -> ObjFault {
        ObjFault {
            position: None,
            message: message.into(),
        }
    }
}

/// A segment of bytes without blanks, and where it stands.
pub(crate) struct Word<'a> {
    /// Bytes of the word.
    pub bytes: &'a [u8],
    /// Line and column, from 1.
    pub position: [usize; 2],
}

impl Word<'_> {
    /// The word for a message.
    pub fn text(&self) -> Cow<'_, str> {
        String::from_utf8_lossy(self.bytes)
    }

    /// A mistake in this word.
    pub fn fault(&self, message: String) -> ObjFault {
        ObjFault {
            position: Some(self.position),
            message,
        }
    }

    /// The finite number that the word is; `name` is for the message.
    pub fn number(&self, name: &str) -> Result<f64, ObjFault> {
        let number = std::str::from_utf8(self.bytes).ok();
        let number = number.and_then(|text| text.parse::<f64>().ok());
        number.filter(|number| number.is_finite()).ok_or_else(|| {
            let text = self.text();
            self.fault(format!(
                "{name} is {text:?}, which is no finite number: write it like 0.5 or 5e-1"
            ))
        })
    }

    /// The keyword of the format that the word is.
    pub fn keyword(&self) -> Result<&'static str, ObjFault> {
        let mut known = KEYWORDS.split_ascii_whitespace();
        known
            .find(|known| known.as_bytes() == self.bytes)
            .ok_or_else(|| {
                let word = self.text();
                self.fault(format!(
                    "{word:?} is not a keyword of the OBJ format: points begin with `v`, faces with \
                     `f`; remove the line or put `#` before it"
                ))
            })
    }
}

/// Every keyword of the format's specification, but those that run something else.
const KEYWORDS: &str = "
    v f vn vt vp p l o g s mg mtllib usemtl maplib usemap cstype deg bmat step curv curv2 surf
    parm trim hole scrv sp end con bevel c_interp d_interp lod shadow_obj trace_obj ctech
    stech
";

/// The statements of a file: its lines, with continued ones put together.
pub(crate) struct Statements<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Statements<'a> {
    /// Statements of a file, which must be text.
    pub fn of(bytes: &'a [u8]) -> Result<Statements<'a>, ObjFault> {
        if let Some(kind) = by_bytes(bytes) {
            return Err(ObjFault::in_file(format!(
                "this begins like {}, and only OBJ is read: convert it with a mesh editor (Blender, MeshLab)",
                kind.name
            )));
        }
        if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") || bytes.contains(&0) {
            return Err(ObjFault::in_file(
                "this is not plain text (a zero byte or UTF-16): save it as UTF-8 or ASCII",
            ));
        }
        Ok(Statements {
            rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            line: 0,
        })
    }

    /// Puts the words of the next statement into `words`: none for a blank line or a comment.
    /// False at the end of the file.
    pub fn read_next(&mut self, words: &mut Vec<Word<'a>>) -> bool {
        words.clear();
        if self.rest.is_empty() {
            return false;
        }
        loop {
            let line = self.next_line();
            let comment = line.iter().position(|&byte| byte == b'#');
            let code = &line[..comment.unwrap_or(line.len())];
            let continued = match comment {
                None => code.trim_ascii_end().strip_suffix(b"\\"),
                Some(_) => None,
            };
            push_words(continued.unwrap_or(code), self.line, words);
            if continued.is_none() || self.rest.is_empty() {
                return true;
            }
        }
    }

    fn next_line(&mut self) -> &'a [u8] {
        let rest = self.rest;
        let end = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
        let (line, after) = match end {
            None => (rest, rest.len()),
            Some(end) if rest[end..].starts_with(b"\r\n") => (&rest[..end], end + 2),
            Some(end) => (&rest[..end], end + 1),
        };
        self.rest = &rest[after..];
        self.line += 1;
        line
    }
}

fn push_words<'a>(code: &'a [u8], line: usize, words: &mut Vec<Word<'a>>) {
    let mut start = 0;
    for bytes in code.split(u8::is_ascii_whitespace) {
        if !bytes.is_empty() {
            words.push(Word {
                bytes,
                position: [line, start + 1],
            });
        }
        start += bytes.len() + 1;
    }
}
