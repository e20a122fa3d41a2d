//! Renderers that stay: started once, and asked for one image after the other.
//!
//! A request is a line of JSON on standard input, an answer a line of JSON on standard output. What else it prints
//! there is output like that on standard error. A renderer that ended, did not answer in time or answered otherwise is
//! ended with all that it started, and another is started for the next image.

use super::keeper::{Keeper, Kept, LEAVE};
use super::printed::{plain, quoted_words};
use super::process::{
    Called, LISTEN, MOST_LINE, PAUSE, Process, counted, failure_of, is_stopped,
    not_started_in_words, reach, remnants,
};
use crate::suite::{NOT_RENDERED, Output};
use serde::Deserialize;
use std::fmt::Display;
use std::sync::mpsc::{RecvTimeoutError, TryRecvError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Renderers of one command that stay, as many as are asked at a time.
#[derive(Clone, Debug)]
pub(crate) struct StayingRenderers {
    words: Vec<String>,
    timeout: Duration,
    keeper: Option<Keeper>,
    /// Renderers that nobody asks.
    idle: Arc<Mutex<Vec<Process>>>,
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
        counted(&self.words, || self.asked(request, output))
    }

    fn asked(&self, request: &str, output: &str) -> Result<Called, String> {
        let mut notes = Vec::new();
        let mut renderer = self.ready(&mut notes)?;
        let one_line = |words: &str| plain(&words.replace('\n', " "));
        let answer = answer(&mut renderer, request, self.timeout);
        let fault = match answer.map(|it| (it.image, it.error, it.cannot)) {
            Ok((Some(image), None, None)) if image == output => {
                return Ok(self.answered(renderer, None, notes));
            }
            Ok((None, Some(words), None)) => {
                let reason = format!("the renderer failed: {}", one_line(&words));
                return Ok(self.answered(renderer, Some(Output::Unusable(reason)), notes));
            }
            Ok((None, None, Some(words))) => {
                let reason = format!("{NOT_RENDERED}{}", one_line(&words));
                return Ok(self.answered(renderer, Some(Output::Missing(reason)), notes));
            }
            Ok((Some(image), None, None)) => {
                let image = one_line(&image);
                wrong(format!(
                    "answered with the image {image}, and was asked for {output}"
                ))
            }
            Ok(_) => wrong("answered with none or several of image, error and cannot"),
            Err(fault) => fault,
        };
        let printed = renderer.printed.clone();
        let ended = renderer.end(LEAVE);
        let printed = printed.take(LISTEN);
        let reason = match ended {
            Err(error) => not_started_in_words(&self.words[0], &error),
            Ok(kept) => {
                notes.extend(remnants(&kept, fault.is_none()));
                let by_itself = || {
                    failure_of(&kept).unwrap_or_else(|| {
                        "the renderer ended before it answered: one that stays reads requests to the end of its \
                         standard input"
                            .to_owned()
                    })
                };
                fault.unwrap_or_else(by_itself)
            }
        };
        Ok(Called {
            failure: Some(Output::Unusable(reason + &quoted_words(&printed))),
            notes,
            printed,
        })
    }

    /// The outcome of a request that was answered. The renderer is put back for another image.
    fn answered(&self, renderer: Process, failure: Option<Output>, notes: Vec<String>) -> Called {
        let printed = renderer.printed.take(Duration::ZERO);
        self.idle().push(renderer);
        let failure = failure.map(|failure| match failure {
            Output::Unusable(reason) => Output::Unusable(reason + &quoted_words(&printed)),
            other => other,
        });
        Called {
            failure,
            notes,
            printed,
        }
    }

    /// A renderer that waits for a request: one that stayed, or else a new one.
    fn ready(&self, notes: &mut Vec<String>) -> Result<Process, String> {
        if is_stopped() {
            return Err("volref is ending".to_owned());
        }
        loop {
            let Some(mut staying) = self.idle().pop() else {
                return Process::start(&self.words, self.keeper.as_ref(), true);
            };
            let fault = match staying.lines.try_recv() {
                Err(TryRecvError::Empty) => return Ok(staying),
                Ok(line) if !is_report(&line) => {
                    format!("answered without being asked: {}", plain(&line))
                }
                other => {
                    staying.last = other.unwrap_or_default();
                    "ended after its last image".to_owned()
                }
            };
            let _ = staying.end(LEAVE);
            notes.push(format!("the renderer {fault}; it was started again"));
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Process>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The answer of `renderer` to `request`; else why there is no right one, `None` of a renderer that ended.
fn answer(
    renderer: &mut Process,
    request: &str,
    timeout: Duration,
) -> Result<Answer, Option<String>> {
    if let Some(requests) = &renderer.requests {
        // Who has ended says so by its lines.
        let _ = requests.send(format!("{request}\n").into_bytes());
    }
    let start = Instant::now();
    let line = loop {
        let left = timeout.saturating_sub(start.elapsed());
        match renderer.lines.recv_timeout(left.min(PAUSE)) {
            Ok(line) => break line,
            Err(RecvTimeoutError::Disconnected) => return Err(None),
            Err(RecvTimeoutError::Timeout) if is_stopped() => {
                return Err(Some("the renderer was ended with volref".to_owned()));
            }
            Err(RecvTimeoutError::Timeout) if left.is_zero() => {
                return Err(Some(format!(
                    "the renderer did not answer within {} s and was ended, {}; an answer ends with a newline, \
                     and is flushed",
                    timeout.as_secs_f64(),
                    reach(renderer.has_keeper),
                )));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    };
    if renderer.has_keeper && is_report(&line) {
        renderer.last = line;
        return Err(None);
    }
    if line.len() >= MOST_LINE {
        let most = MOST_LINE / 1024;
        return Err(wrong(format!(
            "answered with a line that is longer than {most} KiB"
        )));
    }
    serde_json::from_str(&line).map_err(|error| {
        let line = plain(&line);
        wrong(format!(
            "gave an answer that cannot be read ({error}): {line}"
        ))
    })
}

/// Words on a renderer that is ended for what it did.
fn wrong(fault: impl Display) -> Option<String> {
    Some(format!("the renderer {fault}; it was ended"))
}

/// True of a line that may be the report of a keeper.
fn is_report(line: &str) -> bool {
    serde_json::from_str::<Kept>(line).is_ok()
}
