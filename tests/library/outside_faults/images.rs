//! Faults of finished images.

use volref::film::Film;

/// The image with other pixels and other variances.
fn by_both(film: &Film, pixel: impl Fn([[f32; 3]; 2], [usize; 2]) -> [[f32; 3]; 2]) -> Film {
    let (width, height) = (film.width(), film.height());
    let both = (0..width * height).map(|i| {
        let variance = film.noise().map_or([0.0; 3], |noise| noise.variance()[i]);
        pixel([film.radiance()[i], variance], [i % width, i / width])
    });
    let (pixels, variances) = both.map(|[pixel, variance]| (pixel, variance)).unzip();
    match film.noise() {
        Some(noise) => Film::with_noise(width, height, pixels, variances, noise.samples()),
        None => Film::new(width, height, pixels),
    }
}

/// The image with other values; its noise stays.
pub fn by_pixel(film: &Film, pixel: impl Fn([f32; 3], [usize; 2]) -> [f32; 3]) -> Film {
    by_both(film, |[value, variance], at| [pixel(value, at), variance])
}

pub fn by_value(film: &Film, map: impl Fn(f64, usize) -> f64) -> Film {
    by_pixel(film, |pixel, _| {
        std::array::from_fn(|c| map(f64::from(pixel[c]), c) as f32)
    })
}

pub fn by_place(film: &Film, map: impl Fn(f32, [usize; 2]) -> f32) -> Film {
    by_pixel(film, |pixel, at| pixel.map(|x| map(x, at)))
}

/// Each channel times a factor, with its noise.
pub fn times(film: &Film, factors: [f32; 3]) -> Film {
    by_both(film, |[value, variance], _| {
        [
            std::array::from_fn(|c| factors[c] * value[c]),
            std::array::from_fn(|c| factors[c] * factors[c] * variance[c]),
        ]
    })
}

/// Each channel that of another.
pub fn channels(film: &Film, of: [usize; 3]) -> Film {
    by_both(film, |both, _| both.map(|it| of.map(|c| it[c])))
}

/// Pixels from elsewhere, with their noise; black ones without noise from nowhere. The source is found
/// by place and size.
pub fn from_elsewhere(
    film: &Film,
    source: impl Fn([usize; 2], [usize; 2]) -> Option<[usize; 2]>,
) -> Film {
    let size = [film.width(), film.height()];
    by_both(film, |_, at| {
        let Some([x, y]) = source(at, size) else {
            return [[0.0; 3]; 2];
        };
        let i = x.min(size[0] - 1) + y.min(size[1] - 1) * size[0];
        let variance = film.noise().map_or([0.0; 3], |noise| noise.variance()[i]);
        [film.radiance()[i], variance]
    })
}

/// The film with this factor on its stated variances.
pub fn noise_times(film: &Film, factor: f32) -> Film {
    by_both(film, |[value, variance], _| {
        [value, variance.map(|v| factor * v)]
    })
}

/// Places of 20 pixels, the same in every image of a size.
pub fn is_one_of_twenty([x, y]: [usize; 2], [width, height]: [usize; 2]) -> bool {
    (0..20).any(|k| {
        let along = |n: usize, factor: usize| n / 8 + (k * factor) % (3 * n / 4);
        [x, y] == [along(width, 37), along(height, 53)]
    })
}
