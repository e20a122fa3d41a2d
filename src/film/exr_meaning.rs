//! Attributes of an EXR that say what its pixels mean, each applied or refused.
//!
//! | attribute | rule |
//! | --- | --- |
//! | `chromaticities`, `colorInteropID`, `acesImageContainerFlag`, `oiio:ColorSpace` | refused unless they say linear RGB with the primaries of Rec.709 |
//! | `multiView`, `view` | at most one view |
//! | `envmap` | refused |
//! | `pixelAspectRatio` | 1 |
//! | `oiio:UnassociatedAlpha` | refused beside a channel A: radiance is premultiplied |
//! | `compression` | no more digits may be lost than a half float has |
//!
//! A file without a statement about colours has the primaries of Rec.709, as OpenEXR has it. Not used:
//! `whiteLuminance`, since radiance is in the unit of the scene and not in candelas; and what tells of
//! a camera or a display (`expTime`, `adoptedNeutral`, `renderingTransform` and others), for the pixels
//! stay as they are.
//!
//! Source: <https://openexr.com/en/latest/StandardAttributes.html>; Color Interop Forum, "An ID for
//! Color Interop".

use super::FilmError;
use super::exr_layers::{Colours, ExrParts};
use super::primaries::are_rec709;
use exr::meta::attribute::{AttributeValue, SampleType};
use exr::meta::header::Header;
use exr::prelude::{Compression, Text, Vec2};
use std::collections::HashMap;

/// Attributes with the name of an encoding of colours.
const ENCODINGS: [&str; 2] = ["colorInteropID", "oiio:ColorSpace"];

/// Encodings, in small letters, that state nothing (that of a configuration that the file does not name), or linear RGB
/// with the primaries of Rec.709.
///
/// Source: Color Interop Forum, "Color Space Encodings for Texture Assets and CG Rendering".
const REC709: [&str; 8] = [
    "",
    "unknown",
    "scene_linear",
    "lin_rec709_scene",
    "linear",
    "lin_rec709",
    "lin_srgb",
    "linear rec.709 (srgb)",
];

const ACES: &str = "acesImageContainerFlag";
const CHROMATICITIES: &str = "chromaticities";
const UNASSOCIATED: &str = "oiio:UnassociatedAlpha";

const LOSSLESS: &str = "render it again and write it with ZIP or PIZ: recompressing the file does \
not bring the digits back";

const CONVERT: &str = "write linear RGB with the primaries of Rec.709, or convert the file: \
oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr";

/// Compressions by their number in the file, from the first that is not read.
const UNREAD: [(u8, &str); 3] = [(10, "HTJ2K256"), (11, "HTJ2K32"), (13, "ZSTD")];

/// Fails for a compression that cannot be undone here.
pub(super) fn check_compression(number: u8) -> Result<(), FilmError> {
    if number < UNREAD[0].0 {
        return Ok(());
    }
    let named = UNREAD.iter().find(|(of, _)| *of == number);
    let name = named.map_or_else(
        || format!("number {number}"),
        |(_, name)| (*name).to_owned(),
    );
    Err(FilmError::unsuited(
        format!(
            "the compression of this EXR, {name}, is unknown to volref, though the file may be right"
        ),
        "save it with another: oiiotool in.exr --compression zip -o out.exr",
    ))
}

/// Fails for a part that holds no flat image of one view in full digits.
pub(super) fn check_part(header: &Header) -> Result<(), FilmError> {
    let unsuited = |what: String, remedy| Err(FilmError::unsuited(what, remedy));
    if header.deep {
        return unsuited(
            "this EXR has deep data, many samples along each ray".to_owned(),
            "write a flat image, one radiance a pixel",
        );
    }
    let channels = &header.channels.list;
    let has_halves = channels.iter().any(|c| c.sample_type == SampleType::F16);
    let lossy = match header.compression {
        // Besides, the crate allocates whatever a block of it claims.
        Compression::DWAA(_) | Compression::DWAB(_) => Some("DWA, which loses digits"),
        // Other numbers it keeps.
        Compression::B44 | Compression::B44A if has_halves => {
            Some("B44, which loses digits of half floats")
        }
        // PXR24 among them: it rounds floats to 16 significant bits, and half floats have 11.
        _ => None,
    };
    if let Some(lossy) = lossy {
        return unsuited(format!("this EXR is compressed with {lossy}"), LOSSLESS);
    }
    if let Some(channel) = channels.iter().find(|c| c.sampling != Vec2(1, 1)) {
        return unsuited(
            format!(
                "the channel {} of this EXR is subsampled: it has fewer values than pixels",
                channel.name
            ),
            "write R, G and B in full",
        );
    }
    if header.own_attributes.environment_map.is_some() {
        return unsuited(
            "this EXR is an environment map (envmap): its pixels are directions".to_owned(),
            "write the image of the scene's camera, without that attribute",
        );
    }
    let aspect = header.shared_attributes.pixel_aspect;
    // No comparison with NaN is true.
    let is_square = (aspect - 1.0).abs() <= 1e-3;
    if !is_square {
        return unsuited(
            format!("the pixels of this EXR are {aspect} times as wide as high (pixelAspectRatio)"),
            "render square pixels, and write 1",
        );
    }
    Ok(())
}

