//! Mistakes made in the finished image: between the renderer and the file.

use super::{Edit, Mistake};
use crate::film::Film;
use crate::math;
use crate::variations::edited_film::{Value, mapped, rebuilt, value};
use std::f64::consts::PI;

pub(super) const MISTAKES: &[Mistake] = mistakes! {
    "mirrored" => Image(|film| rearranged(film, |film, [x, y]| [film.width() - 1 - x, y])),
        "left and right are swapped: looking along +z with y up, +x points left in the image";
    "upside-down" => Image(|film| rearranged(film, |film, [x, y]| [x, film.height() - 1 - y])),
        "the image is upside down: the top row is written first (PFM alone begins with the bottom row)";
    "turned-half" => Image(|film| rearranged(film, |film, [x, y]| [film.width() - 1 - x, film.height() - 1 - y])),
        "the image is rotated by 180 degrees: both axes are reversed";
    "transposed" => Image(|film| {
        if film.width() == film.height() {
            rearranged(film, |_, [x, y]| [y, x])
        } else {
            film.clone()
        }
    }),
        "rows and columns are swapped: pixel (x, y) is number x + width y of the file";
    "red-and-blue-exchanged" => Pixels(|film| mixed(film, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])),
        "red and blue are swapped: channels are red, green, blue, in this order";
    "red-and-green-exchanged" => Pixels(|film| mixed(film, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])),
        "red and green are swapped: channels are red, green, blue, in this order";
    "green-and-blue-exchanged" => Pixels(|film| mixed(film, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])),
        "green and blue are swapped: channels are red, green, blue, in this order";
    "channels-green-blue-red" => Pixels(|film| mixed(film, [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])),
        "the channels are green, blue, red: write red, green, blue, in this order";
    "channels-blue-red-green" => Pixels(|film| mixed(film, [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])),
        "the channels are blue, red, green: write red, green, blue, in this order";
    "grey" => Pixels(|film| mixed(film, [LUMINANCE; 3])),
        "the image has no colour: write three channels, not luminance";
    "srgb-encoded" => Pixels(|film| mapped(film, |x, _| (math::linear_to_srgb(x), slope(math::linear_to_srgb, x)))),
        "the image is encoded for a display once too often: write linear radiance, with the output's colour space at raw or linear; codes of a .png are encoded once";
    "gamma-encoded" => Pixels(|film| {
        let encode = |x: f64| math::exp(math::ln(x.max(f64::MIN_POSITIVE)) / 2.2);
        mapped(film, |x, _| (encode(x), slope(encode, x)))
    }),
        "the image is encoded with a gamma of 2.2: write linear radiance";
    "srgb-decoded" => Pixels(|film| mapped(film, |x, _| (math::srgb_to_linear(x), slope(math::srgb_to_linear, x)))),
        "the image is decoded as though it had been encoded for a display: write radiance as it is; encode it for a .png, or declare linear codes by --bits 8-linear";
    "clamped" => Pixels(|film| mapped(film, |x, _| if x > 1.0 { (1.0, 0.0) } else { (x, 1.0) })),
        "radiance above 1 is cut off: keep it, the file holds floating-point numbers";
    "tone-mapped" => Pixels(|film| mapped(film, |x, _| (x / (1.0 + x), 1.0 / ((1.0 + x) * (1.0 + x))))),
        "the image is tone mapped, x / (1 + x) or similar: write radiance unchanged";
    "bright-times-pi" => Pixels(|film| scaled(film, PI)),
        "the whole image is too bright by a factor of pi: is irradiance written in place of radiance, or the 1/pi of Lambert's reflection missing?";
    "bright-over-pi" => Pixels(|film| scaled(film, 1.0 / PI)),
        "the whole image is too dark by a factor of pi: is something divided by pi twice?";
    "bright-times-4pi" => Pixels(|film| scaled(film, 4.0 * PI)),
        "the whole image is too bright by a factor of 4 pi: is the phase function without its 1/(4 pi)?";
    "bright-over-4pi" => Pixels(|film| scaled(film, 1.0 / (4.0 * PI))),
        "the whole image is too dark by a factor of 4 pi: is the phase function divided by 4 pi twice, or intensity taken for power?";
    "bright-doubled" => Pixels(|film| scaled(film, 2.0)),
        "the whole image is twice as bright as it should be: is something counted twice, such as a light that rays hit and that is sampled as well, without weights?";
    "bright-halved" => Pixels(|film| scaled(film, 0.5)),
        "the whole image is half as bright as it should be: is a division by a probability of one half missing, or a sum of two averaged?";
    "black" => Pixels(|film| scaled(film, 0.0)),
        "the image is black: nothing was rendered, or nothing was written";
    "premultiplied-twice" => Pixels(|film| {
        let behind = background(film);
        by_opacity(film, |colour, opacity, channel| {
            let background = (1.0 - opacity) * behind[channel];
            (colour - background) * opacity + background
        })
    }),
        "colours are multiplied by opacity twice: compositing has done so already";
    "background-multiplied-by-opacity" => Pixels(|film| {
        if background(film) == [0.0; 3] {
            return film.clone(); // Before black it is `premultiplied-twice`.
        }
        by_opacity(film, |colour, opacity, _| colour * opacity)
    }),
        "the whole image, with its background, is multiplied by opacity: write it as it is, or the colours of the volume alone";
    "unpremultiplied" => Pixels(|film| {
        by_opacity(film, |colour, opacity, _| {
            if opacity > 0.0 {
                colour / opacity
            } else {
                colour
            }
        })
    }),
        "colours are divided by opacity: write the radiance that arrives, multiplied by opacity, in front of the background";
    "opaque-background" => Alpha(|_| 1.0),
        "opacity is 1 everywhere: the background counts as opaque; write the opacity of the volume alone, 1 minus the light from behind that passes";
    "opacity-not-written" => Alpha(|_| 0.0),
        "opacity is 0 everywhere: the fourth channel is cleared and never written";
    "transmittance-for-opacity" => Alpha(|opacity| 1.0 - opacity),
        "the fourth channel holds the light from behind that passes: write 1 minus that";
    "opacity-blended-by-itself" => Alpha(|opacity| opacity * opacity),
        "opacity is multiplied by itself: in the fourth channel, source and destination are blended with the factors 1 and 1 - a, not a and 1 - a (glBlendFuncSeparate)";
    "one-pixel-right" => Image(|film| shifted(film, [1, 0])),
        "the image is a pixel too far to the right: count pixels from 0";
    "one-pixel-left" => Image(|film| shifted(film, [-1, 0])),
        "the image is a pixel too far to the left: count pixels from 0";
    "one-pixel-down" => Image(|film| shifted(film, [0, 1])),
        "the image is a pixel too low: count rows from 0";
    "one-pixel-up" => Image(|film| shifted(film, [0, -1])),
        "the image is a pixel too high: count rows from 0";
    "half-a-pixel-off" => Image(|film| {
        let corners = [
            ([0, 0], 0.25),
            ([-1, 0], 0.25),
            ([0, -1], 0.25),
            ([-1, -1], 0.25),
        ];
        convolved(film, &corners)
    }),
        "the image is half a pixel off: rays go through the centres of pixels, (x + 1/2, y + 1/2), not through their corners";
    "filtered" => Image(|film| {
        let weights = [0.25, 0.5, 0.25];
        let taps: Vec<_> = (0..9)
            .map(|i| ([i % 3 - 1, i / 3 - 1], weights[i as usize % 3] * weights[i as usize / 3]))
            .collect();
        convolved(film, &taps)
    }),
        "pixels are blurred into each other by a reconstruction filter: each is the mean over its own square (a box filter), or its centre where nothing is sampled";
    "half-resolution" => Image(coarsened),
        "the image was rendered with half the pixels each way and enlarged";
    "tile-missing" => Image(|film| {
        let black = [
            film.width() / 2..film.width() * 3 / 4,
            film.height() / 2..film.height() * 3 / 4,
        ];
        let inside = |[x, y]: [usize; 2]| black[0].contains(&x) && black[1].contains(&y);
        rebuilt(film, |film, at| {
            if inside(at) {
                ([0.0; 3], [0.0; 3])
            } else {
                value(film, at)
            }
        })
    }),
        "a part of the image is black: a tile or strip was not rendered, or not written";
};

