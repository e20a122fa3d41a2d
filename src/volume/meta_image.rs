//! MetaImage, the format of ITK: header and data in one file (`.mha`), or a header (`.mhd`) that names the file of
//! the data.
//!
//! Source: "MetaIO/Documentation", ITK wiki (itk.org/Wiki/MetaIO/Documentation), and the behaviour of ITK's reader.
//!
//! Grids of three axes are read, and those with further axes of a single sample. `Offset` is the centre of the
//! first sample; each row of `TransformMatrix` is the direction of an axis of the grid, along which samples are
//! `ElementSpacing` apart. Coordinates are those of the file, which ITK takes for LPS. Data are raw, in
//! decimal numbers, or compressed by zlib.

use super::error::{VolumeFault, refused};
use super::header_field::{HeaderFields, in_line, read_data, read_lines};
use super::orientation::Axes;
use super::samples::{VolumeRead, check_sizes, read_grid};
use super::source::VolumeSource;
use super::{Centring, Element, Encoding, Endian, Layout, LoadOptions};
use crate::files::gzip;
use glam::DVec3;
use std::io::BufRead;

/// Names of the position of the first sample.
const OFFSETS: [&str; 4] = ["Offset", "Position", "Origin", "ElementOrigin"];

/// Names of the directions of the axes.
const MATRICES: [&str; 4] = [
    "TransformMatrix",
    "Rotation",
    "Orientation",
    "ElementDirection",
];

/// Types of samples.
const TYPES: [(&str, Element); 12] = [
    ("MET_CHAR", Element::Int8),
    ("MET_UCHAR", Element::Uint8),
    ("MET_SHORT", Element::Int16),
    ("MET_USHORT", Element::Uint16),
    ("MET_INT", Element::Int32),
    ("MET_UINT", Element::Uint32),
    ("MET_LONG", Element::Int32),
    ("MET_ULONG", Element::Uint32),
    ("MET_LONG_LONG", Element::Int64),
    ("MET_ULONG_LONG", Element::Uint64),
    ("MET_FLOAT", Element::Float32),
    ("MET_DOUBLE", Element::Float64),
];

/// More axes than anybody uses: as ITK's reader has.
const MOST_AXES: usize = 10;

/// The remedy for data and axes that are not read.
const WRITE_ONE: &str = "write one volume to one file, as by `SimpleITK.WriteImage(SimpleITK.ReadImage(\"a.mhd\"), \
                         \"one.mha\")`";

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let header = read_fields(source)?.header()?;
    let name = Some(&*header.data_file).filter(|name| !name.eq_ignore_ascii_case("local"));
    read_data(source, name, options, |data| {
        header.read_from(data, options)
    })
}

/// A header, and the position of the data.
struct Header {
    layout: Layout,
    data_file: String,
    /// Bytes before the data, from the beginning of their file; `None` if they are its last.
    skip: Option<u64>,
}

impl Header {
    /// Reads the data from what is left of a source.
    fn read_from(&self, source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
        let mut layout = self.layout;
        let length = source.length;
        let begin = length - source.remaining;
        let end = match (self.skip, layout.encoding) {
            (Some(skip), _) => begin.max(skip),
            // Too few are reported as a wrong length.
            (None, Encoding::Raw) => length.saturating_sub(layout.promised()).max(begin),
            (None, _) => return refused("`HeaderSize` of -1 needs data that are not compressed"),
        };
        source.skip(end - begin)?;
        // ITK unpacks either.
        if layout.encoding == Encoding::Zlib && source.fill_buf()?.starts_with(&gzip::MAGIC) {
            layout.encoding = Encoding::Gzip;
        }
        read_grid(source, &layout, options)
    }
}

/// Reads the header at the beginning of `source`, which is left behind the line of `ElementDataFile`.
fn read_fields(source: &mut VolumeSource) -> Result<HeaderFields, VolumeFault> {
    let mut fields = HeaderFields::default();
    read_lines(source, |line, number| {
        let Some(text) = line.map(str::trim) else {
            return refused(
                "the header has no field `ElementDataFile`, which is its last: this is no MetaImage, or it was \
                 cut short",
            );
        };
        if !text.is_empty() {
            let (name, value) = text
                .split_once(['=', ':'])
                .ok_or_else(|| in_line(number, "a line of the header is `Field = value`"))?;
            fields.add(name.trim(), value.trim(), number)?;
        }
        Ok(fields.get("ElementDataFile").is_some())
    })?;
    Ok(fields)
}

