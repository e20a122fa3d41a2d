//! Progress: the current work, its share done and the time left. On a terminal a bar, from the
//! start; in a pipe a line from time to time, so that a log shows progress. All on stderr.

use super::output::{number_of, printable};
use crate::naming::SearchStep;
use crate::render::Watch;
use crate::render::plan::Reason;
use crate::report::visible;
use crate::runs::AcceptWatch;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Redraw interval of a terminal.
const FRAME: Duration = Duration::from_millis(100);

/// Steps of the bar: more than a terminal has columns.
const BAR_LENGTH: u64 = 1000;

/// Time before the first line in a pipe: shorter work needs none.
const FIRST_LINE: Duration = Duration::from_secs(2);

/// The longest silence in a pipe. CI services end jobs that print nothing for ten minutes.
const LONGEST_SILENCE: Duration = Duration::from_secs(300);

/// A progress display, until it is dropped or [finished](Bar::finish_and_clear).
pub struct Bar {
    shared: Arc<SharedBar>,
    ticker: Option<JoinHandle<()>>,
}

struct SharedBar {
    start: Instant,
    /// The bar; hidden in a pipe.
    bar: ProgressBar,
    said: Mutex<ProgressText>,
    changed: Condvar,
    /// The parts of the work, such as cases.
    parts: Counter,
    /// Steps of the current part.
    steps: Counter,
}

/// Text shown beside the progress.
#[derive(Default)]
struct ProgressText {
    /// The current work.
    message: String,
    /// Name of the parts, if their count is shown.
    parts: Option<&'static str>,
    /// Printed once, if the work takes long.
    notes: Vec<String>,
    ended: bool,
}

impl ProgressText {
    fn of(message: &str) -> ProgressText {
        ProgressText {
            message: message.to_owned(),
            ..ProgressText::default()
        }
    }
}

/// Steps done, of all; 0 if unknown.
#[derive(Default)]
struct Counter {
    done: AtomicU64,
    all: AtomicU64,
}

impl Counter {
    fn begin(&self, all: u64) {
        self.done.store(0, Ordering::Relaxed);
        self.all.store(all, Ordering::Relaxed);
    }

    fn get(&self) -> [u64; 2] {
        let all = self.all.load(Ordering::Relaxed);
        [self.done.load(Ordering::Relaxed).min(all), all]
    }
}

/// Progress of one image; `label` names the work. Notes are printed once the work takes long.
pub fn image(label: &str, notes: &[&Reason]) -> Bar {
    let said = ProgressText {
        notes: notes.iter().map(ToString::to_string).collect(),
        ..ProgressText::of(label)
    };
    Bar::begin(0, said)
}

/// Progress of that many `parts`, which have this name.
pub fn counted(name: &'static str, parts: usize) -> Bar {
    let said = ProgressText {
        parts: Some(name),
        ..ProgressText::default()
    };
    Bar::begin(parts as u64, said)
}

/// Progress of work whose amount is given later.
pub fn work() -> Bar {
    Bar::begin(0, ProgressText::default())
}

/// Runs `work` without known parts, such as reading files.
pub fn during<T>(label: &str, work: impl FnOnce() -> T) -> T {
    let bar = Bar::begin(0, ProgressText::of(label));
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
    Bar::begin(0, ProgressText::of("looking for the mistake"))
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
    fn begin(parts: u64, said: ProgressText) -> Bar {
        let bar = match std::io::stderr().is_terminal() {
            true => ProgressBar::no_length(),
            false => ProgressBar::hidden(),
        };
        let shared = Arc::new(SharedBar {
            start: Instant::now(),
            bar,
            said: Mutex::new(said),
            changed: Condvar::new(),
            parts: Counter::default(),
            steps: Counter::default(),
        });
        shared.parts.begin(parts);
        let ticking = shared.clone();
        Bar {
            ticker: Some(std::thread::spawn(move || ticking.tick())),
            shared,
        }
    }

    /// Sets the current work, such as the name of a case.
    pub fn set_message(&self, message: impl Into<String>) {
        self.shared.said().message = visible(&message.into());
        self.shared.steps.begin(0);
    }

    /// Adds to the parts done.
    pub fn inc(&self, parts: u64) {
        self.shared.steps.begin(0);
        self.shared.parts.done.fetch_add(parts, Ordering::Relaxed);
    }

    /// Prints a line above the bar.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.shared.bar.suspend(write)
    }

    /// Ends the display, and clears it on a terminal.
    pub fn finish_and_clear(self) {}
}