/// Weights of red, green and blue in the luminance of linear sRGB.
/// Source: ITU-R BT.709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The pixel at each place comes from another.
fn rearranged(film: &Film, source: fn(&Film, [usize; 2]) -> [usize; 2]) -> Film {
    rebuilt(film, |film, at| value(film, source(film, at)))
}

/// Each channel is a weighted sum of all; those of one pixel are taken to be independent.
fn mixed(film: &Film, weights: [[f64; 3]; 3]) -> Film {
    rebuilt(film, |film, at| {
        let (mean, variance) = value(film, at);
        let sum = |values: [f64; 3], weights: [f64; 3]| {
            (0..3).map(|c| values[c] * weights[c]).sum::<f64>()
        };
        (
            weights.map(|weights| sum(mean, weights)),
            weights.map(|weights| sum(variance, weights.map(|w| w * w))),
        )
    })
}

fn scaled(film: &Film, factor: f64) -> Film {
    mapped(film, |x, _| (x * factor, factor))
}

/// Derivative of `map` at `x`, by a small difference.
fn slope(map: fn(f64) -> f64, x: f64) -> f64 {
    let step = 1e-6 * x.abs().max(1e-3);
    (map(x + step) - map(x - step)) / (2.0 * step)
}

/// A film without opacity stays as it is.
fn by_opacity(film: &Film, map: impl Fn(f64, f64, usize) -> f64) -> Film {
    rebuilt(film, |film, at| {
        let (mean, variance) = value(film, at);
        let index = at[0] + film.width() * at[1];
        let opacity = film.opacity().map(|opacity| f64::from(opacity[index]));
        let of = |opacity: f64| [0, 1, 2].map(|c| map(mean[c], opacity, c));
        (opacity.map_or(mean, of), variance)
    })
}

