//! How large FLIP is for differences nobody sees and for faults everybody sees: the ground for
//! thresholds.

use crate::support::pairs::{
    changed, code, constant, image, random, random_pixel, shifted_code, smoke, smoke_image,
    with_noise,
};
use volref::compare::flip::{DEFAULT_PIXELS_PER_DEGREE, SrgbImage, flip};
use volref::compare::perceptual::{MOST_MEAN as ROUNDING_MEAN, MOST_P99 as ROUNDING_HIGH};

// No image tried whose codes are all off by at most one exceeds the limits of the perceptual gate:
// the largest mean is 0.0571 (full green with one channel up), the largest weighted 99th
// percentile 0.0601 (a gradient of colours).

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

/// Mean and weighted 99th percentile.
fn measure(reference: &SrgbImage, test: &SrgbImage) -> (f64, f64) {
    let errors = flip(reference, test, DEFAULT_PIXELS_PER_DEGREE).expect("valid input");
    (errors.mean(), errors.weighted_percentile(99.0))
}

fn images() -> Vec<(String, SrgbImage)> {
    let grey = |level: u8| (format!("grey {level}"), constant(64, 64, [level; 3]));
    let mut images: Vec<_> = [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 128, 192, 254]
        .map(grey)
        .into();
    for (name, colour) in [
        ("red", [254, 0, 0]),
        ("green", [0, 254, 0]),
        ("blue", [0, 0, 254]),
        ("dark red", [16, 0, 0]),
        ("dark green", [0, 16, 0]),
        ("dark blue", [0, 0, 16]),
        ("yellow", [254, 254, 0]),
        ("cyan", [0, 254, 254]),
        ("magenta", [254, 0, 254]),
    ] {
        images.push((name.into(), constant(64, 64, colour)));
    }
    let mut more = |name: &str, image| images.push((name.into(), image));
    more("smoke", smoke_image(WIDTH, HEIGHT));
    more(
        "dark smoke",
        image(WIDTH, HEIGHT, |x, y| {
            smoke(WIDTH, HEIGHT, x as f64, y as f64).map(|c| code(0.1 * c))
        }),
    );
    more(
        "grey gradient",
        image(WIDTH, HEIGHT, |x, _| [(x * 254 / (WIDTH - 1)) as u8; 3]),
    );
    more(
        "dark gradient",
        image(WIDTH, HEIGHT, |x, _| [(x / 10) as u8; 3]),
    );
    more(
        "colour gradient",
        image(WIDTH, HEIGHT, |x, y| {
            [
                (x * 254 / (WIDTH - 1)) as u8,
                (y * 254 / (HEIGHT - 1)) as u8,
                100,
            ]
        }),
    );
    more(
        "random",
        image(WIDTH, HEIGHT, |x, y| random_pixel(11, y * WIDTH + x)),
    );
    images
}

/// Every code of the image one too high in the channels chosen.
fn raised(of: &SrgbImage, channels: [i32; 3]) -> SrgbImage {
    changed(of, |_, pixel| {
        let mut channel = 0;
        pixel.map(|c| {
            channel += 1;
            shifted_code(c, channels[channel - 1])
        })
    })
}

/// Every code one too high or too low, at random.
fn one_off(of: &SrgbImage) -> SrgbImage {
    changed(of, |i, pixel| {
        let bits = random(12, i);
        let mut channel = 0;
        pixel.map(|c| {
            channel += 1;
            shifted_code(c, if bits >> channel & 1 == 1 { 1 } else { -1 })
        })
    })
}

#[test]
fn an_eight_bit_writer_with_another_rounding() {
    let mut largest = [(0.0_f64, 0.0_f64); 4];
    let kinds = [
        "±1 at random",
        "0, ±1 at random",
        "+1 everywhere",
        "+1 in one channel",
    ];
    for (name, reference) in images() {
        let one_channel = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
            .map(|channels| measure(&reference, &raised(&reference, channels)))
            .into_iter()
            .fold((0.0_f64, 0.0_f64), |a, b| (a.0.max(b.0), a.1.max(b.1)));
        let measured = [
            measure(&reference, &one_off(&reference)),
            measure(&reference, &with_noise(&reference, 1, 13)),
            measure(&reference, &raised(&reference, [1; 3])),
            one_channel,
        ];
        for (kind, ((mean, high), all)) in kinds.iter().zip(measured.iter().zip(&mut largest)) {
            println!("{name:16} {kind:18} mean {mean:.4} weighted p99 {high:.4}");
            *all = (all.0.max(*mean), all.1.max(*high));
        }
    }
    for (kind, (mean, high)) in kinds.iter().zip(largest) {
        assert!(mean < ROUNDING_MEAN && high < ROUNDING_HIGH, "{kind}");
        println!("LARGEST          {kind:18} mean {mean:.4} weighted p99 {high:.4}");
    }
}
