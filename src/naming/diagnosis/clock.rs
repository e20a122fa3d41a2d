//! Limit of work and progress of a search.

use super::predictions::Predictions;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Options of the search for a cause.
pub struct Search<'s> {
    /// Limit of the work for each failed case, as the time that it takes on two cores; `None` for no limit. The
    /// search for its conventions counts. One rendered image may exceed it.
    pub budget: Option<Duration>,
    /// Predictions that the run keeps.
    pub predictions: &'s Predictions,
    /// True to stop at once; polled from any thread.
    pub interrupted: &'s (dyn Fn() -> bool + Sync),
    /// Called for every hypothesis, from any thread.
    pub progress: &'s (dyn Fn(&SearchStep) + Sync),
}

impl Search<'_> {
    /// Default limit for each case, seconds: about as long as people wait for an answer.
    pub const BUDGET: u32 = 10;
}

/// Share of the work for first looks: closer looks at what they leave open need the rest.
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
}

/// A stage of the search in an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Profiles that volref brings.
    Profiles,
    /// Conventions, in rounds of a set and all its single changes.
    Conventions,
    /// Each mistake by itself.
    Singles,
}

impl Stage {
    /// Its name for a line of progress, in the plural.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Profiles => "profiles",
            Stage::Conventions => "rounds of conventions",
            Stage::Singles => "single mistakes",
        }
    }
}

/// Work for which a second of a limit stands, in [events](crate::render::Event) of kernels: about what two cores do in a
/// second.
const WORK_PER_SECOND: f64 = 1e8;

/// Longest time of a search, in multiples of its limit. Work is counted, so that no verdict depends on a machine's load;
/// but nobody waits forever.
const SLOWEST: u32 = 6;

/// Shortest such time: beside other programs even a little work takes a while.
const MOMENT: Duration = Duration::from_secs(30);

/// Counts the work of the search in one case, and says when the search is to end.
pub(in crate::naming) struct SearchClock<'s> {
    search: &'s Search<'s>,
    work: AtomicU64,
    /// Limits of the work, of all looks and of first looks.
    limits: Option<[u64; 2]>,
    /// Latest end.
    end: Option<Instant>,
    /// True if the search was ended early.
    was_ended: AtomicBool,
    /// What was reported last.
    step: Mutex<SearchStep>,
}

impl<'s> SearchClock<'s> {
    /// Starts the clock for `case`, after this work was `spent` on it.
    pub fn start(search: &'s Search<'s>, case: &str, spent: u64) -> SearchClock<'s> {
        let limits = |budget: Duration| {
            let all = (WORK_PER_SECOND * budget.as_secs_f64()) as u64;
            let left = all.saturating_sub(spent);
            [1.0, FIRST_LOOKS].map(|share| spent.saturating_add((share * left as f64) as u64))
        };
        SearchClock {
            search,
            work: AtomicU64::new(spent),
            limits: search.budget.map(limits),
            end: latest_end(search),
            was_ended: AtomicBool::new(false),
            step: Mutex::new(SearchStep {
                case: case.to_owned(),
                stage: Stage::Singles,
                done: 0,
                of: 0,
            }),
        }
    }

    pub fn predictions(&self) -> &'s Predictions {
        self.search.predictions
    }

    /// Work done, with what was spent before.
    pub fn work(&self) -> u64 {
        self.work.load(Ordering::Relaxed)
    }

    /// Counts `work` that was done, or is about to be done; true if the search may go on.
    pub fn spend(&self, work: u64) -> bool {
        self.work.fetch_add(work, Ordering::Relaxed);
        !self.is_over()
    }

    /// True if the search of this case is to end.
    pub fn is_over(&self) -> bool {
        self.is_beyond(0) || self.is_stopped()
    }

    /// True when no further hypothesis is to be tried, and those that were found get their closer look.
    pub fn is_late(&self) -> bool {
        self.is_beyond(1) || self.is_stopped()
    }

    /// True if work that has begun is to end.
    pub fn is_stopped(&self) -> bool {
        let is_late = self.end.is_some_and(|end| Instant::now() >= end);
        self.ended_if(is_late || (self.search.interrupted)())
    }

    fn is_beyond(&self, limit: usize) -> bool {
        let is_beyond = |limits: [u64; 2]| self.work() >= limits[limit];
        self.ended_if(self.limits.is_some_and(is_beyond))
    }

    fn ended_if(&self, is: bool) -> bool {
        self.was_ended.fetch_or(is, Ordering::Relaxed);
        is
    }

    /// Reports that `done` of so many things are tried.
    pub fn report(&self, stage: Stage, done: usize, of: usize) {
        let mut step = self.step.lock().unwrap_or_else(PoisonError::into_inner);
        (step.stage, step.done, step.of) = (stage, done, of);
        (self.search.progress)(&step);
    }

    /// Progress of a search that was ended early.
    pub fn unfinished(&self) -> Option<SearchStep> {
        let was_ended = self.was_ended.load(Ordering::Relaxed);
        let step = || self.step.lock().unwrap_or_else(PoisonError::into_inner);
        was_ended.then(|| step().clone())
    }
}

/// Latest end of a search that begins now. A budget beyond the end of time is none.
fn latest_end(search: &Search<'_>) -> Option<Instant> {
    let longest = search.budget?.checked_mul(SLOWEST)?.max(MOMENT);
    Instant::now().checked_add(longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_beyond_all_numbers_ends_no_search() {
        let search = Search {
            budget: Some(Duration::from_secs(1 << 40)),
            predictions: &Predictions::default(),
            interrupted: &|| false,
            progress: &|_| (),
        };
        let clock = SearchClock::start(&search, "case", 5);
        assert!(!clock.is_over() && !clock.is_late());
    }
}
