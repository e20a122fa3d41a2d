//! Processes of another renderer: one that runs until it ends or until its time limit, or that stays.
//!
//! It leads its own process group, and when it ends, or at its time limit, all processes that it
//! started are ended, too: by a [`Keeper`] if there is one, else by the process group.

use super::keeper::{Keeper, Kept, SEES_DAEMONS, feed};
use super::printed::{Printed, quoted_words};
use crate::suite::Output;
use process_wrap::std::{ChildWrapper, CommandWrap};
use std::io::{self, BufRead, BufReader, Read, pipe};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, sync_channel};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Outcome of a call of a renderer, or of a request.
#[derive(Debug)]
pub(super) struct Called {
    /// The output where there is no image.
    pub failure: Option<Output>,
    /// Notes beside the verdict, a sentence each.
    pub notes: Vec<String>,
    /// Standard output and error of the renderer, or their end if they are long.
    pub printed: String,
}

/// How long a process may take to notice that it is over.
pub(super) const PAUSE: Duration = Duration::from_millis(5);

/// How long to listen to what still holds the pipe after the renderer has ended. All that was
/// printed before is in the pipe by then, and is read at once.
pub(super) const LISTEN: Duration = Duration::from_secs(1);

/// How long a keeper that is to end may take: longer than it waits itself.
const KEEPERS_PATIENCE: Duration = Duration::from_secs(10);

/// Programs of some systems write it before their first line.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Longest answer, bytes.
pub(super) const MOST_LINE: usize = 64 * 1024;

/// Answers that wait, at most: a renderer that goes on answering waits, too.
const MOST_WAITING: usize = 16;

/// Programs that are running, and whether no more may be.
static RUNNING: AtomicUsize = AtomicUsize::new(0);
static STOPPED: AtomicBool = AtomicBool::new(false);

/// How long [`stop_all`] waits for programs that do not go.
const PATIENCE: Duration = Duration::from_secs(3);

/// Ends every program that `run` has running, with all its processes, and starts no more. For a
/// process that is about to end, since its children have their own process groups and would
/// continue. Returns when they are gone.
pub fn stop_all() {
    STOPPED.store(true, Ordering::SeqCst);
    let start = Instant::now();
    while RUNNING.load(Ordering::SeqCst) > 0 && start.elapsed() < PATIENCE {
        sleep(PAUSE);
    }
}

/// True once all programs are to end.
pub(super) fn is_stopped() -> bool {
    STOPPED.load(Ordering::SeqCst)
}

/// Does `work` with the program that `words` call, which counts as running. The error says why it could not be started.
pub(super) fn counted(words: &[String], work: impl FnOnce() -> Result<Called, String>) -> Called {
    // Counted before it is asked whether all are stopped: whoever stops asks in the other order, so one of the two sees
    // the other.
    RUNNING.fetch_add(1, Ordering::SeqCst);
    let called = work();
    RUNNING.fetch_sub(1, Ordering::SeqCst);
    called.unwrap_or_else(|error| Called {
        failure: Some(Output::Unusable(not_started_in_words(&words[0], &error))),
        notes: Vec::new(),
        printed: String::new(),
    })
}

/// Runs a program until it ends, or until `timeout`. `words` are the program and its arguments.
/// Without a `keeper`, processes that have left the program's process group are not ended with it.
pub(super) fn run(words: &[String], timeout: Duration, keeper: Option<&Keeper>) -> Called {
    counted(words, || {
        let mut process = Process::start(words, keeper, false)?;
        let (printed, has_keeper) = (process.printed.clone(), process.has_keeper);
        let has_ended = || Ok(process.child.try_wait()?.is_some());
        let in_time = ended_within(timeout, &STOPPED, has_ended);
        let kept = process.end(Duration::ZERO)?;
        // It may have ended in time, and what it left behind not.
        let by_itself = kept.code.is_some() || matches!(in_time, Ok(true));
        let failure = match in_time {
            Ok(_) if by_itself => failure_of(&kept),
            Ok(_) => Some(why_ended(timeout, has_keeper)),
            Err(error) => Some(format!("the renderer could not be waited for: {error}")),
        };
        let printed = printed.take(LISTEN);
        Ok(Called {
            failure: failure.map(|reason| Output::Unusable(reason + &quoted_words(&printed))),
            notes: remnants(&kept, by_itself),
            printed,
        })
    })
}

pub(super) fn not_started_in_words(program: &str, error: &str) -> String {
    format!(
        "the renderer {program:?} could not be started: {error}; there is no shell, which would \
             know built-in commands, variables and && (for one: sh -c '…')"
    )
}

/// Sentences on the processes that a renderer left running; if it ended `by_itself`, on those that were ended, too.
pub(super) fn remnants(kept: &Kept, by_itself: bool) -> Vec<String> {
    let mut notes = Vec::new();
    // A renderer that was itself ended has its message already.
    if !kept.ended.is_empty() && by_itself {
        let ended = kept.ended.join(", ");
        notes.push(format!(
            "the renderer left processes running, which were ended: {ended}"
        ));
    }
    if !kept.left.is_empty() {
        let left = kept.left.join(", ");
        notes.push(format!(
            "the renderer left processes running that could not be ended: {left}"
        ));
    }
    notes
}

