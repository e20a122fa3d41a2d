//! What to say of an input that takes for ever: a test that hangs would not tell which it was.

use super::PATIENCE;
use std::sync::{Mutex, Once};
use std::time::{Duration, Instant};

static UNDER_WAY: Mutex<Option<(Instant, String)>> = Mutex::new(None);
static WATCHMAN: Once = Once::new();

/// Watches until it is dropped.
pub struct Watched;

/// Watches over the reading of `input`, which is in `target/mutants/under-way`.
pub fn during(input: String) -> Watched {
    WATCHMAN.call_once(|| {
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(Duration::from_secs(1));
                give_up_on_what_hangs();
            }
        });
    });
    *UNDER_WAY.lock().unwrap() = Some((Instant::now(), input));
    Watched
}

impl Drop for Watched {
    fn drop(&mut self) {
        *UNDER_WAY.lock().unwrap() = None;
    }
}

fn give_up_on_what_hangs() {
    let under_way = UNDER_WAY.lock().unwrap();
    if let Some((since, input)) = &*under_way
        && since.elapsed() > 2 * PATIENCE
    {
        eprintln!("no end in sight: {input}");
        std::process::exit(101);
    }
}
