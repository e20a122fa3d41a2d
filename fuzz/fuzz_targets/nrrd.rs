//! Any bytes are a NRRD file or an error: with its data, or a header whose data follow in the same
//! bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, NonFinite, Orientation, read_volume};

fuzz_target!(|bytes: &[u8]| {
    let options = LoadOptions::default();
    if let Ok(grid) = read_volume("grid.nrrd", bytes, None, &options) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
    let loose = LoadOptions {
        orientation: Orientation::AsStored,
        non_finite: NonFinite::Replaced(0.0),
        ..options
    };
    if let Ok(grid) = read_volume("grid.nrrd", bytes, None, &loose) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
    if let Some(data) = bytes.windows(2).position(|pair| pair == b"\n\n") {
        let (header, data) = bytes.split_at(data + 2);
        let _ = read_volume("grid.nhdr", header, Some(data), &options);
    }
});
