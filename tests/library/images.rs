//! Images of other programs: what is read from them, and what is refused and why.

use crate::common;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use volref::compare::{Conditions, Gate, Picture, judge};
use volref::film::{Film, FilmError, FilmFormat};
use volref::suite::{Found, Outputs};

/// A small picture of our own, in many files: see `scripts/generate-images.py`.
fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures/images")
        .join(name)
}

const WIDTH: usize = 8;
const HEIGHT: usize = 6;

/// The picture of the fixtures.
fn colour(index: usize) -> [f32; 3] {
    [0, 1, 2].map(|c| (index + 64 * c) as f32)
}

fn colours() -> Vec<[f32; 3]> {
    (0..WIDTH * HEIGHT).map(colour).collect()
}

fn film(name: &str) -> Film {
    match Picture::read(&fixture(name)) {
        Ok(Picture::Radiance(film)) => film,
        other => panic!("{name}: {other:?}"),
    }
}

/// What is said of a file, without its path.
fn refusal(name: &str) -> String {
    let path = fixture(name);
    let message = match Picture::read(&path) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{name} is accepted"),
    };
    let said = message.strip_prefix(&format!("{}: ", path.display()));
    said.unwrap_or_else(|| panic!("{message} does not begin with the path"))
        .to_owned()
}

#[test]
fn every_way_to_write_radiance_is_read() {
    for name in [
        "half.exr",
        "float.exr",
        "uint.exr",
        "no.exr",
        "rle.exr",
        "zips.exr",
        "zip.exr",
        "piz.exr",
        "pxr24.exr",
        "b44.exr",
        "b44a.exr",
        "aovs.exr",
        "layer.exr",
        "small-letters.exr",
        "combined.exr",
        "parts.exr",
        "tiled.exr",
        "mips.exr",
        "rips.exr",
        "overscan.exr",
        "little-f2.npy",
        "little-f4.npy",
        "little-f8.npy",
        "big-f2.npy",
        "big-f4.npy",
        "big-f8.npy",
        "fortran.npy",
        "version-2.npy",
        "version-3.npy",
        "opacity.npy",
        "little.pfm",
        "big.pfm",
        "scaled.pfm",
    ] {
        let film = film(name);
        assert_eq!((film.width(), film.height()), (WIDTH, HEIGHT), "{name}");
        assert_eq!(film.radiance(), colours(), "{name}");
        assert_eq!(film.noise(), None, "{name}");
        let opacity = (name == "opacity.npy").then_some(&[0.5; WIDTH * HEIGHT][..]);
        assert_eq!(film.opacity(), opacity, "{name}");
    }
}

#[test]
fn grey_becomes_three_equal_channels() {
    let grey: Vec<_> = (0..WIDTH * HEIGHT).map(|i| [i as f32; 3]).collect();
    for name in ["grey.exr", "grey.npy", "grey-axis.npy", "grey.pfm"] {
        assert_eq!(film(name).radiance(), grey, "{name}");
    }
}

/// Two columns and a row of the data lie outside and are cut off; as many pixels of the picture
/// have no data and are black.
#[test]
fn the_picture_is_the_display_window() {
    let film = film("shifted.exr");
    assert_eq!((film.width(), film.height()), (WIDTH, HEIGHT));
    for (index, pixel) in film.radiance().iter().enumerate() {
        let is_covered = index % WIDTH < WIDTH - 2 && index / WIDTH < HEIGHT - 1;
        let expected = if is_covered { colour(index) } else { [0.0; 3] };
        assert_eq!(*pixel, expected, "{index}");
    }
}

#[test]
fn every_way_to_write_codes_is_read() {
    let codes: Vec<[u8; 3]> = colours()
        .iter()
        .map(|c| c.map(|value| value as u8))
        .collect();
    let grey: Vec<[u8; 3]> = (0..WIDTH * HEIGHT).map(|i| [i as u8; 3]).collect();
    for (name, expected) in [
        ("rgb-8.png", &codes),
        ("rgb-16.png", &codes),
        ("grey-8.png", &grey),
        ("grey-16.png", &grey),
        ("opaque.png", &codes),
        ("interlaced.png", &codes),
        ("palette.png", &codes),
        ("gamma.png", &codes),
        ("srgb.png", &codes),
        ("profile.png", &codes),
    ] {
        let bytes = std::fs::read(fixture(name)).unwrap();
        let read = Film::codes_from_png(&bytes);
        assert_eq!(read, Ok((WIDTH, HEIGHT, expected.clone())), "{name}");
        let picture = Picture::read(&fixture(name)).unwrap();
        assert_eq!(picture.srgb(0.0).unwrap().pixels(), expected, "{name}");
    }
}

