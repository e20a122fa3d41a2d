//! Number of rendering threads, by an option or by environment variables.

use super::failure::{Failure, bad_input};

/// Option for the number of threads.
#[derive(clap::Args, Debug)]
pub struct Threads {
    /// Threads to use; the image is the same for any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Threads {
    /// Runs `work` on that many threads.
    pub fn run<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        let Some(threads) = self.threads else {
            return Ok(work());
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.into());
        (pool.build().map(|pool| pool.install(work)))
            .map_err(|error| bad_input(format!("--threads: {error}")))
    }
}

/// Largest number of threads, as for `--threads`: more than machines have cores.
const MOST: usize = 1024;

/// The environment variables of rayon, the older one last.
const VARIABLES: [&str; 2] = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"];

/// Starts the threads that the environment asks for.
///
/// # Errors
///
/// If they are too many, or the system refuses them: rayon alone would panic, at the first work.
pub fn start() -> Result<(), Failure> {
    let number = |name| std::env::var(name).ok()?.parse::<usize>().ok();
    let mut asked = VARIABLES
        .into_iter()
        .filter_map(|name| Some((name, number(name)?)));
    let Some((name, threads)) = asked.next() else {
        return Ok(());
    };
    let refused = |why: String| {
        bad_input(format!(
            "{name} asks for {threads} threads: {why}; without it, there is one for each core"
        ))
    };
    if threads > MOST {
        return Err(refused(format!("at most {MOST} are started")));
    }
    // 0 stands for the number of cores.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global()
        .map_err(|error| refused(error.to_string()))
}
