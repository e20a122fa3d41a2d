//! Any bytes are a NIfTI-1 file, compressed or not, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, Orientation, read_volume};

fuzz_target!(|bytes: &[u8]| {
    for orientation in [Orientation::World, Orientation::AsStored] {
        let options = LoadOptions {
            orientation,
            ..LoadOptions::default()
        };
        for name in ["grid.nii", "grid.nii.gz"] {
            if let Ok(grid) = read_volume(name, bytes, None, &options) {
                assert!(grid.values().iter().all(|value| value.is_finite()));
            }
        }
    }
});
