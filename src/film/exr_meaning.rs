//! Attributes of an EXR that say what its pixels mean, each applied or refused.
//!
//! | attribute | rule |
//! | --- | --- |
//! | `chromaticities`, `colorInteropID`, `acesImageContainerFlag`, `oiio:ColorSpace` | refused unless they say linear RGB with the primaries of Rec.709 |
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
const UNASSOCIATED: &str = "oiio:UnassociatedAlpha";

const LOSSLESS: &str = "render it again and write it with ZIP or PIZ: recompressing the file does \
not bring the digits back";

const CONVERT: &str = "write linear RGB with the primaries of Rec.709, or convert the file: \
oiiotool in.exr --colorconvert FROM lin_rec709 --eraseattrib chromaticities -o out.exr";

/// Fails for a part that holds no flat image in full digits.
pub(super) fn check_part(header: &Header) -> Result<(), FilmError> {
    let channels = &header.channels.list;
    let has_halves = channels.iter().any(|c| c.sample_type == SampleType::F16);
    let is_lossy = match header.compression {
        // Besides, the crate allocates whatever a block of it claims.
        Compression::DWAA(_) | Compression::DWAB(_) => true,
        // Other numbers it keeps.
        Compression::B44 | Compression::B44A => has_halves,
        // PXR24 among them: it rounds floats to 16 significant bits, and half floats have 11.
        _ => false,
    };
    let aspect = header.shared_attributes.pixel_aspect;
    let faults = [
        (
            header.deep,
            "has deep data, many samples along each ray",
            "write a flat image, one radiance a pixel",
        ),
        (
            is_lossy,
            "is compressed by DWA or B44, which lose digits",
            LOSSLESS,
        ),
        (
            channels.iter().any(|c| c.sampling != Vec2(1, 1)),
            "has a channel with fewer values than pixels",
            "write R, G and B in full",
        ),
        (
            header.own_attributes.environment_map.is_some(),
            "is an environment map (envmap): its pixels are directions",
            "write the image of the scene's camera, without that attribute",
        ),
        (
            aspect.is_nan() || (aspect - 1.0).abs() > 1e-3,
            "has pixels that are not square (pixelAspectRatio)",
            "render square pixels, and write 1",
        ),
    ];
    match faults.into_iter().find(|(is_so, ..)| *is_so) {
        Some((_, what, remedy)) => Err(FilmError::unsuited(format!("this EXR {what}"), remedy)),
        None => Ok(()),
    }
}

/// Fails if the channels `colours` are not linear RGB with the primaries of Rec.709, as far as is stated.
pub(super) fn check_primaries(colours: &Colours, file: &ExrParts) -> Result<(), FilmError> {
    let other = &colours.part.attributes.other;
    let mut fault = None;
    if let Some(of) = file.attributes.chromaticities {
        let points = [of.red, of.green, of.blue, of.white].map(|Vec2(x, y)| [x, y]);
        if !are_rec709(&points.map(|point| point.map(f64::from))) {
            fault = Some(format!(
                "the chromaticities of this EXR are {points:?}, not those of Rec.709"
            ));
        }
    }
    if is_set(other, ACES) {
        fault = Some(format!(
            "the colours of this EXR are ACES2065-1, by its {ACES}"
        ));
    }
    // Grey has no primaries.
    fault = fault.filter(|_| !colours.is_grey);
    for name in ENCODINGS {
        if let Some(AttributeValue::Text(text)) = other.get(&Text::from(name)) {
            let encoding = text.to_string();
            if !REC709.contains(&&*encoding.to_ascii_lowercase()) {
                fault = Some(format!(
                    "the {name} of this EXR is {encoding:?}, not linear RGB with the primaries of Rec.709"
                ));
            }
        }
    }
    fault.map_or(Ok(()), |fault| Err(FilmError::unsuited(fault, CONVERT)))
}

/// Fails if colours beside an opacity are not multiplied by it.
pub(super) fn check_opacity(colours: &Colours) -> Result<(), FilmError> {
    if is_set(&colours.part.attributes.other, UNASSOCIATED) && colours.opacity.is_some() {
        return Err(FilmError::unsuited(
            format!("the colours of this EXR are not multiplied by its opacity ({UNASSOCIATED})"),
            "write them premultiplied, without that attribute",
        ));
    }
    Ok(())
}

/// True if the attribute `name` is a number other than 0.
fn is_set(attributes: &HashMap<Text, AttributeValue>, name: &str) -> bool {
    let value = attributes.get(&Text::from(name));
    matches!(value, Some(AttributeValue::I32(number)) if *number != 0)
}
