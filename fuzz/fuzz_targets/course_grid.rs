//! Any bytes are a course grid or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::volume::{LoadOptions, read_course_grid, write_course_grid};

fuzz_target!(|bytes: &[u8]| {
    let Ok(grid) = read_course_grid(bytes, &LoadOptions::default()) else { return };
    assert!(grid.values().iter().all(|value| value.is_finite()));
    let _ = write_course_grid(&grid);
});
