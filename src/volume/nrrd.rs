//! NRRD, "nearly raw raster data", versions 1 to 5: header and data in one file (`.nrrd`), or a
//! header (`.nhdr`) that names the file of the data.
//!
//! Source: "Definition of NRRD File Format", Teem 1.9 (teem.sourceforge.net/nrrd/format.html).
//!
//! Grids of three axes are read, and those with further axes of a single sample. An axis is one of
//! space unless `kinds` says that it is none, or `space directions` gives directions to others
//! only. Positions of the samples, of which NaN is an unknown one, as if it were left out:
//! - `space directions` and `space origin` give the steps and the centre of the first sample, in
//!   the coordinates of the file's own space: left and right of a patient are not exchanged.
//! - `axis mins` and `axis maxs` are positions of the outermost samples where the axis is centred
//!   on nodes, and of the faces beyond them where it is centred on cells.
//! - `spacings` alone put the first sample at the origin.
//! - Without any of them the spacing is 1.
//!
//! A file with the wrong `endian` cannot be told apart from one with unusual values.

use super::error::{VolumeFault, refused};
use super::format::{Stored, VolumeFormat, VolumeRead};
use super::orientation::{Axes, AxisSteps};
use super::samples::{check_sizes, read_grid};
use super::source::VolumeSource;
use super::{Centring, Element, Encoding, Endian, Grid, Layout, LoadOptions};
use glam::DVec3;
use std::io::{BufRead, Read};

/// A header, and the position of the data.
#[derive(Clone, Debug, PartialEq)]
pub struct NrrdHeader {
    pub(super) layout: Layout,
    pub(super) data_file: Option<String>,
    line_skip: u64,
    /// `None` stands for −1: the data are the last bytes of the file.
    byte_skip: Option<u64>,
}

impl NrrdHeader {
    /// The file of the data, as the header names it; `None` if they follow the header.
    pub fn data_file(&self) -> Option<&str> {
        self.data_file.as_deref()
    }

    /// Reads the data that this header describes from `bytes`, the file that it names.
    pub fn read_data(&self, bytes: &[u8], options: &LoadOptions) -> Result<Grid<f32>, VolumeFault> {
        self.read_from(&mut VolumeSource::of(bytes), options)
    }

    /// Reads the data from what is left of a source.
    fn read_from(
        &self,
        source: &mut VolumeSource,
        options: &LoadOptions,
    ) -> Result<Grid<f32>, VolumeFault> {
        for _ in 0..self.line_skip {
            if source.skip_until(b'\n')? == 0 {
                return refused("`line skip` goes beyond the end of the data");
            }
            source.line += 1;
        }
        let remaining = source.remaining();
        let layout = &self.layout;
        let skip = match (self.byte_skip, layout.encoding) {
            (Some(0), _) => 0,
            (Some(skip), Encoding::Raw | Encoding::Text) => skip,
            (None, Encoding::Raw) => {
                let samples: usize = layout.axes.sizes.iter().product();
                let promised = samples as u64 * layout.element.bytes() as u64;
                // Too few are reported as a wrong length.
                remaining.saturating_sub(promised)
            }
            (Some(_), Encoding::Gzip) => {
                let message = "`byte skip` within compressed data is not read: write them without";
                return refused(message);
            }
            (None, _) => return refused("`byte skip` of -1 needs the encoding raw"),
        };
        if skip > remaining {
            return refused("`byte skip` goes beyond the end of the data");
        }
        source.skip(skip)?;
        read_grid(source, layout, options)
    }

    /// Reads the header at the beginning of `source`, which is left behind the blank line that
    /// ends it.
    fn read(source: &mut VolumeSource) -> Result<NrrdHeader, VolumeFault> {
        let mut header = source.by_ref().take(LONGEST_HEADER as u64);
        let mut fields = Fields::default();
        let mut line = Vec::new();
        let mut length = 0;
        let mut number = 0;
        loop {
            line.clear();
            let read = header.read_until(b'\n', &mut line)?;
            length += read;
            number += 1;
            let ended = line.last() == Some(&b'\n');
            let text = String::from_utf8_lossy(line.trim_ascii_end());
            if number == 1 {
                let known = ["NRRD0001", "NRRD0002", "NRRD0003", "NRRD0004", "NRRD0005"];
                if !known.contains(&text.as_ref()) {
                    let message = "the file does not begin with NRRD0001 to NRRD0005: this is not \
                    an NRRD file";
                    return refused(message);
                }
                continue;
            }
            if length >= LONGEST_HEADER {
                return refused(format!(
                    "the header does not end within {LONGEST_HEADER} bytes: a blank line ends it"
                ));
            }
            if text.is_empty() && (ended || read == 0) {
                let header = fields.header()?;
                // A detached header may end with its last field.
                if !ended && header.data_file.is_none() {
                    let message = "the file ends within its header: a blank line must follow it, \
                                   and then the data";
                    return refused(message);
                }
                source.line = number;
                return Ok(header);
            }
            fields.take(&text, number)?;
        }
    }
}

/// NRRD, whose data may lie in another file.
pub(super) const NRRD: VolumeFormat = VolumeFormat {
    name: "NRRD",
    extensions: &[".nrrd", ".nhdr"],
    is_point_cloud: false,
    read,
};

fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let header = NrrdHeader::read(source)?;
    let grid = match &header.data_file {
        None => header.read_from(source, options),
        Some(name) => {
            let data = source.open_data(name, options)?;
            let grid = header.read_from(data, options);
            grid.map_err(|fault| match fault {
                VolumeFault::Line(_) => format!("its data file {}", data.error(fault)).into(),
                _ => fault,
            })
        }
    };
    Ok((grid?, Stored::Samples(header.layout)))
}

/// Reads a NRRD file that holds its own data.
pub fn read_nrrd(bytes: &[u8], options: &LoadOptions) -> Result<Grid<f32>, VolumeFault> {
    let mut source = VolumeSource::of(bytes);
    let header = NrrdHeader::read(&mut source)?;
    match &header.data_file {
        Some(name) => refused(format!(
            "the data are in another file, {name:?}: load the header by its path"
        )),
        None => header.read_from(&mut source, options),
    }
}

/// Reads the header of a NRRD file.
pub fn read_nrrd_header(bytes: &[u8]) -> Result<NrrdHeader, VolumeFault> {
    NrrdHeader::read(&mut VolumeSource::of(bytes))
}

