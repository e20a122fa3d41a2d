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
        let pool = pool.build();
        pool.map(|pool| pool.install(work))
            .map_err(|error| bad_input(format!("--threads: {error}")))
    }
}

/// Largest number of threads, as for `--threads`: more than machines have cores.
const MOST: usize = 1024;

/// Starts the threads that the environment variables of rayon ask for, or one for each core.
///
/// # Errors
///
/// If they are too many, or the system refuses them: rayon alone would panic, at the first work.
pub fn start() -> Result<(), Failure> {
    for name in ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"] {
        let asked = std::env::var(name).ok();
        let threads = asked.and_then(|text| text.parse::<usize>().ok());
        if let Some(threads) = threads.filter(|threads| *threads > MOST) {
            return Err(bad_input(format!(
                "{name} asks for {threads} threads: at most {MOST} are started"
            )));
        }
    }
    let pool = rayon::ThreadPoolBuilder::new();
    pool.build_global().map_err(bad_input)
}
