//! Any bytes are a MetaImage or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, Orientation, read_volume};

fuzz_target!(|bytes: &[u8]| {
    for orientation in [Orientation::Oblique, Orientation::AsStored] {
        let options = LoadOptions {
            orientation,
            ..LoadOptions::default()
        };
        if let Ok(grid) = read_volume("grid.mha", bytes, None, &options) {
            assert!(grid.values().iter().all(|value| value.is_finite()));
        }
    }
});