/// Headers of diffusion scans, the longest there are, have some hundred kilobytes.
const LONGEST_HEADER: usize = 1 << 20;

/// As Teem: more axes than anybody uses.
const MOST_AXES: usize = 16;

/// Fields without effect on the positions or values of samples.
const IGNORED: &str = "\
    content, number, block size, blocksize, min, max, old min, oldmin, old max, oldmax, \
    sample units, sampleunits, thicknesses, labels, measurement frame";

/// Fields that are read: as written, and the name they go by.
const READ: [(&str, &str); 25] = [
    ("dimension", "dimension"),
    ("type", "type"),
    ("sizes", "sizes"),
    ("encoding", "encoding"),
    ("endian", "endian"),
    ("spacings", "spacings"),
    ("axis mins", "axis mins"),
    ("axismins", "axis mins"),
    ("axis maxs", "axis maxs"),
    ("axismaxs", "axis maxs"),
    ("centers", "centers"),
    ("centerings", "centers"),
    ("kinds", "kinds"),
    ("units", "units"),
    ("space", "space"),
    ("space units", "space units"),
    ("space dimension", "space dimension"),
    ("space directions", "space directions"),
    ("space origin", "space origin"),
    ("data file", "data file"),
    ("datafile", "data file"),
    ("line skip", "line skip"),
    ("lineskip", "line skip"),
    ("byte skip", "byte skip"),
    ("byteskip", "byte skip"),
];

/// Coordinate systems of the format, and their short names; each may be followed by time.
const SPACES: [(&str, &str); 6] = [
    ("right-anterior-superior", "RAS"),
    ("left-anterior-superior", "LAS"),
    ("left-posterior-superior", "LPS"),
    ("scanner-xyz", ""),
    ("3D-right-handed", ""),
    ("3D-left-handed", ""),
];

