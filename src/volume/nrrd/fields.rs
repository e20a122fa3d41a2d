//! The fields of a header of NRRD: which there are, and the layout of the data that they state.

use super::NrrdHeader;
use super::geometry;
use crate::volume::error::VolumeFault;
use crate::volume::header_field::{HeaderFields, in_line};
use crate::volume::{Element, Encoding, Endian, Layout};

/// As Teem: more axes than anybody uses.
const MOST_AXES: usize = 16;

/// Fields without effect on the positions or values of samples.
const IGNORED: &str = "\
    content, number, block size, blocksize, min, max, old min, oldmin, old max, oldmax, \
    sample units, sampleunits, thicknesses, labels, measurement frame";

/// Fields that are read: as written, and the name they go by.
const READ: &str = "\
    dimension, type, sizes, encoding, endian, spacings, axis mins, axis maxs, centers, kinds, units, \
    space, space units, space dimension, space directions, space origin, data file, line skip, byte skip";

/// Other spellings of them.
const SPELLINGS: [(&str, &str); 6] = [
    ("axismins", "axis mins"),
    ("axismaxs", "axis maxs"),
    ("centerings", "centers"),
    ("datafile", "data file"),
    ("lineskip", "line skip"),
    ("byteskip", "byte skip"),
];

/// Types of samples, by their names.
const TYPES: [(Element, &str); 10] = [
    (Element::Int8, "signed char, int8, int8_t"),
    (Element::Uint8, "uchar, unsigned char, uint8, uint8_t"),
    (
        Element::Int16,
        "short, short int, signed short, signed short int, int16, int16_t",
    ),
    (
        Element::Uint16,
        "ushort, unsigned short, unsigned short int, uint16, uint16_t",
    ),
    (Element::Int32, "int, signed int, int32, int32_t"),
    (Element::Uint32, "uint, unsigned int, uint32, uint32_t"),
    (
        Element::Int64,
        "longlong, long long, long long int, signed long long, signed long long int, int64, int64_t",
    ),
    (
        Element::Uint64,
        "ulonglong, unsigned long long, unsigned long long int, uint64, uint64_t",
    ),
    (Element::Float32, "float"),
    (Element::Float64, "double"),
];

/// True if a list with commas has `word`.
fn is_listed(list: &str, word: &str) -> bool {
    list.split(", ").any(|listed| listed == word)
}

/// Adds the field of a line of a header.
pub(super) fn take(fields: &mut HeaderFields, text: &str, line: usize) -> Result<(), VolumeFault> {
    let fault = |message: &str| in_line(line, message);
    if text.starts_with('#') {
        return Ok(());
    }
    let (name, value) = text.split_once(':').ok_or_else(|| {
        fault("a line of the header is `field: value`, `key:=value` or `# comment`")
    })?;
    if value.starts_with('=') {
        return Ok(());
    }
    let name = name.trim().to_ascii_lowercase();
    if is_listed(IGNORED, &name) {
        return Ok(());
    }
    let spelling = SPELLINGS.iter().find(|(spelt, _)| *spelt == name);
    let usual = spelling.map_or(&*name, |(_, usual)| usual);
    let known = READ.split(", ").find(|field| *field == usual);
    let field = known.ok_or_else(|| {
        fault(&format!(
            "{name:?} is not a field of the format: correct it, or put `#` before it"
        ))
    })?;
    fields.add(field, value.trim(), line)?;
    if field == "data file" {
        // Here, as a list of names follows the field up to the end of the header.
        let remedy = "join them into one, as by `unu save -f nrrd -i several.nhdr -o one.nrrd`";
        fields.required(field)?.one_file(remedy)?;
    }
    Ok(())
}

/// The header that its fields state.
pub(super) fn header(fields: &HeaderFields) -> Result<NrrdHeader, VolumeFault> {
    let dimension = fields.required("dimension")?;
    let expected = "the number of axes, from 1 to 16";
    let dimension = dimension.number(expected, |&n: &usize| (1..=MOST_AXES).contains(&n))?;
    let element = element(fields)?;
    let encoding = encoding(fields)?;
    let data_file = fields.get("data file").map(|field| field.value.clone());
    let needs_endian = element.bytes() > 1 && encoding != Encoding::Text;
    let endian = if needs_endian || fields.get("endian").is_some() {
        let field = fields.required("endian")?;
        match field.value.to_ascii_lowercase().as_str() {
            "little" => Endian::Little,
            "big" => Endian::Big,
            _ => return Err(field.wrong("little or big")),
        }
    } else {
        Endian::Little
    };
    let axes = geometry::axes(fields, &fields.sizes("sizes", dimension)?)?;
    let line_skip = match fields.get("line skip") {
        Some(field) => field.number("a number of lines", |_| true)?,
        None => 0,
    };
    Ok(NrrdHeader {
        layout: Layout {
            endian,
            encoding,
            space: geometry::space(fields),
            ..Layout::raw(element, axes)
        },
        data_file,
        line_skip,
        byte_skip: fields.byte_skip("byte skip")?,
    })
}

fn element(fields: &HeaderFields) -> Result<Element, VolumeFault> {
    let field = fields.required("type")?;
    let words: Vec<&str> = field.value.split_ascii_whitespace().collect();
    let written = words.join(" ").to_ascii_lowercase();
    let mut types = TYPES.iter();
    let found = types.find(|(_, names)| is_listed(names, &written));
    let expected = "a type of the format, such as uint8, short or float";
    found
        .map(|(element, _)| *element)
        .ok_or_else(|| field.wrong(expected))
}

fn encoding(fields: &HeaderFields) -> Result<Encoding, VolumeFault> {
    let field = fields.required("encoding")?;
    match field.value.to_ascii_lowercase().as_str() {
        "raw" => Ok(Encoding::Raw),
        "gzip" | "gz" => Ok(Encoding::Gzip),
        "txt" | "text" | "ascii" => Ok(Encoding::Text),
        _ => Err(field.wrong("raw, gzip or text: write the file again as one")),
    }
}
