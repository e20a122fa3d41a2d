//! Raw samples in one file, and a TOML file that describes them.
//!
//! ```toml
//! file = "scan.raw"       # beside this file
//! type = "uint16"         # int8 to int64, uint8 to uint64, float16, float32, float64
//! endian = "little"       # or "big"; types of one byte need none
//! nodes = [256, 256, 113] # along x, y and z; x runs fastest in the file
//! spacing = [1, 1, 2]     # between nodes, world units; one number for all axes; 1 if left out
//! origin = [0, 0, 0]      # position of the first node; the origin if left out
//! centring = "nodes"      # or "cells"
//! axes = "zyx"            # of an array (z, y, x) in C order, as above; or "xyz", in which z runs fastest
//! encoding = "raw"        # or "gzip"
//! header_bytes = 0        # to skip before the first sample
//! ```
//!
//! A wrong `endian` cannot be told apart from unusual values.

use super::error::VolumeFault;
use super::load_options::AxisOrder;
use super::orientation::Axes;
use super::samples::{VolumeRead, read_grid};
use super::source::VolumeSource;
use super::{Centring, Element, Encoding, Endian, Lattice, Layout, LoadOptions};
use crate::files::misspelling::escape_remedy;
use crate::geometry::InvalidParameter;
use glam::DVec3;
use serde::Deserialize;
use toml::Spanned;

/// Longest description, in bytes: 1 MiB.
const MOST_BYTES: u64 = 1 << 20;

pub(super) fn read(source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
    let bytes = source.all(
        MOST_BYTES,
        "the samples go into another file, which this names",
    )?;
    let not_text =
        "the description is not UTF-8 text: the samples go into another file, which it names";
    let text = String::from_utf8(bytes).map_err(|_| not_text)?;
    let volume = RawVolume::parse(&text)?;
    volume.read_from(source.open_data(&volume.file, options)?, options)
}

/// A description of a file of raw samples.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawVolume {
    file: String,
    r#type: Spanned<Element>,
    endian: Option<Endian>,
    nodes: Spanned<[usize; 3]>,
    spacing: Option<Spacing>,
    origin: Option<[f64; 3]>,
    centring: Option<Centring>,
    axes: Option<AxisOrder>,
    encoding: Option<Encoding>,
    header_bytes: Option<u64>,
}

/// The distance between nodes along all axes, or along each.
#[derive(Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected one number or three, such as [1, 1, 2.5]"
)]
enum Spacing {
    One(f64),
    Three([f64; 3]),
}

