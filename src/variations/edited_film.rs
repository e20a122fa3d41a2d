//! Films made from others, pixel by pixel, with the noise to first order.

use crate::film::Film;

/// Radiance and variance of a pixel.
pub type Value = ([f64; 3], [f64; 3]);

/// Radiance and variance at column and row; variance 0 where the film states none.
pub fn value(film: &Film, [x, y]: [usize; 2]) -> Value {
    let index = x + film.width() * y;
    let radiance = film.radiance()[index].map(f64::from);
    (radiance, [0, 1, 2].map(|c| film.variance_at(index, c)))
}

/// The film with other pixels; opacity is unchanged.
pub fn rebuilt(film: &Film, pixel: impl Fn(&Film, [usize; 2]) -> Value) -> Film {
    let (width, height) = (film.width(), film.height());
    let single = |values: [f64; 3]| values.map(|value| value as f32);
    let pixels = (0..width * height).map(|index| {
        let (mean, spread) = pixel(film, [index % width, index / width]);
        (single(mean), single(spread))
    });
    let (radiance, variance): (Vec<_>, Vec<_>) = pixels.unzip();
    match (film.noise(), film.opacity()) {
        (Some(noise), _) if noise.is_known() => Film::new(width, height, radiance).known(),
        (Some(noise), _) => Film::with_noise(width, height, radiance, variance, noise.samples()),
        (None, Some(opacity)) => {
            let pixels = radiance.iter().zip(opacity);
            let pixels = pixels.map(|(&[r, g, b], &a)| [r, g, b, a]);
            Film::with_opacity(width, height, pixels.collect())
        }
        (None, None) => Film::new(width, height, radiance),
    }
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