/// The fields of MetaImage.
impl HeaderFields {
    /// True or false, or `default` if the field is missing.
    fn flag(&self, name: &str, default: bool) -> Result<bool, VolumeFault> {
        let Some(field) = self.get(name) else {
            return Ok(default);
        };
        match field.value.to_ascii_lowercase().as_str() {
            "true" | "t" | "1" => Ok(true),
            "false" | "f" | "0" => Ok(false),
            _ => Err(field.wrong("True or False")),
        }
    }

    /// A number; `default` if the field is missing.
    fn number(&self, name: &str, default: f64) -> Result<f64, VolumeFault> {
        let field = self.get(name);
        field.map_or(Ok(default), |field| {
            field.number("a finite number", |number: &f64| number.is_finite())
        })
    }

    /// `count` numbers of the first field with one of these names.
    fn numbers(&self, names: &[&str], count: usize) -> Result<Option<Vec<f64>>, VolumeFault> {
        let Some(field) = names.iter().find_map(|name| self.get(name)) else {
            return Ok(None);
        };
        let expected = format!("{count} finite numbers");
        let numbers = field
            .value
            .split_ascii_whitespace()
            .map(|word| word.parse().ok());
        let numbers: Option<Vec<f64>> = numbers.collect();
        let is_right = |numbers: &Vec<f64>| {
            numbers.len() == count && numbers.iter().all(|number| number.is_finite())
        };
        let numbers = numbers.filter(is_right);
        numbers.map(Some).ok_or_else(|| field.wrong(&expected))
    }

    fn header(&self) -> Result<Header, VolumeFault> {
        if let Some(field) = self.get("ObjectType").filter(|it| it.value != "Image") {
            return Err(field.wrong("Image: only images are volumes"));
        }
        for (name, usual) in [
            ("ElementNumberOfChannels", 1.0),
            ("ElementToIntensityFunctionSlope", 1.0),
            ("ElementToIntensityFunctionOffset", 0.0),
        ] {
            let number = self.number(name, usual)?;
            if number != usual {
                return Err(self.required(name)?.fault(&format!(
                    "`{name}` is {number}, and only {usual} is read: a volume has one value per sample, as it \
                     stands; write that"
                )));
            }
        }
        let is_binary = self.flag("BinaryData", true)?;
        let encoding = match (is_binary, self.flag("CompressedData", false)?) {
            (false, _) => Encoding::Text,
            (true, true) => Encoding::Zlib,
            (true, false) => Encoding::Raw,
        };
        let big = self.flag("ElementByteOrderMSB", false)?;
        let big = self.flag("BinaryDataByteOrderMSB", big)?;
        let skip = self.byte_skip("HeaderSize")?;
        let (axes, element) = (self.axes()?, self.element()?);
        Ok(Header {
            layout: Layout {
                endian: if big { Endian::Big } else { Endian::Little },
                encoding,
                space: Some("left-posterior-superior, as ITK takes it"),
                ..Layout::raw(element, axes)
            },
            data_file: self.required("ElementDataFile")?.one_file(WRITE_ONE)?,
            skip,
        })
    }