impl Drop for Bar {
    fn drop(&mut self) {
        let Some(ticker) = self.ticker.take() else {
            return;
        };
        self.shared.said().ended = true;
        self.shared.changed.notify_all();
        let _ = ticker.join();
        self.shared.bar.finish_and_clear();
    }
}

impl Watch for Bar {
    fn begin(&self, steps: u64) {
        self.shared.steps.begin(steps);
    }

    fn step(&self) {
        self.shared.steps.done.fetch_add(1, Ordering::Relaxed);
    }
}

impl AcceptWatch for Bar {
    fn begin_all(&self, work: u64) {
        self.shared.parts.begin(work);
    }

    fn begin_case(&self, case: &str) {
        self.set_message(case);
    }

    fn worked(&self, work: u64) {
        self.shared.parts.done.fetch_add(work, Ordering::Relaxed);
    }

    fn note(&self, text: &str) {
        self.shared.line(text);
    }
}

impl SharedBar {
    fn said(&self) -> MutexGuard<'_, ProgressText> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows the progress until the work has ended.
    fn tick(&self) {
        let mut next = FIRST_LINE;
        loop {
            let wait = match self.bar.is_hidden() {
                true => next.saturating_sub(self.start.elapsed()),
                false => FRAME,
            };
            let said = self.said();
            let ended = |said: &mut ProgressText| !said.ended;
            let (said, _) = self
                .changed
                .wait_timeout_while(said, wait, ended)
                .unwrap_or_else(PoisonError::into_inner);
            if said.ended {
                return;
            }
            drop(said);
            let elapsed = self.start.elapsed();
            if elapsed >= FIRST_LINE {
                self.notes();
            }
            let done = share_done(self.parts.get(), self.steps.get());
            let state = self.state(done, elapsed.as_secs_f64());
            if !self.bar.is_hidden() {
                self.bar.set_style(style(done.is_some()));
                self.bar.set_length(BAR_LENGTH);
                let position = done.unwrap_or(0.0) * BAR_LENGTH as f64;
                self.bar.set_position(position as u64);
                self.bar.set_message(state);
                self.bar.tick();
            } else if elapsed >= next {
                self.line(&state);
                next = next_line(elapsed);
            }
        }
    }

    fn state(&self, done: Option<f64>, elapsed: f64) -> String {
        let said = self.said();
        let parts = said.parts.map(|name| (name, self.parts.get()));
        let beside_bar = !self.bar.is_hidden() && done.is_some();
        state(&said.message, parts, done, elapsed, beside_bar)
    }

    fn notes(&self) {
        let notes = std::mem::take(&mut self.said().notes);
        notes
            .iter()
            .for_each(|note| self.line(&format!("note: {note}")));
    }

    fn line(&self, text: &str) {
        self.bar.suspend(|| note(text));
    }
}

/// Style of the display: a bar only if the share done is known.
fn style(is_known: bool) -> ProgressStyle {
    let template = if is_known {
        "{spinner} [{bar:16}] {wide_msg}"
    } else {
        "{spinner} {wide_msg}"
    };
    let style = ProgressStyle::with_template(template).expect("a valid template");
    style.progress_chars("=> ")
}

/// Time of the next line after one at `elapsed`: three times as late, so that there are few, but
/// never after too long a silence.
fn next_line(elapsed: Duration) -> Duration {
    (elapsed * 3).min(elapsed + LONGEST_SILENCE)
}