/// A renderer that was started, and its pipes.
#[derive(Debug)]
pub(super) struct Process {
    child: Box<dyn ChildWrapper>,
    pub has_keeper: bool,
    /// Its standard input, which ends with the sender.
    pub requests: Option<Sender<Vec<u8>>>,
    /// The lines of its standard output that begin like JSON; the last of all is the report of a keeper.
    pub lines: Receiver<String>,
    /// The last of them that was read where none was asked for.
    pub last: String,
    pub printed: Printed,
}

impl Process {
    /// Starts a renderer, below `keeper` if there is one, as the leader of a process group, or in a job on Windows. One
    /// that does not stay is given no input, and its standard output is like its standard error.
    pub fn start(
        words: &[String],
        keeper: Option<&Keeper>,
        stays: bool,
    ) -> Result<Process, String> {
        if is_stopped() {
            return Err("volref is ending".to_owned());
        }
        let in_words = |error: io::Error| error.to_string();
        let (log, writer) = pipe().map_err(in_words)?;
        let mut command =
            Command::new(keeper.map_or(words[0].as_ref(), |it| it.program.as_os_str()));
        match keeper {
            Some(keeper) => command.args(&keeper.arguments).args(words),
            None => command.args(&words[1..]),
        };
        // A keeper is told to end by the end of its standard input, and prints its report.
        if stays || keeper.is_some() {
            command.stdin(Stdio::piped()).stdout(Stdio::piped());
        } else {
            let writer = writer.try_clone().map_err(in_words)?;
            command.stdin(Stdio::null()).stdout(writer);
        }
        command.stderr(writer);
        let mut command = CommandWrap::from(command);
        // A Ctrl-C at the terminal is for volref, which ends the keeper in its own way.
        #[cfg(unix)]
        command.wrap(process_wrap::std::ProcessGroup::leader());
        #[cfg(windows)]
        command.wrap(process_wrap::std::JobObject);
        let mut child = command.spawn().map_err(in_words)?;
        let printed = Printed::hear(log);
        let (sender, lines) = sync_channel(MOST_WAITING);
        if let Some(stdout) = child.stdout().take() {
            let printed = printed.clone();
            // Not joined: what has left the reach of volref may hold the pipe open for ever.
            std::thread::spawn(move || read_lines(stdout, &sender, &printed));
        }
        Ok(Process {
            requests: child.stdin().take().map(feed),
            has_keeper: keeper.is_some(),
            child,
            lines,
            last: String::new(),
            printed,
        })
    }

    /// Ends it: with its standard input, or by force, after `patience` or after that of a keeper; and with all that it
    /// started. The end as its keeper reports it, or by its own exit status without a keeper.
    pub fn end(mut self, patience: Duration) -> Result<Kept, String> {
        self.requests = None;
        let patience = if self.has_keeper {
            KEEPERS_PATIENCE
        } else {
            patience
        };
        let mut status = None;
        let ended = ended_within(patience, &AtomicBool::new(false), || {
            // Few at a time: it may go on answering.
            if let Some(line) = self.lines.try_iter().take(MOST_WAITING).last() {
                self.last = line;
            }
            status = self.child.try_wait()?;
            Ok(status.is_some())
        });
        // Processes that it started may still be there; that nothing is left is no error.
        let _ = self.child.start_kill();
        let status = match (ended, status) {
            (_, Some(status)) => Ok(status),
            (Err(error), None) => Err(error),
            (Ok(_), None) => self.child.wait(),
        };
        if !self.has_keeper {
            let status = status.map_err(|error| error.to_string())?;
            return Ok(Kept {
                code: status.code(),
                signal: signal_of(status),
                ..Kept::default()
            });
        }
        let end = Instant::now() + LISTEN;
        let left = || end.saturating_duration_since(Instant::now());
        while !left().is_zero()
            && let Ok(line) = self.lines.recv_timeout(left())
        {
            self.last = line;
        }
        // A report that is cut off is no JSON.
        let kept: Kept = serde_json::from_str(&self.last).map_err(|_| match status {
            Ok(status) => format!("its keeper ended without a report ({status})"),
            Err(error) => format!("its keeper ended without a report ({error})"),
        })?;
        kept.not_started.clone().map_or(Ok(kept), Err)
    }
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

/// Asks until it has ended, its time is over, or it is to be stopped.
fn ended_within(
    timeout: Duration,
    stop: &AtomicBool,
    mut ask: impl FnMut() -> io::Result<bool>,
) -> io::Result<bool> {
    let start = Instant::now();
    loop {
        if ask()? {
            return Ok(true);
        }
        if stop.load(Ordering::SeqCst) || start.elapsed() >= timeout {
            return Ok(false);
        }
        sleep(PAUSE.min(timeout.saturating_sub(start.elapsed())));
    }
}

/// Reason for which the renderer was ended: volref is ending, or the time is over.
fn why_ended(timeout: Duration, has_keeper: bool) -> String {
    let why = if is_stopped() {
        "volref was told to end, and ended the renderer".to_owned()
    } else {
        let seconds = timeout.as_secs_f64();
        format!("the renderer did not end within {seconds} s and was ended")
    };
    format!("{why}, {}", reach(has_keeper))
}

/// The processes that were ended with a renderer, in words.
pub(super) fn reach(has_keeper: bool) -> &'static str {
    // A job of Windows has all in it, a process group what did not leave.
    if has_keeper && SEES_DAEMONS || !has_keeper && cfg!(windows) {
        "with all that it had started"
    } else {
        "with its process group; a daemon that has left the group may still run"
    }
}

