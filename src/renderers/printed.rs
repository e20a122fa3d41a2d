//! Output of a renderer: its end, and the lines that are quoted of it.

use std::collections::VecDeque;
use std::io::{PipeReader, Read};
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;

/// Bytes of a renderer's output that are kept: the end, where errors are.
const MOST_PRINTED: usize = 64 * 1024;

/// Reads a pipe as fast as it is written, so that the writer never waits, and keeps the end of the
/// data.
#[derive(Clone, Debug)]
pub struct Printed(Arc<(Mutex<Heard>, Condvar)>);

#[derive(Debug, Default)]
struct Heard {
    end: VecDeque<u8>,
    left_out: u64,
    is_closed: bool,
}

impl Heard {
    fn push(&mut self, bytes: &[u8]) {
        self.end.extend(bytes);
        let surplus = self.end.len().saturating_sub(MOST_PRINTED);
        self.end.drain(..surplus);
        self.left_out += surplus as u64;
    }
}

impl Printed {
    /// Begins to read `pipe`, to its end.
    pub fn hear(mut pipe: PipeReader) -> Printed {
        let printed = Printed(Arc::default());
        let shared = printed.clone();
        // Not joined: what has left the reach of volref may hold the pipe open for ever.
        std::thread::spawn(move || {
            let mut chunk = [0; 16 * 1024];
            loop {
                let read = pipe.read(&mut chunk);
                if matches!(&read, Err(error) if error.kind() == std::io::ErrorKind::Interrupted) {
                    continue;
                }
                let (heard, closed) = &*shared.0;
                let mut heard = heard.lock().expect("no reader panicked");
                match read {
                    Ok(length @ 1..) => heard.push(&chunk[..length]),
                    Ok(0) | Err(_) => {
                        heard.is_closed = true;
                        closed.notify_all();
                        return;
                    }
                }
            }
        });
        printed
    }

    /// Adds what was printed elsewhere.
    pub fn push(&self, bytes: &[u8]) {
        let mut heard = self.0.0.lock().expect("no reader panicked");
        heard.push(bytes);
    }

    /// The output since the last call, or its end if it is long. Waits for the end of the pipe, but no longer
    /// than `patience`.
    pub fn take(&self, patience: Duration) -> String {
        let (heard, closed) = &*self.0;
        let heard = heard.lock().expect("no reader panicked");
        let (mut heard, _) = closed
            .wait_timeout_while(heard, patience, |heard| !heard.is_closed)
            .expect("no reader panicked");
        let bytes = Vec::from(std::mem::take(&mut heard.end));
        let text = String::from_utf8_lossy(&bytes).into_owned();
        match std::mem::take(&mut heard.left_out) {
            0 => text,
            left_out => format!("[the first {left_out} bytes are left out]\n{text}"),
        }
    }
}

/// Lines quoted from the end.
const LAST_LINES: usize = 3;
/// Letters quoted of a line.
const LETTERS: usize = 400;

/// Words by which a line of output is one with an error in it, in lower case.
const ERRORS: [&str; 11] = [
    "error",
    "exception",
    "fatal",
    "panicked",
    "cannot",
    "can't",
    "could not",
    "failed",
    "failure",
    "segmentation fault",
    "abort",
];

/// The lines of a renderer's output that say why it failed, as the end of a message: the first with an error in it,
/// for what follows is often a consequence, and the last.
pub(super) fn quoted_words(printed: &str) -> String {
    let lines = printed.lines().filter(|line| !line.trim().is_empty());
    let lines: Vec<&str> = lines.collect();
    let (before, last) = lines.split_at(lines.len().saturating_sub(LAST_LINES));
    let first = before.iter().find(|line| has_error(line));
    let mut text = String::new();
    if let Some(line) = first {
        text.push_str("; its first error:");
        quote(&mut text, line);
    }
    if !last.is_empty() {
        text.push_str("; its last output:");
    }
    last.iter().for_each(|line| quote(&mut text, line));
    text
}

/// True of a line with a word for an error in it; not of a count of none.
fn has_error(line: &str) -> bool {
    let line = line.to_lowercase();
    let is_none = ["0 error", "no error", "without error"]
        .iter()
        .any(|none| line.contains(none));
    !is_none && ERRORS.iter().any(|word| line.contains(word))
}

/// Adds `line` to `text`. It may hold anything, escape sequences too.
fn quote(text: &mut String, line: &str) {
    text.push('\n');
    text.push_str(&plain(line));
}

/// The beginning of `line` without control characters.
pub(super) fn plain(line: &str) -> String {
    let letters = line.chars().filter(|letter| !letter.is_control());
    letters.take(LETTERS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_is_quoted_besides_the_last_lines() {
        let log = "loading\n0 errors so far\nERROR: no such volume\nretrying\nretrying\n\nretrying\ngiving up\n";
        assert_eq!(
            quoted_words(log),
            "; its first error:\nERROR: no such volume; its last output:\nretrying\nretrying\ngiving up"
        );
        // Once, where it is among the last.
        assert_eq!(
            quoted_words("loading\nerror: no volume\nbye"),
            "; its last output:\nloading\nerror: no volume\nbye"
        );
        assert_eq!(quoted_words("a\nb\nc\nd"), "; its last output:\nb\nc\nd");
        assert_eq!(quoted_words(" \n"), "");
    }

    #[test]
    fn a_traceback_is_quoted_by_its_last_line() {
        let trace = "Traceback (most recent call last):\n  File \"r.py\", line 3\n    f()\nKeyError: 'grid'\n";
        assert_eq!(
            quoted_words(&format!("{trace}closing\nclosed\nbye\n")),
            "; its first error:\nKeyError: 'grid'; its last output:\nclosing\nclosed\nbye"
        );
        assert!(quoted_words(trace).starts_with("; its last output:"));
    }
}
