//! Runs another renderer until it ends, or until its time limit.
//!
//! It leads its own process group, and when it ends, or at its time limit, all processes that it
//! started are ended, too: by a [`Keeper`] if there is one, else by the process group.

use super::keeper::{Keeper, Kept, SEES_DAEMONS};
use super::printed::Printed;
use process_wrap::std::{ChildWrapper, CommandWrap};
use std::io::{self, Read, pipe};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// The outcome of a process.
#[derive(Debug)]
pub struct Ran {
    /// Reason why its output cannot be used; `None` if it succeeded.
    pub failure: Option<String>,
    /// Processes that it left running, a sentence each.
    pub notes: Vec<String>,
    /// Its standard output and error, or their end if they are long.
    pub printed: String,
}

/// How long a process may take to notice that it is over.
pub(super) const PAUSE: Duration = Duration::from_millis(5);

/// How long to listen to what still holds the pipe after the renderer has ended. All that was
/// printed before is in the pipe by then, and is read at once.
pub(super) const LISTEN: Duration = Duration::from_secs(1);

/// How long a keeper that is to end may take: longer than it waits itself.
pub(super) const KEEPERS_PATIENCE: Duration = Duration::from_secs(10);

/// Programs that are running, and whether no more may be.
pub(super) static RUNNING: AtomicUsize = AtomicUsize::new(0);
pub(super) static STOPPED: AtomicBool = AtomicBool::new(false);

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

/// Runs a program until it ends, or until `timeout`. `words` are the program and its arguments.
/// Without a `keeper`, processes that have left the program's process group are not ended with it.
pub fn run(words: &[String], timeout: Duration, keeper: Option<&Keeper>) -> Ran {
    // Counted before it is asked: whoever stops asks in the other order, so one of the two sees
    // the other.
    RUNNING.fetch_add(1, Ordering::SeqCst);
    let ran = run_to_end(words, timeout, keeper);
    RUNNING.fetch_sub(1, Ordering::SeqCst);
    ran.unwrap_or_else(|error| Ran {
        failure: Some(not_started_in_words(&words[0], &error)),
        notes: Vec::new(),
        printed: String::new(),
    })
}

