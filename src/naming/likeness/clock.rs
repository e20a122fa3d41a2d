//! Limit of work and progress of the search for a mistake.

use super::kept::Predictions;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Options of the search for a mistake.
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

/// Share of the work for first looks. A second look takes up to 16 times the work of a first one,
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
    /// Profiles that volref brings.
    Profiles,
    /// Conventions, in rounds of a set and all its single changes.
    Conventions,
    /// Each mistake by itself.
    Singles,
}

impl Stage {
    /// Plural name.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Profiles => "profiles",
            Stage::Conventions => "rounds of conventions",
            Stage::Singles => "single mistakes",
        }
    }
}

/// Work that is done in a second on two cores, in [events](crate::render::Event) of kernels, for which limits in
/// seconds stand.
pub(in crate::naming) const WORK_PER_SECOND: f64 = 1e8;

/// Longest time of a search, in those seconds: work is counted, so that a verdict depends on no machine's load, but
/// nobody waits forever.
const SLOWEST: u32 = 6;

/// Shortest such time: a moment's work may take longer beside other programs.
const MOMENT: Duration = Duration::from_secs(30);

/// The work of one case.
pub(super) struct SearchClock<'s> {
    search: &'s Search<'s>,
    case: &'s str,
    /// Work done, and its limits, of all looks and of first looks, which leave some for second looks at what
    /// they found; no limits where there is no budget.
    work: AtomicU64,
    limits: Option<[u64; 2]>,
    /// Latest end.
    end: Option<Instant>,
    /// True if the search was ended early.
    was_ended: AtomicBool,
    stage: Stage,
    done: AtomicUsize,
    of: usize,
}

impl<'s> SearchClock<'s> {
    /// Starts the clock, with `of` single mistakes to try, after this work was `spent` on conventions.
    pub fn start(search: &'s Search<'s>, case: &'s str, of: usize, spent: u64) -> SearchClock<'s> {
        let limits = |budget: Duration| {
            let all = (WORK_PER_SECOND * budget.as_secs_f64()) as u64;
            let left = all.saturating_sub(spent);
            [1.0, FIRST_LOOKS].map(|share| spent + (share * left as f64) as u64)
        };
        SearchClock {
            search,
            case,
            work: AtomicU64::new(spent),
            limits: search.budget.map(limits),
            end: search.budget.and_then(latest_end),
            was_ended: AtomicBool::new(false),
            stage: Stage::Singles,
            done: AtomicUsize::new(0),
            of,
        }
    }

    /// Continues after another case was searched.
    pub fn resume(&mut self) {
        self.end = self.search.budget.and_then(latest_end);
    }

    pub fn predictions(&self) -> &'s Predictions {
        self.search.predictions
    }

    /// Work done, with what was spent before.
    pub fn work(&self) -> u64 {
        self.work.load(Ordering::Relaxed)
    }

    /// Counts `work` that is about to be done; false, and none of it is to be done, if the search of this case is
    /// to end.
    pub fn spend(&self, work: u64) -> bool {
        let goes_on = !self.is_over();
        if goes_on {
            self.work.fetch_add(work, Ordering::Relaxed);
        }
        goes_on
    }

    /// [`spend`](Self::spend), if that is no more than this `share` of the limit.
    pub fn spend_share(&self, work: u64, share: f64) -> bool {
        let most = self.limits.map(|[all, _]| share * all as f64);
        most.is_none_or(|most| work as f64 <= most) && self.spend(work)
    }

    /// [`spend`](Self::spend), for a further hypothesis.
    pub fn spend_early(&self, work: u64) -> bool {
        !self.is_late() && self.spend(work)
    }

    /// True if the search of this case is to end.
    pub fn is_over(&self) -> bool {
        self.is_beyond(self.limits.map(|[all, _]| all)) || self.is_stopped()
    }

    /// True when no further hypothesis is to be tried, and those that were found get their second
    /// look.
    pub fn is_late(&self) -> bool {
        self.is_beyond(self.limits.map(|[_, first]| first)) || self.is_stopped()
    }

    /// True if work that has begun is to end.
    pub fn is_stopped(&self) -> bool {
        let is_late = self.end.is_some_and(|end| Instant::now() >= end);
        self.ended_if(is_late || (self.search.interrupted)())
    }

    fn is_beyond(&self, limit: Option<u64>) -> bool {
        self.ended_if(limit.is_some_and(|limit| self.work() >= limit))
    }

    fn ended_if(&self, is: bool) -> bool {
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
        let left =
            |[limit, _]: [u64; 2]| limit.saturating_sub(self.work()) as f64 / WORK_PER_SECOND;
        SearchStep {
            case: self.case.to_owned(),
            stage: self.stage,
            done: self.done.load(Ordering::Relaxed).min(self.of),
            of: self.of,
            left: self.limits.map(left).map(Duration::from_secs_f64),
        }
    }
}

/// Latest end of a search that begins now, with this budget.
pub(in crate::naming) fn latest_end(budget: Duration) -> Option<Instant> {
    // A budget beyond the end of time is none.
    Instant::now().checked_add(budget.checked_mul(SLOWEST)?.max(MOMENT))
}
