//! Number of rendering threads, from environment variables.

use super::failure::{Failure, bad_input};

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
