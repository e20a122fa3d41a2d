//! Every gate against the images it must reject and the noise it must accept, and the image
//! readers against files that are unusual, broken or hostile.

use exr::prelude::*;
use volref::compare::flip::SrgbImage;
use volref::compare::{Conditions, GATES, Gate, Judgement, Picture, judge, metric_meaning};
use volref::film::Film;
use volref::math::srgb_to_linear;

const SIZE: usize = 96;

/// A soft coloured ball on black: bright and dark pixels, different left and right, top and
/// bottom, red and blue.
fn ball() -> Vec<[f32; 3]> {
    let pixel = |index: usize| {
        let (x, y) = ((index % SIZE) as f32, (index / SIZE) as f32);
        let (dx, dy) = ((x - 24.0) / 20.0, (y - 36.0) / 18.0);
        let light = (1.0 - dx * dx - dy * dy).max(0.0);
        [0.9 * light, 0.5 * light * light, 0.2 * light * y / 64.0]
    };
    (0..SIZE * SIZE).map(pixel).collect()
}

fn edited(edit: impl Fn(usize, [f32; 3]) -> [f32; 3]) -> Vec<[f32; 3]> {
    let pixels = ball();
    (0..pixels.len())
        .map(|index| edit(index, pixels[index]))
        .collect()
}

fn film(pixels: Vec<[f32; 3]>) -> Film {
    Film::new(SIZE, SIZE, pixels)
}

fn judged(gate: Gate, test: Vec<[f32; 3]>) -> Judgement {
    let (reference, test) = (
        Picture::Radiance(film(ball())),
        Picture::Radiance(film(test)),
    );
    let judgement = judge(gate, &reference, &test, &Conditions::default()).unwrap();
    for name in judgement.metrics.keys() {
        assert!(metric_meaning(name).is_some(), "{name} has no meaning");
    }
    judgement
}

/// The nearest half-float, as an EXR file may hold.
fn half(value: f32) -> f32 {
    f16::from_f32(value).to_f32()
}

/// ±1, by a hash of the place: noise without a pattern.
fn sign(index: usize) -> f32 {
    let mixed = (index as u32)
        .wrapping_mul(0x9e37_79b9)
        .rotate_left(13)
        .wrapping_mul(0x85eb_ca6b);
    if mixed >> 31 == 0 { 1.0 } else { -1.0 }
}

/// What was done to the image, the gates meant, and the result.
type FaultRow = (&'static str, &'static [Gate], Vec<[f32; 3]>);

#[test]
fn what_every_gate_must_reject() {
    let mirrored = |i: usize| ball()[i / SIZE * SIZE + (SIZE - 1 - i % SIZE)];
    let all: &[Gate] = &[Gate::Exact, Gate::Deterministic, Gate::Perceptual];
    let radiance: &[Gate] = &[Gate::Exact, Gate::Deterministic];
    let table: &[FaultRow] = &[
        (
            "red and blue swapped",
            all,
            edited(|_, [r, g, b]| [b, g, r]),
        ),
        ("mirrored", all, edited(|i, _| mirrored(i))),
        (
            "upside down",
            all,
            edited(|i, _| ball()[(SIZE - 1 - i / SIZE) * SIZE + i % SIZE]),
        ),
        (
            "gamma encoded",
            all,
            edited(|_, pixel| pixel.map(f32::sqrt)),
        ),
        (
            "half as bright",
            all,
            edited(|_, pixel| pixel.map(|value| 0.5 * value)),
        ),
        (
            "shifted by a pixel",
            all,
            edited(|i, _| ball()[i.saturating_sub(1)]),
        ),
        ("black", all, edited(|_, _| [0.0; 3])),
        // Too faint or too small for an 8-bit image, and plain in a linear one.
        (
            "one hot pixel",
            radiance,
            edited(|i, [r, g, b]| [r, if i == 900 { 4.0 } else { g }, b]),
        ),
        (
            "a faint bias",
            radiance,
            edited(|_, pixel| pixel.map(|value| value + 4e-4)),
        ),
        (
            "a faint bias of one channel",
            radiance,
            edited(|_, [r, g, b]| [r, g, b * 1.008 + 2e-4]),
        ),
        (
            "0.1 % of the pixels off by twice the tolerance",
            radiance,
            edited(|i, pixel| {
                let off = if i % 1000 == 7 { sign(i) } else { 0.0 };
                pixel.map(|value| value + off * (2e-3 + 0.02 * value))
            }),
        ),
        (
            "one value off by its last bit",
            &[Gate::Exact],
            edited(|i, pixel| {
                if i == 36 * SIZE + 24 {
                    pixel.map(f32::next_up)
                } else {
                    pixel
                }
            }),
        ),
    ];
    for (fault, gates, test) in table {
        for gate in *gates {
            let judgement = judged(*gate, test.clone());
            assert!(
                !judgement.passed,
                "{gate:?} accepts: {fault}. {}",
                judgement.reason
            );
            assert!(
                judgement.metrics.values().all(|value| value.is_finite()),
                "{fault}"
            );
        }
    }
}