    fn element(&self) -> Result<Element, VolumeFault> {
        let field = self.required("ElementType")?;
        let name = field.value.strip_suffix("_ARRAY").unwrap_or(&field.value);
        let found = TYPES.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, element)| *element)
            .ok_or_else(|| field.wrong("a type of numbers, such as MET_SHORT or MET_FLOAT"))
    }

    /// Positions of the samples.
    fn axes(&self) -> Result<Axes, VolumeFault> {
        let dims = self.required("NDims")?;
        let expected = "the number of axes, from 1 to 10";
        let dims = dims.number(expected, |dims: &usize| (1..=MOST_AXES).contains(dims))?;
        let sizes = self.sizes("DimSize", dims)?;
        let volume = match sizes[..] {
            [x, y, z, ref more @ ..] if more.iter().all(|&size| size == 1) => [x, y, z],
            _ => {
                return Err(self.required("DimSize")?.fault(&format!(
                    "the file has {dims} axes, and a volume three, with one value per sample (a plane is one with \
                     `DimSize = 64 64 1`): {WRITE_ONE}, of one index of any other axis"
                )));
            }
        };
        let spacing = self.numbers(&["ElementSpacing", "ElementSize"], dims)?;
        let spacing = spacing.unwrap_or(vec![1.0; dims]);
        let offset = self.numbers(&OFFSETS, dims)?.unwrap_or(vec![0.0; dims]);
        let matrix = self.numbers(&MATRICES, dims * dims)?;
        let along = |axis: usize| match &matrix {
            Some(matrix) => DVec3::from_slice(&matrix[axis * dims..]),
            None => DVec3::AXES[axis],
        };
        Ok(Axes {
            sizes: check_sizes(volume)?,
            steps: [0, 1, 2].map(|axis| along(axis) * spacing[axis]),
            first: DVec3::from_slice(&offset),
            centring: Centring::Nodes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, read_volume};

    const HEADER: &str = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 1\nElementType = MET_SHORT\n\
                          ElementDataFile = LOCAL\n";

    fn read(header: &str, data: &[u8]) -> Result<Grid<f32>, VolumeFault> {
        let bytes = [header.as_bytes(), data].concat();
        read_volume("a.mha", &bytes, None, &LoadOptions::default())
    }

    /// The header with `old` replaced.
    fn with(old: &str, new: &str) -> String {
        assert!(HEADER.contains(old));
        HEADER.replacen(old, new, 1)
    }

    fn message(header: &str) -> String {
        read(header, &[0; 8]).unwrap_err().to_string()
    }

    const DATA: [u8; 8] = [1, 0, 2, 0, 3, 0, 0xff, 0xff];

    #[test]
    fn what_may_be_left_out_and_other_spellings() {
        let grid = read(HEADER, &DATA).unwrap();
        assert_eq!(grid.values(), [1.0, 2.0, 3.0, -1.0]);
        assert_eq!(grid.lattice().spacing(), DVec3::ONE);
        assert_eq!(grid.lattice().first(), DVec3::ZERO);
        let places =
            "Position = 1 2 3\nElementSize = 0.5 2 4\nRotation = 0 1 0 1 0 0 0 0 1\nMine = 7\n";
        let grid = read(&with("ElementType", &format!("{places}ElementType")), &DATA).unwrap();
        assert_eq!(grid.lattice().spacing(), DVec3::new(2.0, 0.5, 4.0));
        assert_eq!(grid.lattice().first(), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(grid.values(), [1.0, 3.0, 2.0, -1.0]);
        let big = with("NDims", "ElementByteOrderMSB = True\r\nNDims");
        let swapped = DATA
            .chunks(2)
            .flat_map(|it| [it[1], it[0]])
            .collect::<Vec<u8>>();
        assert_eq!(
            read(&big, &swapped).unwrap().values(),
            [1.0, 2.0, 3.0, -1.0]
        );
        let text = with("NDims", "BinaryData = False\nNDims");
        assert_eq!(
            read(&text, b"1 2 3 -1\n").unwrap().values(),
            [1.0, 2.0, 3.0, -1.0]
        );
        let four = with(
            "NDims = 3\nDimSize = 2 2 1",
            "NDims = 4\nDimSize = 2 2 1 1\nOffset = 5 6 7 8",
        );
        assert_eq!(
            read(&four, &DATA).unwrap().lattice().first(),
            DVec3::new(5.0, 6.0, 7.0)
        );
    }

    #[test]
    fn data_after_a_header_of_their_own() {
        let after = |size: &str, data: &[u8]| {
            let header = with("LOCAL", "a.raw")
                .replace("ElementType", &format!("HeaderSize = {size}\nElementType"));
            let read = read_volume(
                "a.mhd",
                header.as_bytes(),
                Some(data),
                &LoadOptions::default(),
            );
            read.map(|grid| grid.values().to_vec())
                .map_err(|fault| fault.to_string())
        };
        let values = Ok(vec![1.0, 2.0, 3.0, -1.0]);
        let behind = [b"abc", &DATA[..]].concat();
        assert_eq!(after("3", &behind), values);
        assert_eq!(after("-1", &behind), values);
        assert_eq!(after("0", &DATA), values);
        assert!(
            after("99", &DATA)
                .unwrap_err()
                .contains("but 0 bytes follow")
        );
        assert!(
            after("1", &DATA)
                .unwrap_err()
                .contains("8 bytes, but 7 bytes follow it")
        );
    }

    #[test]
    fn what_is_no_volume_says_what_to_do() {
        for (old, new, expected) in [
            ("= Image", "= Tube", "1: `ObjectType` must be Image"),
            ("NDims = 3\n", "", "the header has no field `NDims`"),
            (
                "ElementType",
                "NDims = 3\nElementType",
                "4: the field `NDims` is there twice",
            ),
            (
                "NDims = 3",
                "NDims = 99",
                "2: `NDims` must be the number of axes",
            ),
            (
                "2 2 1",
                "2 2",
                "3: `DimSize` has 2 values, and the file 3 axes",
            ),
            (
                "2 2 1",
                "2 0 1",
                "3: `DimSize` must be positive whole numbers",
            ),
            ("2 2 1", "99999 99999 99999", "too large"),
            (
                "3\nDimSize = 2 2 1",
                "2\nDimSize = 2 2",
                "3: the file has 2 axes, and a volume three",
            ),
            (
                "3\nDimSize = 2 2 1",
                "4\nDimSize = 2 2 1 5",
                "3: the file has 4 axes",
            ),
            (
                "MET_SHORT",
                "MET_STRING",
                "4: `ElementType` must be a type of numbers",
            ),
            (
                "ElementType",
                "ElementSpacing = 2 2\nElementType",
                "4: `ElementSpacing` must be 3 finite numbers",
            ),
            (
                "ElementType",
                "Offset = 1 2 nan\nElementType",
                "4: `Offset` must be 3 finite numbers",
            ),
            (
                "ElementType",
                "ElementNumberOfChannels = 3\nElementType",
                "4: `ElementNumberOfChannels` is 3",
            ),
            (
                "ElementType",
                "ElementToIntensityFunctionSlope = 2\nElementType",
                "4: `ElementToIntensityFunctionSlope` is 2",
            ),
            (
                "ElementType",
                "TransformMatrix = 1 0 0 1 0 0 0 0 1\nElementType",
                "axes 1 and 2 of the file point along the same axis",
            ),
            (
                "ElementType",
                "ElementSpacing = 1 0 1\nElementType",
                "must be positive and finite",
            ),
            (
                "ElementType",
                "CompressedData = maybe\nElementType",
                "4: `CompressedData` must be True or False",
            ),
            (
                "ElementType",
                "nonsense\nElementType",
                "4: a line of the header is `Field = value`",
            ),
            ("LOCAL", "LIST", "5: the data are spread over several files"),
            (
                "LOCAL",
                "a%03d.raw 1 9 1",
                "5: the data are spread over several files",
            ),
            (
                "LOCAL",
                "",
                "5: `ElementDataFile` must be the name of a file",
            ),
            (
                "ElementDataFile = LOCAL\n",
                "",
                "5: a line of the header is `Field = value`",
            ),
            (
                "ElementType",
                "CompressedData = True\nElementType",
                "the compressed stream of the data is damaged",
            ),
            (
                "ElementType",
                "CompressedData = True\nHeaderSize = -1\nElementType",
                "`HeaderSize` of -1",
            ),
        ] {
            let message = message(&with(old, new));
            assert!(message.contains(expected), "{new}: {message}");
        }
    }

    #[test]
    fn compressed_data_end_where_the_file_does() {
        use std::io::Write;
        let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        zlib.write_all(&DATA).unwrap();
        let packed = zlib.finish().unwrap();
        let header = with("ElementType", "CompressedData = True\nElementType");
        assert_eq!(
            read(&header, &packed).unwrap().values(),
            [1.0, 2.0, 3.0, -1.0]
        );
        let cut = read(&header, &packed[..packed.len() - 2]).unwrap_err();
        assert!(
            cut.to_string()
                .contains("the compressed stream of the data is damaged"),
            "{cut}"
        );
        let mut bomb = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        bomb.write_all(&vec![0; 10_000_000]).unwrap();
        let bomb = read(&header, &bomb.finish().unwrap()).unwrap_err();
        assert!(
            bomb.to_string().contains("there is more data after them"),
            "{bomb}"
        );
    }
}
