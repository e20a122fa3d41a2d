//! Generated image pairs, the same on every platform: whole numbers and IEEE arithmetic only.

use volref::compare::flip::SrgbImage;
use volref::math::{exp, sin};

pub struct Pair {
    pub name: &'static str,
    pub reference: SrgbImage,
    pub test: SrgbImage,
}

/// An image from the code of each column and row.
pub fn image(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [u8; 3]) -> SrgbImage {
    let pixels = (0..width * height)
        .map(|i| pixel(i % width, i / width))
        .collect();
    SrgbImage::new(width, height, pixels).expect("as many pixels as the size says")
}

pub fn constant(width: usize, height: usize, pixel: [u8; 3]) -> SrgbImage {
    image(width, height, |_, _| pixel)
}

/// The same image with every pixel changed.
pub fn changed(of: &SrgbImage, change: impl Fn(usize, [u8; 3]) -> [u8; 3]) -> SrgbImage {
    let pixels = of
        .pixels()
        .iter()
        .enumerate()
        .map(|(i, &p)| change(i, p))
        .collect();
    SrgbImage::new(of.width(), of.height(), pixels).expect("the size is unchanged")
}

/// Number `index` of a stream of equidistributed 64-bit numbers.
/// Source: splitmix64, Steele, Lea, Flood, OOPSLA 2014.
pub fn random(seed: u64, index: usize) -> u64 {
    let mut z = seed
        .wrapping_add(index as u64 + 1)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

pub fn random_pixel(seed: u64, index: usize) -> [u8; 3] {
    let bits = random(seed, index).to_le_bytes();
    [bits[0], bits[1], bits[2]]
}

/// Adds to every channel a whole number equidistributed in ±`amplitude`, kept to 0 to 255.
pub fn with_noise(of: &SrgbImage, amplitude: i32, seed: u64) -> SrgbImage {
    changed(of, |i, pixel| {
        let mut channel = 0;
        pixel.map(|code| {
            channel += 1;
            let span = 2 * amplitude as u64 + 1;
            let offset = (random(seed, 3 * i + channel - 1) % span) as i32 - amplitude;
            shifted_code(code, offset)
        })
    })
}

pub fn shifted_code(code: u8, offset: i32) -> u8 {
    (i32::from(code) + offset).clamp(0, 255) as u8
}

/// The 8-bit code of an encoded value in [0, 1].
pub fn code(encoded: f64) -> u8 {
    (encoded.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8
}

/// Smoke-like: a few soft blobs of grey with a tint, modulated by slow waves, on black.
/// Encoded values; `x` and `y` in pixels, real so that the image can be moved by half a pixel.
pub fn smoke(width: usize, height: usize, x: f64, y: f64) -> [f64; 3] {
    let (u, v) = (x / width as f64, y / height as f64);
    let mut density = 0.0;
    for (cu, cv, radius, strength) in [
        (0.45, 0.40, 0.22, 0.8),
        (0.60, 0.60, 0.15, 0.6),
        (0.30, 0.65, 0.12, 0.4),
        (0.70, 0.28, 0.10, 0.3),
    ] {
        let r2 = ((u - cu) * (u - cu) + (v - cv) * (v - cv)) / (radius * radius);
        density += strength * exp(-r2);
    }
    let waves = 1.0 + 0.25 * sin(23.0 * u + 9.0 * v) * sin(17.0 * v - 5.0 * u);
    let light = 0.85 * (1.0 - exp(-1.5 * density * waves));
    [light, 0.95 * light, 0.85 * light]
}

pub fn smoke_image(width: usize, height: usize) -> SrgbImage {
    image(width, height, |x, y| {
        smoke(width, height, x as f64, y as f64).map(code)
    })
}

/// At least one pair for every way in which images differ that FLIP treats differently.
pub fn varied() -> Vec<Pair> {
    let mut pairs = Vec::new();
    let mut pair = |name, reference, test| {
        pairs.push(Pair {
            name,
            reference,
            test,
        });
    };
    let mid = |x: usize, y: usize| [(40 + x) as u8, (60 + 2 * y) as u8, (200 - x - y) as u8];

    let gradient = image(96, 64, |x, _| [(x * 255 / 95) as u8; 3]);
    pair(
        "gradient, brighter",
        gradient.clone(),
        changed(&gradient, |_, p| p.map(|c| shifted_code(c, 9))),
    );
    let coloured = image(80, 48, |x, y| {
        [(3 * x) as u8, (5 * y) as u8, (255 - 2 * x) as u8]
    });
    pair(
        "colour gradient, mirrored",
        coloured.clone(),
        image(80, 48, |x, y| coloured.pixels()[y * 80 + 79 - x]),
    );
    let dark = image(64, 64, |x, y| {
        [(x / 8) as u8, (y / 8) as u8, ((x + y) / 16) as u8]
    });
    pair(
        "dark gradient, noise 1",
        dark.clone(),
        with_noise(&dark, 1, 1),
    );
    let soft = image(64, 64, mid);
    pair("noise 4", soft.clone(), with_noise(&soft, 4, 3));
    pair(
        "unrelated noise",
        image(61, 47, |x, y| random_pixel(5, y * 61 + x)),
        image(61, 47, |x, y| random_pixel(6, y * 61 + x)),
    );
    let edges = |shift: usize| {
        image(96, 64, move |x, y| {
            let inside = (20 + shift..50 + shift).contains(&x) && (16..48).contains(&y);
            if inside { [220; 3] } else { [30; 3] }
        })
    };
    pair("shifted edges", edges(0), edges(3));
    let lines = |width: usize| {
        image(73, 59, move |x, y| {
            let ink = (x % 7 < width && y % 12 < 9) || (y % 12 == 4 && x % 14 < 9);
            if ink { [15, 15, 20] } else { [245, 240, 235] }
        })
    };
    pair("thin lines", lines(1), lines(2));
    let checker = |size: usize, phase: usize| {
        image(64, 64, move |x, y| {
            [if (x / size + y / size + phase).is_multiple_of(2) {
                255
            } else {
                0
            }; 3]
        })
    };
    pair("checkerboard 1, inverted", checker(1, 0), checker(1, 1));
    let blob = |sharpness: f64| {
        image(64, 64, move |x, y| {
            let (dx, dy) = (x as f64 - 31.5, y as f64 - 30.0);
            let light = exp(-(dx * dx + dy * dy) * sharpness);
            [light, 0.6 * light, 0.2 * light].map(code)
        })
    };
    pair("blurred blob", blob(0.01), blob(0.006));
    let bars = [
        [255, 0, 0],
        [0, 255, 0],
        [0, 0, 255],
        [255, 255, 0],
        [0, 255, 255],
        [255, 0, 255],
    ];
    pair(
        "saturated bars",
        image(90, 40, move |x, _| bars[x / 15]),
        image(90, 40, move |x, _| bars[(x / 15 + 1) % 6]),
    );
    pair(
        "blue and green",
        constant(24, 24, [0, 0, 255]),
        constant(24, 24, [0, 255, 0]),
    );
    let hot = image(41, 41, |x, y| {
        if (x, y) == (20, 20) {
            [255; 3]
        } else {
            [50; 3]
        }
    });
    pair("one hot pixel", constant(41, 41, [50; 3]), hot);
    let smoke = smoke_image(120, 90);
    pair("smoke, noise 2", smoke.clone(), with_noise(&smoke, 2, 7));
    pair(
        "3×5",
        image(3, 5, |x, y| random_pixel(8, 3 * y + x)),
        image(3, 5, |x, y| random_pixel(9, 3 * y + x)),
    );
    pair(
        "1×1",
        constant(1, 1, [90, 20, 200]),
        constant(1, 1, [100, 30, 150]),
    );
    pair(
        "1×33",
        image(1, 33, |_, y| [(7 * y) as u8; 3]),
        image(1, 33, |_, y| [(255 - 7 * y) as u8; 3]),
    );
    pairs
}
