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
//! - A negative spacing, and a minimum above the maximum, is an axis that runs backwards from its first sample.
//! - Without any of them the spacing is 1.
//!
//! A file with the wrong `endian` cannot be told apart from one with unusual values.

mod fields;
mod geometry;

use super::error::{VolumeFault, refused};
use super::header_field::{HeaderFields, read_data, read_lines};
use super::samples::{VolumeRead, read_grid};
use super::source::VolumeSource;
use super::{Encoding, Layout, LoadOptions};
use std::io::BufRead;

/// A header, and the position of the data.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NrrdHeader {
    pub(super) layout: Layout,
    pub(super) data_file: Option<String>,
    line_skip: u64,
    /// `None` stands for −1: the data are the last bytes of the file.
    byte_skip: Option<u64>,
}

impl NrrdHeader {
    /// Reads the data from what is left of a source.
    fn read_from(&self, source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
        for _ in 0..self.line_skip {
            if source.skip_until(b'\n')? == 0 {
                break;
            }
            source.line += 1;
        }
        let layout = &self.layout;
        let skip = match (self.byte_skip, layout.encoding) {
            (Some(0), _) => 0,
            (Some(skip), Encoding::Raw | Encoding::Text) => skip,
            // Too few are reported as a wrong length.
            (None, Encoding::Raw) => source.remaining.saturating_sub(layout.promised()),
            _ => return refused("`byte skip` needs the encoding raw: write the file without it"),
        };
        source.skip(skip)?;
        read_grid(source, layout, options)
    }

    /// Reads the header at the beginning of `source`, which is left behind the blank line that
    /// ends it.
    fn read(source: &mut VolumeSource) -> Result<NrrdHeader, VolumeFault> {
        let (mut fields, mut header) = (HeaderFields::default(), None);
        read_lines(source, |line, number| {
            match line {
                Some("NRRD0001" | "NRRD0002" | "NRRD0003" | "NRRD0004" | "NRRD0005")
                    if number == 1 => {}
                _ if number == 1 => {
                    return refused(
                        "the file does not begin with NRRD0001 to NRRD0005: this is not an NRRD file",
                    );
                }
                // A detached header may end with its last field.
                None if fields.get("data file").is_none() => {
                    return refused(
                        "the header does not end: a blank line ends it, and then follow the data",
                    );
                }
                None | Some("") => header = Some(fields::header(&fields)?),
                Some(text) => fields::take(&mut fields, text, number)?,
            }
            Ok(header.is_some())
        })?;
        Ok(header.expect("its lines have ended"))
    }
}

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let header = NrrdHeader::read(source)?;
    let name = header.data_file.as_deref();
    read_data(source, name, options, |data| {
        header.read_from(data, options)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Centring, Grid, read_volume};
    use glam::DVec3;

    /// A header of a `2 × 2 × 1` grid of bytes with these lines more, and its data.
    fn file(lines: &str) -> Vec<u8> {
        let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 2 1\nencoding: raw\n";
        [header.as_bytes(), lines.as_bytes(), b"\n\x01\x02\x03\x04"].concat()
    }

    fn read(bytes: &[u8]) -> Result<Grid<f32>, VolumeFault> {
        read_volume("grid.nrrd", bytes, None, &LoadOptions::default())
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
        let plane = "may be axes of space: a volume has three";
        for (sizes, lines, expected) in [
            (
                "2 2 1",
                "kinds: RGB-color domain domain",
                "5: axis 1 is not an axis of space: a volume has three axes, and one value per sample",
            ),
            (
                "1 2 2",
                "kinds: domain domain time",
                "5: axis 3 is not an axis of space",
            ),
            (
                "2 2 1",
                "kinds: domain list domain",
                "5: axis 2 is not an axis of space",
            ),
            (
                "2 2 1",
                "kinds: stub domain domain",
                "5: axis 1 is not an axis of space",
            ),
            (
                "2 1 2 1",
                "kinds: domain domain 3-vector domain",
                "5: axis 3 is not an axis of space",
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
                "5: axis 1 is not an axis of space",
            ),
            (
                "2 1 2",
                "space directions: (1,0,0) (0,1,0) (0,0,0)",
                "5: axis 3 is not an axis of space",
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
            let mut source = VolumeSource::of("grid.nhdr", header.as_bytes(), None);
            NrrdHeader::read(&mut source).map(|header| header.data_file)
        };
        for file in [
            "100%.raw",
            "100% done.raw",
            "scan 1 2 3",
            "50%25.raw 1 2 3",
            "LIST.raw",
        ] {
            assert_eq!(name(file), Ok(Some(file.to_owned())));
        }
        for several in [
            "LIST\na.raw\nsp ace.raw",
            "LIST 2\na: b.raw",
            "SKIPLIST\n3 a.raw",
            "s%03d.raw 1 9 1",
            "s%d.raw 9 1 -1 2",
        ] {
            let message = name(several).unwrap_err().to_string();
            assert!(
                message.starts_with("6: the data are spread over several files: "),
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
        let four = with("dimension: 3\nsizes: 2 2 1", "dimension: 4\nsizes: 2 2 2 2");
        let said = "the file has 4 axes, of 2 × 2 × 2 × 2 samples, of which 4 may be axes of space: a volume has three";
        assert!(message(&four).starts_with(said));
        assert!(message(&with("3\nsizes: 2 2 1", "2\nsizes: 2 2")).contains("has 2 axes"));
    }

    #[test]
    fn data_after_lines_and_bytes() {
        let values = |lines: &str, data: &[u8]| {
            let header = format!(
                "NRRD0004\ntype: short\nendian: big\ndimension: 3\nsizes: 2 1 1\nencoding: raw\n\
                 data file: a.raw\n{lines}"
            );
            let (header, options) = (header.as_bytes(), LoadOptions::default());
            let grid = read_volume("grid.nhdr", header, Some(data), &options);
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
                "line skip: 3",
                "the header declares 2 × 1 × 1 samples of int16, 4 bytes, but 0",
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
                "2: `type` must be a type of the format",
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
                "5: `encoding` must be raw, gzip or text",
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
                "6: `spacings` must be a finite, non-zero number for each axis, or NaN if unknown",
            ),
            (
                "spacings: 1 x 1\n",
                "6: `spacings` must be a finite, non-zero number",
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
                "the node spacing must be positive",
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
                "6: `centers` must be the same for all axes",
            ),
            (
                "data file: LIST\n",
                "6: the data are spread over several files",
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
            "the header does not end: a blank line ends it, and then follow the data"
        );
        let long = [b"NRRD0001\n", &b"#\n".repeat(1 << 19)[..]].concat();
        assert_eq!(
            message(&long),
            "the header does not end: a blank line ends it, and then follow the data"
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
        let unended = ", the last, and may have lost digits";
        for (kind, data, expected) in [
            (
                "uchar",
                "1 2 3",
                "the header declares 2 × 2 × 1 samples of uint8, 4 bytes, which",
            ),
            (
                "uchar",
                "100 200 3\n",
                "the header declares 2 × 2 × 1 samples of uint8, but the data end after 3",
            ),
            (
                "uchar",
                "1 2 3 4 5\n",
                "the header declares 2 × 2 × 1 samples of uint8, but there is more data",
            ),
            (
                "uchar",
                "1 2\n three 4",
                "8:2: sample 2 is \"three\", no number",
            ),
            (
                "float",
                "1 2 nan 4 ",
                "voxel (0, 1, 0) in the order of the file holds NaN: values must be finite",
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
