//! Processes of another renderer: one that runs until it ends or until its time limit, or that stays.
//!
//! It leads its own process group, or on Windows a job: when it ends, or at its time limit, the group is ended. A
//! daemon that has left the group is not.

use super::printed::{Printed, quoted_words};
use crate::suite::Output;
use process_wrap::std::{ChildWrapper, CommandWrap};
use std::io::{self, BufRead, BufReader, Read, pipe};
use std::process::{ChildStdin, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Outcome of a call of a renderer, or of a request.
#[derive(Debug, Default)]
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

/// Ends every program that `run` has running, with its process group, and starts no more. For a
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

/// Does `work` with a program, which counts as running. The error says why there is no program to work with.
pub(super) fn counted(work: impl FnOnce() -> Result<Called, String>) -> Called {
    // Counted before it is asked whether all are stopped: whoever stops asks in the other order, so one of the two sees
    // the other.
    RUNNING.fetch_add(1, Ordering::SeqCst);
    let called = work();
    RUNNING.fetch_sub(1, Ordering::SeqCst);
    called.unwrap_or_else(|error| Called {
        failure: Some(Output::Unusable(error)),
        ..Called::default()
    })
}

/// Runs a program until it ends, or until `timeout`. `words` are the program and its arguments.
pub(super) fn run(words: &[String], timeout: Duration) -> Called {
    counted(|| {
        let mut process = Process::start(words, false)?;
        let printed = process.printed.clone();
        let in_time = process.ends_within(timeout, &STOPPED);
        let status = process.end(Duration::ZERO)?;
        let failure = match in_time {
            true => failure_of(status),
            false if is_stopped() => Some(ENDED_WITH_VOLREF.to_owned()),
            false => Some(format!(
                "the renderer did not end within {} s and was ended",
                timeout.as_secs_f64()
            )),
        };
        let printed = printed.take(LISTEN);
        Ok(Called {
            failure: failure.map(|reason| Output::Unusable(reason + &quoted_words(&printed))),
            notes: Vec::new(),
            printed,
        })
    })
}

/// Reason for which a renderer was ended with volref.
pub(super) const ENDED_WITH_VOLREF: &str = "the renderer was ended with volref";

/// A renderer that was started, and its pipes.
#[derive(Debug)]
pub(super) struct Process {
    child: Box<dyn ChildWrapper>,
    /// Its standard input, if it stays.
    pub requests: Option<ChildStdin>,
    /// The lines of its standard output that begin like JSON, if it stays.
    pub lines: Receiver<String>,
    pub printed: Printed,
}

impl Process {
    /// Starts a renderer as the leader of a process group, or in a job on Windows. One that does not stay is given no
    /// input, and its standard output is like its standard error.
    pub fn start(words: &[String], stays: bool) -> Result<Process, String> {
        if is_stopped() {
            return Err("volref is ending".to_owned());
        }
        let in_words = |error: io::Error| {
            format!(
                "the renderer {:?} could not be started: {error}; there is no shell, which would \
                 know built-in commands, variables and && (for one: sh -c '…')",
                words[0]
            )
        };
        let (log, writer) = pipe().map_err(in_words)?;
        let mut command = Command::new(&words[0]);
        command.args(&words[1..]);
        if stays {
            command.stdin(Stdio::piped()).stdout(Stdio::piped());
        } else {
            let writer = writer.try_clone().map_err(in_words)?;
            command.stdin(Stdio::null()).stdout(writer);
        }
        command.stderr(writer);
        let mut command = CommandWrap::from(command);
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
            requests: child.stdin().take(),
            child,
            lines,
            printed,
        })
    }

    /// Waits until it has ended, its time is over, or all are to `stop`; true if it has ended.
    fn ends_within(&mut self, timeout: Duration, stop: &AtomicBool) -> bool {
        let start = Instant::now();
        loop {
            if matches!(self.child.try_wait(), Ok(Some(_))) {
                return true;
            }
            if stop.load(Ordering::SeqCst) || start.elapsed() >= timeout {
                return false;
            }
            // It may go on answering: few at a time.
            self.lines.try_iter().take(MOST_WAITING).for_each(drop);
            sleep(PAUSE.min(timeout.saturating_sub(start.elapsed())));
        }
    }

    /// Ends it with its standard input, or after `patience` by force, and its process group.
    pub fn end(mut self, patience: Duration) -> Result<ExitStatus, String> {
        self.requests = None;
        self.ends_within(patience, &AtomicBool::new(false));
        // Processes that it started may still be there; that nothing is left is no error.
        let _ = self.child.start_kill();
        let waited = self.child.wait();
        waited.map_err(|error| format!("the renderer could not be waited for: {error}"))
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

/// Why a renderer that ended by itself failed, if it did.
pub(super) fn failure_of(status: ExitStatus) -> Option<String> {
    (!status.success()).then(|| format!("the renderer failed: {status}"))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn shell(script: &str, seconds: f64) -> Called {
        let words = ["sh", "-c", script].map(str::to_owned);
        run(&words, Duration::from_secs_f64(seconds))
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
        assert_eq!(code, "the renderer failed: exit status: 7");
        let signal = failure(shell("kill -SEGV $$", 10.0));
        assert!(signal.starts_with("the renderer failed: signal: 11 (SIGSEGV)"));
        let words = ["/no/such/renderer".to_owned()];
        let absent = failure(run(&words, Duration::from_secs(1)));
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

    /// A daemon gets away, but nobody waits for it to close what it prints to.
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
