//! Progress: the current work, its share done and the time left. On a terminal a bar, from the
//! start; in a pipe a line from time to time, so that a log shows progress. All on stderr.

use super::output::{number_of, printable};
use crate::files::visible::visible;
use crate::judging::Step;
use crate::naming::SearchStep;
use crate::render::Watch;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

/// Redraw interval of a terminal.
const FRAME: Duration = Duration::from_millis(100);

/// Length of the bar for each of the parts of the work, such as cases: more than any has steps.
const PART: u64 = 1 << 40;

/// Time before the first line in a pipe: shorter work needs none.
const FIRST_LINE: Duration = Duration::from_secs(2);

/// The longest silence in a pipe. CI services end jobs that print nothing for ten minutes.
const LONGEST_SILENCE: Duration = Duration::from_secs(300);

/// A progress display, until it is dropped or [finished](Bar::finish_and_clear).
pub struct Bar {
    /// Hidden in a pipe.
    bar: ProgressBar,
    /// Steps of the current part; 0 before it says how many.
    steps: AtomicU64,
    /// Ends the thread that prints lines.
    end: Option<Sender<()>>,
    printing: Option<JoinHandle<()>>,
}

/// Progress of one image; `label` names the work.
pub fn image(label: &str) -> Bar {
    Bar::begin(label)
}

/// Progress of that many parts, such as cases.
pub fn counted(parts: usize) -> Bar {
    let bar = Bar::begin("");
    bar.set_length(parts as u64 * PART);
    bar
}

/// Runs `work` without known parts, such as reading files.
pub fn during<T>(label: &str, work: impl FnOnce() -> T) -> T {
    let bar = Bar::begin(label);
    let result = work();
    bar.finish_and_clear();
    result
}

/// Prints a line about the work, such as the suite in use.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr(), "volref: {}", printable(text));
}

/// The search for the causes of failures: in a pipe announced at once, as that in so many cases, at most so many seconds
/// each.
pub fn causes(announced: Option<(usize, f64)>) -> Bar {
    if let Some((failed, seconds)) = announced
        && !std::io::stderr().is_terminal()
    {
        let cases = number_of(failed as u64, "failing case");
        note(&format!(
            "looking for the mistake in {cases}, at most {seconds} s of work for each (change with \
             --explain SECONDS; 0 skips the search)"
        ));
    }
    Bar::begin("looking for the mistake")
}

/// Shows a step of the search for mistakes.
pub fn mistake(bar: &Bar, step: &SearchStep) {
    let left = step.left.map_or(String::new(), |left| {
        format!(", {:.0} s left for this case", left.as_secs_f64())
    });
    bar.set_message(format!(
        "looking for the mistake in {}: {} of {} {}{left}; Ctrl-C keeps the verdicts",
        step.case,
        step.done,
        step.of,
        step.stage.name()
    ));
}

impl Bar {
    fn begin(message: &str) -> Bar {
        let is_terminal = std::io::stderr().is_terminal();
        let bar = match is_terminal {
            true => ProgressBar::no_length(),
            false => ProgressBar::hidden(),
        };
        bar.set_style(style("{spinner} {wide_msg}"));
        bar.set_message(message.to_owned());
        if is_terminal {
            bar.enable_steady_tick(FRAME);
        }
        let (end, ended) = mpsc::channel();
        let printed = bar.clone();
        let printing = std::thread::spawn(move || print_lines(&printed, &ended));
        Bar {
            bar,
            steps: AtomicU64::new(0),
            end: Some(end),
            printing: Some(printing),
        }
    }

    /// Now the share done is known.
    fn set_length(&self, length: u64) {
        let template = "{spinner} [{bar:16}] {percent} % done, about {eta} left, {wide_msg}";
        self.bar.set_style(style(template));
        self.bar.set_length(length);
    }

    /// Sets the current work, such as the name of a case.
    pub fn set_message(&self, message: impl Into<String>) {
        self.bar.set_message(visible(&message.into()));
    }

