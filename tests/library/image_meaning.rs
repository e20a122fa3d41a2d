//! What files state about their pixels: heeded, or refused with a remedy.

use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image,
    Layer, LayerAttributes, LineOrder, Text, Vec2, WritableImage, f16,
};
use std::io::Cursor;
use volref::compare::{Conditions, Gate, Picture, judge};
use volref::film::Film;

type ExrImage = Image<Layer<AnyChannels<FlatSamples>>>;

const PIXELS: usize = 6;

/// Channels of 3 × 2 pixels, each of one value, with the header that `edit` makes.
fn exr(channels: &[(&str, f32)], edit: impl FnOnce(&mut ExrImage)) -> Vec<u8> {
    let channel =
        |&(name, value): &(&str, f32)| AnyChannel::new(name, FlatSamples::F32(vec![value; PIXELS]));
    let layer = Layer::new(
        (3, 2),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.iter().map(channel).collect()),
    );
    let mut image = Image::from_layer(layer);
    edit(&mut image);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

const COLOURS: [(&str, f32); 4] = [("R", 1.0), ("G", 0.5), ("B", 0.25), ("A", 0.75)];

fn stated(name: &str, value: AttributeValue) -> impl Fn(&mut ExrImage) + use<> {
    let name = Text::from(name);
    move |image| {
        let other = &mut image.layer_data.attributes.other;
        other.insert(name.clone(), value.clone());
    }
}

fn text(name: &str, value: &str) -> impl Fn(&mut ExrImage) + use<> {
    stated(name, AttributeValue::Text(Text::from(value)))
}

fn chromaticities(points: [[f32; 2]; 4]) -> impl Fn(&mut ExrImage) {
    move |image| {
        let [red, green, blue, white] = points.map(|[x, y]| Vec2(x, y));
        image.attributes.chromaticities = Some(Chromaticities {
            red,
            green,
            blue,
            white,
        });
    }
}

const REC709: [[f32; 2]; 4] = [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.3127, 0.329]];
const AP1: [[f32; 2]; 4] = [
    [0.713, 0.293],
    [0.165, 0.83],
    [0.128, 0.044],
    [0.32168, 0.33767],
];

fn refusal(bytes: &[u8]) -> String {
    Film::from_exr(bytes).expect_err("refused").to_string()
}

#[test]
fn statements_that_change_nothing_change_no_bit() {
    let plain = Film::from_exr(&exr(&COLOURS, |_| ())).unwrap();
    assert_eq!(plain.radiance(), [[1.0, 0.5, 0.25]; PIXELS]);
    let near = REC709.map(|point| point.map(|value| value + 2e-5));
    for bytes in [
        exr(&COLOURS, chromaticities(REC709)),
        exr(&COLOURS, chromaticities(near)),
        exr(&COLOURS, text("colorInteropID", "lin_rec709_scene")),
        exr(&COLOURS, text("colorInteropID", "unknown")),
        exr(&COLOURS, text("oiio:ColorSpace", "Linear")),
        exr(
            &COLOURS,
            stated("acesImageContainerFlag", AttributeValue::I32(0)),
        ),
        exr(&COLOURS, |image| {
            let own = &mut image.layer_data.attributes;
            own.white_luminance = Some(100.0);
            own.exposure = Some(0.02);
            own.adopted_neutral = Some(Vec2(0.3, 0.3));
            own.view_name = Some(Text::from("main"));
        }),
    ] {
        assert_eq!(Film::from_exr(&bytes), Ok(plain.clone()));
    }
    let grey = exr(&[("Y", 0.3)], chromaticities(AP1));
    let grey = Film::from_exr(&grey).unwrap();
    assert_eq!(grey.radiance(), [[0.3; 3]; PIXELS]);
    assert!(grey.changes_on_reading().is_empty());
}

