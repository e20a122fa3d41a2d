//! Any bytes are a Mitsuba volume or an error; what was read from `float32` is written back as it
//! was.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{Centring, LoadOptions, read_volume, vol_bytes};

fuzz_target!(|bytes: &[u8]| {
    for centring in [Centring::Nodes, Centring::Cells] {
        let options = LoadOptions {
            centring: Some(centring),
            ..LoadOptions::default()
        };
        let Ok(grid) = read_volume("grid.vol", bytes, None, &options) else { continue };
        assert!(grid.values().iter().all(|value| value.is_finite()));
        let (lattice, bounds) = (grid.lattice(), grid.lattice().bounds());
        let corners = [bounds.min, bounds.max].map(|corner| corner.as_vec3());
        if corners[1].is_finite() && corners[1].cmpgt(corners[0]).all() {
            let counts = lattice.nodes().map(|nodes| nodes as i32);
            let written = vol_bytes(counts, corners.map(|it| it.to_array()), grid.values());
            let again = read_volume("grid.vol", &written, None, &options);
            let again = again.expect("what was written can be read");
            assert_eq!(again.values(), grid.values());
            assert_eq!(again.lattice().nodes(), grid.lattice().nodes());
        }
    }
});
