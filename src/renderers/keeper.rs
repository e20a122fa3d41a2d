//! A process between volref and a renderer that ends all processes the renderer started.
//!
//! Ending a process group ends its members. A daemon leaves its group and its parent, so that
//! nobody would end it. A keeper has one renderer. On Linux a process below the keeper that loses
//! its parent becomes a child of the keeper, so that none escapes and no other renderer is
//! affected. The keeper ends all of them when the renderer ends, and when its own standard input
//! closes: after the time limit, or when volref itself has ended for any reason. A renderer that stays is given
//! what comes from there, and a moment to leave after its end.

use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;

/// The command line of a keeper, before the words of the renderer's command. The program must call
/// [`keep`] and print the result as JSON.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Keeper {
    /// The program.
    pub program: PathBuf,
    /// Its arguments before the command.
    pub arguments: Vec<OsString>,
}

/// The report of a keeper on its renderer.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Kept {
    /// Reason why the renderer could not be started.
    pub not_started: Option<String>,
    /// The exit code of the renderer, if it had one.
    pub code: Option<i32>,
    /// The signal that ended the renderer, if one did.
    pub signal: Option<i32>,
    /// Processes still running after the renderer, which were ended: name and number.
    pub ended: Vec<String>,
    /// Processes still running after the renderer that could not be ended: name and number.
    pub left: Vec<String>,
}

/// Whether a keeper sees processes that have left the renderer's process group, such as daemons.
pub const SEES_DAEMONS: bool = cfg!(target_os = "linux");

/// Longest time that a renderer that stays may take to leave when its requests end.
pub(super) const LEAVE: Duration = Duration::from_secs(1);

/// Writes what is sent into `pipe`, and closes it when the sender is dropped. Nobody waits for a reader.
pub(super) fn feed(mut pipe: impl Write + Send + 'static) -> Sender<Vec<u8>> {
    let (sender, chunks) = channel::<Vec<u8>>();
    std::thread::spawn(move || {
        for chunk in chunks {
            if pipe.write_all(&chunk).and_then(|()| pipe.flush()).is_err() {
                return;
            }
        }
    });
    sender
}

/// Runs the renderer that `words` call, to its end or to that of standard input, then ends all that
/// is left of it. What it prints goes to standard error. If it `stays`, standard input and output are its own, and it
/// has a moment to leave.
#[cfg(not(unix))]
pub fn keep(_words: &[OsString], _stays: bool) -> Kept {
    Kept {
        not_started: Some("this system has no keepers".to_owned()),
        ..Kept::default()
    }
}

#[cfg(unix)]
pub use unix::keep;

