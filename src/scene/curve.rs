//! A plot of a transfer function instead of a view of a volume.

use super::SceneResult;
use super::format::{Key, Kind, Range, Table};
use super::reader::Reader;
use super::transfer_function::OpacityByValue;
use crate::optics::{TransferOpacity, TransferPoints};

/// The declaration of `[curve]`.
pub(super) const CURVE: Table = Table::new("A plot of the transfer function: transparency T(d) and opacity 1 − T(d) over density d; of a table of points, opacity over value with the colours below.").keys(&[
    Key::or("densities", Kind::Number(Range::POSITIVE), "1.2")
        .doc("Density at the right end of the axis; the left end is 0. Not with a table of points, whose ends are those of the axis."),
]);

/// A plot of the opacity of a transfer function.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// Transparency and opacity over density.
    Formula {
        /// The opacity plotted.
        opacity: TransferOpacity,
        /// Density at the right end of the axis, > 0.
        densities: f64,
    },
    /// Opacity over the values of a table, with the colours below it.
    Points(TransferPoints),
}

impl Curve {
    /// Reads `[curve]` of the file whose root table is `root`.
    pub(super) fn read(root: &Reader, reader: &Reader) -> SceneResult<Curve> {
        let opacity = OpacityByValue::read(&root.table_or_default("transfer_function")?)?;
        refuse! { root: "camera", "a plot of the curve has no camera"; }
        match opacity {
            OpacityByValue::Formula(opacity) => {
                let densities = reader.get("densities")?;
                Ok(Curve::Formula { opacity, densities })
            }
            OpacityByValue::Points(points) => {
                refuse! { reader:
                    "densities", "the axis of a table of points goes from its first to its last", "remove `densities`";
                }
                Ok(Curve::Points(points))
            }
        }
    }
}