/// Fails if the parts are several views, or differ in what OpenEXR asks to be the same for all.
pub(super) fn check_parts(headers: &[Header]) -> Result<(), FilmError> {
    let mut views: Vec<String> = Vec::new();
    for header in headers {
        let own = &header.own_attributes;
        let named = own.multi_view_names.iter().flatten().chain(&own.view_name);
        views.extend(named.map(ToString::to_string));
    }
    views.sort_unstable();
    views.dedup();
    if views.len() > 1 {
        return Err(FilmError::unsuited(
            format!("this EXR holds several views: {}", views.join(", ")),
            "write the one that the scene's camera sees",
        ));
    }
    let mut stated = headers.iter().map(|of| of.shared_attributes.chromaticities);
    let first = stated.next().flatten();
    // Points that are no number equal nothing, and are none of colours.
    if stated.any(|other| other != first) {
        return Err(FilmError::unsuited(
            "the parts of this EXR contradict each other in their chromaticities",
            "state the same in each",
        ));
    }
    Ok(())
}

/// Fails if the channels `colours` are not linear RGB with the primaries of Rec.709, as far as is stated.
pub(super) fn check_primaries(colours: &Colours, file: &ExrParts) -> Result<(), FilmError> {
    let other = &colours.part.attributes.other;
    let mut fault = None;
    match (
        &file.attributes.chromaticities,
        other.get(&Text::from(CHROMATICITIES)),
    ) {
        (Some(of), None) => {
            let points = [of.red, of.green, of.blue, of.white];
            let points = points.map(|Vec2(x, y)| [x, y].map(f64::from));
            if !are_rec709(&points) {
                let [r, g, b, w] = points.map(|[x, y]| format!("({x:.4}, {y:.4})"));
                fault = Some(format!(
                    "the {CHROMATICITIES} of this EXR are {r}, {g}, {b} with white {w}, not those of Rec.709"
                ));
            }
        }
        (None, None) => {}
        _ => return Err(of_another_type(CHROMATICITIES)),
    }
    if integer(other, ACES)? != 0 {
        fault = Some(format!(
            "the colours of this EXR are ACES2065-1, by its {ACES}"
        ));
    }
    // Grey has no primaries.
    fault = fault.filter(|_| !colours.is_grey);
    for name in ENCODINGS {
        let encoding = match other.get(&Text::from(name)) {
            None => continue,
            Some(AttributeValue::Text(text)) => text.to_string(),
            Some(_) => return Err(of_another_type(name)),
        };
        if !REC709.contains(&&*encoding.to_ascii_lowercase()) {
            fault = Some(format!(
                "the {name} of this EXR is {encoding:?}, not linear RGB with the primaries of Rec.709"
            ));
        }
    }
    fault.map_or(Ok(()), |fault| Err(FilmError::unsuited(fault, CONVERT)))
}

/// Fails if colours beside an opacity are not multiplied by it.
pub(super) fn check_opacity(colours: &Colours) -> Result<(), FilmError> {
    let is_unassociated = integer(&colours.part.attributes.other, UNASSOCIATED)? != 0;
    if is_unassociated && colours.opacity.is_some() {
        return Err(FilmError::unsuited(
            format!("the colours of this EXR are not multiplied by its opacity ({UNASSOCIATED})"),
            "write them premultiplied, without that attribute",
        ));
    }
    Ok(())
}

/// The whole number `name`; 0 if there is none.
fn integer(attributes: &HashMap<Text, AttributeValue>, name: &str) -> Result<i32, FilmError> {
    match attributes.get(&Text::from(name)) {
        None => Ok(0),
        Some(AttributeValue::I32(number)) => Ok(*number),
        Some(_) => Err(of_another_type(name)),
    }
}

fn of_another_type(name: &str) -> FilmError {
    FilmError::unreadable("EXR", format!("its attribute {name} is of another type"))
}