#[cfg(unix)]
mod unix {
    use super::{LEAVE, feed};
    use crate::renderers::Kept;
    use nix::errno::Errno;
    use nix::sys::signal::{Signal, kill, killpg};
    use nix::sys::wait::{WaitPidFlag, WaitStatus, waitpid};
    use nix::unistd::Pid;
    use std::collections::BTreeMap;
    use std::ffi::OsString;
    use std::io::Read;
    use std::os::fd::AsFd;
    use std::os::unix::process::{CommandExt, ExitStatusExt};
    use std::process::{Child, Command, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    /// Between two looks at what is still there.
    const PAUSE: Duration = Duration::from_millis(5);

    /// Helpers of a renderer may end a moment after it: only what outlives this is a remnant.
    const GRACE: Duration = Duration::from_millis(100);

    /// How long to wait for what was ended. A process in a call that cannot be interrupted, as to
    /// a disk that does not answer, may never go.
    const PATIENCE: Duration = Duration::from_secs(2);

    /// At most this many leftover processes are named.
    const MOST_NAMED: usize = 8;

    /// Runs the renderer that `words` call, to its end or to that of standard input, then ends all
    /// that is left of it. What it prints goes to standard error. If it `stays`, standard input and output are its
    /// own, and it has a moment to leave.
    pub fn keep(words: &[OsString], stays: bool) -> Kept {
        adopt_orphans();
        let mut renderer = match spawn(words, stays) {
            Ok(renderer) => renderer,
            Err(error) => {
                return Kept {
                    not_started: Some(error.to_string()),
                    ..Kept::default()
                };
            }
        };
        let group = Pid::from_raw(renderer.id() as i32);
        let requests = renderer.stdin.take().map(feed);
        std::thread::spawn(move || {
            let mut chunk = [0; 4096];
            while let Ok(length @ 1..) = std::io::stdin().read(&mut chunk) {
                if let Some(requests) = &requests {
                    // It may have closed its end, and work all the same.
                    let _ = requests.send(chunk[..length].to_vec());
                }
            }
            drop(requests);
            if stays {
                sleep(LEAVE);
            }
            // Until this process ends: what is being started meanwhile is ended next time.
            loop {
                end_all(group);
                sleep(PAUSE);
            }
        });
        let ended = renderer.wait();
        let mut kept = Kept::default();
        match ended {
            Ok(status) => (kept.code, kept.signal) = (status.code(), status.signal()),
            Err(error) => kept.not_started = Some(error.to_string()),
        }
        end_remnants(group, &mut kept);
        kept
    }

    #[cfg(target_os = "linux")]
    fn adopt_orphans() {
        // Without it daemons get away, as on other systems.
        let _ = nix::sys::prctl::set_child_subreaper(true);
        // For whoever looks at a list of processes.
        let _ = nix::sys::prctl::set_name(c"volref-keeper");
    }

    #[cfg(not(target_os = "linux"))]
    fn adopt_orphans() {}

    fn spawn(words: &[OsString], stays: bool) -> std::io::Result<Child> {
        let (program, arguments) = words
            .split_first()
            .ok_or_else(|| std::io::Error::other("there is no command"))?;
        let log = || std::io::stderr().as_fd().try_clone_to_owned();
        let (stdin, stdout) = match stays {
            true => (Stdio::piped(), Stdio::inherit()),
            false => (Stdio::null(), log()?.into()),
        };
        Command::new(program)
            .args(arguments)
            .stdin(stdin)
            .stdout(stdout)
            .stderr(log()?)
            .process_group(0)
            .spawn()
    }

    /// Sends away what is left of the renderer, which has ended.
    fn end_remnants(group: Pid, kept: &mut Kept) {
        let grace = Instant::now();
        let mut remnants = running();
        while has_children() && !remnants.is_empty() && grace.elapsed() < GRACE {
            sleep(PAUSE);
            remnants = running();
        }
        let start = Instant::now();
        loop {
            end_all(group);
            if !has_children() {
                kept.ended = named(&remnants);
                return;
            }
            if start.elapsed() >= PATIENCE {
                kept.left = named(&running());
                if kept.left.is_empty() {
                    kept.left = vec!["a process without a name".to_owned()];
                }
                return;
            }
            sleep(PAUSE);
        }
    }

    /// Names and numbers of processes.
    fn named(processes: &BTreeMap<i32, String>) -> Vec<String> {
        let mut named: Vec<String> = processes
            .iter()
            .take(MOST_NAMED)
            .map(|(number, name)| format!("{name} (process {number})"))
            .collect();
        if processes.len() > MOST_NAMED {
            named.push(format!("{} more", processes.len() - MOST_NAMED));
        }
        named
    }

    /// Ends all processes below this one; where the system does not name them, the renderer's
    /// group. That something is gone already is no error.
    fn end_all(group: Pid) {
        let running = running();
        if running.is_empty() {
            let _ = killpg(group, Signal::SIGKILL);
        }
        for number in running.into_keys() {
            let _ = kill(Pid::from_raw(number), Signal::SIGKILL);
        }
    }

    /// Whether there is any child, running or to be waited for. Ended ones are taken off the list of processes.
    fn has_children() -> bool {
        loop {
            match waitpid(None, Some(WaitPidFlag::WNOHANG)) {
                Ok(WaitStatus::StillAlive) => return true,
                Err(Errno::ECHILD) => return false,
                // One of them, or one that was ended by a signal without a name.
                Ok(_) | Err(_) => {}
            }
        }
    }

    /// The processes below this one that have not ended, by number, with their names. None where
    /// the system does not say.
    fn running() -> BTreeMap<i32, String> {
        let mut all = BTreeMap::new();
        for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
            let number: Option<i32> = entry.file_name().to_str().and_then(|n| n.parse().ok());
            if let Some(number) = number
                && let Ok(bytes) = std::fs::read(entry.path().join("stat"))
                && let Some(process) = Process::parse(&String::from_utf8_lossy(&bytes))
            {
                all.insert(number, process);
            }
        }
        let this = std::process::id() as i32;
        let is_below = |number: i32| {
            let mut parent = all.get(&number).map(|process| process.parent);
            // The list was not read at one moment: a circle is improbable, not impossible.
            for _ in 0..=all.len() {
                match parent {
                    Some(found) if found == this => return true,
                    Some(found) => parent = all.get(&found).map(|process| process.parent),
                    None => return false,
                }
            }
            false
        };
        all.iter()
            .filter(|(number, process)| !process.has_ended && is_below(**number))
            .map(|(number, process)| (*number, process.name.clone()))
            .collect()
    }

    /// What `/proc/PID/stat` says of a process.
    #[derive(Debug, PartialEq, Eq)]
    struct Process {
        name: String,
        parent: i32,
        /// A zombie, which only waits for its parent to hear of it.
        has_ended: bool,
    }

    impl Process {
        /// `1234 (name) S 1 …`, where the name may hold anything.
        fn parse(stat: &str) -> Option<Process> {
            let (before, after) = stat.rsplit_once(')')?;
            let (_, name) = before.split_once('(')?;
            let mut fields = after.split_ascii_whitespace();
            let state = fields.next()?;
            Some(Process {
                name: name.to_owned(),
                parent: fields.next()?.parse().ok()?,
                has_ended: matches!(state, "Z" | "X"),
            })
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn names_of_processes_may_hold_anything() {
            let process = Process::parse("77 (a) S 1 ) (\n) Z 12 77 77 0 -1").unwrap();
            assert_eq!(process.name, "a) S 1 ) (\n");
            assert_eq!((process.parent, process.has_ended), (12, true));
            assert_eq!(Process::parse("77 (a"), None);
            assert_eq!(Process::parse("77 (a) S"), None);
        }
    }
}
