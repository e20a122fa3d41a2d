//! Renderers that stay: started once, and asked for one image after the other.
//!
//! A request is a line of JSON on standard input, an answer a line of JSON on standard output. What else it prints
//! there is output like that on standard error. A renderer that ended, did not answer in time or answered otherwise is
//! ended with all that it started, and another is started for the next image.

use super::keeper::{Keeper, Kept, LEAVE, feed};
use super::printed::{Printed, plain, quoted_words};
use super::process::{
    KEEPERS_PATIENCE, LISTEN, PAUSE, RUNNING, STOPPED, failure_of, kept, not_started_in_words,
    reach, remnants, start, status_at_end,
};
use crate::suite::{NOT_RENDERED, Output};
use process_wrap::std::ChildWrapper;
use serde::Deserialize;
use std::io::{BufRead, BufReader, Read, pipe};
use std::process::Stdio;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Programs of some systems write it before their first line.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Longest answer, bytes.
const MOST_LINE: usize = 64 * 1024;

/// Answers that wait, at most: a renderer that goes on answering waits, too.
const MOST_WAITING: usize = 16;

/// Renderers of one command that stay, as many as are asked at a time.
#[derive(Clone, Debug)]
pub(crate) struct StayingRenderers {
    words: Vec<String>,
    timeout: Duration,
    keeper: Option<Keeper>,
    /// Renderers that nobody asks.
    idle: Arc<Mutex<Vec<Staying>>>,
}

/// Outcome of a call of a renderer, or of a request.
#[derive(Debug)]
pub(super) struct Called {
    /// The output where there is no image.
    pub failure: Option<Output>,
    /// Notes beside the verdict.
    pub notes: Vec<String>,
    /// Standard output and error of the renderer.
    pub printed: String,
}

/// A line of an answer.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Answer {
    /// Path of the image that was written.
    image: Option<String>,
    /// Reason why the renderer failed.
    error: Option<String>,
    /// Something in the scene for which the renderer has no words.
    cannot: Option<String>,
}

/// Reason why there is no right answer.
enum Fault {
    Ended,
    Late,
    Stopped,
    Wrong(String),
}

impl StayingRenderers {
    /// Renderers that `words` start, each when it is first needed.
    pub fn new(words: Vec<String>, timeout: Duration, keeper: Option<Keeper>) -> StayingRenderers {
        StayingRenderers {
            words,
            timeout,
            keeper,
            idle: Arc::default(),
        }
    }

    /// Ends those that nobody asks: their standard input ends, and they have a moment to leave.
    pub fn end(&self) {
        let mut all = std::mem::take(&mut *self.idle());
        // All at the same time.
        all.iter_mut().for_each(|it| it.requests = None);
        for it in all {
            let _ = it.end();
        }
    }

    /// The words of a command line that makes the same `request` by itself.
    pub(super) fn call(&self, request: &str) -> String {
        let request = shell_words::quote(request);
        format!(
            "printf '%s\\n' {request} | {}",
            shell_words::join(&self.words)
        )
    }

    /// Asks a renderer for the image that `request` says, to be written at `output`.
    pub(super) fn ask(&self, request: &str, output: &str) -> Called {
        // Counted before it is asked whether all are stopped, as in `run`.
        RUNNING.fetch_add(1, Ordering::SeqCst);
        let called = self.asked(request, output);
        RUNNING.fetch_sub(1, Ordering::SeqCst);
        called
    }