impl RawVolume {
    /// Reads a description.
    fn parse(text: &str) -> Result<RawVolume, VolumeFault> {
        let volume: RawVolume = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let message = error.message().trim();
            let remedy = escape_remedy(message).map_or(String::new(), |it| format!("; {it}"));
            in_line(text, start, &(message.to_owned() + &remedy))
        })?;
        let element = volume.r#type.get_ref();
        if volume.endian.is_none() && element.bytes() > 1 {
            let message = format!(
                "missing `endian`: samples of {} need \"little\" or \"big\"",
                element.name()
            );
            return Err(in_line(text, volume.r#type.span().start, &message));
        }
        volume
            .lattice()
            .map_err(|error| in_line(text, volume.nodes.span().start, &error.message))?;
        Ok(volume)
    }

    /// Positions of the samples, as if x ran fastest.
    fn lattice(&self) -> Result<Lattice, InvalidParameter> {
        let spacing = match self.spacing {
            Some(Spacing::Three(spacing)) => DVec3::from_array(spacing),
            Some(Spacing::One(spacing)) => DVec3::splat(spacing),
            None => DVec3::ONE,
        };
        let first = DVec3::from_array(self.origin.unwrap_or_default());
        let lattice = Lattice::new(*self.nodes.get_ref(), spacing, first)?;
        lattice.with_centring(self.centring.unwrap_or_default())
    }

    fn read_from(&self, source: &mut VolumeSource, options: &LoadOptions) -> VolumeRead {
        let header_bytes = self.header_bytes.unwrap_or(0);
        source.skip(header_bytes)?;
        let mut layout = Layout {
            endian: self.endian.unwrap_or(Endian::Little),
            encoding: self.encoding.unwrap_or(Encoding::Raw),
            ..Layout::raw(*self.r#type.get_ref(), Axes::of(&self.lattice()?))
        };
        if options.axes.or(self.axes).unwrap_or_default() == AxisOrder::Xyz {
            layout.axes = layout.axes.reversed();
        }
        let more = source.remaining.saturating_sub(layout.promised());
        read_grid(source, &layout, &options.of_array()).map_err(|fault| match layout.encoding {
            Encoding::Raw if more > 0 => {
                let header = header_bytes + more;
                format!("{fault}; `header_bytes = {header}` skips a header before the samples")
                    .into()
            }
            _ => fault,
        })
    }
}

/// A mistake at a byte of a description.
fn in_line(text: &str, start: usize, message: &str) -> VolumeFault {
    let before = &text[..start.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let last = before.rsplit('\n').next().unwrap_or_default();
    VolumeFault::Line(format!("{line}:{}: {message}", last.chars().count() + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::{Grid, read_volume};

    fn read(text: &str, samples: &[u8]) -> Result<Grid<f32>, VolumeFault> {
        read_volume(
            "grid.toml",
            text.as_bytes(),
            Some(samples),
            &LoadOptions::default(),
        )
    }

    const WHOLE: &str = "file = \"a.raw\"\ntype = \"int16\"\nendian = \"big\"\nnodes = [2, 1, 1]\n";

    fn message(text: &str) -> String {
        RawVolume::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn what_may_be_left_out() {
        assert_eq!(RawVolume::parse(WHOLE).unwrap().file, "a.raw");
        let grid = read(WHOLE, &[0, 1, 255, 254]).unwrap();
        assert_eq!(grid.values(), [1.0, -2.0]);
        assert_eq!(grid.lattice().spacing(), DVec3::ONE);
        assert_eq!(grid.lattice().first(), DVec3::ZERO);
        let more = format!("{WHOLE}spacing = 2\norigin = [1, 2.5, 3]\ncentring = \"cells\"\n");
        let grid = read(&more, &[0; 4]).unwrap();
        assert_eq!(grid.lattice().spacing(), DVec3::splat(2.0));
        assert_eq!(grid.lattice().bounds().min, DVec3::new(0.0, 1.5, 2.0));
    }

    #[test]
    fn mistakes_have_a_place() {
        for (old, new, expected) in [
            (
                "file = ",
                "fiel = ",
                "1:1: unknown field `fiel`, expected one of `file`",
            ),
            ("\"a.raw\"", "a.raw", "1:8: "),
            (
                "int16",
                "short",
                "2:8: unknown variant `short`, expected one of `int8`, `uint8`",
            ),
            (
                "endian = \"big\"\n",
                "",
                "2:8: missing `endian`: samples of int16 need",
            ),
            (
                "\"big\"",
                "\"middle\"",
                "3:10: unknown variant `middle`, expected `little` or `big`",
            ),
            (
                "[2, 1, 1]",
                "[2, 0, 1]",
                "4:9: a grid of 2 × 0 × 1 nodes has no node",
            ),
            (
                "[2, 1, 1]",
                "[2, -1, 1]",
                "4:13: invalid value: integer `-1`, expected usize",
            ),
            (
                "nodes",
                "header_bytes = -1\nnodes",
                "4:16: invalid value: integer `-1`, expected u64",
            ),
            (
                "nodes",
                "spacing = [1, 2]\nnodes",
                "4:11: expected one number or three",
            ),
            (
                "nodes",
                "spacing = \"1\"\nnodes",
                "4:11: expected one number or three",
            ),
            (
                "nodes",
                "origin = 0\nnodes",
                "4:10: invalid type: integer `0`, expected an array of length 3",
            ),
            (
                "[2, 1, 1]",
                "[1048576, 1048576, 1048576]",
                "4:9: a grid of 1048576 × 1048576",
            ),
            (
                "[2, 1, 1]",
                "[2, 1]",
                "4:9: invalid length 2, expected an array of length 3",
            ),
            (
                "nodes",
                "spacing = [1, nan, 1]\nnodes",
                "5:9: the node spacing must be positive",
            ),
            (
                "nodes",
                "spacing = 0\nnodes",
                "5:9: the node spacing must be positive",
            ),
            (
                "nodes",
                "spacing = -1.5\nnodes",
                "5:9: the node spacing must be positive",
            ),
            (
                "nodes",
                "spacing = 2\norigin = [0, nan, 0]\nnodes",
                "6:9: the position of the first node must be finite",
            ),
            (
                "nodes",
                "encoding = \"hex\"\nnodes",
                "4:12: unknown variant `hex`, expected `raw` or `gzip`",
            ),
            ("nodes = [2, 1, 1]\n", "", "1:1: missing field `nodes`"),
        ] {
            assert!(WHOLE.contains(old));
            let message = message(&WHOLE.replacen(old, new, 1));
            assert!(message.starts_with(expected), "{new}: {message}");
        }
    }

    #[test]
    fn samples_that_are_not_as_described() {
        let text = format!("{WHOLE}header_bytes = 3\n");
        let message = |bytes: &[u8]| read(&text, bytes).unwrap_err().to_string();
        assert!(message(&[0; 2]).contains("4 bytes, but 0 bytes follow it"));
        assert!(message(&[0; 6]).starts_with("the header declares 2 × 1 × 1 samples of int16, 4"));
        let more = message(&[0; 8]);
        assert!(more.contains("has extra data"), "{more}");
        assert!(
            more.ends_with("; `header_bytes = 4` skips a header before the samples"),
            "{more}"
        );
    }
}
