//! Bare samples in one file, and a TOML file that says what they are.
//!
//! ```toml
//! file = "scan.raw"       # beside this file
//! type = "uint16"         # int8 to int64, uint8 to uint64, float16, float32, float64
//! endian = "little"       # or "big"; types of one byte need none
//! nodes = [256, 256, 113] # along x, y and z; x runs fastest in the file
//! spacing = [1, 1, 2]     # between nodes, world units; one number for all axes; 1 if left out
//! origin = [0, 0, 0]      # position of the first node; the origin if left out
//! centring = "nodes"      # or "cells"
//! encoding = "raw"        # or "gzip"
//! header_bytes = 0        # to skip before the first sample
//! ```
//!
//! A wrong `endian` cannot be told from odd values.

use super::error::VolumeError;
use super::orientation::{Axes, AxisSteps};
use super::reader::{Stored, VolumeReader};
use super::samples::{check_sizes, read_grid};
use super::source::VolumeSource;
use super::{
    Centring, Element, Encoding, Endian, Grid, LatticeError, Layout, LoadOptions, Orientation,
    SamplesError,
};
use glam::DVec3;
use serde::Deserialize;
use std::io::{self, BufRead, Read};
use std::ops::Range;
use thiserror::Error;
use toml::Spanned;

/// Why a description is none, or does not describe its file.
#[derive(Debug, Error)]
pub enum RawVolumeError {
    /// Not text.
    #[error("the description is not UTF-8 text: the samples go into another file, which it names")]
    NotText,
    /// No description is that long.
    #[error("the description has {0} bytes: the samples go into another file, which it names")]
    TooLong(u64),
    /// A mistake at a place of the description.
    #[error("{line}:{column}: {message}")]
    Description {
        /// Counted from 1.
        line: usize,
        /// Counted from 1, in characters.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// More nodes than a lattice may have.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The samples are not what the description says.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// A header longer than the file.
    #[error("`header_bytes` is {header_bytes}, and the file of the samples has {bytes} bytes")]
    Skip {
        /// Bytes to skip.
        header_bytes: u64,
        /// Bytes there are.
        bytes: u64,
    },
}

/// Longest description, in bytes: 1 MiB.
const MOST_BYTES: u64 = 1 << 20;

/// Reader of bare samples by their description.
#[derive(Clone, Copy, Debug)]
pub struct BareSamples;

impl VolumeReader for BareSamples {
    fn name(&self) -> &'static str {
        "bare samples, described in TOML"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &[".toml"]
    }

    fn read(
        &self,
        source: &mut VolumeSource,
        options: &LoadOptions,
    ) -> Result<(Grid<f32>, Stored), VolumeError> {
        if source.length() > MOST_BYTES {
            return Err(source.fault(RawVolumeError::TooLong(source.length())));
        }
        let text = String::from_utf8(source.bytes(MOST_BYTES)?);
        let text = text.map_err(|_| source.fault(RawVolumeError::NotText))?;
        let volume = RawVolume::parse(&text).map_err(|error| fault(source, error))?;
        let data = source.open_data(&volume.file, options)?;
        let length = data.length();
        let grid = volume.read_from(data, length, options);
        let grid = grid.map_err(|error| fault(source, error))?;
        Ok((grid, Stored::Samples(volume.layout)))
    }
}