    /// Shows a step of work with parts.
    pub fn show(&self, step: Step<'_>) {
        match step {
            Step::Begins(what) => self.set_message(what),
            Step::Done => self.end_part(),
        }
    }

    /// Ends a part.
    pub fn end_part(&self) {
        match self.steps.swap(0, Ordering::Relaxed) {
            0 => self.bar.inc(PART),
            _ => self.bar.set_position(self.begin_of_part() + PART),
        }
    }

    /// Position at which the part under way begins.
    fn begin_of_part(&self) -> u64 {
        self.bar.position() / PART * PART
    }

    /// Prints a line above the bar.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Ends the display, and clears it on a terminal.
    pub fn finish_and_clear(self) {}
}

impl Drop for Bar {
    fn drop(&mut self) {
        drop(self.end.take());
        let _ = self.printing.take().map(JoinHandle::join);
        self.bar.finish_and_clear();
    }
}

impl Watch for Bar {
    fn begin(&self, steps: u64) {
        if self.bar.length().is_none() {
            self.set_length(PART);
        }
        self.bar.set_position(self.begin_of_part());
        self.steps.store(steps, Ordering::Relaxed);
    }

    fn step(&self) {
        // All steps together stay within the part.
        let steps = self.steps.load(Ordering::Relaxed).max(1);
        self.bar.inc((PART - 1) / steps);
    }
}

/// Prints lines with the progress, in a pipe, while the work lasts.
fn print_lines(bar: &ProgressBar, ended: &Receiver<()>) {
    let mut next = FIRST_LINE;
    while let Err(RecvTimeoutError::Timeout) =
        ended.recv_timeout(next.saturating_sub(bar.elapsed()))
    {
        let elapsed = bar.elapsed();
        if bar.is_hidden() {
            let length = bar.length().unwrap_or(0);
            note(&line(&bar.message(), [bar.position(), length], elapsed));
        }
        next = next_line(elapsed);
    }
}

fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).expect("a valid template");
    style.progress_chars("=> ")
}

/// Time of the next line after one at `elapsed`: three times as late, so that there are few, but
/// never after too long a silence.
fn next_line(elapsed: Duration) -> Duration {
    (elapsed * 3).min(elapsed + LONGEST_SILENCE)
}

/// The display as one line: the current work, its share done, time elapsed and left, extrapolated.
fn line(message: &str, [done, all]: [u64; 2], elapsed: Duration) -> String {
    let mut facts = Vec::from_iter((!message.is_empty()).then(|| message.to_owned()));
    let share = done as f64 / all as f64;
    facts.extend((all > 0).then(|| format!("{:.2} % done", 100.0 * share)));
    facts.push(format!("{} so far", HumanDuration(elapsed)));
    let left = Duration::try_from_secs_f64(elapsed.as_secs_f64() * (1.0 / share - 1.0));
    facts.extend(left.map(|left| format!("about {} left", HumanDuration(left))));
    facts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_say_what_how_far_and_how_long() {
        let seconds = Duration::from_secs;
        assert_eq!(
            line("rendering", [1, 8], seconds(30)),
            "rendering, 12.50 % done, 30 seconds so far, about 4 minutes left"
        );
        assert_eq!(
            line("rendering", [2, 10_000], seconds(30)),
            "rendering, 0.02 % done, 30 seconds so far, about 2 days left"
        );
        assert_eq!(
            line("fog/forward", [0, PART], seconds(2)),
            "fog/forward, 0.00 % done, 2 seconds so far"
        );
        assert_eq!(line("", [0, 0], seconds(2)), "2 seconds so far");
    }

    #[test]
    fn lines_become_rare_but_never_stop() {
        let mut at = FIRST_LINE;
        let mut lines = vec![];
        while at < Duration::from_secs(3600) {
            lines.push(at.as_secs());
            at = next_line(at);
        }
        assert_eq!(lines[..6], [2, 6, 18, 54, 162, 462]);
        assert!(lines.windows(2).all(|pair| pair[1] - pair[0] <= 300));
        assert_eq!(lines.len(), 16);
    }
}
