//! Any bytes are a PFM image, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::film::Film;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(film) = Film::from_pfm(bytes) {
        assert_eq!(film.radiance().len(), film.width() * film.height());
    }
});
