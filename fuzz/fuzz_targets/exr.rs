//! Any bytes are an EXR image, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::film::Film;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(film) = Film::from_exr(bytes) {
        assert_eq!(film.radiance().len(), film.width() * film.height());
    }
    let _ = Film::variance_from_exr(bytes);
});
