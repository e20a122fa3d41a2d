//! Wall time, measured in turns, with its spread, and marked if noisy.

use crate::files::regular_file;
use serde::Serialize;
use std::time::Instant;

/// Runs of each setting.
pub const RUNS: usize = 10;

/// Wall time for each pixel, in seconds, of runs taken by turns with those of the other settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Number of runs.
    pub runs: usize,
    /// Median.
    pub median: f64,
    /// Least.
    pub min: f64,
    /// Most.
    pub max: f64,
    /// True if the coefficient of variation is above 5 %.
    pub is_noisy: bool,
}

/// The machine that measured the times.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Processor, as it calls itself.
    pub processor: String,
    /// Threads used for timing.
    pub threads: usize,
    /// Operating system and architecture.
    pub platform: String,
    /// Compiler.
    pub compiler: String,
    /// `release` or `debug`.
    pub profile: &'static str,
    /// Instruction sets the program was compiled for.
    pub target_features: String,
}

/// Work to be timed.
pub type Task<'a> = Box<dyn Fn() + Sync + 'a>;

/// Time measurement; counts of work and errors do not need it. By default no timings and no time limit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    /// Runs of each setting; 0 for no timings.
    pub runs: usize,
    /// The time limit.
    pub deadline: Option<Instant>,
}

impl Clock {
    /// True if the time limit has passed.
    pub fn is_over(&self) -> bool {
        self.deadline
            .is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Times `tasks` by turns, A B C A B C …, so that what slows the machine down for a while
    /// meets all of them. Returns the times of each task, divided by `share`, the number of pixels; `None` if timing is off,
    /// or if the time left is too short for two rounds.
    ///
    /// On one thread: what is compared is work, not how well it is shared out.
    pub(crate) fn by_turns(&self, tasks: &[Task<'_>], share: f64) -> Vec<Option<Times>> {
        if self.runs == 0 || self.is_over() {
            return vec![None; tasks.len()];
        }
        let mut seconds: Vec<Vec<f64>> = vec![Vec::new(); tasks.len()];
        let take_turns = || {
            // The first run finds everything cold: it does not count.
            for round in 0..=self.runs {
                for (task, seconds) in tasks.iter().zip(&mut seconds) {
                    if self.is_over() {
                        return;
                    }
                    let start = Instant::now();
                    task();
                    if round > 0 {
                        seconds.push(start.elapsed().as_secs_f64() / share);
                    }
                }
            }
        };
        if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(1).build() {
            pool.install(take_turns);
        }
        seconds.iter().map(|runs| summary(runs)).collect()
    }
}

/// Statistics of `runs`, in seconds; `None` for fewer than two.
pub fn summary(runs: &[f64]) -> Option<Times> {
    if runs.len() < 2 {
        return None;
    }
    let mut sorted = runs.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let count = runs.len() as f64;
    let mean = runs.iter().sum::<f64>() / count;
    let squares: f64 = runs.iter().map(|run| (run - mean) * (run - mean)).sum();
    Some(Times {
        runs: runs.len(),
        median: 0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[sorted.len() / 2]),
        min: sorted[0],
        max: sorted[sorted.len() - 1],
        is_noisy: (squares / (count - 1.0)).sqrt() > 0.05 * mean,
    })
}

impl Machine {
    /// The machine of this process, timing with `threads` threads.
    pub fn here(threads: usize) -> Machine {
        Machine {
            processor: processor(),
            threads,
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            compiler: env!("VOLREF_COMPILER").to_owned(),
            profile: if cfg!(debug_assertions) {
                "debug"
            } else {
                "release"
            },
            target_features: env!("VOLREF_TARGET_FEATURES").to_owned(),
        }
    }
}

/// Name of the processor, where the system gives it.
fn processor() -> String {
    let bytes = regular_file::read("/proc/cpuinfo".as_ref(), 1 << 24).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let named = |line: &str| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    };
    text.lines()
        .find_map(named)
        .unwrap_or_else(|| "unknown".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn median_and_spread() {
        let times = summary(&[3.0, 1.0, 2.0, 4.0, 100.0]).unwrap();
        assert_eq!((times.median, times.min, times.max), (3.0, 1.0, 100.0));
        assert!(times.is_noisy);
        assert!(!summary(&[1.0, 1.01, 0.99]).unwrap().is_noisy);
        assert_eq!(summary(&[1.0]), None);
    }

    #[test]
    fn tasks_take_turns() {
        let order = Mutex::new(String::new());
        let (a, b) = (
            || order.lock().unwrap().push('a'),
            || order.lock().unwrap().push('b'),
        );
        let clock = Clock {
            runs: 3,
            deadline: None,
        };
        let times = clock.by_turns(&[Box::new(a), Box::new(b)], 1.0);
        assert_eq!(*order.lock().unwrap(), "abababab");
        assert!(times.iter().all(|times| times.unwrap().runs == 3));
        assert_eq!(Clock::default().by_turns(&[Box::new(a)], 1.0), [None]);
    }
}