/// A slope of grey too dark for the cap on single pixels: one that was lost, by itself or at an edge.
#[test]
fn noise_that_gates_must_accept() {
    let code = |i: usize, value: f32| {
        let codes = Film::new(1, 1, vec![[value; 3]]).srgb_codes(0.0)[0][0];
        let noisy = (f32::from(codes) + sign(i)).clamp(0.0, 255.0) / 255.0;
        srgb_to_linear(f64::from(noisy)) as f32
    };
    let both: &[Gate] = &[Gate::Deterministic, Gate::Perceptual];
    let table: &[FaultRow] = &[
        (
            "nothing",
            &[Gate::Exact, Gate::Deterministic, Gate::Perceptual],
            ball(),
        ),
        (
            "rounding",
            both,
            edited(|i, pixel| pixel.map(|value| value * (1.0 + sign(i) * f32::EPSILON))),
        ),
        ("half floats", both, edited(|_, pixel| pixel.map(half))),
        (
            "half the tolerance, both ways",
            both,
            // Not on black: clipped at zero, noise has one way only, and is a bias.
            edited(|i, pixel| {
                pixel.map(|value| {
                    if value > 0.01 {
                        value + 0.5 * sign(i) * (1e-3 + 0.01 * value)
                    } else {
                        value
                    }
                })
            }),
        ),
        (
            "one pixel just outside",
            both,
            edited(|i, pixel| {
                pixel.map(|value| value + if i == 2000 { 2e-3 + 0.02 * value } else { 0.0 })
            }),
        ),
        (
            "one code more or less",
            &[Gate::Perceptual],
            edited(|i, pixel| pixel.map(|v| code(i, v))),
        ),
    ];
    for (noise, gates, test) in table {
        for gate in *gates {
            let judgement = judged(*gate, test.clone());
            assert!(
                judgement.passed,
                "{gate:?} rejects: {noise}. {}",
                judgement.reason
            );
        }
    }
}

/// Looked for before any gate, because no difference to NaN is above a limit.
#[test]
fn sizes_and_what_is_not_finite() {
    for gate in GATES {
        let right = Picture::Radiance(film(ball()));
        for (width, height) in [(SIZE, SIZE - 1), (SIZE / 2, 2 * SIZE), (1, 1)] {
            let other = Picture::Radiance(Film::new(width, height, vec![[0.5; 3]; width * height]));
            for (a, b) in [(&right, &other), (&other, &right)] {
                let judgement = judge(gate, a, b, &Conditions::default()).unwrap();
                assert!(
                    !judgement.passed && judgement.reason.contains("size differs"),
                    "{gate:?}"
                );
            }
        }
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let broken = edited(|i, [r, g, b]| [r, g, if i == SIZE + 6 { value } else { b }]);
            let broken = Picture::Radiance(film(broken));
            for (reference, test, whose) in [
                (&right, &broken, "the test image"),
                (&broken, &right, "the reference"),
                // Equal in every bit, and still no image.
                (&broken, &broken, "the reference"),
            ] {
                let judgement = judge(gate, reference, test, &Conditions::default()).unwrap();
                assert!(!judgement.passed, "{gate:?} accepts {value} in {whose}");
                let said = &judgement.reason;
                assert!(said.contains(whose) && said.contains("(6, 1)"), "{said}");
                assert_eq!(judgement.metrics["non_finite_pixels"], 1.0);
            }
        }
    }
}

