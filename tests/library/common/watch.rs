//! A watchdog over work that may never end: a test that hangs would not name what it hangs on.

use std::sync::{Mutex, Once};
use std::time::{Duration, Instant};

struct Work {
    /// A text that names it.
    name: String,
    patience: Duration,
    since: Instant,
}

static UNDER_WAY: Mutex<Option<Work>> = Mutex::new(None);
static WATCHDOG: Once = Once::new();

/// Watches until it is dropped.
pub struct Watched;

/// Watches over work named by the text `name`: after `patience` prints it and gives up the test
/// program.
pub fn during(name: impl Into<String>, patience: Duration) -> Watched {
    WATCHDOG.call_once(|| {
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(Duration::from_secs(1));
                give_up_on_what_hangs();
            }
        });
    });
    *UNDER_WAY.lock().unwrap() = Some(Work {
        name: name.into(),
        patience,
        since: Instant::now(),
    });
    Watched
}

impl Drop for Watched {
    fn drop(&mut self) {
        *UNDER_WAY.lock().unwrap() = None;
    }
}

fn give_up_on_what_hangs() {
    let under_way = UNDER_WAY.lock().unwrap();
    if let Some(work) = &*under_way
        && work.since.elapsed() > work.patience
    {
        eprintln!("no end in sight after {:?}:\n{}", work.patience, work.name);
        std::process::exit(101);
    }
}
