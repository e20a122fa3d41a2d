//! Any bytes are a PNG image, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::film::Film;

fuzz_target!(|bytes: &[u8]| {
    if let Ok((width, height, codes)) = Film::codes_from_png(bytes) {
        assert_eq!(codes.len(), width * height);
    }
});
