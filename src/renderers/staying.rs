//! Renderers that stay: started once, and asked for one image after the other.
//!
//! A request is a line of JSON on standard input, an answer a line of JSON on standard output. What else it prints
//! there is output like that on standard error. A renderer that ended, did not answer in time or answered otherwise is
//! ended with all that it started, and another is started for the next image.

use super::printed::{plain, quoted_words};
use super::process::{
    Called, ENDED_WITH_VOLREF, LISTEN, MOST_LINE, PAUSE, Process, counted, failure_of, is_stopped,
};
use crate::suite::{NOT_RENDERED, Output};
use serde::Deserialize;
use std::fmt::Display;
use std::io::Write;
use std::sync::mpsc::{RecvTimeoutError, TryRecvError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Renderers of one command that stay, as many as are asked at a time.
#[derive(Clone, Debug)]
pub(crate) struct StayingRenderers {
    words: Vec<String>,
    timeout: Duration,
    /// Renderers that nobody asks.
    idle: Arc<Mutex<Vec<Process>>>,
}

/// Longest time that a renderer may take to leave when its requests end.
const LEAVE: Duration = Duration::from_secs(1);

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

impl StayingRenderers {
    /// Renderers that `words` start, each when it is first needed.
    pub fn new(words: Vec<String>, timeout: Duration) -> StayingRenderers {
        StayingRenderers {
            words,
            timeout,
            idle: Arc::default(),
        }
    }

    /// Ends those that nobody asks: their standard input ends, and they have a moment to leave.
    pub fn end(&self) {
        let mut all = std::mem::take(&mut *self.idle());
        // All at the same time.
        all.iter_mut().for_each(|it| it.requests = None);
        for it in all {
            let _ = it.end(LEAVE);
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
        counted(|| {
            let mut notes = Vec::new();
            let mut renderer = self.ready(&mut notes)?;
            let (failure, printed) = match answer(&mut renderer, request, output, self.timeout) {
                Ok(failure) => {
                    let printed = renderer.printed.take(Duration::ZERO);
                    self.idle().push(renderer);
                    (failure, printed)
                }
                Err(fault) => {
                    let printed = renderer.printed.clone();
                    let status = renderer.end(LEAVE)?;
                    let by_itself = || failure_of(status).unwrap_or_else(|| ENDED_EARLY.to_owned());
                    let reason = fault.unwrap_or_else(by_itself);
                    (Some(Output::Unusable(reason)), printed.take(LISTEN))
                }
            };
            let failure = failure.map(|failure| match failure {
                Output::Unusable(reason) => Output::Unusable(reason + &quoted_words(&printed)),
                other => other,
            });
            Ok(Called {
                failure,
                notes,
                printed,
            })
        })
    }

    /// A renderer that waits for a request: one that stayed, or else a new one.
    fn ready(&self, notes: &mut Vec<String>) -> Result<Process, String> {
        loop {
            let idle = self.idle().pop();
            let Some(staying) = idle.filter(|_| !is_stopped()) else {
                return Process::start(&self.words, true);
            };
            let fault = match staying.lines.try_recv() {
                Err(TryRecvError::Empty) => return Ok(staying),
                Ok(line) => format!("answered without being asked: {}", plain(&line)),
                Err(TryRecvError::Disconnected) => "ended after its last image".to_owned(),
            };
            let _ = staying.end(LEAVE);
            notes.push(format!("the renderer {fault}; it was started again"));
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Process>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reason where a renderer succeeded and did not answer.
const ENDED_EARLY: &str = "the renderer ended before it answered: one that stays reads requests to the end of its \
                           standard input";

/// The answer of `renderer` to `request`, with the output where there is no image; else why there is no right answer,
/// `None` of a renderer that ended.
fn answer(
    renderer: &mut Process,
    request: &str,
    output: &str,
    timeout: Duration,
) -> Result<Option<Output>, Option<String>> {
    if let Some(requests) = &mut renderer.requests {
        // Who has ended says so by its lines.
        let _ = writeln!(requests, "{request}");
    }
    let start = Instant::now();
    let line = loop {
        let left = timeout.saturating_sub(start.elapsed());
        match renderer.lines.recv_timeout(left.min(PAUSE)) {
            Ok(line) => break line,
            Err(RecvTimeoutError::Disconnected) => return Err(None),
            Err(RecvTimeoutError::Timeout) if is_stopped() => {
                return Err(Some(ENDED_WITH_VOLREF.to_owned()));
            }
            Err(RecvTimeoutError::Timeout) if left.is_zero() => {
                return Err(Some(format!(
                    "the renderer did not answer within {} s and was ended; an answer ends with a newline, \
                     and is flushed",
                    timeout.as_secs_f64(),
                )));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    };
    if line.len() >= MOST_LINE {
        let most = MOST_LINE / 1024;
        return wrong(format!(
            "answered with a line that is longer than {most} KiB"
        ));
    }
    let one_line = |words: &str| plain(&words.replace('\n', " "));
    match serde_json::from_str(&line).map(|it: Answer| (it.image, it.error, it.cannot)) {
        Ok((Some(image), None, None)) if image == output => Ok(None),
        Ok((Some(image), None, None)) => {
            wrong(format!("wrote {} instead of {output}", one_line(&image)))
        }
        Ok((None, Some(words), None)) => Ok(Some(Output::Unusable(format!(
            "the renderer failed: {}",
            one_line(&words)
        )))),
        Ok((None, None, Some(words))) => Ok(Some(Output::Missing(format!(
            "{NOT_RENDERED}{}",
            one_line(&words)
        )))),
        Ok(_) => wrong("gave an answer that does not have exactly one of image, error and cannot"),
        Err(error) => wrong(format!(
            "gave an answer that cannot be read ({error}): {}",
            plain(&line)
        )),
    }
}

/// A renderer that is ended for what it did.
fn wrong<T>(fault: impl Display) -> Result<T, Option<String>> {
    Err(Some(format!("the renderer {fault}; it was ended")))
}
