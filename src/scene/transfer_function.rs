//! Transfer functions: the assignment's formula or a table of points.

use super::format::{Key, Kind, Range, Rule, Table};
use super::placement::PlacedGrid;
use super::reader::Reader;
use super::record::Record;
use super::{Length, SceneResult};
use crate::optics::{
    Appearance, Colormap, TransferFunction, TransferOpacity, TransferPoint, TransferPoints,
};

/// The declaration of `[transfer_function]`.
pub(super) const TRANSFER_FUNCTION: Table = Table::new("Opacity over the reference length and colour, by density. Either transparency T(d) = (exp(−d²) − floor)/(1 − floor), clamped to [0, 1], with a colour by name; or a table of points, for values of any kind.").keys(&[
    Key::or("floor", Kind::Number(Range::half_open(0.0, 1.0)), "0.36")
        .doc("Value of exp(−d²) that counts as opaque."),
    Key::or("reference_length", Kind::Length, "'1 voxel'")
        .doc("Path length over which the transparency is stated, world units or voxels."),
    Key::or("colormap", Kind::Choice(Colormap::NAMES), "'heat'")
        .doc("Colours for densities 0 to 1."),
    Key::optional("range", Kind::Interval(Range::STORED))
        .doc("Values [lo, hi] that stand for densities 0 and 1, and all between for those between; beyond its ends they count as the nearer end. With `point`, its values are these densities. If left out, the values are densities; those of a file that leave 0 to 1 have the range from their 1st to their 99.9th percentile, with `mode = \"sum\"` times the longest edge of the box."),
    Key::optional("point", Kind::Tables(&TransferPoint::TABLE))
        .doc("A table in place of floor and colormap: points in order of their values, joined by straight lines, constant beyond the outermost; two points at one value make a step, where the later holds at the value itself."),
]).rules(&[Rule::Apart([&["point"], &["floor", "colormap"]])]);

record! {
    impl TransferPoint in "Colour and opacity of one value of the volume." {
        value = required Number(Range::STORED),
            "Value of the volume, in the unit of its file; with `range`, its position in that, from 0 to 1.";
        colour = required Colour(Range::NOT_NEGATIVE), "Linear radiance of the material before shading.";
        opacity = required Number(Range::UNIT),
            "Opacity over the reference length: the fraction of the light behind that is absorbed.";
    }
}

/// What a transfer function says of opacity, by whichever of the two ways.
#[derive(Clone)]
pub(super) enum OpacityByValue {
    /// By the formula; the colours are named apart.
    Formula(TransferOpacity),
    /// By a table, which holds the colours too.
    Points(TransferPoints),
}

impl OpacityByValue {
    pub(super) fn read(reader: &Reader) -> SceneResult<OpacityByValue> {
        if reader.has("point") {
            let range = interval(reader)?;
            let points = read_points(reader, |point: TransferPoint| TransferPoint {
                // Exactly the ends of the range at 0 and 1.
                value: range.map_or(point.value, |[low, high]| {
                    low * (1.0 - point.value) + high * point.value
                }),
                ..point
            });
            return Ok(OpacityByValue::Points(points?));
        }
        let floor = reader.get("floor")?;
        Ok(OpacityByValue::Formula(TransferOpacity { floor }))
    }
}

/// The tables `point`, of each of which `point` makes one, in order of their values.
pub(super) fn read_points<R: Record>(
    reader: &Reader,
    point: impl Fn(R) -> TransferPoint,
) -> SceneResult<TransferPoints> {
    let rows = reader.tables("point")?;
    let points = rows.iter().map(|row| R::read(row).map(&point));
    TransferPoints::new(points.collect::<SceneResult<_>>()?).map_err(|error| match error.index {
        None => reader.error("point", error.message),
        Some(index) => rows[index].error("value", error.message),
    })
}

/// The key `range`, which holds more than a number.
fn interval(reader: &Reader) -> SceneResult<Option<[f64; 2]>> {
    let range = reader.get::<Option<[f64; 2]>>("range")?;
    if let Some([low, high]) = range {
        refuse! { reader:
            "range" if low >= high,
                format!("the range from {low} to {high} is empty: its second number must be above its first");
        }
    }
    Ok(range)
}

/// The range of values of a formula: that of its table, read by `table`, or, without it, that of a `volume` from a
/// file whose values are not all in [0, 1].
pub(super) fn read_range(
    table: &Reader,
    volume: &Reader,
    is_shared: bool,
    placed: &PlacedGrid,
    is_sum: bool,
) -> SceneResult<Option<[f64; 2]>> {
    if let Some(range) = interval(table)? {
        return Ok(Some(range));
    }
    let (least, most) = placed.grid.range();
    if volume.has("field") || (least >= 0.0 && most <= 1.0) {
        return Ok(None);
    }
    let mut range = placed.grid.usual_range();
    let mut rule = "1st to 99.9th percentile of the values of the file";
    if is_sum {
        let edge = placed.extent().world_bounds().size().max_element();
        range = range.map(|value| value * edge);
        rule =
            "1st to 99.9th percentile of the values of the file, times the longest edge of the box";
    }
    match is_shared {
        true => volume.derived("transfer_function.range", format!("{range:?}"), rule),
        false => table.derived("range", format!("{range:?}"), rule),
    }
    Ok(Some(range))
}

/// The rest of the transfer function, once the grid gives the length of a voxel.
pub(super) fn read_transfer_function(
    reader: &Reader,
    opacity: OpacityByValue,
    range: Option<[f64; 2]>,
    voxel: f64,
) -> SceneResult<TransferFunction> {
    let reference_length = reader
        .get::<Length>("reference_length")?
        .in_world_units(voxel);
    let reference_length = reader.accepted_at("reference_length", reference_length)?;
    let appearance = match opacity {
        OpacityByValue::Points(points) => Appearance::Points(points),
        OpacityByValue::Formula(opacity) => {
            let colormap: String = reader.get("colormap")?;
            let colormap = Colormap::named(&colormap).expect("one of the declared names");
            Appearance::Formula {
                opacity,
                colormap,
                range,
            }
        }
    };
    Ok(TransferFunction {
        appearance,
        reference_length,
    })
}
