//! Runs another renderer, once for each case, without a shell.
//!
//! The command is split into words as a shell would, then placeholders are filled in, so that no
//! path needs quoting. What the process prints goes to a file: a full pipe stops nobody. It leads
//! a process group of its own, and when it ends, or its time is over, whatever it has started is
//! ended too.

use process_wrap::std::{ChildWrapper, CommandWrap};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};
use thiserror::Error;

/// A command with placeholders such as `{output}`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandTemplate {
    words: Vec<String>,
}

/// Why a text is no command.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum TemplateError {
    /// Quotes that do not end.
    #[error("a quote is opened and not closed in: {0}")]
    Quotes(String),
    /// Nothing to run.
    #[error("there is no command to run")]
    Empty,
    /// A placeholder without which no image can be found.
    #[error("the command does not say where the image goes: it has no {{output}}")]
    NoOutput,
    /// A name in braces that stands for nothing.
    #[error("{{{name}}} stands for nothing; known are: {known}")]
    Unknown {
        /// What stands in the braces.
        name: String,
        /// Every placeholder.
        known: String,
    },
}

impl CommandTemplate {
    /// Every placeholder, without its braces.
    pub const PLACEHOLDERS: [&str; 10] = [
        "scene",
        "output",
        "width",
        "height",
        "spp",
        "seed",
        "case",
        "export:mitsuba",
        "export:pbrt",
        "export:bundle",
    ];

    /// Splits `text` into words as a POSIX shell would, quotes and backslashes included, and
    /// nothing else a shell does.
    pub fn parse(text: &str) -> Result<CommandTemplate, TemplateError> {
        let words = shell_words::split(text).map_err(|_| TemplateError::Quotes(text.to_owned()))?;
        if words.is_empty() {
            return Err(TemplateError::Empty);
        }
        let template = CommandTemplate { words };
        let used = template.placeholders();
        if let Some(name) = used
            .iter()
            .find(|name| !Self::PLACEHOLDERS.contains(&name.as_str()))
        {
            let known = Self::PLACEHOLDERS
                .map(|name| format!("{{{name}}}"))
                .join(" ");
            return Err(TemplateError::Unknown {
                name: name.clone(),
                known,
            });
        }
        if !used.iter().any(|name| name == "output") {
            return Err(TemplateError::NoOutput);
        }
        Ok(template)
    }

    /// The names in braces, in order.
    pub fn placeholders(&self) -> Vec<String> {
        let mut names = Vec::new();
        for word in &self.words {
            replace(word, |name| names.push(name.to_owned()));
        }
        names
    }

    /// The words of the command with the placeholders filled in.
    pub fn fill(&self, values: &BTreeMap<&str, String>) -> Vec<String> {
        let fill = |word: &String| {
            let mut filled = String::new();
            let rest = replace_with(word, &mut filled, |name| {
                values.get(name).cloned().unwrap_or_default()
            });
            filled.push_str(rest);
            filled
        };
        self.words.iter().map(fill).collect()
    }
}

/// Names `{like-this}` in `word`. Braces around anything else stand for themselves.
fn replace(word: &str, mut each: impl FnMut(&str)) {
    let mut nothing = String::new();
    replace_with(word, &mut nothing, |name| {
        each(name);
        String::new()
    });
}

/// Copies `word` to `filled` up to its last placeholder, values put in; returns what is left.
fn replace_with<'w>(
    word: &'w str,
    filled: &mut String,
    mut value: impl FnMut(&str) -> String,
) -> &'w str {
    let mut rest = word;
    let mut from = 0;
    while let Some(open) = rest[from..].find('{').map(|at| from + at) {
        let Some(close) = rest[open..].find('}').map(|at| open + at) else {
            break;
        };
        let name = &rest[open + 1..close];
        let is_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, ':' | '-' | '_');
        if name.is_empty() || !name.chars().all(is_name) {
            from = open + 1;
            continue;
        }
        filled.push_str(&rest[..open]);
        filled.push_str(&value(name));
        rest = &rest[close + 1..];
        from = 0;
    }
    rest
}

/// How a process ended.
#[derive(Debug)]
pub struct Ran {
    /// Why its output cannot be used; nothing if it ended well.
    pub failure: Option<String>,
    /// What it wrote to its standard output and error, the end of it if that is long.
    pub printed: String,
}

/// Of what a process prints, this much is kept: the end, where errors are.
const MOST_PRINTED: u64 = 64 * 1024;

/// How long a process may take to notice that it is over.
const PAUSE: Duration = Duration::from_millis(5);

/// Programs that are running, and whether no more may be.
static RUNNING: AtomicUsize = AtomicUsize::new(0);
static STOPPED: AtomicBool = AtomicBool::new(false);

/// How long [`stop_all`] waits for programs that do not go.
const PATIENCE: Duration = Duration::from_secs(2);

/// Ends every program that [`run`] has running, with all that it started, and starts no more: for
/// a process that was told to end, since what it started has process groups of its own and would
/// go on. Returns when they are gone.
pub fn stop_all() {
    STOPPED.store(true, Ordering::SeqCst);
    let start = Instant::now();
    while RUNNING.load(Ordering::SeqCst) > 0 && start.elapsed() < PATIENCE {
        sleep(PAUSE);
    }
}