    fn asked(&self, request: &str, output: &str) -> Called {
        let mut notes = Vec::new();
        let not_started = |error: &str| Called {
            failure: Some(Output::Unusable(not_started_in_words(
                &self.words[0],
                error,
            ))),
            notes: Vec::new(),
            printed: String::new(),
        };
        if STOPPED.load(Ordering::SeqCst) {
            return not_started("volref is ending");
        }
        let mut renderer = match self.ready(&mut notes) {
            Ok(renderer) => renderer,
            Err(error) => return not_started(&error),
        };
        let answer = renderer.answer(request, self.timeout);
        let answer = answer.map(|it| (it.image, it.error, it.cannot));
        let one_line = |words: &str| plain(&words.replace('\n', " "));
        let (failure, printed) = match answer {
            Ok((Some(image), None, None)) if image == output => (None, renderer.keep_in(self)),
            Ok((None, Some(words), None)) => {
                let printed = renderer.keep_in(self);
                let words = one_line(&words) + &quoted_words(&printed);
                let reason = format!("the renderer failed: {words}");
                (Some(Output::Unusable(reason)), printed)
            }
            Ok((None, None, Some(words))) => {
                let reason = format!("{NOT_RENDERED}{}", one_line(&words));
                (Some(Output::Missing(reason)), renderer.keep_in(self))
            }
            Ok((Some(image), None, None)) => {
                let image = one_line(&image);
                let fault = format!("answered with the image {image}, and was asked for {output}");
                self.faulty(renderer, Fault::Wrong(fault), &mut notes)
            }
            Ok(_) => {
                let fault = "answered with none or several of image, error and cannot".to_owned();
                self.faulty(renderer, Fault::Wrong(fault), &mut notes)
            }
            Err(fault) => self.faulty(renderer, fault, &mut notes),
        };
        Called {
            failure,
            notes,
            printed,
        }
    }

    /// A renderer that waits for a request: one that stayed, or else a new one.
    fn ready(&self, notes: &mut Vec<String>) -> Result<Staying, String> {
        loop {
            let Some(mut staying) = self.idle().pop() else {
                return Staying::start(&self.words, self.keeper.as_ref());
            };
            let fault = match staying.lines.try_recv() {
                Err(TryRecvError::Empty) => return Ok(staying),
                Ok(line) if !is_report(&line) => {
                    format!("answered without being asked: {}", plain(&line))
                }
                Ok(line) => {
                    staying.last = line;
                    "ended after its last image".to_owned()
                }
                Err(TryRecvError::Disconnected) => "ended after its last image".to_owned(),
            };
            let _ = staying.end();
            notes.push(format!("the renderer {fault}; it was started again"));
        }
    }

    /// The output, and what was printed, of a renderer that is ended for a fault.
    fn faulty(
        &self,
        renderer: Staying,
        fault: Fault,
        notes: &mut Vec<String>,
    ) -> (Option<Output>, String) {
        let printed = renderer.printed.clone();
        let has_keeper = self.keeper.is_some();
        let ended = renderer.end();
        let printed = printed.take(LISTEN);
        let by_itself = matches!(fault, Fault::Ended);
        let reason = match (ended, fault) {
            (Err(error), _) => not_started_in_words(&self.words[0], &error),
            (Ok(kept), fault) => {
                notes.extend(remnants(&kept, by_itself));
                match fault {
                    Fault::Ended => failure_of(kept.code, kept.signal).unwrap_or_else(|| {
                        "the renderer ended before it answered: one that stays reads requests to the end of its \
                         standard input"
                            .to_owned()
                    }),
                    Fault::Late => format!(
                        "the renderer did not answer within {} s and was ended, {}; an answer ends with a newline, \
                         and is flushed",
                        self.timeout.as_secs_f64(),
                        reach(has_keeper),
                    ),
                    Fault::Stopped => "the renderer was ended with volref".to_owned(),
                    Fault::Wrong(fault) => format!("the renderer {fault}; it was ended"),
                }
            }
        };
        let output = Output::Unusable(reason + &quoted_words(&printed));
        (Some(output), printed)
    }

    fn idle(&self) -> std::sync::MutexGuard<'_, Vec<Staying>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A renderer that was started, and its pipes.
#[derive(Debug)]
struct Staying {
    child: Box<dyn ChildWrapper>,
    has_keeper: bool,
    /// Its standard input, which ends with the sender.
    requests: Option<Sender<Vec<u8>>>,
    /// The lines of its standard output that begin like JSON; the last of all is the report of a keeper.
    lines: Receiver<String>,
    /// The last of them that was read where none was asked for.
    last: String,
    printed: Printed,
}

impl Staying {
    fn start(words: &[String], keeper: Option<&Keeper>) -> Result<Staying, String> {
        let (log, writer) = pipe().map_err(|error| error.to_string())?;
        let pipes = [Stdio::piped(), Stdio::piped(), writer.into()];
        let mut child = start(words, keeper, pipes)?;
        let printed = Printed::hear(log);
        let (sender, lines) = sync_channel(MOST_WAITING);
        if let Some(stdout) = child.stdout().take() {
            let printed = printed.clone();
            // Not joined: what has left the reach of volref may hold the pipe open for ever.
            std::thread::spawn(move || read_lines(stdout, &sender, &printed));
        }
        Ok(Staying {
            requests: child.stdin().take().map(feed),
            has_keeper: keeper.is_some(),
            child,
            lines,
            last: String::new(),
            printed,
        })
    }