/// The fields of a header as they stand there: name, value, line.
#[derive(Default)]
struct Fields(Vec<(&'static str, String, usize)>);

impl Fields {
    fn take(&mut self, text: &str, line: usize) -> Result<(), VolumeFault> {
        let fault = |message: String| VolumeFault::Line(format!("{line}: {message}"));
        if text.starts_with('#') {
            return Ok(());
        }
        let (name, value) = text.split_once(':').ok_or_else(|| {
            let text = shortened(text);
            fault(format!(
                "a line of the header is `field: value`, `key:=value` or `# comment`, not {text:?}"
            ))
        })?;
        if value.starts_with('=') {
            return Ok(());
        }
        let name = name.trim().to_ascii_lowercase();
        if IGNORED.split(", ").any(|ignored| ignored == name) {
            return Ok(());
        }
        let known = READ.iter().find(|(written, _)| *written == name);
        let (_, field) = known.ok_or_else(|| {
            let name = shortened(&name);
            fault(format!(
                "{name:?} is not a field of the format: correct it, or put `#` before it"
            ))
        })?;
        if self.0.iter().any(|(other, ..)| other == field) {
            return Err(fault(format!("the field `{field}` is there twice")));
        }
        let value = value.trim();
        if *field == "data file" {
            // Here, as a list of names follows the field up to the end of the header.
            let name = *field;
            HeaderField { name, value, line }.check_one_file()?;
        }
        self.0.push((field, value.to_owned(), line));
        Ok(())
    }

    fn get(&self, name: &'static str) -> Option<HeaderField<'_>> {
        let found = self.0.iter().find(|(field, ..)| *field == name);
        found.map(|(name, value, line)| HeaderField {
            name,
            value,
            line: *line,
        })
    }

    fn required(&self, name: &'static str) -> Result<HeaderField<'_>, VolumeFault> {
        self.get(name).ok_or_else(|| missing(name))
    }

    fn header(&self) -> Result<NrrdHeader, VolumeFault> {
        let dimension = self.required("dimension")?;
        let expected = "the number of axes, from 1 to 16";
        let dimension = dimension.number(expected, |&n: &usize| (1..=MOST_AXES).contains(&n))?;
        let element = self.element()?;
        let encoding = self.encoding()?;
        let data_file = self.get("data file").map(|field| field.value.to_owned());
        let endian = match self.get("endian") {
            Some(field) => match field.value.to_ascii_lowercase().as_str() {
                "little" => Endian::Little,
                "big" => Endian::Big,
                _ => return Err(field.wrong("little or big")),
            },
            None if element.bytes() > 1 && encoding != Encoding::Text => {
                return Err(missing("endian"));
            }
            None => Endian::Little,
        };
        let sizes = self.required("sizes")?;
        let expected = "positive whole numbers";
        let sizes: Vec<u64> = sizes.each(dimension, |text| {
            let size = text.parse().ok().filter(|&size| size > 0);
            size.ok_or_else(|| sizes.wrong(expected))
        })?;
        let axes = self.axes(&sizes)?;
        let line_skip = match self.get("line skip") {
            Some(field) => field.number("a number of lines", |_| true)?,
            None => 0,
        };
        let byte_skip = match self.get("byte skip") {
            Some(field) if field.value == "-1" => None,
            Some(field) => Some(field.number("a number of bytes, or -1", |_| true)?),
            None => Some(0),
        };
        Ok(NrrdHeader {
            layout: Layout {
                axes,
                element,
                endian,
                encoding,
                scaling: None,
                space: self.space(),
            },
            data_file,
            line_skip,
            byte_skip,
        })
    }

    fn element(&self) -> Result<Element, VolumeFault> {
        let field = self.required("type")?;
        let words: Vec<&str> = field.value.split_ascii_whitespace().collect();
        Ok(match words.join(" ").to_ascii_lowercase().as_str() {
            "signed char" | "int8" | "int8_t" => Element::Int8,
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => Element::Uint8,
            "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
                Element::Int16
            }
            "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => {
                Element::Uint16
            }
            "int" | "signed int" | "int32" | "int32_t" => Element::Int32,
            "uint" | "unsigned int" | "uint32" | "uint32_t" => Element::Uint32,
            "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "int64"
            | "int64_t" => Element::Int64,
            "ulonglong"
            | "unsigned long long"
            | "unsigned long long int"
            | "uint64"
            | "uint64_t" => Element::Uint64,
            "float" => Element::Float32,
            "double" => Element::Float64,
            "block" => return Err(field.fault("samples of type block are not numbers")),
            _ => {
                let expected = "a type of the format, such as uint8, short or float";
                return Err(field.wrong(expected));
            }
        })
    }

    /// The coordinate system, if it is one of the format.
    fn space(&self) -> Option<&'static str> {
        let written = self.get("space")?.value.to_ascii_lowercase();
        let space = match written.strip_suffix("-time") {
            Some(space) => space,
            // RAST, LAST and LPST.
            None if written.len() == 4 => written.strip_suffix('t')?,
            None => &written,
        };
        let found = SPACES.iter().find(|(name, short)| {
            [name, short]
                .into_iter()
                .any(|name| name.eq_ignore_ascii_case(space))
        });
        found.map(|(name, _)| *name)
    }

    /// Refuses lengths that are not comparable.
    fn check_units(&self, dimension: usize, kept: [usize; 3]) -> Result<(), VolumeFault> {
        for name in ["units", "space units"] {
            let Some(field) = self.get(name) else {
                continue;
            };
            let mut units = field.units();
            if name == "units" && units.len() == dimension {
                units = kept.map(|axis| units[axis]).to_vec();
            }
            units.retain(|unit| !["", "???", "none"].contains(unit));
            if units.windows(2).any(|pair| pair[0] != pair[1]) {
                return Err(field.fault(&format!(
                    "`{name}` differ between the axes of space, {}: write all positions in one \
                     unit, and the field accordingly",
                    shortened(field.value)
                )));
            }
        }
        Ok(())
    }

    fn encoding(&self) -> Result<Encoding, VolumeFault> {
        let field = self.required("encoding")?;
        let unread = |name| {
            field.fault(&format!(
                "the encoding is {name}, and raw, gzip and text are read: write the file again as \
                 one"
            ))
        };
        match field.value.to_ascii_lowercase().as_str() {
            "raw" => Ok(Encoding::Raw),
            "gzip" | "gz" => Ok(Encoding::Gzip),
            "txt" | "text" | "ascii" => Ok(Encoding::Text),
            "hex" => Err(unread("hex")),
            "bzip2" | "bz2" => Err(unread("bzip2")),
            _ => Err(field.fault(&format!(
                "{:?} is not an encoding of the format: known are raw, gzip, text, hex and bzip2",
                shortened(field.value)
            ))),
        }
    }

    /// The role of each axis; an error if one that is not of space has several samples.
    fn roles(&self, sizes: &[u64]) -> Result<Vec<Role>, VolumeFault> {
        let Some(field) = self.get("kinds") else {
            return Ok(vec![Role::Space; sizes.len()]);
        };
        let kinds = field.each(sizes.len(), |kind| Ok(kind.to_owned()))?;
        let role = |(axis, kind): (usize, &String)| match kind.to_ascii_lowercase().as_str() {
            "domain" | "space" | "???" | "none" => Ok(Role::Space),
            "stub" | "scalar" if sizes[axis] == 1 => Ok(Role::Placeholder),
            _ if sizes[axis] == 1 => Ok(Role::Other),
            _ => {
                let kind = shortened(kind);
                Err(field.no_space(axis, sizes[axis], &format!("of the kind {kind:?}")))
            }
        };
        kinds.iter().enumerate().map(role).collect()
    }

    /// The directions of the axes; `None` if they are all unknown.
    fn directions(&self, sizes: &[u64]) -> Result<Option<Vec<Option<DVec3>>>, VolumeFault> {
        let Some(field) = self.get("space directions") else {
            return Ok(None);
        };
        let mut directions = field.vectors(sizes.len())?;
        if directions.iter().all(Option::is_none) {
            return Ok(None);
        }
        for (axis, direction) in directions.iter_mut().enumerate() {
            // Zero leads nowhere.
            *direction = direction.filter(|&direction| direction != DVec3::ZERO);
            if direction.is_none() && sizes[axis] > 1 {
                return Err(field.no_space(axis, sizes[axis], "without a direction"));
            }
        }
        Ok(Some(directions))
    }

    /// Positions of the samples.
    fn axes(&self, sizes: &[u64]) -> Result<Axes, VolumeFault> {
        let dimension = sizes.len();
        let mut roles = self.roles(sizes)?;
        let directions = self.directions(sizes)?;
        if let Some(directions) = &directions {
            for (role, direction) in roles.iter_mut().zip(directions) {
                if direction.is_none() {
                    *role = Role::Other;
                }
            }
        }
        let kept = kept_axes(sizes, &roles)?;
        self.check_units(dimension, kept)?;
        let mut axes = Axes {
            sizes: check_sizes(kept.map(|axis| sizes[axis]))?,
            steps: AxisSteps::Upright(DVec3::ONE),
            first: DVec3::ZERO,
            centring: self.centring(dimension, kept)?,
        };
        let positive = |number: f64| number.is_normal() && number > 0.0;
        let spacings = self.numbers("spacings", "positive, finite", positive, dimension, kept)?;
        let ends = |name| self.numbers(name, "finite", f64::is_finite, dimension, kept);
        let (mins, maxs) = (ends("axis mins")?, ends("axis maxs")?);
        let known = |numbers: [Option<f64>; 3]| numbers.iter().any(Option::is_some);
        let origin = match self.get("space origin") {
            Some(field) => field.vector_in(field.value)?,
            None => None,
        };
        axes.first = origin.unwrap_or_default();
        if let Some(directions) = directions {
            for (name, given) in [
                ("spacings", spacings),
                ("axis mins", mins),
                ("axis maxs", maxs),
            ] {
                if known(given) {
                    return Err(both("space directions", name));
                }
            }
            let steps = kept.map(|axis| directions[axis].expect("the axes of space have one"));
            axes.steps = AxisSteps::Directed(steps);
            return Ok(axes);
        }
        if origin.is_some() && (known(mins) || known(maxs)) {
            return Err(both("space origin", "axis mins or axis maxs"));
        }
        let mut spacing = [1.0; 3];
        for axis in 0..3 {
            let (beyond, intervals) = match axes.centring {
                Centring::Nodes if axes.sizes[axis] > 1 => (0.0, axes.sizes[axis] - 1),
                // A single sample stands in the middle, whatever the centring.
                Centring::Nodes | Centring::Cells => (0.5, axes.sizes[axis]),
            };
            let intervals = intervals as f64;
            let (min, max) = (mins[axis], maxs[axis]);
            let ordinal = kept[axis] + 1;
            if let (Some(min), Some(max)) = (min, max)
                && min >= max
            {
                return refused(format!(
                    "along axis {ordinal} `axis mins` is {min} and `axis maxs` {max}, which must be \
                     greater"
                ));
            }
            let between = min.zip(max).map(|(min, max)| (max - min) / intervals);
            // Headers are written with six digits, some with fewer.
            if let (Some(given), Some(length)) = (spacings[axis], between)
                && (length - given).abs() > 1e-3 * length.abs()
            {
                return refused(format!(
                    "along axis {ordinal} the header gives a spacing of {given}, and minimum and \
                     maximum that make it {length}: keep one"
                ));
            }
            spacing[axis] = between.or(spacings[axis]).unwrap_or(1.0);
            if let Some(min) = min {
                axes.first[axis] = min + beyond * spacing[axis];
            } else if let Some(max) = max {
                axes.first[axis] = max - (intervals - beyond) * spacing[axis];
            }
        }
        axes.steps = AxisSteps::Upright(DVec3::from_array(spacing));
        Ok(axes)
    }

    fn centring(&self, dimension: usize, kept: [usize; 3]) -> Result<Centring, VolumeFault> {
        let Some(field) = self.get("centers") else {
            return Ok(Centring::Nodes);
        };
        let expected = "cell, node, ??? or none for each axis";
        let all = field.each(dimension, |word| match word.to_ascii_lowercase().as_str() {
            "cell" => Ok(Some(Centring::Cells)),
            "node" => Ok(Some(Centring::Nodes)),
            "???" | "none" => Ok(None),
            _ => Err(field.wrong(expected)),
        })?;
        let mut known = kept.iter().filter_map(|&axis| all[axis]);
        let first = known.next().unwrap_or_default();
        if known.any(|other| other != first) {
            let message = "some axes are centred on nodes, others on cells: a grid has one \
                           centring";
            return refused(message);
        }
        Ok(first)
    }

    /// Numbers of the axes that are kept; `None` where they are unknown.
    fn numbers(
        &self,
        name: &'static str,
        expected: &str,
        accepts: impl Fn(f64) -> bool,
        dimension: usize,
        kept: [usize; 3],
    ) -> Result<[Option<f64>; 3], VolumeFault> {
        let Some(field) = self.get(name) else {
            return Ok([None; 3]);
        };
        let wrong = || {
            field.wrong(&format!(
                "a {expected} number for each axis, or NaN if unknown"
            ))
        };
        let all: Vec<f64> = field.each(dimension, |word| word.parse().map_err(|_| wrong()))?;
        let numbers = kept.map(|axis| Some(all[axis]).filter(|number| !number.is_nan()));
        if numbers.into_iter().flatten().all(accepts) {
            return Ok(numbers);
        }
        match wrong() {
            VolumeFault::Line(message) if name == "spacings" && all.iter().any(|&s| s < 0.0) => {
                Err(VolumeFault::Line(format!(
                    "{message}; `space directions` and `space origin` describe an axis that runs \
                     backwards"
                )))
            }
            fault => Err(fault),
        }
    }
}

/// Role of an axis.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Space,
    /// Keeps the place of one, with a single sample.
    Placeholder,
    /// Time, colour, a vector and the like.
    Other,
}

