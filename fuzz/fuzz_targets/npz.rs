//! Any bytes are an archive of one array, in either order of its axes, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{AxisOrder, LoadOptions, read_volume};

fuzz_target!(|bytes: &[u8]| {
    for (_, order) in AxisOrder::ALL {
        let options = LoadOptions {
            axes: Some(order),
            ..LoadOptions::default()
        };
        if let Ok(grid) = read_volume("grid.npz", bytes, None, &options) {
            assert!(grid.values().iter().all(|value| value.is_finite()));
        }
    }
});