/// The colour that is seen where opacity is 0; black where it is nowhere.
fn background(film: &Film) -> [f64; 3] {
    let pixels = film.opacity().unwrap_or_default().iter();
    let clear = pixels
        .zip(film.radiance())
        .find(|(opacity, _)| **opacity == 0.0);
    clear.map_or([0.0; 3], |(_, colour)| colour.map(f64::from))
}

/// Everything is moved; what comes in from outside repeats the edge.
fn shifted(film: &Film, [right, down]: [isize; 2]) -> Film {
    convolved(film, &[([-right, -down], 1.0)])
}

/// Each pixel is a weighted sum of those at some offsets, within the image.
fn convolved(film: &Film, taps: &[([isize; 2], f64)]) -> Film {
    let clamped =
        |at: usize, offset: isize, size: usize| at.saturating_add_signed(offset).min(size - 1);
    rebuilt(film, |film, [x, y]| {
        let (width, height) = (film.width(), film.height());
        let places = taps.iter().map(|&([right, down], weight)| {
            ([clamped(x, right, width), clamped(y, down, height)], weight)
        });
        weighted(film, places)
    })
}

/// Squares of two by two pixels, each of the colour of their mean.
fn coarsened(film: &Film) -> Film {
    rebuilt(film, |film, [x, y]| {
        let xs = [x & !1, (x | 1).min(film.width() - 1)];
        let ys = [y & !1, (y | 1).min(film.height() - 1)];
        let places = [0, 1, 2, 3].map(|i| ([xs[i % 2], ys[i / 2]], 0.25));
        weighted(film, places.into_iter())
    })
}