/// The three axes of space that are left when those of a single sample that are too many are
/// dropped: first placeholders, then the slowest.
fn kept_axes(sizes: &[u64], roles: &[Role]) -> Result<[usize; 3], VolumeFault> {
    let axes = (0..sizes.len()).filter(|&axis| roles[axis] != Role::Other);
    let mut kept: Vec<usize> = axes.collect();
    while kept.len() > 3 {
        let placeholder = kept
            .iter()
            .rposition(|&axis| roles[axis] == Role::Placeholder);
        let single = || kept.iter().rposition(|&axis| sizes[axis] == 1);
        let Some(index) = placeholder.or_else(single) else {
            break;
        };
        kept.remove(index);
    }
    let of_space = kept.len();
    kept.try_into().map_err(|kept: Vec<usize>| {
        let samples: Vec<String> = sizes.iter().map(u64::to_string).collect();
        let (count, samples) = (sizes.len(), samples.join(" × "));
        if of_space < 3 {
            return format!(
                "the file has {count} axes, of {samples} samples, and {of_space} of them are axes of \
                 space: a volume has three; write a plane with a third of a single sample, \
                 as `dimension: 3` and `sizes: 64 64 1`"
            )
            .into();
        }
        // Colours and times are mostly few, colours the fastest and times the slowest.
        let fewest = kept.into_iter().rev().min_by_key(|&axis| sizes[axis]);
        format!(
            "the file has {count} axes, of {samples} samples: a volume has three axes and one value \
             per sample; {}",
            write_slice("one index of the other axis", fewest.unwrap_or_default())
        )
        .into()
    })
}

/// The remedy for an axis that is too many.
fn write_slice(what: &str, axis: usize) -> String {
    format!(
        "write {what} to a file of its own, as by `unu slice -a {axis} -p 0 -i all.nrrd -o \
         one.nrrd`, or in Python from `numpy.take(data, 0, axis={axis})` of the array that pynrrd \
         reads"
    )
}

/// The error of a field that must be there.
fn missing(name: &str) -> VolumeFault {
    let example = match name {
        "dimension" => "`dimension: 3`, the number of axes",
        "type" => "`type: float`, or the type of the samples",
        "sizes" => "`sizes: `, and the number of samples along each axis, the fastest first",
        "encoding" => "`encoding: raw`, or gzip or text",
        _ => "`endian: little`, or big if the most significant byte comes first",
    };
    format!("the header has no field `{name}`: add {example}").into()
}

/// The error of positions that are given twice.
fn both(one: &str, other: &str) -> VolumeFault {
    format!("the header gives `{one}` and `{other}`, which exclude each other: keep one").into()
}

/// A field of a header.
#[derive(Clone, Copy)]
struct HeaderField<'h> {
    name: &'static str,
    value: &'h str,
    line: usize,
}