#[test]
fn statements_that_cannot_be_heeded_are_refused() {
    let half = |image: &mut ExrImage, compression| {
        image.layer_data.encoding.compression = compression;
        for channel in &mut image.layer_data.channel_data.list {
            channel.sample_data = FlatSamples::F16(vec![f16::from_f32(0.5); PIXELS]);
        }
    };
    let said: String = [
        exr(&COLOURS, text("colorInteropID", "data")),
        exr(&COLOURS, text("colorInteropID", "srgb_rec709_scene")),
        exr(&COLOURS, text("oiio:ColorSpace", "ACEScg")),
        exr(&COLOURS, chromaticities(AP1)),
        exr(
            &COLOURS,
            stated("acesImageContainerFlag", AttributeValue::I32(1)),
        ),
        exr(&COLOURS, chromaticities([[0.3, 0.3]; 4])),
        exr(&COLOURS, |image| {
            image.layer_data.attributes.environment_map = Some(EnvironmentMap::LatitudeLongitude);
        }),
        exr(&COLOURS, |image| image.attributes.pixel_aspect = 2.0),
        exr(
            &COLOURS,
            stated("oiio:UnassociatedAlpha", AttributeValue::I32(1)),
        ),
        exr(&[("X", 1.0), ("Y", 1.0), ("Z", 1.0)], |_| ()),
        exr(&[("N.X", 1.0), ("N.Y", 1.0), ("N.Z", 1.0)], |_| ()),
        exr(
            &[("rgba.red", 1.0), ("rgba.green", 1.0), ("rgba.blue", 1.0)],
            |_| (),
        ),
        exr(&[("R", 1.0)], |_| ()),
        exr(&COLOURS, |image| half(image, Compression::B44)),
        exr(&COLOURS, |image| half(image, Compression::B44A)),
    ]
    .map(|bytes| refusal(&bytes) + "\n")
    .concat();
    insta::assert_snapshot!(said, @r#"
    the colorInteropID of this EXR is "data", not linear RGB with the primaries of Rec.709; write linear RGB with the primaries of Rec.709, or convert the file: oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr
    the colorInteropID of this EXR is "srgb_rec709_scene", not linear RGB with the primaries of Rec.709; write linear RGB with the primaries of Rec.709, or convert the file: oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr
    the oiio:ColorSpace of this EXR is "ACEScg", not linear RGB with the primaries of Rec.709; write linear RGB with the primaries of Rec.709, or convert the file: oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr
    the chromaticities of this EXR are [[0.713, 0.293], [0.165, 0.83], [0.128, 0.044], [0.32168, 0.33767]], not those of Rec.709; write linear RGB with the primaries of Rec.709, or convert the file: oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr
    the colours of this EXR are ACES2065-1, by its acesImageContainerFlag; write linear RGB with the primaries of Rec.709, or convert the file: oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr
    the chromaticities of this EXR are [[0.3, 0.3], [0.3, 0.3], [0.3, 0.3], [0.3, 0.3]], not those of Rec.709; write linear RGB with the primaries of Rec.709, or convert the file: oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr
    this EXR is an environment map (envmap): its pixels are directions; write the image of the scene's camera, without that attribute
    this EXR has pixels that are not square (pixelAspectRatio); render square pixels, and write 1
    the colours of this EXR are not multiplied by its opacity (oiio:UnassociatedAlpha); write them premultiplied, without that attribute
    no layer of the image has the channels R, G and B; there are: X, Y, Z; name those of linear RGB R, G and B (in a layer beauty.R, beauty.G and beauty.B), or the one of a grey image Y
    no layer of the image has the channels R, G and B; there are: N.X, N.Y, N.Z; name those of linear RGB R, G and B (in a layer beauty.R, beauty.G and beauty.B), or the one of a grey image Y
    no layer of the image has the channels R, G and B; there are: rgba.blue, rgba.green, rgba.red; name those of linear RGB R, G and B (in a layer beauty.R, beauty.G and beauty.B), or the one of a grey image Y
    no layer of the image has the channels R, G and B; there are: R; name those of linear RGB R, G and B (in a layer beauty.R, beauty.G and beauty.B), or the one of a grey image Y
    this EXR is compressed by DWA or B44, which lose digits; render it again and write it with ZIP or PIZ: recompressing the file does not bring the digits back
    this EXR is compressed by DWA or B44, which lose digits; render it again and write it with ZIP or PIZ: recompressing the file does not bring the digits back
    "#);
}

/// Rows written from below are the same image, and a layer that is the only one is named.
#[test]
fn lines_in_any_order_and_layers_by_name() {
    let rows = |order: LineOrder| {
        let bytes = exr(&[], |image| {
            let values = |from: u8| (0..6).map(|i| f32::from(from + i)).collect();
            let channel = |name, from| AnyChannel::new(name, FlatSamples::F32(values(from)));
            let channels = [channel("B", 20), channel("G", 10), channel("R", 0)];
            image.layer_data.channel_data = AnyChannels::sort(channels.into_iter().collect());
            image.layer_data.encoding.line_order = order;
            image.layer_data.encoding.blocks = Blocks::ScanLines;
            image.layer_data.encoding.compression = Compression::ZIP1;
        });
        Film::from_exr(&bytes).unwrap()
    };
    assert_eq!(rows(LineOrder::Decreasing), rows(LineOrder::Increasing));
    let albedo = [("albedo.R", 1.0), ("albedo.G", 0.5), ("albedo.B", 0.25)];
    let film = Film::from_exr(&exr(&albedo, |_| ())).unwrap();
    assert_eq!(
        film.changes_on_reading(),
        ["was read from the layer albedo"]
    );
    let beauty = [("beauty.R", 1.0), ("beauty.G", 0.5), ("beauty.B", 0.25)];
    let film = Film::from_exr(&exr(&beauty, |_| ())).unwrap();
    assert!(film.changes_on_reading().is_empty());
}

/// The bytes of `file` with another number for its compression.
fn compressed(mut file: Vec<u8>, number: u8) -> Vec<u8> {
    let name = b"compression\0compression\0\x01\0\0\0";
    let at = file.windows(name.len()).position(|part| part == name);
    file[at.unwrap() + name.len()] = number;
    file
}

/// What volref does not know reads otherwise than what is broken.
#[test]
fn unknown_and_broken_are_told_apart() {
    let plain = exr(&COLOURS, |_| ());
    let channels = b"channels\0chlist\0";
    let at = plain
        .windows(channels.len())
        .position(|part| part == channels);
    let mut no_channels = plain.clone();
    no_channels[at.unwrap()] = b'x';
    let said: String = [
        compressed(plain.clone(), 10),
        no_channels,
        plain[..plain.len() - 9].to_vec(),
    ]
    .map(|bytes| refusal(&bytes) + "\n")
    .concat();
    insta::assert_snapshot!(said, @r#"
    this EXR has something unknown to volref ("yet unimplemented compression method: ht j2k 256 compression"), though it may be right; save it as a plain image: oiiotool in.exr --compression zip -o out.exr
    not a readable EXR image: it is broken (invalid: missing or invalid channels attribute): write it again
    not a readable EXR image: the file ends too early
    "#);
}

fn npy(kind: &str, bytes: &[u8]) -> Film {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (1, 1)}}");
    let length = (header.len() as u16).to_le_bytes();
    Film::from_npy(&[b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), bytes].concat()).unwrap()
}

