//! Images of means of random samples, drawn one by one, without a renderer: what the stochastic
//! gate must accept, and what it must not.

use volref::film::Film;
use volref::math::{exp, ln};

/// Entries of a table of samples: events of one in a thousand and rarer have some.
const ENTRIES: usize = 1 << 16;

/// Random bits: SplitMix64, one number after the other.
///
/// Source: Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators".
pub struct Bits(pub u64);

impl Bits {
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

/// How samples are distributed: as many values as [`ENTRIES`], equally likely, of mean 1.
pub struct Shape {
    pub name: &'static str,
    samples: Vec<f64>,
}

impl Shape {
    fn new(name: &'static str, quantile: impl Fn(f64) -> f64) -> Shape {
        let middle = |i: usize| (i as f64 + 0.5) / ENTRIES as f64;
        let mut samples: Vec<f64> = (0..ENTRIES).map(|i| quantile(middle(i))).collect();
        let mean = samples.iter().sum::<f64>() / ENTRIES as f64;
        samples.iter_mut().for_each(|sample| *sample /= mean);
        Shape { name, samples }
    }

    /// From mild to wild.
    pub fn all() -> Vec<Shape> {
        vec![
            Shape::new("normal", |u| 1.0 + 0.3 * normal(u)),
            Shape::new("exponential", |u| -ln(1.0 - u)),
            // Gamma-like: half of the samples hold next to nothing.
            Shape::new("cubed exponential", |u| {
                let e = -ln(1.0 - u);
                e * e * e
            }),
            Shape::new("lognormal", |u| exp(1.5 * normal(u))),
            // One sample in a thousand brings half of the light.
            Shape::new("rare lamp", |u| if u < 1e-3 { 1000.0 } else { 0.5 + u }),
            // One in fifty, and nothing else.
            Shape::new("lamp only", |u| if u < 0.02 { 1.0 } else { 0.0 }),
        ]
    }

    /// Mean of `count` samples, and the estimate of its variance.
    fn mean(&self, count: u32, bits: &mut Bits) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        let mut left = count;
        while left > 0 {
            let mut word = bits.word();
            for _ in 0..left.min(4) {
                // Taken from the mean of all, which keeps the digits of the variance.
                let sample = self.samples[word as usize % ENTRIES] - 1.0;
                sum += sample;
                squares += sample * sample;
                word >>= 16;
            }
            left = left.saturating_sub(4);
        }
        let n = f64::from(count);
        let variance = if count < 2 {
            0.0
        } else {
            (squares - sum * sum / n).max(0.0) / (n - 1.0) / n
        };
        (1.0 + sum / n, variance)
    }
}

/// Quantile of the standard normal distribution, to three digits: what for is called normal here
/// need not be so to the last.
///
/// Source: Hastings 1955, as Abramowitz & Stegun 26.2.23.
fn normal(u: f64) -> f64 {
    let t = (-2.0 * ln(u.min(1.0 - u))).sqrt();
    let above = 2.515517 + t * (0.802853 + t * 0.010328);
    let below = 1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308));
    (t - above / below).copysign(u - 0.5)
}

/// What is seen without noise at column x, row y: a ball, a floor that brightens, a checkered
/// part, all but black elsewhere. Edges do not keep to blocks.
pub fn scene(x: f64, y: f64) -> [f64; 3] {
    let (dx, dy) = ((x - 20.0) / 15.0, (y - 18.0) / 13.0);
    let ball = (1.0 - dx * dx - dy * dy).max(0.0).sqrt();
    let floor = if y >= 42.0 { 0.3 + x / 80.0 } else { 0.0 };
    let is_light = ((x / 3.0).floor() + (y / 3.0).floor()).rem_euclid(2.0) < 1.0;
    let checkers = match x >= 43.0 && y < 30.0 {
        true if is_light => 0.8,
        true => 0.2,
        false => 0.02,
    };
    let light = ball + floor + checkers;
    [0.9 * light, 0.6 * light, 0.3 * light]
}

/// How an image is sampled.
#[derive(Clone, Copy)]
pub struct Sampling<'s> {
    pub side: usize,
    pub samples: u32,
    pub seed: u64,
    /// Of the noise in the left part of the image, and of that in the right one.
    pub shapes: [&'s Shape; 2],
    /// Each channel has samples of its own.
    pub coloured: bool,
    /// All pixels use the same random numbers: a mistake.
    pub one_for_all: bool,
}

