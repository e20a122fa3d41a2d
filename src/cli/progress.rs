//! Progress: the current work, its share done and the time left. On a terminal a bar, from the
//! start; in a pipe a line from time to time, so that a log shows progress. All on stderr.

use super::output::{number_of, printable};
use crate::files::visible::visible;
use crate::naming::SearchStep;
use crate::render::Watch;
use crate::render::plan::Reason;
use crate::runs::AcceptWatch;
use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

/// Redraw interval of a terminal.
const FRAME: Duration = Duration::from_millis(100);

/// Length of the bar for each of the parts of the work, such as cases, which have steps of their own.
const PART: u64 = 1 << 32;

/// Time before the first line in a pipe: shorter work needs none.
const FIRST_LINE: Duration = Duration::from_secs(2);

/// The longest silence in a pipe. CI services end jobs that print nothing for ten minutes.
const LONGEST_SILENCE: Duration = Duration::from_secs(300);

/// A progress display, until it is dropped or [finished](Bar::finish_and_clear).
pub struct Bar {
    /// Hidden in a pipe.
    bar: ProgressBar,
    /// Name of the parts, if their count is shown.
    name: Option<&'static str>,
    /// Position at which the current part begins; its steps, and those done.
    part: AtomicU64,
    steps: AtomicU64,
    done: AtomicU64,
    /// Ends the thread that prints lines.
    end: Option<Sender<()>>,
    printing: Option<JoinHandle<()>>,
}

/// Progress of one image; `label` names the work. Notes are printed once the work takes long.
pub fn image(label: &str, notes: &[&Reason]) -> Bar {
    let notes = notes.iter().map(ToString::to_string).collect();
    Bar::begin(label, None, notes)
}

/// Progress of that many `parts`, which have this name.
pub fn counted(name: &'static str, parts: usize) -> Bar {
    let bar = Bar::begin("", Some(name), Vec::new());
    bar.set_length(parts as u64 * PART);
    bar
}

/// Runs `work` without known parts, such as reading files.
pub fn during<T>(label: &str, work: impl FnOnce() -> T) -> T {
    let bar = Bar::begin(label, None, Vec::new());
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
    Bar::begin("looking for the mistake", None, Vec::new())
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
    fn begin(message: &str, name: Option<&'static str>, notes: Vec<String>) -> Bar {
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
        let printing = std::thread::spawn(move || print_lines(&printed, name, notes, &ended));
        Bar {
            bar,
            name,
            part: AtomicU64::new(0),
            steps: AtomicU64::new(0),
            done: AtomicU64::new(0),
            end: Some(end),
            printing: Some(printing),
        }
    }

    /// Now the share done is known.
    fn set_length(&self, length: u64) {
        let name = self.name;
        let facts = move |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            let [done, left] = facts(
                [state.pos(), state.len().unwrap_or(0)],
                name,
                state.elapsed(),
            );
            let _ = text.write_str(&joined([&done, &left]));
        };
        let style = style("{spinner} [{bar:16}] {facts}, {wide_msg}");
        self.bar.set_style(style.with_key("facts", facts));
        self.bar.set_length(length);
    }

    /// Sets the current work, such as the name of a case.
    pub fn set_message(&self, message: impl Into<String>) {
        self.bar.set_message(visible(&message.into()));
        self.steps.store(0, Ordering::Relaxed);
    }

    /// Adds to the parts done.
    pub fn inc(&self, parts: u64) {
        self.steps.store(0, Ordering::Relaxed);
        let part = self.part.fetch_add(parts * PART, Ordering::Relaxed);
        self.bar.set_position(part + parts * PART);
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
        self.done.store(0, Ordering::Relaxed);
        self.steps.store(steps, Ordering::Relaxed);
    }

    fn step(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        let steps = self.steps.load(Ordering::Relaxed).max(done);
        let within = PART as f64 * (done as f64 / steps as f64);
        let part = self.part.load(Ordering::Relaxed);
        self.bar.set_position(part + within as u64);
    }
}

impl AcceptWatch for Bar {
    fn begin_case(&self, case: &str) {
        self.set_message(case);
    }

    fn end_case(&self) {
        self.inc(1);
    }
}

/// Prints the notes if the work takes long; in a pipe, lines with the progress besides.
fn print_lines(bar: &ProgressBar, name: Option<&str>, notes: Vec<String>, ended: &Receiver<()>) {
    let (mut next, mut notes) = (FIRST_LINE, notes.into_iter());
    while let Err(RecvTimeoutError::Timeout) =
        ended.recv_timeout(next.saturating_sub(bar.elapsed()))
    {
        notes
            .by_ref()
            .for_each(|text| bar.suspend(|| note(&format!("note: {text}"))));
        let elapsed = bar.elapsed();
        if bar.is_hidden() {
            let progress = [bar.position(), bar.length().unwrap_or(0)];
            note(&line(&bar.message(), progress, name, elapsed));
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

/// The display as one line: the current work, its share done, time elapsed and left.
fn line(message: &str, progress: [u64; 2], name: Option<&str>, elapsed: Duration) -> String {
    let [done, left] = facts(progress, name, elapsed);
    let so_far = format!("{} so far", HumanDuration(elapsed));
    joined([message, &done, &so_far, &left])
}

fn joined<const N: usize>(facts: [&str; N]) -> String {
    let facts = facts.into_iter().filter(|fact| !fact.is_empty());
    facts.collect::<Vec<_>>().join(", ")
}

/// The share done, position and length, in words, and the time left, extrapolated; empty where nothing is known.
fn facts([done, all]: [u64; 2], name: Option<&str>, elapsed: Duration) -> [String; 2] {
    if all == 0 {
        return Default::default();
    }
    let share = (done as f64 / all as f64).min(1.0);
    let left = elapsed.as_secs_f64() * (1.0 - share) / share;
    let left = Duration::try_from_secs_f64(left).map(HumanDuration);
    let amount = match name {
        Some(name) => format!("{} of {} {name} done", done / PART, all / PART),
        None => format!("{} done", percent(share)),
    };
    [
        amount,
        left.map_or(String::new(), |left| format!("about {left} left")),
    ]
}

/// Whole percents, or two digits of less than one.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        _ if percent >= 1.0 || percent == 0.0 => format!("{} %", percent.floor()),
        _ if percent >= 0.01 => format!("{percent:.2} %"),
        _ => "less than 0.01 %".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_say_what_how_far_and_how_long() {
        let seconds = Duration::from_secs;
        assert_eq!(
            line("rendering", [1, 8], None, seconds(30)),
            "rendering, 12 % done, 30 seconds so far, about 4 minutes left"
        );
        assert_eq!(
            line("rendering", [2, 10_000], None, seconds(30)),
            "rendering, 0.02 % done, 30 seconds so far, about 2 days left"
        );
        // A part under way counts in part.
        let cases = [49 * PART - PART / 2, 194 * PART];
        assert_eq!(
            line("fog/forward", cases, Some("cases"), seconds(20)),
            "fog/forward, 48 of 194 cases done, 20 seconds so far, about 60 seconds left"
        );
        assert_eq!(
            line("fog/forward", [0, PART], None, seconds(2)),
            "fog/forward, 0 % done, 2 seconds so far"
        );
        assert_eq!(line("", [0, 0], None, seconds(2)), "2 seconds so far");
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
