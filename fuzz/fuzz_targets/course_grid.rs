//! Any bytes are a course grid or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, read_volume};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(grid) = read_volume("grid.bin", bytes, None, &LoadOptions::default()) {
        assert!(grid.values().iter().all(|value| value.is_finite()));
    }
});