/// A weighted sum of pixels.
fn weighted(film: &Film, places: impl Iterator<Item = ([usize; 2], f64)>) -> Value {
    let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
    for (at, weight) in places {
        let (m, v) = value(film, at);
        for c in 0..3 {
            mean[c] += weight * m[c];
            variance[c] += weight * weight * v[c];
        }
    }
    (mean, variance)
}

#[cfg(test)]
mod tests {
    use crate::film::Film;
    use crate::variations::mistakes::named;

    fn film() -> Film {
        let pixels = (0..12).map(|i| [i as f32, 1.0, 0.5]).collect();
        Film::with_noise(4, 3, pixels, vec![[4.0, 1.0, 0.25]; 12], 8)
    }

    #[test]
    fn scaling_scales_the_noise_too() {
        let edited = named("bright-doubled").unwrap().in_image(&film()).unwrap();
        assert_eq!(edited.radiance()[3], [6.0, 2.0, 1.0]);
        assert_eq!(edited.noise().unwrap().variance()[3], [16.0, 4.0, 1.0]);
    }

    #[test]
    fn a_pixel_to_the_right_is_a_pixel_to_the_right() {
        let edited = named("one-pixel-right").unwrap().in_image(&film()).unwrap();
        let reds: Vec<f32> = edited.radiance().iter().map(|pixel| pixel[0]).collect();
        assert_eq!(reds[..8], [0.0, 0.0, 1.0, 2.0, 4.0, 4.0, 5.0, 6.0]);
        let edited = named("one-pixel-up").unwrap().in_image(&film()).unwrap();
        assert_eq!(edited.radiance()[0][0], 4.0);
        assert_eq!(edited.radiance()[8][0], 8.0);
    }

    /// A pixel of the background, 0.25, and one of opacity 1/2 whose colour, alone, is 0.375.
    #[test]
    fn colours_are_multiplied_twice_before_their_background() {
        let grey = |value: f32, opacity: f32| [value, value, value, opacity];
        let film = Film::with_opacity(2, 1, vec![grey(0.25, 0.0), grey(0.5, 0.5)]);
        let reds = |name: &str| {
            let edited = named(name).unwrap().in_image(&film).unwrap();
            [0, 1].map(|index| edited.radiance()[index][0])
        };
        assert_eq!(reds("premultiplied-twice"), [0.25, 0.375 / 2.0 + 0.125]);
        assert_eq!(reds("background-multiplied-by-opacity"), [0.0, 0.25]);
        let before_black = Film::with_opacity(2, 1, vec![grey(0.0, 0.0), grey(0.5, 0.5)]);
        let twice = named("premultiplied-twice")
            .unwrap()
            .in_image(&before_black);
        assert_eq!(twice.unwrap().radiance()[1][0], 0.25);
        let whole = named("background-multiplied-by-opacity").unwrap();
        assert!(whole.in_image(&before_black).is_none());
    }

    #[test]
    fn what_changes_nothing_is_no_mistake() {
        let grey = Film::new(2, 2, vec![[0.5; 3]; 4]);
        assert!(
            named("red-and-blue-exchanged")
                .unwrap()
                .in_image(&grey)
                .is_none()
        );
        assert!(named("clamped").unwrap().in_image(&grey).is_none());
        assert!(named("mirrored").unwrap().in_image(&grey).is_none());
        assert!(
            named("premultiplied-twice")
                .unwrap()
                .in_image(&grey)
                .is_none()
        );
        assert!(named("srgb-encoded").unwrap().in_image(&grey).is_some());
    }

    #[test]
    fn black_has_a_derivative_of_the_srgb_curve() {
        let black = Film::with_noise(1, 1, vec![[0.0; 3]], vec![[1.0; 3]], 2);
        let edited = named("srgb-encoded").unwrap().in_image(&black).unwrap();
        let slope = edited.noise().unwrap().variance()[0][0].sqrt();
        // The curve is 12.92 x there; the variance is kept to 8 bits.
        assert!((slope / 12.92 - 1.0).abs() < 0.01);
    }
}
