//! Films as serde reads them, before they are checked.

use super::{Film, Noise};
use serde::Deserialize;

/// The fields of a film.
#[derive(Deserialize)]
pub(super) struct StoredFilm {
    width: usize,
    height: usize,
    radiance: Vec<[f32; 3]>,
    opacity: Option<Vec<f32>>,
    noise: Option<Noise>,
    samples: Option<u64>,
}

impl TryFrom<StoredFilm> for Film {
    type Error = &'static str;

    fn try_from(stored: StoredFilm) -> Result<Film, Self::Error> {
        let pixels = stored.width.checked_mul(stored.height);
        let is_of_all = |count: usize| Some(count) == pixels;
        let is_whole = is_of_all(stored.radiance.len())
            && stored.opacity.as_ref().is_none_or(|of| is_of_all(of.len()))
            && stored
                .noise
                .as_ref()
                .is_none_or(|of| is_of_all(of.variance.len()));
        if !is_whole {
            return Err("the image has not one value per pixel");
        }
        Ok(Film {
            opacity: stored.opacity,
            noise: stored.noise,
            samples: stored.samples,
            ..Film::new(stored.width, stored.height, stored.radiance)
        })
    }
}
