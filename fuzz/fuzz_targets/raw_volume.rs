//! Any text is a description or an error; the samples follow a blank line.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, read_volume};

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.windows(2).position(|pair| pair == b"\n\n");
    let (text, data) = bytes.split_at(end.map_or(bytes.len(), |end| end + 2));
    if let Ok(grid) = read_volume("grid.toml", text, Some(data), &LoadOptions::default()) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
});
