//! Barrier around the decoders of other crates: a panic on the bytes of another program is an error
//! of the file.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;
use thiserror::Error;

#[cfg(not(panic = "unwind"))]
compile_error!("a decoder that panics must not end the process: build with panic = \"unwind\"");

/// A decoder panicked. Its input is broken, in a way it does not expect.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("the decoder stopped: {0}")]
pub struct Stopped(String);

/// Letters of a panic that are reported: enough for any message of a slice or an arithmetic.
const MOST_LETTERS: usize = 200;

thread_local! {
    /// True if this thread runs a decoder.
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// Result of `decode`, or the message of its panic, which is not printed. Data that `decode` was
/// changing at a panic is incomplete and must be dropped.
///
/// For code that panics in the thread it is called in: a panic in a thread of its own ends the
/// process, or is waited for without end.
pub fn run<T>(decode: impl FnOnce() -> T) -> Result<T, Stopped> {
    silence_decoders();
    let outer = DECODING.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(decode));
    DECODING.set(outer);
    result.map_err(|payload| {
        let text = payload.downcast_ref::<&str>().copied();
        let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str));
        // The further lines of an assertion are its values.
        let mut lines = text.unwrap_or("it says nothing").lines();
        let line = lines.next().unwrap_or_default();
        Stopped(line.chars().take(MOST_LETTERS).collect())
    })
}

/// Replaces the panic hook, one for all threads, by one that is silent in threads that decode.
fn silence_decoders() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let print = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            // A thread that ends has no such value any more.
            if !DECODING.try_with(Cell::get).unwrap_or(false) {
                print(panic);
            }
        }));
    });
}

/// A reader whose panics are errors of reading.
pub struct Guarded<R>(pub R);

impl<R: std::io::Read> std::io::Read for Guarded<R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        run(|| self.0.read(bytes)).map_err(std::io::Error::other)?
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;

    #[test]
    fn a_panic_is_an_error_with_its_message() {
        assert_eq!(run(|| 7), Ok(7));
        let stopped = run(|| -> u8 { panic!("no {}", "palette") }).unwrap_err();
        assert_eq!(stopped.to_string(), "the decoder stopped: no palette");
        let stopped = run(|| assert_eq!(1, 2, "odd")).unwrap_err();
        assert!(!stopped.to_string().contains('\n'), "{stopped}");
        let stopped = run(|| -> u8 { panic::panic_any(7) }).unwrap_err();
        assert_eq!(stopped.to_string(), "the decoder stopped: it says nothing");
        assert!(!DECODING.get(), "later panics of this thread are printed");
    }

    #[test]
    fn a_reader_that_panics_cannot_be_read() {
        struct Broken;
        impl Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
                panic!("broken")
            }
        }
        let error = Guarded(Broken).read(&mut [0; 4]).unwrap_err();
        assert_eq!(error.to_string(), "the decoder stopped: broken");
    }
}