#[test]
fn what_cannot_be_used_is_refused_in_words() {
    let entries = std::fs::read_dir(fixture("")).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.starts_with("bad-")).collect();
    names.sort();
    let said = names
        .iter()
        .map(|name| format!("{name}: {}\n", refusal(name)));
    let said: String = said.collect();
    insta::assert_snapshot!(said, @r#"
    bad-alpha.png: the pixel (3, 1) is transparent; composite the image over the background of the scene in linear light, before it is encoded as sRGB (codes that are mixed or premultiplied are other colours), or write linear, premultiplied radiance as .exr
    bad-animated.png: this PNG is animated; write a single image
    bad-chroma.exr: this EXR has a channel with fewer values than pixels; write R, G and B in full
    bad-complex.npy: an array of dtype "<c8"; radiance and depths are floating-point numbers: save linear radiance before it is rounded and gamma encoded, with image.astype(np.float32), or 8-bit sRGB in .png
    bad-crc.png: not a readable PNG image: it is broken (Format error decoding Png: CRC error: expected 0x9724fbc9 have 0xcf6a00d4 while decoding ChunkType { type: IDAT, critical: true, private: false, reserved: false, safecopy: false } chunk.): copy it or write it again
    bad-deep.exr: this EXR has deep data, many samples along each ray; write a flat image, one radiance a pixel
    bad-dwaa.exr: this EXR is compressed by DWA or B44, which lose digits; render it again and write it with ZIP or PIZ: recompressing the file does not bring the digits back
    bad-dwab.exr: this EXR is compressed by DWA or B44, which lose digits; render it again and write it with ZIP or PIZ: recompressing the file does not bring the digits back
    bad-elsewhere.exr: the data of this EXR cover 0 of the 8 × 6 pixels of its display window; make both windows equal
    bad-full-chroma.exr: this EXR holds luminance and chroma (Y, RY, BY); write R, G and B
    bad-gamma.png: the codes of this PNG are not sRGB: its gAMA says 1; encode them as sRGB and state nothing else, or write linear radiance as .exr
    bad-grey-alpha.png: the pixel (3, 1) is transparent; composite the image over the background of the scene in linear light, before it is encoded as sRGB (codes that are mixed or premultiplied are other colours), or write linear, premultiplied radiance as .exr
    bad-huge.exr: the image claims 1000000000 × 1000000000 pixels; from 1 to 268435456 are read
    bad-int64.npy: an array of dtype "<i8"; radiance and depths are floating-point numbers: save linear radiance before it is rounded and gamma encoded, with image.astype(np.float32), or 8-bit sRGB in .png
    bad-levels-swapped.exr: not a readable EXR image: it is broken (the decoder stopped: assertion `left == right` failed: line should have been filtered): write it again
    bad-line.npy: an array of shape (12,); an image has the shape (height, width, 3), (height, width, 4) with opacity, or (height, width) if it is grey
    bad-linear-profile.png: the codes of this PNG are not sRGB: they have a colour profile of their own; encode them as sRGB and state nothing else, or write linear radiance as .exr
    bad-lines-missing.exr: not a readable EXR image: of its 3 blocks of pixels, 1 are missing
    bad-objects.npy: an array of dtype "|O"; radiance and depths are floating-point numbers: save linear radiance before it is rounded and gamma encoded, with image.astype(np.float32), or 8-bit sRGB in .png
    bad-palette-alpha.png: the pixel (1, 0) is transparent; composite the image over the background of the scene in linear light, before it is encoded as sRGB (codes that are mixed or premultiplied are other colours), or write linear, premultiplied radiance as .exr
    bad-palette-length.png: not a readable PNG image: it is broken (the decoder stopped: range end index 3 out of range for slice of length 2): write it again
    bad-planes.npy: an array of shape (3, 6, 8); an image has the shape (height, width, 3), (height, width, 4) with opacity, or (height, width) if it is grey
    bad-profile.png: the codes of this PNG are not sRGB: they have a colour profile of their own; encode them as sRGB and state nothing else, or write linear radiance as .exr
    bad-records.npy: not a readable NPY image: it is an array of records; save one of its fields as an array of np.float32
    bad-stack.npy: an array of shape (1, 6, 8, 3); an image has the shape (height, width, 3), (height, width, 4) with opacity, or (height, width) if it is grey
    bad-tile-missing.exr: not a readable EXR image: of its 6 blocks of pixels, 1 are missing
    bad-two-layers.exr: several layers have colours, and none is the main one: albedo, direct; write one of them without a name, or call it rgba, beauty or combined
    bad-uint8.npy: an array of dtype "|u1"; radiance and depths are floating-point numbers: save linear radiance before it is rounded and gamma encoded, with image.astype(np.float32), or 8-bit sRGB in .png
    bad-wide.png: the codes of this PNG are not sRGB: its cICP says 9 and 16; encode them as sRGB and state nothing else, or write linear radiance as .exr
    "#);
}