#[cfg(unix)]
fn signal_of(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal_of(_: ExitStatus) -> Option<i32> {
    None
}

pub(super) fn failure_of(kept: &Kept) -> Option<String> {
    match (kept.code, kept.signal) {
        (Some(0), _) => None,
        (_, Some(signal)) => Some(format!(
            "the renderer crashed: it was ended by signal {signal}"
        )),
        (Some(code), None) => Some(format!(
            "the renderer failed: it ended with exit code {code}"
        )),
        (None, None) => Some("the renderer failed: it ended without an exit code".to_owned()),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str, seconds: f64) -> Called {
        let words = ["sh", "-c", script].map(str::to_owned);
        run(&words, Duration::from_secs_f64(seconds), None)
    }

    fn failure(called: Called) -> String {
        match called.failure {
            Some(Output::Unusable(reason)) => reason,
            _ => String::new(),
        }
    }

    #[test]
    fn ends_well_and_is_heard() {
        let ran = shell("echo out; echo err >&2", 10.0);
        assert!(ran.failure.is_none());
        assert_eq!(ran.printed, "out\nerr\n");
    }

    #[test]
    fn exit_codes_and_signals_are_failures() {
        let code = failure(shell("exit 7", 10.0));
        assert_eq!(code, "the renderer failed: it ended with exit code 7");
        let signal = failure(shell("kill -SEGV $$", 10.0));
        assert_eq!(signal, "the renderer crashed: it was ended by signal 11");
        let words = ["/no/such/renderer".to_owned()];
        let absent = failure(run(&words, Duration::from_secs(1), None));
        assert!(absent.contains("could not be started"), "{absent}");
    }

    /// The process that hangs is one that the renderer started, and it is ended as well.
    #[test]
    fn time_is_over_for_all_that_was_started() {
        let folder = tempfile::tempdir().unwrap();
        let pid = folder.path().join("pid");
        let script = format!("sleep 1000 & echo $! > {}; wait", pid.display());
        let ran = shell(&script, 0.5);
        assert!(failure(ran).contains("did not end within 0.5 s"));
        assert_is_gone(&pid);
    }

    /// What a renderer leaves behind does not keep anybody waiting, nor running.
    #[test]
    fn nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let pid = folder.path().join("pid");
        let start = Instant::now();
        let ran = shell(&format!("sleep 1000 & echo $! > {}", pid.display()), 500.0);
        assert!(ran.failure.is_none());
        assert!(start.elapsed() < Duration::from_secs(250));
        assert_is_gone(&pid);
    }

    /// Without a keeper a daemon gets away, but nobody waits for it to close what it prints to.
    #[test]
    fn nobody_waits_for_a_daemon() {
        let folder = tempfile::tempdir().unwrap();
        let pid = folder.path().join("pid");
        let script = format!(
            "echo rendered; setsid sleep 1000 & echo $! > {0}.new; mv {0}.new {0}",
            pid.display()
        );
        let start = Instant::now();
        let ran = shell(&script, 500.0);
        let _ = Command::new("kill")
            .arg(std::fs::read_to_string(&pid).unwrap().trim())
            .status();
        assert_eq!(ran.printed, "rendered\n");
        assert!(ran.failure.is_none() && ran.notes.is_empty());
        assert!(start.elapsed() < Duration::from_secs(250));
    }

    /// A process that was ended is gone, or waits as a zombie for whoever inherits it.
    fn assert_is_gone(pid: &std::path::Path) {
        let pid = std::fs::read_to_string(pid).unwrap();
        let status = format!("/proc/{}/status", pid.trim());
        for _ in 0..500 {
            match std::fs::read_to_string(&status) {
                Ok(text) if !text.contains("State:\tZ") => sleep(Duration::from_millis(10)),
                _ => return,
            }
        }
        panic!("process {pid} is still there");
    }

    #[test]
    fn only_the_end_of_much_is_kept() {
        let ran = shell("head -c 200000 /dev/zero | tr '\\0' x; echo end", 30.0);
        assert!(ran.printed.len() < 70_000);
        assert!(
            ran.printed
                .starts_with("[the first 134468 bytes are left out]")
        );
        assert!(ran.printed.ends_with("xend\n"));
    }
}