/// As [`run`]; an error if the program could not be started.
fn run_to_end(words: &[String], timeout: Duration, keeper: Option<&Keeper>) -> Result<Ran, String> {
    if STOPPED.load(Ordering::SeqCst) {
        return Err("volref is ending".to_owned());
    }
    let in_words = |error: io::Error| error.to_string();
    let (log, writer) = pipe().map_err(in_words)?;
    let has_keeper = keeper.is_some();
    // A keeper is told to end by the end of its standard input, and prints its report.
    let [stdin, stdout] = match has_keeper {
        true => [Stdio::piped(), Stdio::piped()],
        false => [Stdio::null(), writer.try_clone().map_err(in_words)?.into()],
    };
    let mut child = start(words, keeper, [stdin, stdout, writer.into()])?;
    let printed = Printed::hear(log);
    let in_time = has_ended(timeout, &STOPPED, || Ok(child.try_wait()?.is_some()));
    drop(child.stdin().take());
    let patience = match has_keeper {
        true => KEEPERS_PATIENCE,
        false => Duration::ZERO,
    };
    let status = status_at_end(&mut *child, patience, || {});
    let mut report = String::new();
    if let Some(mut stdout) = child.stdout().take() {
        // A report that is cut off is no JSON.
        let _ = stdout.read_to_string(&mut report);
    }
    let kept = kept(has_keeper, &report, status)?;
    // It may have ended in time, and what it left behind not.
    let by_itself = kept.code.is_some() || matches!(in_time, Ok(true));
    let failure = match in_time {
        Ok(_) if by_itself => failure_of(kept.code, kept.signal),
        Ok(_) => Some(why_ended(timeout, has_keeper)),
        Err(error) => Some(format!("the renderer could not be waited for: {error}")),
    };
    Ok(Ran {
        failure,
        notes: remnants(&kept, by_itself),
        printed: printed.take(LISTEN),
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

/// Waits up to `patience` for a process, then ends it with its group; its exit status.
pub(super) fn status_at_end(
    child: &mut dyn ChildWrapper,
    patience: Duration,
    mut meanwhile: impl FnMut(),
) -> io::Result<ExitStatus> {
    let mut status = None;
    let ended = has_ended(patience, &AtomicBool::new(false), || {
        meanwhile();
        status = child.try_wait()?;
        Ok(status.is_some())
    });
    // Processes that it started may still be there; that nothing is left is no error.
    let _ = child.start_kill();
    match (ended, status) {
        (_, Some(status)) => Ok(status),
        (Err(error), None) => Err(error),
        (Ok(_), None) => child.wait(),
    }
}

/// The end of a renderer, as its keeper reports it, or by its own exit status without a keeper.
pub(super) fn kept(
    has_keeper: bool,
    report: &str,
    status: io::Result<ExitStatus>,
) -> Result<Kept, String> {
    if !has_keeper {
        let status = status.map_err(|error| error.to_string())?;
        return Ok(Kept {
            code: status.code(),
            signal: signal_of(status),
            ..Kept::default()
        });
    }
    let kept: Kept = serde_json::from_str(report).map_err(|_| match status {
        Ok(status) => format!("its keeper ended without a report ({status})"),
        Err(error) => format!("its keeper ended without a report ({error})"),
    })?;
    kept.not_started.clone().map_or(Ok(kept), Err)
}

/// Starts a renderer, below `keeper` if there is one, as the leader of a process group, or in a job on Windows. `pipes`
/// are its standard input, output and error.
pub(super) fn start(
    words: &[String],
    keeper: Option<&Keeper>,
    pipes: [Stdio; 3],
) -> Result<Box<dyn ChildWrapper>, String> {
    let mut command = match keeper {
        Some(keeper) => keeper.command(words),
        None => {
            let mut command = Command::new(&words[0]);
            command.args(&words[1..]);
            command
        }
    };
    let [stdin, stdout, stderr] = pipes;
    command.stdin(stdin).stdout(stdout).stderr(stderr);
    let mut command = CommandWrap::from(command);
    // A Ctrl-C at the terminal is for volref, which ends the keeper in its own way.
    #[cfg(unix)]
    command.wrap(process_wrap::std::ProcessGroup::leader());
    #[cfg(windows)]
    command.wrap(process_wrap::std::JobObject);
    command.spawn().map_err(|error| error.to_string())
}

/// Asks until it has ended, its time is over, or it is to be stopped.
pub(super) fn has_ended(
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
    let why = if STOPPED.load(Ordering::SeqCst) {
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

pub(super) fn failure_of(code: Option<i32>, signal: Option<i32>) -> Option<String> {
    match (code, signal) {
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

    fn shell(script: &str, seconds: f64) -> Ran {
        let words = ["sh", "-c", script].map(str::to_owned);
        run(&words, Duration::from_secs_f64(seconds), None)
    }

    #[test]
    fn ends_well_and_is_heard() {
        let ran = shell("echo out; echo err >&2", 10.0);
        assert_eq!(ran.failure, None);
        assert_eq!(ran.printed, "out\nerr\n");
    }

    #[test]
    fn exit_codes_and_signals_are_failures() {
        let code = shell("exit 7", 10.0).failure.unwrap();
        assert_eq!(code, "the renderer failed: it ended with exit code 7");
        let signal = shell("kill -SEGV $$", 10.0).failure.unwrap();
        assert_eq!(signal, "the renderer crashed: it was ended by signal 11");
        let words = ["/no/such/renderer".to_owned()];
        let absent = run(&words, Duration::from_secs(1), None).failure.unwrap();
        assert!(absent.contains("could not be started"), "{absent}");
    }

    /// The process that hangs is one that the renderer started, and it is ended as well.
    #[test]
    fn time_is_over_for_all_that_was_started() {
        let folder = tempfile::tempdir().unwrap();
        let pid = folder.path().join("pid");
        let script = format!("sleep 1000 & echo $! > {}; wait", pid.display());
        let ran = shell(&script, 0.5);
        assert!(ran.failure.unwrap().contains("did not end within 0.5 s"));
        assert_is_gone(&pid);
    }

    /// What a renderer leaves behind does not keep anybody waiting, nor running.
    #[test]
    fn nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let pid = folder.path().join("pid");
        let start = Instant::now();
        let ran = shell(&format!("sleep 1000 & echo $! > {}", pid.display()), 500.0);
        assert_eq!(ran.failure, None);
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
        assert_eq!((ran.failure, ran.notes), (None, Vec::new()));
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