/// The corpus that fuzzing begins with: kinds that renderers seldom write, each of which is read.
/// See `scripts/generate-corpus.py`.
#[test]
fn images_that_are_seldom_written_are_read() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let radiance: Vec<[f32; 3]> = (0..3)
        .flat_map(|y| (0..5).map(move |x| [0, 1, 2].map(|c| (x + 8 * y + 64 * c) as f32)))
        .collect();
    for name in ["lines.exr", "zips.exr", "tiles.exr", "mips.exr", "rips.exr"] {
        let bytes = std::fs::read(corpus.join("exr").join(name)).unwrap();
        let film = Film::from_exr(&bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(film.radiance(), radiance, "{name}");
        for length in 0..bytes.len() {
            let error = Film::from_exr(&bytes[..length]).unwrap_err().to_string();
            assert!(error.contains("the file ends too early"), "{name}: {error}");
        }
    }
    let bytes = std::fs::read(corpus.join("exr/parts-and-tiles.exr")).unwrap();
    assert_eq!(Film::from_exr(&bytes).unwrap().radiance(), radiance);
    for bits in [1, 2, 4, 8] {
        for ending in ["", "-interlaced"] {
            let name = format!("png/palette-{bits}{ending}.png");
            let bytes = std::fs::read(corpus.join(&name)).unwrap();
            let (width, height, codes) = Film::codes_from_png(&bytes).unwrap();
            assert_eq!((width, height), (5, 3), "{name}");
            let most = (1 << bits).min(16);
            let colour = |index: usize| {
                let index = index % most;
                [10 * index, 200 - index, 7 * index % 256].map(|value| value as u8)
            };
            let expected: Vec<_> = (0..15).map(colour).collect();
            assert_eq!(codes, expected, "{name}");
        }
    }
}

fn read(format: FilmFormat, bytes: &[u8]) -> Result<(), FilmError> {
    match format {
        FilmFormat::Exr => Film::from_exr(bytes).map(drop),
        FilmFormat::Pfm => Film::from_pfm(bytes).map(drop),
        FilmFormat::Npy => Film::from_npy(bytes).map(drop),
        FilmFormat::Png => Film::codes_from_png(bytes).map(drop),
    }
}

#[test]
fn a_byte_too_many_is_refused() {
    for name in ["little-f4.npy", "grey.npy", "little.pfm", "grey.pfm"] {
        let mut bytes = std::fs::read(fixture(name)).unwrap();
        bytes.push(0);
        let format = FilmFormat::of(Path::new(name)).unwrap();
        let error = read(format, &bytes).unwrap_err();
        let said = error.to_string();
        assert!(said.starts_with("not a readable"), "{name}: {said}");
    }
}

/// A file of NumPy with this header, and data behind it.
fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), data].concat()
}

