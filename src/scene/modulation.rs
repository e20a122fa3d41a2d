//! Modulation: a second number at each place, by which opacities are multiplied.

use super::SceneResult;
use super::files::Files;
use super::format::{Key, Kind, Range, Rule, Table};
use super::placement::PlacedGrid;
use super::reader::Reader;
use super::record::Record;
use super::transfer_function::read_points;
use super::volume::VolumeRequest;
use crate::optics::{TransferPoint, TransferPoints};
use crate::volume::{Cell, Grid, Interpolation, gradient_lengths};
use glam::DVec3;
use std::sync::Arc;

/// The declaration of `[classified.volume.modulation]`.
pub(super) const MODULATION: Table = Table::new("Multiplies opacities over the reference length by a factor, by a second number at each place: the length of the gradient, or the values of another file.").keys(&[
    Key::optional("of", Kind::Choice(&["gradient"]))
        .doc("The second number: the length of the gradient at the nodes, by central differences, in values per world unit."),
    Key::optional("file", Kind::Text)
        .doc("A grid of the second number at as many nodes as the volume has, which are taken for the same, wherever the file puts them."),
    Key::optional("replace_non_finite", Kind::Number(Range::STORED))
        .doc("With `file`: the value that takes the place of NaN and infinity. If left out, they are an error."),
    Key::required("point", Kind::Tables(&Point::TABLE))
        .doc("Factors, in order of the second number, joined by straight lines and constant beyond the outermost."),
]).rules(&[
    Rule::ExactlyOne("source", &["of", "file"]),
    Rule::Apart([&["of"], &["replace_non_finite"]]),
]);

record! {
    struct Point in "The factor of one number." {
        value: f64 = required Number(Range::STORED), "The second number.";
        factor: f64 = required Number(Range::UNIT), "Factor of the opacity.";
    }
}

/// Factors of opacity by a second field.
#[derive(Clone, Debug)]
pub struct Modulation {
    /// The second number at the nodes of the volume.
    pub grid: Arc<Grid<f32>>,
    /// Factors as opacities, without colours.
    pub factors: TransferPoints,
}

impl Modulation {
    pub(super) fn read(
        volume: &Reader,
        placed: &PlacedGrid,
        files: &mut Files,
    ) -> SceneResult<Option<Modulation>> {
        let Some(reader) = volume.table("modulation")? else {
            return Ok(None);
        };
        let factors = read_points(&reader, |point: Point| TransferPoint {
            value: point.value,
            colour: DVec3::ZERO,
            opacity: point.factor,
        })?;
        reader.optional::<String>("of")?;
        let grid = match reader.get("file")? {
            None => Arc::new(gradient_lengths(&placed.grid, placed.to_world.as_ref())),
            Some(file) => {
                let replaced = reader.get("replace_non_finite")?;
                let request = VolumeRequest::of_grid(file, replaced);
                let grid = files.loaded(&reader, request)?.grid;
                let [own, other] = [&placed.grid, &grid].map(|grid| grid.lattice().nodes());
                if own != other {
                    let message = format!(
                        "the volume has {own:?} nodes, and this file {other:?}: it holds one number for each"
                    );
                    let help = "resample one of them to the nodes of the other";
                    return Err(reader.mistake("file", message, help));
                }
                // At the nodes of the volume, wherever its own file says that it is.
                let values = grid.values().to_vec();
                Arc::new(Grid::new(*placed.grid.lattice(), values).expect("as many nodes"))
            }
        };
        Ok(Some(Modulation { grid, factors }))
    }

    /// The factor of the opacity at a place in `cell`, in [0, 1].
    pub fn factor(&self, interpolation: Interpolation, cell: &Cell) -> f64 {
        self.factors.opacity(interpolation.read(&*self.grid, cell))
    }
}
