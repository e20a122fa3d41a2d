//! Mistakes made in the finished image: between the renderer and the file.

use super::{Edit, Mistake};
use crate::film::Film;
use crate::math;
use crate::variations::edited_film::{mapped, rebuilt, value};
use std::f64::consts::PI;

pub(super) const MISTAKES: &[Mistake] = &[
    Mistake {
        name: "mirrored",
        advice: "left and right are swapped: looking along +z with y up, +x points left in the image",
        edit: Edit::Image(|film| rearranged(film, |film, [x, y]| [film.width() - 1 - x, y])),
    },
    Mistake {
        name: "upside-down",
        advice: "the image is upside down: the top row is written first (PFM alone begins with the bottom row)",
        edit: Edit::Image(|film| rearranged(film, |film, [x, y]| [x, film.height() - 1 - y])),
    },
    Mistake {
        name: "turned-half",
        advice: "the image is rotated by 180 degrees: both axes are reversed",
        edit: Edit::Image(|film| {
            rearranged(film, |film, [x, y]| {
                [film.width() - 1 - x, film.height() - 1 - y]
            })
        }),
    },
    Mistake {
        name: "transposed",
        advice: "rows and columns are swapped: pixel (x, y) is number x + width y of the file",
        edit: Edit::Image(|film| {
            if film.width() == film.height() {
                rearranged(film, |_, [x, y]| [y, x])
            } else {
                film.clone()
            }
        }),
    },
    Mistake {
        name: "red-and-blue-exchanged",
        advice: "red and blue are swapped: channels are red, green, blue, in this order",
        edit: Edit::Pixels(|film| mixed(film, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])),
    },
    Mistake {
        name: "grey",
        advice: "the image has no colour: write three channels, not luminance",
        edit: Edit::Pixels(|film| mixed(film, [LUMINANCE; 3])),
    },
    Mistake {
        name: "srgb-encoded",
        advice: "the image is encoded for a display once too often: write radiance linear, set to raw or linear; codes of a .png are encoded once",
        edit: Edit::Pixels(|film| {
            mapped(film, |x, _| {
                (math::linear_to_srgb(x), slope(math::linear_to_srgb, x))
            })
        }),
    },
    Mistake {
        name: "gamma-encoded",
        advice: "the image is encoded with a gamma of 2.2: write linear radiance",
        edit: Edit::Pixels(|film| {
            let encode = |x: f64| math::exp(math::ln(x.max(f64::MIN_POSITIVE)) / 2.2);
            mapped(film, |x, _| (encode(x), slope(encode, x)))
        }),
    },
    Mistake {
        name: "srgb-decoded",
        advice: "the image is decoded as though it had been encoded for a display: write radiance as it is; encode it for a .png, or declare linear codes by --bits 8-linear",
        edit: Edit::Pixels(|film| {
            mapped(film, |x, _| {
                (math::srgb_to_linear(x), slope(math::srgb_to_linear, x))
            })
        }),
    },
    Mistake {
        name: "clamped",
        advice: "radiance above 1 is cut off: keep it, the file holds floating-point numbers",
        edit: Edit::Pixels(|film| mapped(film, |x, _| if x > 1.0 { (1.0, 0.0) } else { (x, 1.0) })),
    },
    Mistake {
        name: "tone-mapped",
        advice: "the image is tone mapped, x / (1 + x) or similar: write radiance unchanged",
        edit: Edit::Pixels(|film| {
            mapped(film, |x, _| (x / (1.0 + x), 1.0 / ((1.0 + x) * (1.0 + x))))
        }),
    },
    Mistake {
        name: "bright-times-pi",
        advice: "the whole image is too bright by a factor of pi: is irradiance written in place of radiance, or the 1/pi of Lambert's reflection missing?",
        edit: Edit::Pixels(|film| scaled(film, PI)),
    },
    Mistake {
        name: "bright-over-pi",
        advice: "the whole image is too dark by a factor of pi: is something divided by pi twice?",
        edit: Edit::Pixels(|film| scaled(film, 1.0 / PI)),
    },
    Mistake {
        name: "bright-times-4pi",
        advice: "the whole image is too bright by a factor of 4 pi: is the phase function without its 1/(4 pi)?",
        edit: Edit::Pixels(|film| scaled(film, 4.0 * PI)),
    },
    Mistake {
        name: "bright-over-4pi",
        advice: "the whole image is too dark by a factor of 4 pi: is the phase function divided by 4 pi twice, or intensity taken for power?",
        edit: Edit::Pixels(|film| scaled(film, 1.0 / (4.0 * PI))),
    },
    Mistake {
        name: "bright-doubled",
        advice: "the whole image is twice as bright as it should be: is something counted twice, such as a light that rays hit and that is sampled as well, without weights?",
        edit: Edit::Pixels(|film| scaled(film, 2.0)),
    },
    Mistake {
        name: "bright-halved",
        advice: "the whole image is half as bright as it should be: is a probability of one half divided out only once, or a sum of two averaged?",
        edit: Edit::Pixels(|film| scaled(film, 0.5)),
    },
    Mistake {
        name: "black",
        advice: "the image is black: nothing was rendered, or nothing was written",
        edit: Edit::Pixels(|film| scaled(film, 0.0)),
    },
    Mistake {
        name: "premultiplied-twice",
        advice: "colours are multiplied by opacity twice: compositing has done so already",
        edit: Edit::Pixels(|film| {
            let behind = background(film);
            by_opacity(film, |colour, opacity, channel| {
                let background = (1.0 - opacity) * behind[channel];
                (colour - background) * opacity + background
            })
        }),
    },
    Mistake {
        name: "background-multiplied-by-opacity",
        advice: "the whole image, with its background, is multiplied by opacity: write it as it is, or the colours of the volume alone",
        edit: Edit::Pixels(|film| {
            if background(film) == [0.0; 3] {
                return film.clone(); // Before black it is `premultiplied-twice`.
            }
            by_opacity(film, |colour, opacity, _| colour * opacity)
        }),
    },
    Mistake {
        name: "unpremultiplied",
        advice: "colours are divided by opacity: write the radiance that arrives, multiplied by opacity, in front of the background",
        edit: Edit::Pixels(|film| {
            by_opacity(film, |colour, opacity, _| {
                if opacity > 0.0 {
                    colour / opacity
                } else {
                    colour
                }
            })
        }),
    },
    Mistake {
        name: "opaque-background",
        advice: "opacity is 1 everywhere: the background counts as opaque; write the opacity of the volume alone, 1 minus the light from behind that passes",
        edit: Edit::Alpha(|_| 1.0),
    },
    Mistake {
        name: "opacity-not-written",
        advice: "opacity is 0 everywhere: the fourth channel is cleared and never written",
        edit: Edit::Alpha(|_| 0.0),
    },
    Mistake {
        name: "transmittance-for-opacity",
        advice: "the fourth channel holds the light from behind that passes: write 1 minus that",
        edit: Edit::Alpha(|opacity| 1.0 - opacity),
    },
    Mistake {
        name: "opacity-blended-by-itself",
        advice: "opacity is multiplied by itself: in the fourth channel, source and destination are blended with the factors 1 and 1 - a, not a and 1 - a (glBlendFuncSeparate)",
        edit: Edit::Alpha(|opacity| opacity * opacity),
    },
    Mistake {
        name: "one-pixel-right",
        advice: "the image is a pixel too far to the right: count pixels from 0",
        edit: Edit::Image(|film| shifted(film, [1, 0])),
    },
    Mistake {
        name: "one-pixel-left",
        advice: "the image is a pixel too far to the left: count pixels from 0",
        edit: Edit::Image(|film| shifted(film, [-1, 0])),
    },
    Mistake {
        name: "one-pixel-down",
        advice: "the image is a pixel too low: count rows from 0",
        edit: Edit::Image(|film| shifted(film, [0, 1])),
    },
    Mistake {
        name: "one-pixel-up",
        advice: "the image is a pixel too high: count rows from 0",
        edit: Edit::Image(|film| shifted(film, [0, -1])),
    },
    Mistake {
        name: "half-a-pixel-off",
        advice: "the image is half a pixel off: rays go through the centres of pixels, (x + 1/2, y + 1/2), not through their corners",
        edit: Edit::Image(|film| {
            let corners = [
                ([0, 0], 0.25),
                ([-1, 0], 0.25),
                ([0, -1], 0.25),
                ([-1, -1], 0.25),
            ];
            convolved(film, &corners)
        }),
    },
    Mistake {
        name: "filtered",
        advice: "pixels are blurred into each other by a reconstruction filter: each is the mean over its own square (a box filter), or its centre where nothing is sampled",
        edit: Edit::Image(|film| {
            let weights = [0.25, 0.5, 0.25];
            let taps: Vec<_> = (0..9)
                .map(|i| {
                    (
                        [i % 3 - 1, i / 3 - 1],
                        weights[i as usize % 3] * weights[i as usize / 3],
                    )
                })
                .collect();
            convolved(film, &taps)
        }),
    },
    Mistake {
        name: "half-resolution",
        advice: "the image was rendered with half the pixels each way and enlarged",
        edit: Edit::Image(coarsened),
    },
    Mistake {
        name: "tile-missing",
        advice: "a part of the image is black: a tile or strip was not rendered, or not written",
        edit: Edit::Image(|film| {
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
    },
];

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
        let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
        for &([right, down], weight) in taps {
            let (m, v) = value(
                film,
                [
                    clamped(x, right, film.width()),
                    clamped(y, down, film.height()),
                ],
            );
            for c in 0..3 {
                mean[c] += weight * m[c];
                variance[c] += weight * weight * v[c];
            }
        }
        (mean, variance)
    })
}

/// Squares of two by two pixels, each of the colour of their mean.
fn coarsened(film: &Film) -> Film {
    rebuilt(film, |film, [x, y]| {
        let xs = [x & !1, (x | 1).min(film.width() - 1)];
        let ys = [y & !1, (y | 1).min(film.height() - 1)];
        let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
        for at in [
            [xs[0], ys[0]],
            [xs[1], ys[0]],
            [xs[0], ys[1]],
            [xs[1], ys[1]],
        ] {
            let (m, v) = value(film, at);
            for c in 0..3 {
                mean[c] += m[c] / 4.0;
                variance[c] += v[c] / 16.0;
            }
        }
        (mean, variance)
    })
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