#[test]
fn headers_of_numpy() {
    let data = [0x3f, 0x80, 0, 0];
    let one = |header: &str| Film::from_npy(&npy(header, &data));
    for header in [
        "{'descr': '>f4', 'fortran_order': False, 'shape': (1, 1), }\n",
        "{\"shape\":(1,1,1),\"descr\":\">f4\",\"fortran_order\":True}",
        " { 'fortran_order' : False , 'shape' : ( 1 , 1 ) , 'descr' : '>f4' } ",
    ] {
        assert_eq!(one(header).unwrap().radiance(), [[1.0; 3]], "{header}");
    }
    let deep = "[".repeat(9000);
    for header in [
        "",
        "{",
        "{}",
        "}",
        "{'descr'",
        "{'descr': '>f4'}",
        "{'descr': '>f4",
        "{'descr': '>f4', 'fortran_order': False, 'shape': (1, 1)} more",
        "{'descr': '>f4', 'fortran_order': False, 'shape': (1, -1)}",
        "{'descr': '>f4', 'fortran_order': False, 'shape': (,)}",
        "{'descr': '>f4', 'fortran_order': False, 'shape': ()}",
        "{'descr': '>f4', 'fortran_order': False, 'shape': (0, 1)}",
        "{'descr': '', 'fortran_order': False, 'shape': (1, 1)}",
        "{'descr': '>f4', 'fortran_order': False, 'shape': (1, 1), 'x': (1, 1)}",
        &deep,
    ] {
        assert!(one(header).is_err(), "{header}");
    }
}

/// A few bytes that claim to be more than memory holds, or more than a number holds.
#[test]
fn claims_are_checked_before_anything_is_allocated() {
    let limit = 1_usize << 14;
    for (width, height) in [
        (limit, limit),
        (limit, limit + 1),
        (usize::MAX / 3, usize::MAX / 3),
        (usize::MAX, usize::MAX),
        (usize::MAX, 1),
    ] {
        let pfm = format!("PF\n{width} {height}\n-1\n");
        let header =
            format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({height}, {width}, 4)}}");
        for (format, bytes) in [
            (FilmFormat::Pfm, pfm.into_bytes()),
            (FilmFormat::Npy, npy(&header, &[])),
        ] {
            let error = read(format, &bytes).unwrap_err();
            let is_too_large = error.to_string().contains("pixels; from 1 to");
            assert_eq!(is_too_large, (width, height) != (limit, limit), "{error}");
        }
    }
    let long = [&b"\x93NUMPY\x02\0"[..], &u32::MAX.to_le_bytes(), b"{"].concat();
    assert!(Film::from_npy(&long).is_err());
}

#[test]
fn headers_of_pfm() {
    let data = [0, 0, 0x80, 0x3f];
    let grey = |header: &str| Film::from_pfm(&[header.as_bytes(), &data].concat());
    for (header, expected) in [
        ("Pf\n1 1\n-1.0\n", 1.0),
        ("Pf 1 1 -1 ", 1.0),
        ("Pf\r\n1 1\r\n-1\r\n", 1.0),
        ("Pf\n1\n1\n-0.5e0\n", 0.5),
        // The same bytes from the other end.
        ("Pf\n1 1\n1\n", f32::from_be_bytes(data)),
    ] {
        assert_eq!(
            grey(header).unwrap().radiance(),
            [[expected; 3]],
            "{header:?}"
        );
    }
    for header in [
        "",
        "Pf",
        "Pg\n1 1\n-1\n",
        "PF4\n1 1\n-1\n",
        "Pf\n# me\n1 1\n-1\n",
        "PF\n1 1\n-1\n",
        "Pf\n1 2\n-1\n",
        "Pf\n0 1\n-1\n",
        "Pf\n-1 1\n-1\n",
        "Pf\n1.0 1\n-1\n",
        "Pf\n1 1\n0\n",
        "Pf\n1 1\nnan\n",
        "Pf\n1 1\ninf\n",
        "Pf\n1 1\n-1",
        "Pf\n1 1\n-1\n\n",
    ] {
        assert!(grey(header).is_err(), "{header:?}");
    }
}

/// A list of pixels is read as a grey image, of another size than the golden.
#[test]
fn lists_of_pixels() {
    let hint = "(a NumPy array of pixels needs the shape (height, width, 3))";
    for (shape, length, is_said) in [
        ("(6, 3)", 18, true),
        ("(6, 4)", 24, true),
        ("(6, 2)", 12, false),
    ] {
        let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}}}");
        let film = Film::from_npy(&npy(&header, &vec![0; 4 * length])).unwrap();
        let [golden, test] = [Film::new(8, 6, vec![[0.0; 3]; 48]), film].map(Picture::Radiance);
        let reason = judge(Gate::Deterministic, &golden, &test, &Conditions::default());
        assert_eq!(reason.unwrap().reason.ends_with(hint), is_said, "{shape}");
    }
}

