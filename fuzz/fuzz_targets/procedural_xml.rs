//! Any text is a procedural medium or an error that has a place.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::scene::read_procedural;

fuzz_target!(|text: &str| {
    match read_procedural("block.xml", text) {
        Ok(medium) => assert!(medium.coefficients.sigma_t().is_finite()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
