//! Any bytes are a Mitsuba volume or an error; what was read from `float32` is written back as it
//! was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{Centring, LoadOptions, read_vol, write_vol};

fuzz_target!(|bytes: &[u8]| {
    for centring in [Centring::Nodes, Centring::Cells] {
        let options = LoadOptions {
            centring: Some(centring),
            ..LoadOptions::default()
        };
        let Ok(grid) = read_vol(bytes, &options) else { continue };
        assert!(grid.values().iter().all(|value| value.is_finite()));
        if let Ok(written) = write_vol(&grid) {
            let again = read_vol(&written, &options).expect("what was written can be read");
            assert_eq!(again.values(), grid.values());
            assert_eq!(again.lattice().nodes(), grid.lattice().nodes());
        }
    }
});
