//! Images with noise: what is kept, what is written, what is read back.

use exr::prelude::*;
use std::io::Cursor;
use volref::film::Film;

const WIDTH: usize = 5;
const HEIGHT: usize = 4;

/// Means and variances without a pattern.
fn noisy(samples: u32) -> Film {
    let value = |i: usize, c: usize| (1 + (i * 7 + c * 3) % 11) as f32 / 13.0;
    let pixels = |scale: f32| -> Vec<[f32; 3]> {
        let pixel = |i| [0, 1, 2].map(|c| scale * value(i, c));
        (0..WIDTH * HEIGHT).map(pixel).collect()
    };
    Film::with_noise(WIDTH, HEIGHT, pixels(1.0), pixels(1e-3), samples)
}

#[test]
fn a_film_with_noise_survives_exr() {
    // Above 2²⁴ a 32-bit float no longer tells neighbours apart.
    for samples in [2, 4096, (1 << 24) + 1, u32::MAX] {
        let film = noisy(samples);
        let read = Film::from_exr(&film.to_exr().unwrap()).unwrap();
        assert_eq!(read, film);
        assert_eq!(read.pixel_hash(), film.pixel_hash());
        assert_eq!(read.noise().unwrap().samples(), samples);
    }
}

#[test]
fn the_hash_covers_the_noise() {
    let film = noisy(16);
    let silent = Film::new(WIDTH, HEIGHT, film.radiance().to_vec());
    let mut variance = film.noise().unwrap().variance().to_vec();
    variance[3][1] *= 2.0;
    let louder = Film::with_noise(WIDTH, HEIGHT, film.radiance().to_vec(), variance, 16);
    let hashes = [&film, &silent, &louder, &noisy(17)].map(Film::pixel_hash);
    for (i, hash) in hashes.iter().enumerate() {
        assert!(!hashes[..i].contains(hash), "{i}");
    }
}

/// The goldens of images without noise carry this hash; it must never change.
#[test]
fn the_hash_of_a_film_without_noise_stays() {
    let film = Film::with_opacity(2, 1, vec![[0.25, 0.5, 1.0, 1.0], [0.0, 2.0, 0.125, 0.5]]);
    let mut bytes = Vec::new();
    for number in [2_u64, 1, 4] {
        bytes.extend(number.to_le_bytes());
    }
    for value in [0.25_f32, 0.5, 1.0, 0.0, 2.0, 0.125, 1.0, 0.5] {
        bytes.extend(value.to_le_bytes());
    }
    assert_eq!(film.pixel_hash(), blake3::hash(&bytes).to_hex().to_string());
}

#[test]
fn panels_keep_their_noise_where_all_have_it() {
    let both = Film::side_by_side(&[noisy(16), noisy(16)]);
    let noise = both.noise().unwrap();
    assert_eq!((noise.samples(), both.width()), (16, 2 * WIDTH));
    let part = noisy(16);
    for row in 0..HEIGHT {
        for column in 0..2 * WIDTH {
            let expected = part.noise().unwrap().variance()[row * WIDTH + column % WIDTH];
            assert_eq!(noise.variance()[row * 2 * WIDTH + column], expected);
        }
    }
    let silent = Film::new(WIDTH, HEIGHT, noisy(16).radiance().to_vec());
    for other in [noisy(17), silent] {
        for pair in [[noisy(16), other.clone()], [other, noisy(16)]] {
            assert_eq!(Film::side_by_side(&pair).noise(), None);
        }
    }
}

type NamedLayers = Vec<(Option<&'static str>, Vec<(&'static str, f32)>)>;

/// An EXR file of 2 × 2 pixels of these constant channels, one part for each name.
fn exr(layers: NamedLayers) -> Vec<u8> {
    let layers: Vec<_> = layers
        .into_iter()
        .map(|(name, channels)| {
            let channel = |(name, value)| AnyChannel::new(name, FlatSamples::F32(vec![value; 4]));
            let attributes = LayerAttributes {
                layer_name: name.map(Text::from),
                ..Default::default()
            };
            let channels = AnyChannels::sort(channels.into_iter().map(channel).collect());
            Layer::new((2, 2), attributes, Encoding::UNCOMPRESSED, channels)
        })
        .collect();
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions((2, 2)));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layers(attributes, layers)
        .write()
        .to_buffered(&mut bytes)
        .unwrap();
    bytes.into_inner()
}

fn colours() -> Vec<(&'static str, f32)> {
    vec![("R", 0.5), ("G", 0.25), ("B", 0.125)]
}

#[test]
fn noise_that_says_too_little() {
    let with = |more: &[(&'static str, f32)]| {
        let mut channels = colours();
        channels.extend(more);
        Film::from_exr(&exr(vec![(None, channels)]))
    };
    let variance = [
        ("variance.R", 0.3),
        ("variance.G", 0.2),
        ("variance.B", 0.1),
    ];
    let is_refused = |channels: &[_]| {
        let said = with(channels).unwrap_err().to_string();
        said.starts_with("the noise of the image cannot be read")
    };
    assert!(is_refused(&variance[..2]));
    assert!(is_refused(&variance));
    for count in [0.0, 1.0, 2.5, -4.0, 1e30, f32::NAN, f32::INFINITY] {
        let mut channels = variance.to_vec();
        channels.push(("samples.Y", count));
        assert!(is_refused(&channels), "{count}");
    }
    // Another quantity, of other renderers.
    assert_eq!(
        with(&[("Variance.R", 0.1), ("samples.Y", 4.0)])
            .unwrap()
            .noise(),
        None
    );
}

/// How many samples an image has is known without their variance, too: by its own word, else by
/// that of who asked for it.
#[test]
fn samples_without_a_variance() {
    let silent = Film::new(WIDTH, HEIGHT, noisy(16).radiance().to_vec());
    let colours = ["R", "G", "B"].map(|name| {
        let values = vec![0.5; WIDTH * HEIGHT];
        AnyChannel::new(name, FlatSamples::F32(values))
    });
    let samples = |count: u32| {
        let counts = FlatSamples::U32(vec![count; WIDTH * HEIGHT]);
        let channels = colours.iter().cloned();
        let channels = channels.chain([AnyChannel::new("samples.Y", counts)]);
        let channels = AnyChannels::sort(channels.collect());
        let mut bytes = Cursor::new(Vec::new());
        Image::from_channels((WIDTH, HEIGHT), channels)
            .write()
            .to_buffered(&mut bytes)
            .unwrap();
        Film::from_exr(bytes.get_ref()).unwrap()
    };
    assert_eq!(samples(48).samples(), Some(48));
    assert!(samples(48).noise().is_none());
    assert_eq!(noisy(16).samples(), Some(16));
    assert_eq!(silent.samples(), None);
    assert_eq!(silent.clone().with_samples(8).samples(), Some(8));
    assert_eq!(samples(48).with_samples(8).samples(), Some(48));

    let other = Film::new(WIDTH, HEIGHT, vec![[0.25; 3]; WIDTH * HEIGHT]);
    let both = Film::from_replicates(&[silent, other]).unwrap();
    assert_eq!((both.samples(), both.renderings()), (None, Some(2)));
    assert_eq!(both.with_samples(8).samples(), Some(16));
}