    /// The answer to `request`.
    fn answer(&mut self, request: &str, timeout: Duration) -> Result<Answer, Fault> {
        if let Some(requests) = &self.requests {
            // Who has ended says so by its lines.
            let _ = requests.send(format!("{request}\n").into_bytes());
        }
        let start = Instant::now();
        let line = loop {
            let left = timeout.saturating_sub(start.elapsed());
            match self.lines.recv_timeout(left.min(PAUSE)) {
                Ok(line) => break line,
                Err(RecvTimeoutError::Disconnected) => return Err(Fault::Ended),
                Err(RecvTimeoutError::Timeout) if STOPPED.load(Ordering::SeqCst) => {
                    return Err(Fault::Stopped);
                }
                Err(RecvTimeoutError::Timeout) if left.is_zero() => return Err(Fault::Late),
                Err(RecvTimeoutError::Timeout) => {}
            }
        };
        if self.has_keeper && is_report(&line) {
            self.last = line;
            return Err(Fault::Ended);
        }
        if line.len() >= MOST_LINE {
            let most = MOST_LINE / 1024;
            let reason = format!("answered with a line that is longer than {most} KiB");
            return Err(Fault::Wrong(reason));
        }
        serde_json::from_str(&line).map_err(|error| {
            let line = plain(&line);
            Fault::Wrong(format!(
                "gave an answer that cannot be read ({error}): {line}"
            ))
        })
    }

    /// Puts it back for another image; what it has printed for this one.
    fn keep_in(self, all: &StayingRenderers) -> String {
        let printed = self.printed.take(Duration::ZERO);
        all.idle().push(self);
        printed
    }

    /// Ends it: with its standard input, or after a moment by force, and with all that it started.
    fn end(mut self) -> Result<Kept, String> {
        self.requests = None;
        let patience = if self.has_keeper {
            KEEPERS_PATIENCE
        } else {
            LEAVE
        };
        let status = status_at_end(&mut *self.child, patience, || {
            // Few at a time: it may go on answering.
            let lines = self.lines.try_iter().take(MOST_WAITING);
            if let Some(line) = lines.last() {
                self.last = line;
            }
        });
        let end = Instant::now() + LISTEN;
        let left = || end.saturating_duration_since(Instant::now());
        while self.has_keeper
            && !left().is_zero()
            && let Ok(line) = self.lines.recv_timeout(left())
        {
            self.last = line;
        }
        kept(self.has_keeper, &self.last, status)
    }
}

/// True of a line that may be the report of a keeper.
fn is_report(line: &str) -> bool {
    serde_json::from_str::<Kept>(line).is_ok()
}

/// Sends the lines that begin like JSON, or as much of one as an answer may be long; others are `printed`.
fn read_lines(stdout: impl Read, lines: &SyncSender<String>, printed: &Printed) {
    let mut stdout = BufReader::new(stdout);
    // Whether the unfinished line is an answer, if there is one.
    let mut rest_of = None;
    loop {
        let mut part = Vec::new();
        let mut limited = stdout.by_ref().take(MOST_LINE as u64);
        if !matches!(limited.read_until(b'\n', &mut part), Ok(1..)) {
            return;
        }
        if rest_of.is_none() && part.starts_with(BYTE_ORDER_MARK) {
            part.drain(..BYTE_ORDER_MARK.len());
        }
        let is_answer = rest_of.unwrap_or_else(|| part.starts_with(b"{"));
        if !is_answer {
            printed.push(&part);
        } else if rest_of.is_none() {
            // The beginning of an answer that is too long is no JSON.
            let line = String::from_utf8_lossy(&part).into_owned();
            if lines.send(line).is_err() {
                return;
            }
        }
        rest_of = (!part.ends_with(b"\n")).then_some(is_answer);
    }
}
