//! The end of a renderer's output.

use std::collections::VecDeque;
use std::io::{PipeReader, Read};
use std::sync::{Arc, Condvar, Mutex};
use std::time::Duration;

/// Bytes of a renderer's output that are kept: the end, where errors are.
const MOST_PRINTED: usize = 64 * 1024;

/// Reads a pipe as fast as it is written, so that the writer never waits, and keeps the end of the
/// data.
pub struct Printed {
    shared: Arc<SharedOutput>,
}

struct SharedOutput {
    heard: Mutex<Heard>,
    closed: Condvar,
}

#[derive(Default)]
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
        let shared = Arc::new(SharedOutput {
            heard: Mutex::default(),
            closed: Condvar::new(),
        });
        let printed = Printed {
            shared: shared.clone(),
        };
        // Not joined: what has left the reach of volref may hold the pipe open for ever.
        std::thread::spawn(move || {
            let mut chunk = [0; 16 * 1024];
            loop {
                let read = pipe.read(&mut chunk);
                if matches!(&read, Err(error) if error.kind() == std::io::ErrorKind::Interrupted) {
                    continue;
                }
                let mut heard = shared.heard.lock().expect("no reader panicked");
                match read {
                    Ok(length @ 1..) => heard.push(&chunk[..length]),
                    Ok(0) | Err(_) => {
                        heard.is_closed = true;
                        shared.closed.notify_all();
                        return;
                    }
                }
            }
        });
        printed
    }

    /// The output so far, or its end if it is long. Waits for the end of the pipe, but no longer
    /// than `patience`.
    pub fn text(&self, patience: Duration) -> String {
        let heard = self.shared.heard.lock().expect("no reader panicked");
        let (heard, _) = (self.shared.closed)
            .wait_timeout_while(heard, patience, |heard| !heard.is_closed)
            .expect("no reader panicked");
        let bytes: Vec<u8> = heard.end.iter().copied().collect();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        match heard.left_out {
            0 => text,
            left_out => format!("[the first {left_out} bytes are left out]\n{text}"),
        }
    }
}
