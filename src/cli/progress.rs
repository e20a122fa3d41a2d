//! Progress on a terminal, on stderr: the current work, its share done and the time left; none in a pipe.

use super::output::printable;
use crate::files::visible::visible;
use crate::judging::Step;
use crate::naming::SearchStep;
use crate::render::Watch;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Redraw interval of a terminal.
const FRAME: Duration = Duration::from_millis(100);

/// Length of the bar for each of the parts of the work, such as cases: more than any has steps.
const PART: u64 = 1 << 40;

/// A progress display, until it is dropped.
pub struct Bar {
    /// Hidden in a pipe.
    bar: ProgressBar,
    /// Steps of the current part; 0 before it says how many.
    steps: AtomicU64,
}

/// Progress of one image, or of work without known parts; `label` names the work.
pub fn image(label: &str) -> Bar {
    let is_terminal = std::io::stderr().is_terminal();
    let bar = match is_terminal {
        true => ProgressBar::no_length(),
        false => ProgressBar::hidden(),
    };
    bar.set_style(style("{spinner} {wide_msg}"));
    bar.set_message(label.to_owned());
    if is_terminal {
        bar.enable_steady_tick(FRAME);
    }
    Bar {
        bar,
        steps: AtomicU64::new(0),
    }
}

/// Progress of that many parts, such as cases.
pub fn counted(parts: usize) -> Bar {
    let bar = image("");
    bar.set_length(parts as u64 * PART);
    bar
}

/// Runs `work` without known parts, such as reading files.
pub fn during<T>(label: &str, work: impl FnOnce() -> T) -> T {
    let _bar = image(label);
    work()
}

/// Prints a line about the work, such as the suite in use.
pub fn note(text: &str) {
    let _ = writeln!(std::io::stderr(), "volref: {}", printable(text));
}

/// Shows a step of the search for mistakes.
pub fn mistake(bar: &Bar, step: &SearchStep) {
    bar.set_message(format!(
        "looking for the mistake in {}: {} of {} {}; Ctrl-C keeps the verdicts",
        step.case,
        step.done,
        step.of,
        step.stage.name()
    ));
}

impl Bar {
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
}

impl Drop for Bar {
    fn drop(&mut self) {
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

fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).expect("a valid template");
    style.progress_chars("=> ")
}