/// Share of the work that is done, from 0 to 1: that of the parts, of which one is under way and done in
/// part. None where nothing is known.
fn share_done([parts, all_parts]: [u64; 2], [steps, all_steps]: [u64; 2]) -> Option<f64> {
    let within = (all_steps > 0).then(|| steps as f64 / all_steps as f64);
    match all_parts {
        0 => within,
        _ => {
            let parts = parts as f64 + within.unwrap_or(0.0);
            Some((parts / all_parts as f64).min(1.0))
        }
    }
}

/// Seconds left, extrapolated from the share done; none before anything is done.
fn left(done: Option<f64>, elapsed: f64) -> Option<f64> {
    let share = done.filter(|share| *share > 0.0)?;
    Some(elapsed * (1.0 - share) / share)
}

/// The display as one line: the current work, its share done, time elapsed and left. Beside a bar
/// the parts that may be cut off come last, and the time elapsed is left out.
fn state(
    message: &str,
    parts: Option<(&str, [u64; 2])>,
    done: Option<f64>,
    elapsed: f64,
    beside_bar: bool,
) -> String {
    let amount = match (parts, done) {
        (Some((name, [done, all])), _) => format!("{done} of {all} {name} done"),
        (None, Some(done)) => format!("{} done", percent(done)),
        (None, None) => String::new(),
    };
    let so_far = format!("{} so far", duration(elapsed));
    let left = left(done, elapsed);
    let left = left.map_or(String::new(), |left| {
        format!("about {} left", duration(left))
    });
    let message = message.to_owned();
    let facts = if beside_bar {
        vec![amount, left, message]
    } else {
        vec![message, amount, so_far, left]
    };
    let facts: Vec<String> = facts.into_iter().filter(|fact| !fact.is_empty()).collect();
    facts.join(", ")
}

fn duration(seconds: f64) -> HumanDuration {
    let duration = Duration::try_from_secs_f64(seconds.max(0.0));
    HumanDuration(duration.unwrap_or(Duration::MAX))
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
    fn what_is_left_follows_from_what_is_done() {
        // A quarter in 30 seconds leaves 90.
        assert_eq!(left(Some(0.25), 30.0), Some(90.0));
        assert_eq!(left(Some(0.0), 5.0), None);
        assert_eq!(left(None, 5.0), None);
        assert_eq!(left(Some(1.0), 5.0), Some(0.0));
    }

    #[test]
    fn a_part_under_way_counts_in_part() {
        assert_eq!(share_done([3, 8], [10, 20]), Some(0.4375));
        assert_eq!(share_done([3, 8], [0, 0]), Some(0.375));
        assert_eq!(share_done([0, 0], [10, 20]), Some(0.5));
        assert_eq!(share_done([0, 0], [0, 0]), None);
        assert_eq!(share_done([8, 8], [20, 20]), Some(1.0));
    }

    #[test]
    fn lines_say_what_how_far_and_how_long() {
        assert_eq!(
            state("rendering", None, Some(0.125), 30.0, false),
            "rendering, 12 % done, 30 seconds so far, about 4 minutes left"
        );
        assert_eq!(
            state("rendering", None, Some(0.0002), 30.0, false),
            "rendering, 0.02 % done, 30 seconds so far, about 2 days left"
        );
        let cases = Some(("cases", [49, 194]));
        assert_eq!(
            state("fog/forward", cases, Some(0.25), 20.0, false),
            "fog/forward, 49 of 194 cases done, 20 seconds so far, about 60 seconds left"
        );
        assert_eq!(
            state("fog/forward", cases, Some(0.25), 20.0, true),
            "49 of 194 cases done, about 60 seconds left, fog/forward"
        );
        assert_eq!(
            state("fog/forward: sweep", None, None, 2.0, false),
            "fog/forward: sweep, 2 seconds so far"
        );
        assert_eq!(state("", None, None, 2.0, false), "2 seconds so far");
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
