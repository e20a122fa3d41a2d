//! Ctrl-C: ends the process, or only work that can be interrupted.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

/// The next Ctrl-C ends the process.
const ENDS: u8 = 0;
/// The next Ctrl-C interrupts the work.
const CUTS: u8 = 1;
/// The work was interrupted, and the next Ctrl-C ends the process.
const CUT: u8 = 2;

static NEXT: AtomicU8 = AtomicU8::new(ENDS);

/// Functions to run before the process ends.
static LAST: Mutex<Vec<Box<dyn Fn() + Send>>> = Mutex::new(Vec::new());

/// Runs `last`, after functions given earlier, before Ctrl-C or another signal ends this process.
/// On systems without such signals it does nothing.
pub fn before_the_end(last: impl Fn() + Send + 'static) {
    LAST.lock()
        .unwrap_or_else(PoisonError::into_inner)
        .push(Box::new(last));
    // Fails where it was set before.
    let _ = ctrlc::set_handler(|| {
        let is_cut = NEXT.compare_exchange(CUTS, CUT, Ordering::SeqCst, Ordering::SeqCst);
        if is_cut.is_err() {
            let last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
            last.iter().for_each(|last| last());
            // 128 and the number of SIGINT, as shells have it.
            std::process::exit(130);
        }
    });
}

/// Runs `work`, which a first Ctrl-C interrupts instead of ending the process: it must poll
/// [`is_cut_short`].
pub fn can_be_cut_short<T>(work: impl FnOnce() -> T) -> T {
    NEXT.store(CUTS, Ordering::SeqCst);
    let value = work();
    NEXT.store(ENDS, Ordering::SeqCst);
    value
}

/// True if Ctrl-C was pressed since the interruptible work began.
pub fn is_cut_short() -> bool {
    NEXT.load(Ordering::SeqCst) == CUT
}