/// Infinity has another origin than NaN; numbers of 64 bits may leave the range of those that are kept.
#[test]
fn infinity_says_where_it_comes_from() {
    let pfm = |text: &str, value: f32| {
        Film::from_pfm(&[text.as_bytes(), &value.to_le_bytes()].concat()).unwrap()
    };
    let both = vec![[f32::NAN, f32::INFINITY, 1.0]];
    let said: String = [
        npy("<f2", &f16::INFINITY.to_le_bytes()),
        npy(">f8", &1e39_f64.to_be_bytes()),
        npy("<f4", &f32::NAN.to_le_bytes()),
        pfm("Pf\n1 1\n-10\n", f32::MAX),
        Film::new(1, 1, both),
    ]
    .map(|film| {
        let golden = Film::new(
            film.width(),
            film.height(),
            vec![[1.0; 3]; film.radiance().len()],
        );
        let [golden, test] = [golden, film].map(Picture::Radiance);
        let reason = judge(Gate::Deterministic, &golden, &test, &Conditions::default());
        let reason = reason.unwrap().reason;
        reason.split_once("]; ").unwrap().1.to_owned() + "\n"
    })
    .concat();
    insta::assert_snapshot!(said, @r"
    look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504
    look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504
    look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504
    look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504; the test image was multiplied by 10, the magnitude of its scale
    look for a division by 0, a vector of length 0 that is normalised, or a value beyond the range of the file: half floats end at 65504
    ");
}
