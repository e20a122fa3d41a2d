//! Ctrl-C: ends the process, or only work that can be cut short.

use std::sync::atomic::{AtomicU8, Ordering};

/// The next Ctrl-C ends the process.
const ENDS: u8 = 0;
/// The next one is taken as a wish to cut work short.
const CUTS: u8 = 1;
/// There was such a wish, and the next one ends the process.
const CUT: u8 = 2;

static NEXT: AtomicU8 = AtomicU8::new(ENDS);

/// Has `last` done before Ctrl-C, or whatever else tells this process to end, ends it. To be called
/// once; where the system has no such signals, nothing happens.
pub fn before_the_end(last: impl Fn() + Send + 'static) {
    let _ = ctrlc::set_handler(move || {
        let is_cut = NEXT.compare_exchange(CUTS, CUT, Ordering::SeqCst, Ordering::SeqCst);
        if is_cut.is_err() {
            last();
            // 128 and the number of SIGINT, as shells have it.
            std::process::exit(130);
        }
    });
}

/// Does `work`, which a first Ctrl-C cuts short rather than ending the process: it is to ask often
/// whether [`is_cut_short`]. Whether it was, is the second value.
pub fn can_be_cut_short<T>(work: impl FnOnce() -> T) -> (T, bool) {
    NEXT.store(CUTS, Ordering::SeqCst);
    let value = work();
    (value, NEXT.swap(ENDS, Ordering::SeqCst) == CUT)
}

/// Whether there was a Ctrl-C since the work began that can be cut short.
pub fn is_cut_short() -> bool {
    NEXT.load(Ordering::SeqCst) == CUT
}