impl HeaderField<'_> {
    /// A mistake in the line of the field.
    fn fault(&self, message: &str) -> VolumeFault {
        VolumeFault::Line(format!("{}: {message}", self.line))
    }

    fn wrong(&self, expected: &str) -> VolumeFault {
        let (name, value) = (self.name, shortened(self.value));
        self.fault(&format!("`{name}` must be {expected}, not {value:?}"))
    }

    /// The error of an axis that is not of space, and has several samples.
    fn no_space(&self, axis: usize, samples: u64, what: &str) -> VolumeFault {
        let ordinal = axis + 1;
        self.fault(&format!(
            "axis {ordinal}, of {samples} samples, is {what}, and not an axis of space: a volume has \
             three, and one value per sample; {}",
            write_slice(&format!("one of the {samples}"), axis)
        ))
    }

    /// Refuses data in several files: a list of them, or a pattern with the numbers that take the
    /// place of its `%`.
    fn check_one_file(&self) -> Result<(), VolumeFault> {
        let words: Vec<&str> = self.value.split_ascii_whitespace().collect();
        let is_number = |word: &&&str| word.parse::<i64>().is_ok();
        let numbers = words.iter().rev().take_while(is_number).count();
        let name = words[..words.len() - numbers].join(" ").replace("%%", "");
        let mut conversions = name.split('%').skip(1);
        let is_pattern = conversions.any(|rest| {
            let rest = rest.trim_start_matches(|digit: char| digit.is_ascii_digit());
            rest.starts_with(['d', 'u'])
        });
        let how = match words[..] {
            [] => return Err(self.wrong("the name of a file")),
            ["LIST" | "SKIPLIST"] => "a list",
            ["LIST" | "SKIPLIST", _] if numbers == 1 => "a list",
            // Minimum, maximum and step, and perhaps the axes of a file.
            _ if is_pattern && (3..=4).contains(&numbers) => "a pattern with %",
            _ => return Ok(()),
        };
        Err(self.fault(&format!(
            "the data are spread over several files ({how}): join them into one, as by `unu save -f \
             nrrd -i several.nhdr -o one.nrrd`"
        )))
    }

    fn number<T: std::str::FromStr>(
        &self,
        expected: &'static str,
        accepts: impl Fn(&T) -> bool,
    ) -> Result<T, VolumeFault> {
        let number = self.value.parse().ok().filter(accepts);
        number.ok_or_else(|| self.wrong(expected))
    }

    fn count(&self, found: usize, dimension: usize) -> Result<(), VolumeFault> {
        if found == dimension {
            return Ok(());
        }
        let name = self.name;
        Err(self.fault(&format!(
            "`{name}` has {found} values, and the file {dimension} axes: give one for each axis"
        )))
    }

    /// Words that stand in quotes, or between blanks if none does.
    fn units(&self) -> Vec<&str> {
        if self.value.contains('"') {
            let quoted = self.value.split('"').skip(1).step_by(2);
            quoted.map(str::trim).collect()
        } else {
            self.value.split_ascii_whitespace().collect()
        }
    }

    /// One word for each axis.
    fn each<T>(
        &self,
        dimension: usize,
        read: impl Fn(&str) -> Result<T, VolumeFault>,
    ) -> Result<Vec<T>, VolumeFault> {
        let words: Vec<&str> = self.value.split_ascii_whitespace().collect();
        self.count(words.len(), dimension)?;
        words.into_iter().map(read).collect()
    }

    /// `(1,0,0) (0,1,0) none`
    fn vectors(&self, dimension: usize) -> Result<Vec<Option<DVec3>>, VolumeFault> {
        let mut vectors = Vec::new();
        let mut rest = self.value.trim();
        while !rest.is_empty() {
            if let Some(after) = rest.strip_prefix("none") {
                vectors.push(None);
                rest = after.trim_start();
                continue;
            }
            let end = rest.find(')').map_or(rest.len(), |end| end + 1);
            vectors.push(self.vector_in(&rest[..end])?);
            rest = rest[end..].trim_start();
        }
        self.count(vectors.len(), dimension)?;
        Ok(vectors)
    }

    /// `(1,0,0)`; `None` for `none` or `(nan,nan,nan)`.
    fn vector_in(&self, text: &str) -> Result<Option<DVec3>, VolumeFault> {
        let text = text.trim();
        if text == "none" {
            return Ok(None);
        }
        let inner = text.strip_prefix('(');
        let inner = inner.and_then(|inner| inner.strip_suffix(')'));
        let numbers: Option<Vec<f64>> =
            inner.and_then(|inner| inner.split(',').map(|n| n.trim().parse().ok()).collect());
        match numbers.as_deref() {
            Some([x, y, z]) if [x, y, z].iter().all(|number| number.is_nan()) => Ok(None),
            Some(&[x, y, z]) if DVec3::new(x, y, z).is_finite() => Ok(Some(DVec3::new(x, y, z))),
            _ => Err(self.wrong("vectors of three finite numbers, such as (1,0,0), or none")),
        }
    }
}

