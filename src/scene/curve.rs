//! A plot of a transfer function instead of a view of a volume.

use super::SceneError;
use super::format::{Absent, Key, Kind, Literal, Range, Table};
use super::reader::Reader;
use crate::media::TransferOpacity;

/// The declaration of `[curve]`.
pub(super) const CURVE: Table = Table {
    doc: "A plot of the transfer function: transparency T(d) and opacity 1 − T(d) over density d.",
    keys: &[Key {
        name: "densities",
        kind: Kind::Number(Range::open(0.0, f64::INFINITY)),
        absent: Absent::Default(Literal::Number(1.2)),
        doc: "Density at the right end of the axis; the left end is 0.",
    }],
    rules: &[],
};

/// A plot of transparency and opacity over density.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What is plotted.
    pub opacity: TransferOpacity,
    /// Density at the right end of the axis, > 0.
    pub densities: f64,
}

impl Curve {
    pub(super) fn read(
        reader: &Reader<'_, '_>,
        opacity: TransferOpacity,
    ) -> Result<Curve, Box<SceneError>> {
        let densities = reader.number("densities")?;
        Ok(Curve { opacity, densities })
    }
}
