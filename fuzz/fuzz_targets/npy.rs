//! Any bytes are an array of NumPy that is an image, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use volref::film::Film;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(film) = Film::from_npy(bytes) {
        assert_eq!(film.radiance().len(), film.width() * film.height());
    }
});
