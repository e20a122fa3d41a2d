//! Number of rendering threads, by an option or by environment variables.

use super::failure::{Failure, bad_input};

/// Most threads.
const MOST: u16 = 1024;

/// Option for the number of threads.
#[derive(clap::Args, Debug)]
pub struct Threads {
    /// Threads to use; the image is the same for any number [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST)))]
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

/// Starts the threads that the environment asks for.
///
/// # Errors
///
/// If they are too many, or the system refuses them: rayon alone would panic, at the first work.
pub fn start() -> Result<(), Failure> {
    let number = |name| Some((name, std::env::var(name).ok()?.parse::<usize>().ok()?));
    // The older name last, as rayon has it.
    let asked = number("RAYON_NUM_THREADS").or_else(|| number("RAYON_RS_NUM_CPUS"));
    let Some((name, threads)) = asked else {
        return Ok(());
    };
    let refused = |why: &str| bad_input(format!("{name} asks for {threads} threads: {why}"));
    if threads > MOST.into() {
        return Err(refused(&format!("at most {MOST} are started")));
    }
    // 0 stands for the number of cores.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build_global()
        .map_err(|error| refused(&error.to_string()))
}