/// Text for a message, cut where it is long.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header of a `2 × 2 × 1` grid of bytes with these lines more, and its data.
    fn file(lines: &str) -> Vec<u8> {
        let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n";
        [header.as_bytes(), lines.as_bytes(), b"\n\x01\x02\x03\x04"].concat()
    }

    fn read(bytes: &[u8]) -> Result<Grid<f32>, VolumeFault> {
        read_nrrd(bytes, &LoadOptions::default())
    }

    fn message(bytes: &[u8]) -> String {
        read(bytes).unwrap_err().to_string()
    }

    /// Spacing and first node.
    fn geometry(lines: &str) -> ([f64; 3], [f64; 3]) {
        let grid = read(&file(lines)).unwrap();
        let lattice = grid.lattice();
        (lattice.spacing().to_array(), lattice.first().to_array())
    }

    /// As [`file`], with `old` of the header replaced.
    fn with(old: &str, new: &str) -> Vec<u8> {
        let text = String::from_utf8(file("")).unwrap();
        assert!(text.contains(old));
        text.replacen(old, new, 1).into_bytes()
    }

    #[test]
    fn what_is_not_said_about_places() {
        assert_eq!(geometry(""), ([1.0; 3], [0.0; 3]));
        assert_eq!(geometry("spacings: 0.5 2 3\n"), ([0.5, 2.0, 3.0], [0.0; 3]));
        assert_eq!(
            geometry("spacings: 0.5 2 3\nspace dimension: 3\nspace origin: (1, -2, 3e1)\n"),
            ([0.5, 2.0, 3.0], [1.0, -2.0, 30.0])
        );
    }

    /// NaN, as if it were left out.
    #[test]
    fn what_is_unknown_about_places() {
        let alone = geometry("spacings: 0.5 2 3\n");
        for lines in [
            "spacings: 0.5 2 3\naxis mins: nan NaN nan\naxis maxs: nan nan nan\n",
            "spacings: 0.5 2 3\nspace directions: none none none\n",
            "spacings: 0.5 2 3\nspace origin: (nan,nan,nan)\nspace directions: (nan,nan,nan) none none\n",
            "spacings: NaN nan nan\nspace directions: (0.5,0,0) (0,2,0) (0,0,3)\nspace origin: none\n",
        ] {
            assert_eq!(geometry(lines), alone, "{lines}");
        }
        assert_eq!(geometry("spacings: nan NaN nan\n"), geometry(""));
        assert_eq!(
            geometry("spacings: nan 2 3\naxis mins: 1 nan 0\naxis maxs: 4 7 nan\n"),
            ([3.0, 2.0, 3.0], [1.0, 5.0, 1.5])
        );
    }

    #[test]
    fn axes_that_are_no_space() {
        let shape = "dimension: 3\nsizes: 2 2 1";
        let of = |sizes: &str, lines: &str| {
            let dimension = sizes.split(' ').count();
            let header = format!("dimension: {dimension}\nsizes: {sizes}\n{lines}");
            let read = read(&with(shape, &header));
            read.map(|grid| grid.lattice().nodes())
                .map_err(|error| error.to_string())
        };
        for kinds in ["domain SPACE ???", "none none none", "domain domain stub"] {
            assert_eq!(of("2 2 1", &format!("kinds: {kinds}")), Ok([2, 2, 1]));
        }
        // The axis of a single sample that is no axis of space is the one that goes.
        for kind in ["list", "scalar", "stub", "time", "RGB-color"] {
            let kinds = format!("kinds: {kind} domain domain domain");
            assert_eq!(of("1 2 2 1", &kinds), Ok([2, 2, 1]), "{kind}");
            let kinds = format!("kinds: domain domain domain {kind}");
            assert_eq!(of("1 2 2 1", &kinds), Ok([1, 2, 2]), "{kind}");
        }
        let plane = "of them are axes of space: a volume has three; write a plane with";
        for (sizes, lines, expected) in [
            (
                "2 2 1",
                "kinds: RGB-color domain domain",
                "5: axis 1, of 2 samples, is of the kind \"RGB-color\", and not an axis of space: a \
                 volume has three, and one value per sample; write one of the 2 to a file of its \
                 own, as by `unu slice -a 0 -p 0 -i all.nrrd -o one.nrrd`",
            ),
            (
                "1 2 2",
                "kinds: domain domain time",
                "5: axis 3, of 2 samples, is of the kind \"time\"",
            ),
            (
                "2 2 1",
                "kinds: domain list domain",
                "5: axis 2, of 2 samples, is of the kind \"list\"",
            ),
            (
                "2 2 1",
                "kinds: stub domain domain",
                "5: axis 1, of 2 samples, is of the kind \"stub\"",
            ),
            (
                "2 1 2 1",
                "kinds: domain domain 3-vector domain",
                "5: axis 3, of 2 samples, is of the kind \"3-vector\"",
            ),
            ("1 2 2", "kinds: list domain domain", plane),
            ("2 2", "content: a plane", plane),
            (
                "2 2 1",
                "kinds: domain domain",
                "5: `kinds` has 2 values, and the file 3 axes",
            ),
            (
                "2 2 1",
                "space directions: none (1,0,0) (0,1,0)",
                "5: axis 1, of 2 samples, is without a direction, and not an axis of space",
            ),
            (
                "2 1 2",
                "space directions: (1,0,0) (0,1,0) (0,0,0)",
                "5: axis 3, of 2 samples, is without a direction, and not an axis of space",
            ),
            ("2 2 1", "space directions: (1,0,0) (0,1,0) none", plane),
        ] {
            let message = of(sizes, lines).unwrap_err();
            assert!(message.contains(expected), "{lines}: {message}");
        }
    }

    #[test]
    fn names_of_data_files() {
        let name = |value: &str| {
            let header = format!(
                "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\ndata file: {value}\n"
            );
            let header = read_nrrd_header(header.as_bytes());
            header.map(|header| header.data_file().map(str::to_owned))
        };
        for file in [
            "100%.raw",
            "100% done.raw",
            "%d.raw",
            "scan 1 2 3",
            "50%25.raw 1 2 3",
            "LIST.raw",
            "a list",
        ] {
            assert_eq!(name(file), Ok(Some(file.to_owned())));
        }
        for several in [
            "LIST\na.raw\nsp ace.raw",
            "LIST 2\na: b.raw",
            "SKIPLIST\n3 a.raw",
            "s%03d.raw 1 9 1",
            "s%d.raw 9 1 -1 2",
            "my scan %u.raw 1 9 1",
        ] {
            let message = name(several).unwrap_err().to_string();
            assert!(
                message.starts_with("6: the data are spread over several files (a "),
                "{message}"
            );
        }
        assert_eq!(
            name("").unwrap_err().to_string(),
            "6: `data file` must be the name of a file, not \"\""
        );
    }

    #[test]
    fn mins_and_maxs_go_by_the_centring() {
        let ends = "axis mins: 0 0 0\naxis maxs: 4 2 6\n";
        // A single sample stands in the middle of its axis.
        let nodes = ([4.0, 2.0, 6.0], [0.0, 0.0, 3.0]);
        let cells = ([2.0, 1.0, 6.0], [1.0, 0.5, 3.0]);
        assert_eq!(geometry(ends), nodes);
        assert_eq!(geometry(&format!("{ends}centers: node ??? node\n")), nodes);
        assert_eq!(
            geometry(&format!("{ends}centerings: cell cell cell\n")),
            cells
        );
        assert_eq!(
            geometry("spacings: 2 1 6\naxis maxs: 4 2 6\ncenters: cell cell cell\n"),
            cells
        );
        assert_eq!(geometry("spacings: 4 2 6\naxis mins: 0 0 0\n"), nodes);
        let grid = read(&file(&format!("{ends}centers: cell cell cell\n"))).unwrap();
        assert_eq!(grid.lattice().centring(), Centring::Cells);
        assert_eq!(grid.lattice().bounds().max, DVec3::new(4.0, 2.0, 6.0));
    }

    #[test]
    fn comments_keys_and_line_ends() {
        let text = "NRRD0005\r\n# made by hand\r\ntype: unsigned char\r\nencoding: RAW\r\n\
                    key:=value: with colon\r\ndimension: 3\r\nsizes:   1 1   1\r\n\r\n\x07";
        assert_eq!(read(text.as_bytes()).unwrap().values(), [7.0]);
    }

    #[test]
    fn axes_of_one_sample_are_dropped() {
        let bytes = with(
            "dimension: 3\nsizes: 2 2 1",
            "dimension: 5\nsizes: 1 2 2 1 1",
        );
        assert_eq!(read(&bytes).unwrap().lattice().nodes(), [1, 2, 2]);
        let lines = "dimension: 4\nsizes: 1 2 2 1\n\
                     space directions: none (1,0,0) (0,1,0) (0,0,1)";
        let bytes = with("dimension: 3\nsizes: 2 2 1", lines);
        assert_eq!(read(&bytes).unwrap().lattice().nodes(), [2, 2, 1]);
        assert_eq!(
            message(&with(
                "dimension: 3\nsizes: 2 2 1",
                "dimension: 4\nsizes: 2 2 2 2"
            )),
            "the file has 4 axes, of 2 × 2 × 2 × 2 samples: a volume has three axes and one value \
            per sample; write one index of the other axis to a file of its own, as by `unu slice \
            -a 3 -p 0 -i all.nrrd -o one.nrrd`, or in Python from `numpy.take(data, 0, axis=3)` of \
            the array that pynrrd reads"
        );
        assert!(message(&with("3\nsizes: 2 2 1", "2\nsizes: 2 2")).contains("has 2 axes"));
    }

    #[test]
    fn data_after_lines_and_bytes() {
        let values = |lines: &str, data: &[u8]| {
            let header = format!(
                "NRRD0004\ntype: short\nendian: big\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n\
                 data file: a.raw\n{lines}"
            );
            let header = read_nrrd_header(header.as_bytes()).unwrap();
            assert_eq!(header.data_file(), Some("a.raw"));
            let grid = header.read_data(data, &LoadOptions::default());
            grid.map(|grid| grid.values().to_vec())
                .map_err(|error| error.to_string())
        };
        let two = Ok(vec![1.0, -2.0]);
        let samples = [0, 1, 255, 254];
        let after = |front: &[u8]| [front, &samples].concat();
        assert_eq!(values("", &samples), two);
        assert_eq!(values("byte skip: 3\n", &after(b"abc")), two);
        assert_eq!(values("byte skip: -1\n", &after(b"anything")), two);
        assert_eq!(values("line skip: 2\n", &after(b"one\ntwo\n")), two);
        assert_eq!(values("line skip: 1\nbyte skip: 1", &after(b"one\nx")), two);
        for (lines, expected) in [
            (
                "byte skip: 5",
                "`byte skip` goes beyond the end of the data",
            ),
            (
                "line skip: 3",
                "`line skip` goes beyond the end of the data",
            ),
            (
                "byte skip: 1",
                "the header declares 2 × 1 × 1 samples of int16, 4 bytes, but 3",
            ),
        ] {
            let message = values(lines, &samples).unwrap_err();
            assert!(message.starts_with(expected), "{message}");
        }
    }

    #[test]
    fn lines_that_are_wrong() {
        for (old, new, expected) in [
            (
                "type: uchar",
                "type: uchat",
                "2: `type` must be a type of the format",
            ),
            (
                "type: uchar",
                "type: block",
                "2: samples of type block are not numbers",
            ),
            (
                "type: uchar",
                "typ: uchar",
                "2: \"typ\" is not a field of the format",
            ),
            (
                "type: uchar",
                "type uchar",
                "2: a line of the header is `field: value`",
            ),
            ("type: uchar\n", "", "the header has no field `type`"),
            (
                "type: uchar",
                "type: int",
                "the header has no field `endian`",
            ),
            (
                "type: uchar",
                "type: uchar\ntype: uchar",
                "3: the field `type` is there twice",
            ),
            (
                "dimension: 3",
                "dimension: 0",
                "3: `dimension` must be the number of axes",
            ),
            (
                "dimension: 3",
                "dimension: 4",
                "4: `sizes` has 3 values, and the file 4 axes",
            ),
            (
                "sizes: 2 2 1",
                "sizes: 2 0 1",
                "4: `sizes` must be positive whole numbers",
            ),
            (
                "sizes: 2 2 1",
                "sizes: 2 -2 1",
                "4: `sizes` must be positive whole numbers",
            ),
            (
                "encoding: raw",
                "encoding: hex",
                "5: the encoding is hex, and raw, gzip and text",
            ),
            (
                "encoding: raw",
                "encoding: bz2",
                "5: the encoding is bzip2, and raw",
            ),
            (
                "encoding: raw",
                "encoding: zip",
                "5: \"zip\" is not an encoding of the format",
            ),
            (
                "NRRD0004",
                "NRRD0009",
                "the file does not begin with NRRD0001 to NRRD0005",
            ),
            (
                "sizes: 2 2 1",
                "sizes: 1048576 1048576 1048576",
                "a grid of 1048576 × 1048576 × 1048576 nodes is too large",
            ),
            (
                "sizes: 2 2 1",
                "sizes: 18446744073709551615 3 3",
                "a grid of 18446744073709551615 × 3 × 3 nodes is too large",
            ),
            (
                "sizes: 2 2 1",
                "sizes: 2 2 2",
                "the header declares 2 × 2 × 2 samples of uint8, 8",
            ),
            (
                "sizes: 2 2 1",
                "sizes: 1 1 1",
                "the header declares 1 × 1 × 1 samples of uint8, 1",
            ),
        ] {
            let message = message(&with(old, new));
            assert!(message.starts_with(expected), "{message}");
        }
        for (lines, expected) in [
            (
                "spacings: 0 1 1\n",
                "6: `spacings` must be a positive, finite number for each axis, or NaN if unknown",
            ),
            (
                "spacings: 1 -1 nan\n",
                "6: `spacings` must be a positive, finite number",
            ),
            (
                "spacings: 1 x 1\n",
                "6: `spacings` must be a positive, finite number",
            ),
            (
                "spacings: 1 1 1\naxis mins: 0 -inf 0\n",
                "7: `axis mins` must be a finite number for each axis, or NaN if unknown",
            ),
            (
                "axis maxs: inf 1 1\n",
                "6: `axis maxs` must be a finite number for each axis",
            ),
            (
                "axis mins: 0 1 0\naxis maxs: 1 1 1\n",
                "along axis 2 `axis mins` is 1 and `axis maxs` 1, which must be greater",
            ),
            (
                "space origin: (0,nan,0)\n",
                "6: `space origin` must be vectors of three finite numbers",
            ),
            (
                "space directions: (1,0,0) (0,inf,0) (0,0,1)\n",
                "6: `space directions` must be vectors of three finite numbers",
            ),
            ("spacings: 1 1\n", "6: `spacings` has 2 values"),
            ("endian: middle\n", "6: `endian` must be little or big"),
            (
                "centers: cell node cell\n",
                "some axes are centred on nodes, others on cells",
            ),
            (
                "data file: LIST\n",
                "6: the data are spread over several files (a list)",
            ),
            (
                "data file: s%03d.raw 1 9 1\n",
                "6: the data are spread over several files (a pat",
            ),
            (
                "data file: other.raw\n",
                "the data are in another file, \"other.raw\"",
            ),
            (
                "space directions: (1,0,0) (0,1,0)\n",
                "6: `space directions` has 2 values",
            ),
            (
                "space directions: (1,0) (0,1) (1,1)\n",
                "6: `space directions` must be vectors",
            ),
            (
                "space directions: (1,0,0) (0,1,0) (0,0,1)\nspacings: 1 1 1\n",
                "the header gives `space directions` and `spacings`, which exclude each other",
            ),
            (
                "spacings: 1 1 1\naxis mins: 0 0 0\naxis maxs: 5 1 1\n",
                "along axis 1 the header gives a spacing of 1, and minimum and maximum that make \
                 it 5",
            ),
            (
                "space directions: (1,0.01,0) (0,1,0) (0,0,1)\n",
                "axis 1 of the file is rotated by 0.5729 degrees",
            ),
        ] {
            let message = message(&file(lines));
            assert!(message.starts_with(expected), "{lines}: {message}");
        }
    }

    #[test]
    fn headers_without_end() {
        assert_eq!(message(b""), message(b"PNG"));
        let whole = file("");
        for cut in 9..whole.len() - 5 {
            assert!(read(&whole[..cut]).is_err(), "{cut}");
        }
        assert_eq!(
            message(&whole[..whole.len() - 5]),
            "the file ends within its header: a blank line must follow it, and then the data"
        );
        let long = [b"NRRD0001\n", &b"#\n".repeat(1 << 19)[..]].concat();
        assert_eq!(
            message(&long),
            "the header does not end within 1048576 bytes: a blank line ends it"
        );
    }

    #[test]
    fn text() {
        let text = |kind: &str, data: &str| {
            let header = with("encoding: raw", "encoding: ascii");
            let header = String::from_utf8_lossy(&header[..header.len() - 4]).into_owned();
            let header = header.replace("uchar", kind);
            [header.as_bytes(), data.as_bytes()].concat()
        };
        let values = |kind: &str, data: &str| read(&text(kind, data)).unwrap().values().to_vec();
        assert_eq!(values("float", "1, 2.5 -3e1\n4\n"), [1.0, 2.5, -30.0, 4.0]);
        assert_eq!(values("uchar", "0 255\n7.0 1e2,"), [0.0, 255.0, 7.0, 100.0]);
        let (least, most) = (i64::MIN as f32, u64::MAX as f32);
        assert_eq!(
            values("int64", "-9223372036854775808 0 0 1e+17 "),
            [least, 0.0, 0.0, 1e17]
        );
        // As %.17g writes it.
        assert_eq!(
            values(
                "uint64",
                "18446744073709551615 1.8446744073709552e+19 0 0\n"
            ),
            [most, most, 0.0, 0.0]
        );
        let byte = "no uint8, a whole number from 0 to 255: correct it, or the type in the header";
        let unended = ", the last of the text, with nothing behind it, and may have lost digits: \
                       copy the file again, or end it with a line break if it is whole";
        for (kind, data, expected) in [
            (
                "uchar",
                "1 2 3",
                "the header declares 2 × 2 × 1 samples, 4 bytes when unpacked",
            ),
            (
                "uchar",
                "100 200 3\n",
                "the header declares 2 × 2 × 1 samples, but the data ends after 3",
            ),
            (
                "uchar",
                "1 2 3 4 5\n",
                "there is data after the 2 × 2 × 1 samples",
            ),
            (
                "uchar",
                "1 2\n three 4",
                "8:2: sample 2 is \"three\", no number",
            ),
            (
                "float",
                "1 2 nan 4 ",
                "voxel (0, 1, 0), counted as stored, holds NaN: values must be finite",
            ),
            (
                "uchar",
                "1 300 3 4\n",
                &format!("7:3: sample 1 is \"300\", {byte}"),
            ),
            (
                "uchar",
                "1\r\n2\r\n3, 1.7\r\n",
                &format!("9:4: sample 3 is \"1.7\", {byte}"),
            ),
            (
                "uchar",
                "1 2 nan 4\n",
                &format!("7:5: sample 2 is \"nan\", {byte}"),
            ),
            (
                "uchar",
                "1 2 3 -1\n",
                &format!("7:7: sample 3 is \"-1\", {byte}"),
            ),
            (
                "ulonglong",
                "1 2 3 18446744073709551616\n",
                "7:7: sample 3 is \"18446744073709551616\", no uint64",
            ),
            (
                "uchar",
                "1 2 3 4",
                &format!("7:7: sample 3 is \"4\"{unended}"),
            ),
            (
                "uchar",
                "1 2\n3 120",
                &format!("8:3: sample 3 is \"120\"{unended}"),
            ),
            (
                "float",
                "1 2 3 0.12",
                &format!("7:7: sample 3 is \"0.12\"{unended}"),
            ),
        ] {
            let message = message(&text(kind, data));
            assert!(message.starts_with(expected), "{message}");
        }
    }

    /// However much is lost, what is left is no other volume.
    #[test]
    fn text_that_was_cut() {
        let whole = b"NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 1\nencoding: text\n\n\
                      11 22\n33 44\n";
        assert_eq!(read(whole).unwrap().values(), [11.0, 22.0, 33.0, 44.0]);
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
    }
}