/// Runs a program to its end, or until `timeout` is over. `words` are the program and its
/// arguments.
pub fn run(words: &[String], timeout: Duration) -> Ran {
    let mut log = match tempfile::tempfile() {
        Ok(file) => file,
        Err(error) => return not_started(&words[0], &error),
    };
    // Counted before it is asked: whoever stops asks in the other order, so one of the two sees
    // the other.
    RUNNING.fetch_add(1, Ordering::SeqCst);
    let failure = match STOPPED.load(Ordering::SeqCst) {
        true => Err(std::io::ErrorKind::Interrupted.into()),
        false => spawn(words, &log).map(|child| wait(child, timeout)),
    };
    RUNNING.fetch_sub(1, Ordering::SeqCst);
    let failure = match failure {
        Ok(failure) => failure,
        Err(error) => return not_started(&words[0], &error),
    };
    Ran {
        failure,
        printed: tail(&mut log).unwrap_or_default(),
    }
}

fn not_started(program: &str, error: &std::io::Error) -> Ran {
    Ran {
        failure: Some(format!(
            "the renderer {program:?} could not be started: {error}"
        )),
        printed: String::new(),
    }
}

fn spawn(words: &[String], log: &File) -> std::io::Result<Box<dyn ChildWrapper>> {
    let mut command = Command::new(&words[0]);
    command
        .args(&words[1..])
        .stdin(Stdio::null())
        .stdout(log.try_clone()?)
        .stderr(log.try_clone()?);
    let mut command = CommandWrap::from(command);
    #[cfg(unix)]
    command.wrap(process_wrap::std::ProcessGroup::leader());
    #[cfg(windows)]
    command.wrap(process_wrap::std::JobObject);
    command.spawn()
}

/// Why the process did not end well, if so.
fn wait(mut child: Box<dyn ChildWrapper>, timeout: Duration) -> Option<String> {
    let start = Instant::now();
    let ended = loop {
        match child.try_wait() {
            Ok(Some(status)) => break Ok(status),
            Ok(None) if STOPPED.load(Ordering::SeqCst) || start.elapsed() >= timeout => {
                break Err(None);
            }
            Ok(None) => sleep(PAUSE.min(timeout.saturating_sub(start.elapsed()))),
            Err(error) => break Err(Some(error)),
        }
    };
    // What it started may still be there; that nothing is left is no error.
    let _ = child.start_kill();
    let failure = match ended {
        Ok(status) => return failure_of(status),
        Err(None) => format!(
            "the renderer did not end within {} s and was ended, with all that it had started",
            timeout.as_secs_f64()
        ),
        Err(Some(error)) => format!("the renderer could not be waited for: {error}"),
    };
    let _ = child.wait();
    Some(failure)
}

fn failure_of(status: ExitStatus) -> Option<String> {
    if status.success() {
        return None;
    }
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return Some(format!(
            "the renderer crashed: it was ended by signal {signal}"
        ));
    }
    let code = status
        .code()
        .map_or("no code".to_owned(), |code| code.to_string());
    Some(format!(
        "the renderer failed: it ended with exit code {code}"
    ))
}

/// The end of what was written to `log`.
fn tail(log: &mut File) -> std::io::Result<String> {
    log.flush()?;
    let length = log.seek(SeekFrom::End(0))?;
    let from = length.saturating_sub(MOST_PRINTED);
    log.seek(SeekFrom::Start(from))?;
    let mut bytes = Vec::new();
    log.take(MOST_PRINTED).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    Ok(match from {
        0 => text,
        _ => format!("[the first {from} bytes are left out]\n{text}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn template(text: &str) -> Vec<String> {
        let values = [("scene", "a b.toml"), ("output", "o.exr"), ("spp", "4")];
        let values = values.map(|(name, value)| (name, value.to_owned()));
        CommandTemplate::parse(text)
            .unwrap()
            .fill(&BTreeMap::from(values))
    }

    #[test]
    fn words_are_split_before_values_are_put_in() {
        assert_eq!(
            template("render --to={output} {scene} 'x y' \"{spp}{spp}\""),
            ["render", "--to=o.exr", "a b.toml", "x y", "44"]
        );
    }

    #[test]
    fn other_braces_stand_for_themselves() {
        assert_eq!(
            template("r {output} '{' '}{' '{\"a b\": {spp}}'"),
            ["r", "o.exr", "{", "}{", "{\"a b\": 4}"]
        );
    }

    #[test]
    fn what_is_no_command() {
        let error = |text: &str| CommandTemplate::parse(text).unwrap_err().to_string();
        assert_eq!(error("  "), "there is no command to run");
        assert!(error("render 'x").starts_with("a quote is opened"));
        assert!(error("render {scene}").contains("{output}"));
        assert!(
            error("render {otput}").starts_with("{otput} stands for nothing; known are: {scene}")
        );
    }

    #[cfg(unix)]
    mod processes {
        use super::super::*;

        fn shell(script: &str, seconds: f64) -> Ran {
            let words = ["sh", "-c", script].map(str::to_owned);
            run(&words, Duration::from_secs_f64(seconds))
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
            let absent = run(&words, Duration::from_secs(1)).failure.unwrap();
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
}