fn fault(source: &VolumeSource, error: RawVolumeError) -> VolumeError {
    if matches!(error, RawVolumeError::Description { .. }) {
        source.fault_in_line(error)
    } else {
        source.fault(error)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    file: Spanned<String>,
    r#type: Spanned<String>,
    endian: Option<Spanned<String>>,
    nodes: Spanned<[u64; 3]>,
    spacing: Option<Spanned<Spacing>>,
    origin: Option<[f64; 3]>,
    centring: Option<Spanned<String>>,
    encoding: Option<Spanned<String>>,
    header_bytes: Option<u64>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Spacing {
    One(f64),
    Three([f64; 3]),
}

/// A description of a file of bare samples.
#[derive(Clone, Debug, PartialEq)]
pub struct RawVolume {
    pub(super) layout: Layout,
    pub(super) file: String,
    header_bytes: u64,
}

impl RawVolume {
    /// Reads a description.
    pub fn parse(text: &str) -> Result<RawVolume, RawVolumeError> {
        let at = |span: Option<Range<usize>>, message: &str| {
            let before = &text[..span.map_or(0, |span| span.start).min(text.len())];
            let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
            RawVolumeError::Description {
                line: before.matches('\n').count() + 1,
                column: before[line_start..].chars().count() + 1,
                message: message.to_owned(),
            }
        };
        let description: Description =
            toml::from_str(text).map_err(|error| at(error.span(), error.message().trim()))?;
        let element = choice(&description.r#type, &Element::ALL).map_err(|message| {
            at(
                Some(description.r#type.span()),
                &format!("`type` {message}"),
            )
        })?;
        // The value of a word that may be left out.
        fn optional<T: Copy>(
            key: &str,
            word: Option<&Spanned<String>>,
            words: &[(&str, T)],
        ) -> Result<Option<T>, (Range<usize>, String)> {
            let Some(word) = word else { return Ok(None) };
            let found = choice(word, words);
            let found = found.map_err(|message| (word.span(), format!("`{key}` {message}")));
            found.map(Some)
        }
        let wrong = |(span, message): (Range<usize>, String)| at(Some(span), &message);
        let endians = [("little", Endian::Little), ("big", Endian::Big)];
        let endian = optional("endian", description.endian.as_ref(), &endians).map_err(wrong)?;
        let centrings = [("nodes", Centring::Nodes), ("cells", Centring::Cells)];
        let centring =
            optional("centring", description.centring.as_ref(), &centrings).map_err(wrong)?;
        let encodings = [("raw", Encoding::Raw), ("gzip", Encoding::Gzip)];
        let encoding =
            optional("encoding", description.encoding.as_ref(), &encodings).map_err(wrong)?;
        if endian.is_none() && element.bytes() > 1 {
            let message = format!(
                "missing `endian`: samples of {} need \"little\" or \"big\"",
                element.name()
            );
            return Err(at(Some(description.r#type.span()), &message));
        }
        let of_nodes = |error: LatticeError| at(Some(description.nodes.span()), &error.to_string());
        let sizes = check_sizes(*description.nodes.get_ref()).map_err(of_nodes)?;
        let spacing = match description.spacing.as_ref().map(Spanned::get_ref) {
            None => DVec3::ONE,
            Some(Spacing::One(spacing)) => DVec3::splat(*spacing),
            Some(Spacing::Three(spacing)) => DVec3::from_array(*spacing),
        };
        let axes = Axes {
            sizes,
            steps: AxisSteps::Upright(spacing),
            first: DVec3::from_array(description.origin.unwrap_or_default()),
            centring: centring.unwrap_or_default(),
        };
        if let Err(error) = axes.placement(None, Orientation::World) {
            let span = description.spacing.as_ref().map(Spanned::span);
            return Err(at(span, &error.to_string()));
        }
        if description.file.get_ref().is_empty() {
            let span = Some(description.file.span());
            return Err(at(
                span,
                "`file` is empty: it names the file of the samples",
            ));
        }
        Ok(RawVolume {
            layout: Layout {
                axes,
                element,
                endian: endian.unwrap_or(Endian::Little),
                encoding: encoding.unwrap_or(Encoding::Raw),
                scaling: None,
            },
            file: description.file.into_inner(),
            header_bytes: description.header_bytes.unwrap_or(0),
        })
    }

    /// The file of the samples, as the description names it.
    pub fn data_file(&self) -> &str {
        &self.file
    }

    /// Reads the samples from `bytes`, the file that the description names.
    pub fn read_data(
        &self,
        bytes: &[u8],
        options: &LoadOptions,
    ) -> Result<Grid<f32>, RawVolumeError> {
        let mut source = bytes;
        self.read_from(&mut source, bytes.len() as u64, options)
    }

    /// Reads the samples from a source of `length` bytes.
    pub(super) fn read_from(
        &self,
        source: &mut impl BufRead,
        length: u64,
        options: &LoadOptions,
    ) -> Result<Grid<f32>, RawVolumeError> {
        let header_bytes = self.header_bytes;
        let remaining = length.checked_sub(header_bytes);
        let remaining = remaining.ok_or(RawVolumeError::Skip {
            header_bytes,
            bytes: length,
        })?;
        io::copy(&mut source.by_ref().take(header_bytes), &mut io::sink())
            .map_err(SamplesError::Read)?;
        Ok(read_grid(source, remaining, &self.layout, options)?)
    }
}

/// The value that a word stands for, or what is wrong with it.
fn choice<T: Copy>(word: &Spanned<String>, words: &[(&str, T)]) -> Result<T, String> {
    let found = words.iter().find(|(name, _)| name == word.get_ref());
    found.map(|(_, value)| *value).ok_or_else(|| {
        let known: Vec<_> = words.iter().map(|(name, _)| format!("{name:?}")).collect();
        format!(
            "takes one of {}, got {:?}",
            known.join(", "),
            word.get_ref()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: &str = "file = \"a.raw\"\ntype = \"int16\"\nendian = \"big\"\nnodes = [2, 1, 1]\n";

    fn message(text: &str) -> String {
        RawVolume::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn what_may_be_left_out() {
        let volume = RawVolume::parse(WHOLE).unwrap();
        assert_eq!(volume.data_file(), "a.raw");
        let grid = volume.read_data(&[0, 1, 255, 254], &LoadOptions::default());
        let grid = grid.unwrap();
        assert_eq!(grid.values(), [1.0, -2.0]);
        assert_eq!(grid.lattice().spacing(), DVec3::ONE);
        assert_eq!(grid.lattice().first(), DVec3::ZERO);
        let more = format!("{WHOLE}spacing = 2\norigin = [1, 2.5, 3]\ncentring = \"cells\"\n");
        let volume = RawVolume::parse(&more).unwrap();
        let grid = volume.read_data(&[0; 4], &LoadOptions::default()).unwrap();
        assert_eq!(grid.lattice().spacing(), DVec3::splat(2.0));
        assert_eq!(grid.lattice().bounds().min, DVec3::new(0.0, 1.5, 2.0));
    }

    #[test]
    fn mistakes_have_a_place() {
        for (old, new, expected) in [
            ("file = ", "fiel = ", "1:1: unknown field `fiel`"),
            ("\"a.raw\"", "\"\"", "1:8: `file` is empty"),
            ("\"a.raw\"", "a.raw", "1:8: "),
            (
                "int16",
                "short",
                "2:8: `type` takes one of \"int8\", \"uint8\"",
            ),
            (
                "endian = \"big\"\n",
                "",
                "2:8: missing `endian`: samples of int16 need",
            ),
            (
                "\"big\"",
                "\"middle\"",
                "3:10: `endian` takes one of \"little\", \"big\"",
            ),
            (
                "[2, 1, 1]",
                "[2, 0, 1]",
                "4:9: a grid of 2 × 0 × 1 nodes has no node",
            ),
            ("[2, 1, 1]", "[2, -1, 1]", "4:"),
            (
                "[2, 1, 1]",
                "[1048576, 1048576, 1048576]",
                "4:9: a grid of 1048576 × 1048576",
            ),
            ("[2, 1, 1]", "[2, 1]", "4:"),
            (
                "nodes",
                "spacing = [1, nan, 1]\nnodes",
                "4:11: the node spacing must be positive",
            ),
            (
                "nodes",
                "spacing = 0\nnodes",
                "4:11: the node spacing must be positive",
            ),
            (
                "nodes",
                "spacing = -1.5\nnodes",
                "4:11: the node spacing must be positive",
            ),
            (
                "nodes",
                "encoding = \"hex\"\nnodes",
                "4:12: `encoding` takes one of \"raw\"",
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
        let volume = RawVolume::parse(&format!("{WHOLE}header_bytes = 3\n")).unwrap();
        let message = |bytes: &[u8]| {
            let read = volume.read_data(bytes, &LoadOptions::default());
            read.unwrap_err().to_string()
        };
        assert_eq!(
            message(&[0; 2]),
            "`header_bytes` is 3, and the file of the samples has 2 bytes"
        );
        assert!(message(&[0; 6]).starts_with("the header promises 2 × 1 × 1 samples of int16, 4"));
        assert!(message(&[0; 8]).contains("holds something else as well"));
    }
}
