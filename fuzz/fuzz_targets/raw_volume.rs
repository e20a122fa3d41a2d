//! Any text is a description or an error; the samples follow a blank line.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, RawVolume};

fuzz_target!(|bytes: &[u8]| {
    let end = bytes.windows(2).position(|pair| pair == b"\n\n");
    let (text, data) = bytes.split_at(end.map_or(bytes.len(), |end| end + 2));
    let Ok(text) = std::str::from_utf8(text) else { return };
    let Ok(volume) = RawVolume::parse(text) else { return };
    if let Ok(grid) = volume.read_data(data, &LoadOptions::default()) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
});