#[test]
fn a_file_that_is_not_what_its_name_says() {
    let folder = tempfile::tempdir().unwrap();
    let said: String = [
        ("rgb-8.png", "a.exr"),
        ("half.exr", "b.PNG"),
        ("little.pfm", "c.npy"),
        ("grey.npy", "d.pfm"),
    ]
    .map(|(fixture_name, name)| {
        let path = folder.path().join(name);
        std::fs::copy(fixture(fixture_name), &path).unwrap();
        let message = Picture::read(&path).unwrap_err().to_string();
        let start = message.find(name).unwrap();
        message[start..].to_owned() + "\n"
    })
    .concat();
    insta::assert_snapshot!(said, @r#"
    a.exr: named .exr, but it begins like a PNG image: give it the right extension, or write one of the supported formats (.exr, .pfm, .npy, .png)
    b.PNG: named .png, but it begins like an EXR image: give it the right extension, or write one of the supported formats (.exr, .pfm, .npy, .png)
    c.npy: named .npy, but it begins like a PFM image: give it the right extension, or write one of the supported formats (.exr, .pfm, .npy, .png)
    d.pfm: named .pfm, but it begins like a NumPy array: give it the right extension, or write one of the supported formats (.exr, .pfm, .npy, .png)
    "#);
    let jpeg = folder.path().join("e.exr");
    std::fs::write(&jpeg, b"\xff\xd8\xff\xe0").unwrap();
    let message = Picture::read(&jpeg).unwrap_err().to_string();
    assert!(message.contains("begins like a JPEG image"), "{message}");
    // In capitals or not.
    let capitals = folder.path().join("f.Npy");
    std::fs::copy(fixture("grey.npy"), &capitals).unwrap();
    assert!(Picture::read(&capitals).is_ok());
}

/// An image of constant colour, and of constant noise if there is a count.
fn constant(value: f32, noise: Option<(f32, u32)>) -> Film {
    let pixels = |value: f32| vec![[value, 2.0 * value, 4.0 * value]; 6];
    match noise {
        Some((variance, samples)) => {
            Film::with_noise(3, 2, pixels(value), pixels(variance), samples)
        }
        None => Film::new(3, 2, pixels(value)),
    }
}

#[test]
fn replicates_that_are_none() {
    let one = constant(1.0, None);
    let wide = Film::new(2, 3, one.radiance().to_vec());
    let clear = Film::with_opacity(3, 2, vec![[0.0; 4]; 6]);
    for films in [
        vec![],
        vec![one.clone()],
        vec![one.clone(), wide],
        vec![one.clone(), clear],
        // The same seed twice: its spread would say that there is no noise.
        vec![one.clone(), constant(2.0, None), one.clone()],
    ] {
        let error = Film::from_replicates(&films).unwrap_err();
        let said = error.to_string();
        assert!(said.starts_with("not independent renderings"), "{said}");
    }
}

/// A folder with these files, and what is in them.
fn folder(files: &[(&str, Vec<u8>)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

fn empty(names: &[&'static str]) -> tempfile::TempDir {
    let files: Vec<_> = names.iter().map(|name| (*name, Vec::new())).collect();
    folder(&files)
}

const CASES: [&str; 6] = [
    "figures/figure-1",
    "fog/forward",
    "fog/rate-0",
    "fog/rate-0.1",
    "fog/twice",
    "smoke/twice",
];

/// What is found for `case` among these files, relative to their folder.
fn found(names: &[&'static str], case: &str) -> Result<Option<Found>, String> {
    let folder = empty(names);
    let relative = |path: &PathBuf| path.strip_prefix(folder.path()).unwrap().to_owned();
    let outputs = Outputs::list(folder.path(), &CASES).unwrap();
    match outputs.find(case) {
        Ok(found) => Ok(found.map(|found| Found {
            files: found.files.iter().map(relative).collect(),
            variance: found.variance.as_ref().map(relative),
            depth: found.depth.as_ref().map(relative),
            is_refined: found.is_refined,
        })),
        Err(error) => Err(error
            .to_string()
            .replace(&format!("{}/", folder.path().display()), "")),
    }
}

#[test]
fn images_are_found_by_case() {
    let images = |files: &[&str], variance: Option<&str>| {
        Ok(Some(Found {
            files: files.iter().map(PathBuf::from).collect(),
            variance: variance.map(PathBuf::from),
            depth: None,
            is_refined: false,
        }))
    };
    let f = "fog/forward";
    let beside = Found {
        files: vec!["fog/forward.npy".into()],
        variance: None,
        depth: Some("fog/forward.depth.npy".into()),
        is_refined: false,
    };
    assert_eq!(
        found(&["fog/forward.npy", "fog/forward.depth.npy"], f),
        Ok(Some(beside))
    );
    let alone = found(&["fog/forward.depth.npy"], f).unwrap_err();
    assert!(
        alone.contains("belongs to a single image, but there are 0"),
        "{alone}"
    );
    assert_eq!(found(&[], f), Ok(None));
    assert_eq!(
        found(&["fog/forward.txt", "fog/deep/forward.exr"], f),
        Ok(None)
    );
    for name in [
        "fog/forward.exr",
        "fog/forward.PFM",
        "forward.npy",
        "forward.png",
    ] {
        assert_eq!(found(&[name], f), images(&[name], None));
    }
    let replicates = [
        "fog/forward.1.exr",
        "fog/forward.2.npy",
        "fog/forward.03.pfm",
    ];
    assert_eq!(found(&replicates, f), images(&replicates, None));
    let many: Vec<String> = (0..12).map(|i| format!("forward.{i}.exr")).collect();
    let many: Vec<&'static str> = many.iter().map(|name| &*name.clone().leak()).collect();
    assert_eq!(found(&many, f), images(&many, None));
    let both = ["fog/forward.npy", "forward.variance.exr"];
    assert_eq!(found(&both, f), images(&both[..1], Some(both[1])));
    // The name of a case may look like the number of a replicate.
    let rates = ["fog/rate-0.1.exr", "fog/rate-0.0.exr", "fog/rate-0.1.0.exr"];
    assert_eq!(
        found(&rates[..1], "fog/rate-0.1"),
        images(&rates[..1], None)
    );
    assert_eq!(found(&rates[..1], "fog/rate-0"), Ok(None));
    assert_eq!(found(&rates[..2], "fog/rate-0"), images(&rates[1..2], None));
    assert_eq!(
        found(&rates[2..], "fog/rate-0.1"),
        images(&rates[2..], None)
    );
    // In two families.
    assert_eq!(found(&["twice.exr"], "fog/twice"), Ok(None));
    assert_eq!(found(&["smoke/twice.exr"], "fog/twice"), Ok(None));
}

#[test]
fn files_that_contradict_each_other() {
    let said: String = [
        &["fog/forward.exr", "fog/forward.png"][..],
        &["fog/forward.exr", "forward.exr"],
        &["fog/forward.exr", "fog/forward.0.exr"],
        &["fog/forward.0.exr", "fog/forward.00.exr"],
        &["fog/forward.0.exr", "fog/forward.2.exr"],
        &["fog/forward.2.exr", "fog/forward.3.exr"],
        &["fog/forward.variance.exr"],
        &["forward.0.exr", "forward.1.exr", "forward.variance.exr"],
    ]
    .map(|names| found(names, "fog/forward").unwrap_err() + "\n")
    .concat();
    insta::assert_snapshot!(said, @r#"
    fog/forward: both fog/forward.exr and fog/forward.png could be its image: keep one of them
    fog/forward: both fog/forward.exr and forward.exr could be its image: keep one of them
    fog/forward: both fog/forward.exr and fog/forward.0.exr could be its image: keep one of them
    fog/forward: both fog/forward.0.exr and fog/forward.00.exr could be its image: keep one of them
    fog/forward: there is the rendering fog/forward.2.exr but none with the number 1: number them from 0 or 1 without gaps
    fog/forward: there is the rendering fog/forward.2.exr but none with the number 1: number them from 0 or 1 without gaps
    fog/forward: fog/forward.variance.exr belongs to a single image, but there are 0
    fog/forward: forward.variance.exr belongs to a single image, but there are 2
    "#);
    let nowhere = Outputs::list(Path::new("no such folder"), &CASES);
    let said = nowhere.unwrap_err().to_string();
    assert!(said.contains("the folder cannot be read"), "{said}");
}

#[test]
fn files_of_no_case_are_named() {
    let folder = empty(&[
        "fog/forwrad.exr",
        "figure-1.1.2.exr",
        "twice.exr",
        "fog/forward.jpg",
        "fog/forward.variance.npy",
        "frowad.npy",
        "notes.txt",
        ".hidden.exr",
        "fog/<script>alert('1')<script>.png",
    ]);
    let outputs = Outputs::list(folder.path(), &CASES).unwrap();
    let lines = outputs.unknown_files().iter().map(|unknown| {
        let file = unknown.file.strip_prefix(folder.path()).unwrap();
        format!("{} {}\n", file.display(), unknown.reason)
    });
    insta::assert_snapshot!(lines.collect::<String>(), @r"
    figure-1.1.2.exr does not match any case
    fog/<script>alert('1')<script>.png does not match any case
    fog/forward.variance.npy is not read: variances are an .exr, with R, G, B and samples.Y
    fog/forwrad.exr does not match any case: did you mean fog/forward?
    frowad.npy does not match any case: did you mean fog/forward?
    twice.exr may be of fog/twice or smoke/twice: put it into the folder of its family
    ");
}

#[test]
fn what_is_found_is_read() {
    let exr = |film: &Film| film.to_exr().unwrap();
    let [a, b] = [1.0, 2.0].map(|value| constant(value, None));
    let noisy = constant(3.0, Some((0.25, 64)));
    // A file of variances: the colours of the image, the count of its own.
    let spread = constant(0.25, Some((1.0, 64)));
    let files = folder(&[
        ("fog/forward.0.exr", exr(&a)),
        ("fog/forward.1.npy", b.to_npy()),
        ("fog/rate-0.pfm", a.to_pfm()),
        ("fog/rate-0.variance.exr", exr(&spread)),
        ("fog/rate-0.1.exr", exr(&noisy)),
        ("fog/rate-0.1.variance.exr", exr(&spread)),
        ("fog/twice.exr", exr(&a)),
        ("fog/twice.variance.exr", exr(&a)),
        ("smoke/twice.0.png", a.to_png(0.0)),
        ("smoke/twice.1.png", b.to_png(0.0)),
        ("figure-1.exr", exr(&noisy)),
    ]);
    let outputs = Outputs::list(files.path(), &CASES).unwrap();
    let read = |case: &str| outputs.find(case).unwrap().unwrap().read();
    let pooled = Film::from_replicates(&[a.clone(), b]).unwrap();
    assert_eq!(read("fog/forward").unwrap(), Picture::Radiance(pooled));
    let expected = a.with_variance_of(&spread, 64).unwrap();
    assert_eq!(expected.noise().unwrap().variance(), spread.radiance());
    assert_eq!(read("fog/rate-0").unwrap(), Picture::Radiance(expected));
    assert_eq!(read("figures/figure-1").unwrap(), Picture::Radiance(noisy));
    for (case, file, reason) in [
        ("fog/rate-0.1", "fog/rate-0.1.variance.exr", "leave one out"),
        (
            "fog/twice",
            "fog/twice.variance.exr",
            "no channel samples.Y",
        ),
        ("smoke/twice", "smoke/twice.0.png", "a PNG has no noise"),
    ] {
        let message = read(case).unwrap_err().to_string();
        assert!(
            message.contains(file) && message.contains(reason),
            "{message}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 2000,
        ..common::failures_in("fixtures/proptest-regressions/images.txt")
    })]

    /// What is written is what is read.
    #[test]
    fn the_small_formats_keep_every_bit(
        width in 1_usize..6,
        height in 1_usize..6,
        values in prop::collection::vec(any::<[f32; 4]>(), 25),
        has_opacity: bool,
    ) {
        let pixels = values[..width * height].to_vec();
        let colours = pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
        let plain = Film::new(width, height, colours);
        let film = if has_opacity { Film::with_opacity(width, height, pixels) } else { plain.clone() };
        let read = Film::from_npy(&film.to_npy()).unwrap();
        prop_assert_eq!(read.pixel_hash(), film.pixel_hash());
        let read = Film::from_pfm(&film.to_pfm()).unwrap();
        // NaN times one may become another NaN.
        for (read, given) in read.radiance().iter().flatten().zip(plain.radiance().iter().flatten()) {
            prop_assert!(read.to_bits() == given.to_bits() || read.is_nan() && given.is_nan());
        }
    }
}
