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
const LAST_LINES: usize = 5;
/// Letters quoted of a line.
const LETTERS: usize = 400;

/// The last lines of a renderer's output, as the end of a message that says why it failed.
pub(super) fn quoted_words(printed: &str) -> String {
    let lines = printed.lines().filter(|line| !line.trim().is_empty());
    // They may hold anything, escape sequences too.
    let lines: Vec<String> = lines.map(plain).collect();
    match &lines[lines.len().saturating_sub(LAST_LINES)..] {
        [] => String::new(),
        last => format!("; its last output:\n{}", last.join("\n")),
    }
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
    fn the_last_lines_are_quoted() {
        assert_eq!(
            quoted_words("a\nb\n\nc\nd\x1b[31m\ne\nf\n"),
            "; its last output:\nb\nc\nd[31m\ne\nf"
        );
        assert_eq!(quoted_words(" \n"), "");
    }
}