/// Enough places to see a pattern, and not a page of them.
#[test]
fn places_of_what_is_not_finite() {
    for (broken, places) in [
        (2, "(1, 0), (4, 0); the first"),
        (8, "(16, 0), (19, 0), (22, 0); the first"),
        (9, "(16, 0), (19, 0), (22, 0); the first"),
    ] {
        let pixels = edited(|i, pixel| {
            if i % 3 == 1 && i / 3 < broken {
                [f32::NAN; 3]
            } else {
                pixel
            }
        });
        let judgement = judged(Gate::Deterministic, pixels);
        let said = &judgement.reason;
        assert!(
            said.contains(&format!("{broken} of 9216 pixels of the test image")),
            "{said}"
        );
        assert!(said.contains(places), "{said}");
        assert_eq!(judgement.metrics["non_finite_pixels"], broken as f64);
    }
}

#[test]
fn codes_are_judged_by_how_they_look_only() {
    let codes = film(ball()).srgb_codes(0.0);
    let codes = Picture::Codes(SrgbImage::new(SIZE, SIZE, codes).unwrap());
    let radiance = Picture::Radiance(film(ball()));
    for (a, b) in [(&codes, &codes), (&codes, &radiance), (&radiance, &codes)] {
        assert!(
            judge(Gate::Perceptual, a, b, &Conditions::default())
                .unwrap()
                .passed
        );
        let of_radiance: [Gate; 2] = [Gate::Exact, Gate::Deterministic];
        for gate in of_radiance {
            assert!(judge(gate, a, b, &Conditions::default()).is_err());
        }
    }
}

/// The first place of `needle` in `bytes`.
fn find(bytes: &[u8], needle: &[u8]) -> usize {
    bytes
        .windows(needle.len())
        .position(|window| window == needle)
        .unwrap()
}

/// `bytes` with the data and display windows of the header set to `width` × `height`.
fn claiming(bytes: &[u8], width: u32, height: u32) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for attribute in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        // The attribute's name and type, its length, then x and y of the least corner.
        let at = find(&bytes, attribute) + attribute.len() + 4 + 8;
        bytes[at..at + 4].copy_from_slice(&(width - 1).to_le_bytes());
        bytes[at + 4..at + 8].copy_from_slice(&(height - 1).to_le_bytes());
    }
    bytes
}

/// A few hundred bytes that claim to be more than any memory holds: refused by the header,
/// before anything is allocated.
#[test]
fn exr_bombs() {
    let small = Film::new(4, 2, vec![[0.5; 3]; 8]).to_exr().unwrap();
    {
        for (width, height) in [
            (1 << 31, 1 << 31),
            (1 << 30, 1 << 30),
            (1 << 31, 2),
            (16384, 16384),
            (1 << 28, 1),
            (1, 1 << 28),
        ] {
            let bomb = claiming(&small, width, height);
            let error = Film::from_exr(&bomb).unwrap_err();
            if u64::from(width) * u64::from(height) <= Film::MOST_PIXELS as u64 {
                assert!(
                    error.to_string().contains("cannot hold"),
                    "{width} × {height}: {error}"
                );
            }
        }
    }
}

/// The CRC of PNG chunks.
fn crc(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                0xedb8_8320 ^ (crc >> 1)
            } else {
                crc >> 1
            };
        }
    }
    !crc
}

fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let typed = [&kind[..], data].concat();
    let length = (data.len() as u32).to_be_bytes();
    [&length[..], &typed, &crc(&typed).to_be_bytes()].concat()
}

#[test]
fn png_bombs() {
    let header = |width: u32, height: u32, kind: &[u8]| {
        let header = [&width.to_be_bytes()[..], &height.to_be_bytes(), kind].concat();
        let data = chunk(b"IDAT", &[0x78, 0x01, 3, 0, 0, 0, 0, 1]);
        [
            &b"\x89PNG\r\n\x1a\n"[..],
            &chunk(b"IHDR", &header),
            &data,
            &chunk(b"IEND", &[]),
        ]
        .concat()
    };
    for kind in [[8, 2, 0, 0, 0], [16, 6, 0, 0, 0], [1, 0, 0, 0, 1]] {
        for (width, height) in [
            (i32::MAX as u32, i32::MAX as u32),
            (16384, 16384),
            (0, 5),
            (5, 0),
        ] {
            let error = Film::codes_from_png(&header(width, height, &kind)).unwrap_err();
            if width == 16384 {
                assert!(error.to_string().contains("cannot hold"), "{error}");
            }
        }
    }
}
