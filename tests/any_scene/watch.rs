//! What to say of a scene that takes for ever: a test that hangs would not tell which it was.

use std::sync::{Mutex, Once};
use std::time::{Duration, Instant};

/// A scene under way for longer is shown, and the test given up. Those that are rendered take
/// milliseconds; the bounds of their work, seconds.
const PATIENCE: Duration = Duration::from_secs(300);

static UNDER_WAY: Mutex<Option<(Instant, String)>> = Mutex::new(None);
static WATCHMAN: Once = Once::new();

/// Watches until it is dropped.
pub struct Watched;

/// Watches over work on `scene`.
pub fn during(scene: &str) -> Watched {
    WATCHMAN.call_once(|| {
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(Duration::from_secs(1));
                give_up_on_what_hangs();
            }
        });
    });
    *UNDER_WAY.lock().unwrap() = Some((Instant::now(), scene.to_owned()));
    Watched
}

impl Drop for Watched {
    fn drop(&mut self) {
        *UNDER_WAY.lock().unwrap() = None;
    }
}

fn give_up_on_what_hangs() {
    let under_way = UNDER_WAY.lock().unwrap();
    if let Some((since, scene)) = &*under_way
        && since.elapsed() > PATIENCE
    {
        eprintln!("no end in sight after {PATIENCE:?}:\n{scene}");
        std::process::exit(101);
    }
}
