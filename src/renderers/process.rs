//! Runs another renderer until it ends, or until its time limit.
//!
//! It leads its own process group, and when it ends, or at its time limit, all processes that it
//! started are ended, too: by a [`Keeper`] if there is one, else by the process group.

use super::keeper::{Keeper, Kept, SEES_DAEMONS};
use super::printed::Printed;
use process_wrap::std::{ChildWrapper, CommandWrap};
use std::io::{PipeWriter, Read, pipe};
use std::process::{Child, Command, ExitStatus, Stdio};
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
    let (reader, writer) = match pipe() {
        Ok(ends) => ends,
        Err(error) => return not_started(&words[0], &error.to_string()),
    };
    // Counted before it is asked: whoever stops asks in the other order, so one of the two sees
    // the other.
    RUNNING.fetch_add(1, Ordering::SeqCst);
    let printed = Printed::hear(reader);
    let ended = if STOPPED.load(Ordering::SeqCst) {
        Err("volref is ending".to_owned())
    } else {
        match keeper {
            Some(keeper) => run_kept(words, writer, timeout, keeper),
            None => run_in_group(words, writer, timeout),
        }
    };
    RUNNING.fetch_sub(1, Ordering::SeqCst);
    match ended {
        Err(error) => not_started(&words[0], &error),
        Ok((failure, notes)) => Ran {
            failure,
            notes,
            printed: printed.take(LISTEN),
        },
    }
}

fn not_started(program: &str, error: &str) -> Ran {
    Ran {
        failure: Some(not_started_in_words(program, error)),
        notes: Vec::new(),
        printed: String::new(),
    }
}

pub(super) fn not_started_in_words(program: &str, error: &str) -> String {
    format!(
        "the renderer {program:?} could not be started: {error}; there is no shell, which would \
             know built-in commands, variables and && (for one: sh -c '…')"
    )
}

/// Why a program did not end well, if so, and what it has left running; or why it could not be
/// started.
type Ended = Result<(Option<String>, Vec<String>), String>;

/// Runs a program below `keeper`.
fn run_kept(words: &[String], log: PipeWriter, timeout: Duration, keeper: &Keeper) -> Ended {
    let mut command = keeper.command(words);
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(log);
    // A Ctrl-C at the terminal is for volref, which ends the keeper in its own way.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command
        .spawn()
        .map_err(|error| format!("its keeper: {error}"))?;
    // The command holds the pipe for what is printed.
    drop(command);
    let in_time = has_ended(timeout, &STOPPED, || {
        child.try_wait().map(|ended| ended.is_some())
    });
    // The end of its standard input is the keeper's sign to end.
    drop(child.stdin.take());
    let is_gone = has_ended(KEEPERS_PATIENCE, &AtomicBool::new(false), || {
        child.try_wait().map(|ended| ended.is_some())
    });
    if !matches!(is_gone, Ok(true)) {
        let _ = child.kill();
    }
    let kept = report(&mut child)?;
    if let Some(error) = kept.not_started {
        return Err(error);
    }
    // It may have ended in time, and what it left behind not.
    let by_itself = kept.code.is_some() || matches!(in_time, Ok(true));
    let failure = match in_time {
        Ok(_) if by_itself => failure_of(kept.code, kept.signal),
        Ok(_) => Some(why_ended(timeout, SEES_DAEMONS)),
        Err(error) => Some(format!("the renderer could not be waited for: {error}")),
    };
    Ok((failure, remnants(&kept, by_itself)))
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

/// What the keeper says at its end.
fn report(child: &mut Child) -> Result<Kept, String> {
    let mut text = String::new();
    if let Some(mut stdout) = child.stdout.take() {
        // A report that is cut off is no JSON.
        let _ = stdout.read_to_string(&mut text);
    }
    let status = child.wait();
    report_in(&text, status)
}

/// The report that is `text`, of a keeper that ended with `status`.
pub(super) fn report_in(text: &str, status: std::io::Result<ExitStatus>) -> Result<Kept, String> {
    serde_json::from_str(text).map_err(|_| match status {
        Ok(status) => format!("its keeper ended without a report ({status})"),
        Err(error) => format!("its keeper ended without a report ({error})"),
    })
}

/// Runs a program as the leader of a process group, or in a job on Windows.
fn run_in_group(words: &[String], log: PipeWriter, timeout: Duration) -> Ended {
    let mut child = command_in_group(words, log)
        .and_then(spawn_in_group)
        .map_err(|error| error.to_string())?;
    let mut status = None;
    let in_time = has_ended(timeout, &STOPPED, || {
        status = child.try_wait()?;
        Ok(status.is_some())
    });
    // What it started may still be there; that nothing is left is no error.
    let _ = child.start_kill();
    let failure = match (in_time, status) {
        (Ok(_), Some(status)) => failure_of(status.code(), signal_of(status)),
        (Ok(_), None) => {
            let _ = child.wait();
            // A job of Windows has all in it, a process group what did not leave.
            Some(why_ended(timeout, cfg!(windows)))
        }
        (Err(error), _) => Some(format!("the renderer could not be waited for: {error}")),
    };
    Ok((failure, Vec::new()))
}

fn command_in_group(words: &[String], log: PipeWriter) -> std::io::Result<Command> {
    let mut command = Command::new(&words[0]);
    command
        .args(&words[1..])
        .stdin(Stdio::null())
        .stdout(log.try_clone()?)
        .stderr(log);
    Ok(command)
}

/// Starts `command` as the leader of a process group, or in a job on Windows.
pub(super) fn spawn_in_group(command: Command) -> std::io::Result<Box<dyn ChildWrapper>> {
    let mut command = CommandWrap::from(command);
    #[cfg(unix)]
    command.wrap(process_wrap::std::ProcessGroup::leader());
    #[cfg(windows)]
    command.wrap(process_wrap::std::JobObject);
    command.spawn()
}

/// Asks until it has ended, its time is over, or it is to be stopped.
pub(super) fn has_ended(
    timeout: Duration,
    stop: &AtomicBool,
    mut ask: impl FnMut() -> std::io::Result<bool>,
) -> std::io::Result<bool> {
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
fn why_ended(timeout: Duration, with_daemons: bool) -> String {
    let why = if STOPPED.load(Ordering::SeqCst) {
        "volref was told to end, and ended the renderer".to_owned()
    } else {
        let seconds = timeout.as_secs_f64();
        format!("the renderer did not end within {seconds} s and was ended")
    };
    format!("{why}, {}", reach(with_daemons))
}

/// The processes that were ended with a renderer, in words.
pub(super) fn reach(with_daemons: bool) -> &'static str {
    if with_daemons {
        "with all that it had started"
    } else {
        "with its process group; a daemon that has left the group may still run"
    }
}

#[cfg(unix)]
pub(super) fn signal_of(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
pub(super) fn signal_of(_: ExitStatus) -> Option<i32> {
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
