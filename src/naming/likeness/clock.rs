//! Time limit and progress of the search for a mistake.

use super::kept::Predictions;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Options of the search for a mistake.
pub struct Search<'s> {
    /// Time limit for each failed case; `None` for no limit. One rendered row may exceed it.
    pub budget: Option<Duration>,
    /// Predictions kept from run to run.
    pub predictions: &'s Predictions,
    /// True to stop at once; polled from any thread.
    pub interrupted: &'s (dyn Fn() -> bool + Sync),
    /// Called for every hypothesis, from any thread.
    pub progress: &'s (dyn Fn(&SearchStep) + Sync),
}

impl Search<'_> {
    /// Default time limit for each case, seconds: about as long as people wait for an answer.
    pub const BUDGET: u32 = 10;
}

/// Share of the time for first looks. A second look takes up to 16 times the work of a first one,
/// and there are [eight](crate::naming::likeness::hunt) at most, where first looks are hundreds.
const FIRST_LOOKS: f64 = 0.75;

/// Progress of the search.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SearchStep {
    /// Name of the case.
    pub case: String,
    /// The current stage.
    pub stage: Stage,
    /// Hypotheses done in this stage.
    pub done: usize,
    /// Hypotheses of this stage.
    pub of: usize,
    /// Time left for this case, where it has a limit.
    pub left: Option<Duration>,
}

/// A stage of the search in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Each mistake by itself.
    Singles,
    /// Two mistakes together.
    Pairs,
}

impl Stage {
    /// Plural name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Singles => "single mistakes",
            Stage::Pairs => "pairs of mistakes",
        }
    }
}

/// The time of one case.
pub(super) struct SearchClock<'s> {
    search: &'s Search<'s>,
    case: &'s str,
    end: Option<Instant>,
    /// End of the first looks, which leaves time for second looks at what they found.
    late: Option<Instant>,
    /// True if the search was ended early.
    was_ended: AtomicBool,
    stage: Stage,
    done: AtomicUsize,
    of: usize,
    /// Time left until `end` and `late`, while the clock is paused.
    left: [Option<Duration>; 2],
}

impl<'s> SearchClock<'s> {
    /// Starts the clock, with `of` single mistakes to try.
    pub fn start(search: &'s Search<'s>, case: &'s str, of: usize) -> SearchClock<'s> {
        let now = Instant::now();
        // A budget beyond the end of time is none.
        let after = |share| now.checked_add(search.budget?.mul_f64(share));
        SearchClock {
            search,
            case,
            end: after(1.0),
            late: after(FIRST_LOOKS),
            was_ended: AtomicBool::new(false),
            stage: Stage::Singles,
            done: AtomicUsize::new(0),
            of,
            left: [None; 2],
        }
    }

    /// Pauses the clock, while another case is searched.
    pub fn pause(&mut self) {
        let now = Instant::now();
        let until = |end: Option<Instant>| Some(end?.saturating_duration_since(now));
        self.left = [until(self.end), until(self.late)];
    }

    /// Continues after a pause.
    pub fn resume(&mut self) {
        let now = Instant::now();
        [self.end, self.late] = self.left.map(|left| now.checked_add(left?));
    }

    /// Continues with `of` pairs.
    pub fn go_on_with_pairs(&mut self, of: usize) {
        self.stage = Stage::Pairs;
        self.done = AtomicUsize::new(0);
        self.of = of;
    }

    pub fn predictions(&self) -> &'s Predictions {
        self.search.predictions
    }

    /// True if the search of this case is to end.
    pub fn is_over(&self) -> bool {
        self.is_after(self.end)
    }

    /// True when no further hypothesis is to be tried, and those that were found get their second
    /// look.
    pub fn is_late(&self) -> bool {
        self.is_after(self.late)
    }

    fn is_after(&self, end: Option<Instant>) -> bool {
        let is = end.is_some_and(|end| Instant::now() >= end) || (self.search.interrupted)();
        if is {
            self.was_ended.store(true, Ordering::Relaxed);
        }
        is
    }

    /// Counts a hypothesis as decided; not to be called for one that was given up.
    pub fn decided(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.report();
    }

    /// Reports the progress.
    pub fn report(&self) {
        (self.search.progress)(&self.step());
    }

    /// Progress of a search that was ended early.
    pub fn unfinished(&self) -> Option<SearchStep> {
        let was_ended = self.was_ended.load(Ordering::Relaxed);
        was_ended.then(|| self.step())
    }

    fn step(&self) -> SearchStep {
        let left = |end: Instant| end.saturating_duration_since(Instant::now());
        SearchStep {
            case: self.case.to_owned(),
            stage: self.stage,
            done: self.done.load(Ordering::Relaxed).min(self.of),
            of: self.of,
            left: self.end.map(left),
        }
    }
}