impl<'s> Sampling<'s> {
    /// Samples of one shape that every pixel has for itself, and all channels together.
    pub fn of(shape: &'s Shape, side: usize, samples: u32, seed: u64) -> Sampling<'s> {
        Sampling {
            side,
            samples,
            seed,
            shapes: [shape; 2],
            coloured: false,
            one_for_all: false,
        }
    }
}

/// An image of `truth` with noise, and what variance it states.
pub fn sampled(sampling: Sampling<'_>, truth: impl Fn(f64, f64) -> [f64; 3]) -> Film {
    let Sampling { side, samples, .. } = sampling;
    let (mut means, mut variances) = (Vec::new(), Vec::new());
    for index in 0..side * side {
        let (x, y) = (index % side, index / side);
        // Numbers of its own for each pixel: more samples begin with the fewer.
        let pixel = if sampling.one_for_all {
            0
        } else {
            index as u64
        };
        let mut bits = Bits(Bits(sampling.seed ^ (pixel << 40)).word());
        let truth = truth(x as f64, y as f64);
        let shape = sampling.shapes[usize::from(3 * x > side + 5)];
        let first = shape.mean(samples, &mut bits);
        let mut drawn = [first; 3];
        if sampling.coloured {
            drawn[1..].fill_with(|| shape.mean(samples, &mut bits));
        }
        means.push([0, 1, 2].map(|c| (truth[c] * drawn[c].0) as f32));
        variances.push([0, 1, 2].map(|c| (truth[c] * truth[c] * drawn[c].1) as f32));
    }
    if samples < 2 {
        return Film::new(side, side, means);
    }
    Film::with_noise(side, side, means, variances, samples)
}

/// The image without what it says of its noise.
pub fn silent(film: &Film) -> Film {
    Film::new(film.width(), film.height(), film.radiance().to_vec())
}

/// Images of one size as replicates: what several runs of a renderer that knows no variance come
/// to.
pub fn replicates(films: &[Film]) -> Film {
    let films: Vec<Film> = films.iter().map(silent).collect();
    Film::from_replicates(&films).expect("two images or more, of seeds of their own")
}

/// The image with other means and the variances it states, if it does.
pub fn with_means(film: &Film, means: Vec<[f32; 3]>) -> Film {
    let (width, height) = (film.width(), film.height());
    match film.noise() {
        None => Film::new(width, height, means),
        Some(noise) => {
            let variance = noise.variance().to_vec();
            Film::with_noise(width, height, means, variance, noise.samples())
        }
    }
}

/// Every pixel edited by its column and row.
pub fn edited(film: &Film, edit: impl Fn(usize, usize, [f32; 3]) -> [f32; 3]) -> Film {
    let pixels = film.radiance().iter().enumerate();
    let pixels = pixels.map(|(i, &pixel)| edit(i % film.width(), i / film.width(), pixel));
    with_means(film, pixels.collect())
}

/// Every pixel the mean of its neighbours within `radius`, weighted by `weight` of the distance
/// across and down and of the pixels themselves.
pub fn smoothed(
    film: &Film,
    radius: usize,
    weight: impl Fn(usize, usize, [f32; 3], [f32; 3]) -> f32,
) -> Film {
    let (width, height) = (film.width(), film.height());
    edited(film, |x, y, here| {
        let (mut sum, mut weights) = ([0.0; 3], 0.0);
        for row in y.saturating_sub(radius)..=(y + radius).min(height - 1) {
            for column in x.saturating_sub(radius)..=(x + radius).min(width - 1) {
                let there = film.radiance()[row * width + column];
                let weight = weight(column.abs_diff(x), row.abs_diff(y), here, there);
                weights += weight;
                for c in 0..3 {
                    sum[c] += weight * there[c];
                }
            }
        }
        sum.map(|value| value / weights)
    })
}

/// Faults of an image, by name; `None` where the image itself is drawn wrongly.
pub type Fault = (&'static str, fn(&Film) -> Film);

/// What is done to finished images.
pub fn faults() -> Vec<Fault> {
    fn scaled(film: &Film, factor: f32) -> Film {
        edited(film, |_, _, pixel| pixel.map(|value| value * factor))
    }
    fn block(film: &Film, factor: f32) -> Film {
        edited(film, |x, y, pixel| {
            if (16..24).contains(&x) && (16..24).contains(&y) {
                pixel.map(|value| value * factor)
            } else {
                pixel
            }
        })
    }
    vec![
        ("+0.5 %", |film| scaled(film, 1.005)),
        ("+1 %", |film| scaled(film, 1.01)),
        ("+5 %", |film| scaled(film, 1.05)),
        ("a block +10 %", |film| block(film, 1.1)),
        ("a block +50 %", |film| block(film, 1.5)),
        ("0.2 % fireflies", |film| {
            // Ten times the brightest that a scene without lamps reflects.
            let mut bits = Bits(7);
            let hits: Vec<bool> = (0..film.radiance().len())
                .map(|_| bits.word().is_multiple_of(500))
                .collect();
            edited(film, |x, y, pixel| {
                if hits[y * film.width() + x] {
                    pixel.map(|value| value + 10.0)
                } else {
                    pixel
                }
            })
        }),
        ("one pixel to the right", |film| {
            edited(film, |x, y, _| {
                film.radiance()[y * film.width() + x.saturating_sub(1)]
            })
        }),
        ("half a pixel to the right, resampled", |film| {
            edited(film, |x, y, pixel| {
                let left = film.radiance()[y * film.width() + x.saturating_sub(1)];
                [0, 1, 2].map(|c| 0.5 * (pixel[c] + left[c]))
            })
        }),
        ("mean of 3 × 3 pixels", |film| {
            smoothed(film, 1, |_, _, _, _| 1.0)
        }),
        ("tent of radius 1.5", |film| {
            let tent = |distance: usize| (1.5 - distance as f32).max(0.0);
            smoothed(film, 1, |dx, dy, _, _| tent(dx) * tent(dy))
        }),
        ("bilateral filter", |film| {
            smoothed(film, 3, |dx, dy, here, there| {
                let apart = (dx * dx + dy * dy) as f64 / 8.0;
                // Alike to a third.
                let unlike = f64::from((here[1] - there[1]) / (0.33 * (here[1] + there[1]) + 1e-3));
                exp(-apart - unlike * unlike) as f32
            })
        }),
    ]
}
