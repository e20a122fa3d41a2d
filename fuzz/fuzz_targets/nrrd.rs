//! Any bytes are a NRRD file or an error: with its data, or a header whose data follow in the same
//! bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, NonFinite, Orientation, read_nrrd, read_nrrd_header};

fuzz_target!(|bytes: &[u8]| {
    let options = LoadOptions::default();
    if let Ok(grid) = read_nrrd(bytes, &options) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
    let loose = LoadOptions {
        orientation: Orientation::AsStored,
        non_finite: NonFinite::Replaced(0.0),
        ..options
    };
    if let Ok(grid) = read_nrrd(bytes, &loose) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
    if let Ok(header) = read_nrrd_header(bytes)
        && let Some(data) = bytes.windows(2).position(|pair| pair == b"\n\n")
    {
        let _ = header.read_data(&bytes[data + 2..], &options);
    }
});
