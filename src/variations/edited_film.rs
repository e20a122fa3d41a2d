//! Films made from others, pixel by pixel, with the noise to first order.

use crate::film::Film;

/// Radiance and variance of a pixel.
pub type Value = ([f64; 3], [f64; 3]);

/// Radiance and variance at column and row; variance 0 where the film states none.
pub fn value(film: &Film, [x, y]: [usize; 2]) -> Value {
    let index = x + film.width() * y;
    let variance = film
        .noise()
        .map_or([0.0; 3], |noise| noise.variance()[index]);
    (
        film.radiance()[index].map(f64::from),
        variance.map(f64::from),
    )
}

/// The film with other pixels; opacity is unchanged.
pub fn rebuilt(film: &Film, pixel: impl Fn(&Film, [usize; 2]) -> Value) -> Film {
    let (width, height) = (film.width(), film.height());
    let single = |values: [f64; 3]| values.map(|value| value as f32);
    let (mut radiance, mut variance) = (Vec::new(), Vec::new());
    for index in 0..width * height {
        let (mean, spread) = pixel(film, [index % width, index / width]);
        radiance.push(single(mean));
        variance.push(single(spread));
    }
    if let Some(noise) = film.noise() {
        if noise.is_known() {
            return Film::new(width, height, radiance).known();
        }
        return Film::with_noise(width, height, radiance, variance, noise.samples());
    }
    let Some(opacity) = film.opacity() else {
        return Film::new(width, height, radiance);
    };
    let pixels = radiance.iter().zip(opacity);
    let pixels = pixels.map(|(&[r, g, b], &a)| [r, g, b, a]);
    Film::with_opacity(width, height, pixels.collect())
}

/// The value of each channel mapped to another; with the derivative of the map, by which noise
/// grows.
pub fn mapped(film: &Film, map: impl Fn(f64, usize) -> (f64, f64)) -> Film {
    rebuilt(film, |film, at| {
        let (mean, variance) = value(film, at);
        let new: [(f64, f64); 3] = std::array::from_fn(|channel| map(mean[channel], channel));
        let spread = |channel: usize| variance[channel] * new[channel].1 * new[channel].1;
        (new.map(|(value, _)| value), [0, 1, 2].map(spread))
    })
}
