//! The grid of a classified volume by a formula, in place of a file.

use super::SceneResult;
use super::format::{Key, Kind, Range};
use super::reader::Reader;
use super::record::Record;
use crate::volume::{Centring, Lattice, NodeFormula};
use glam::DVec3;

/// Nodes along an axis, at most: those of a grid of one row.
const MOST: u64 = NodeFormula::MOST_NODES as u64;

/// Keys that belong to `field` alone.
pub(super) const FORMULA_KEYS: [&str; 6] = ["nodes", "value", "slope", "every", "bright", "spot"];

/// Distance between nodes, of formulas and of files that state none.
pub(super) const SPACING: Key = Key::optional("spacing", Kind::Vector)
    .doc("With `field` or an .npy or .npz file: distance between nodes along x, y and z, world units; 1 if left out.");

/// Position of the first node, likewise.
pub(super) const ORIGIN: Key = Key::optional("origin", Kind::Vector)
    .doc("With `field` or an .npy or .npz file: position of the first node, world units; the origin if left out.");

/// The declarations of `field` and its keys.
pub(super) const FORMULA: [Key; 9] = [
    Key::optional("field", Kind::Choice(&["ramp", "spots"]))
        .doc("In place of `file`, a formula for the value of node (i, j, k), counted from 0: \"ramp\" is `value` + `slope`·(i, j, k); \"spots\" is `value` but at single nodes. Values that 32-bit numbers do not hold exactly are refused."),
    Key::optional("nodes", Kind::Counts(1, MOST))
        .doc("With `field`: nodes along x, y and z, in all at most 2^27, which take 512 MiB."),
    SPACING,
    ORIGIN,
    Key::optional("value", Kind::Number(Range::STORED))
        .doc("With `field`: of a ramp, the value of the first node; of spots, that of all other nodes; 0 if left out."),
    Key::optional("slope", Kind::Vector)
        .doc("For a ramp: the change from node to node along x, y and z. Powers of two are exact."),
    Key::optional("every", Kind::Count(2, MOST))
        .doc("For spots: edge of a brick, in nodes. A spot lies at nodes whose numbers are multiples of it; along a shorter axis, at the middle node."),
    Key::optional("bright", Kind::Number(Range::STORED))
        .doc("For spots: the value at the nodes of `every`; 1 if left out."),
    Key::optional("spot", Kind::Tables(&Spot::TABLE))
        .doc("For spots: single nodes, with their values."),
];

record! {
    struct Spot in "A node with a value of its own." {
        node: [u64; 3] = required Counts(0, MOST - 1), "Its numbers along x, y and z, counted from 0.";
        value: f64 = or("1.0") Number(Range::STORED), "Its value.";
    }
}

/// The formula of a volume table, and the lattice of its nodes.
pub(super) fn read_formula(reader: &Reader) -> SceneResult<(NodeFormula, Lattice)> {
    let is_ramp = reader.get::<String>("field")? == "ramp";
    let lattice = read_lattice(reader)?;
    let value = reader.optional("value")?.unwrap_or(0.0);
    let slope = reader.get::<Option<DVec3>>("slope")?;
    if let Some(slope) = slope.filter(|_| is_ramp) {
        return Ok((NodeFormula::Ramp { value, slope }, lattice));
    }
    let every: Option<u32> = reader.get("every")?;
    let every = match every {
        Some(nodes) => Some((nodes as usize, reader.optional("bright")?.unwrap_or(1.0))),
        None => None,
    };
    let spots = reader.tables("spot")?;
    refuse! { reader:
        "field" if is_ramp, "the field \"ramp\" needs `slope`, its change from node to node",
            "give it, such as slope = [0.5, 0, 0.25]";
        "field" if every.is_none() && spots.is_empty(), "the field \"spots\" has none",
            "give `every`, such as every = 32, or `spot`, such as spot = [{ node = [3, 4, 5] }]";
    }
    let spot = |spot: &Reader| {
        let Spot { node, value } = Record::read(spot)?;
        Ok((node.map(|index| index as usize), value))
    };
    let formula = NodeFormula::Spots {
        value,
        every,
        spots: spots.iter().map(spot).collect::<SceneResult<_>>()?,
    };
    Ok((formula, lattice))
}

fn read_lattice(reader: &Reader) -> SceneResult<Lattice> {
    refuse! { reader:
        "field" if !reader.has("nodes"), "a formula needs `nodes`, the size of its grid",
            "give it, such as nodes = [64, 64, 32]";
    }
    let nodes @ [x, y, z]: [u64; 3] = reader.get("nodes")?;
    let count = x.checked_mul(y).and_then(|plane| plane.checked_mul(z));
    refuse! { reader:
        "nodes" if count.is_none_or(|count| count > MOST), format!(
            "{x} × {y} × {z} nodes are too many: a formula is computed at no more than 2^27, which take 512 MiB"
        ), "give fewer nodes, or a file of that size";
    }
    let spacing = reader.optional("spacing")?.unwrap_or(DVec3::ONE);
    let first = reader.optional("origin")?.unwrap_or(DVec3::ZERO);
    let centring: Option<Centring> = reader.get("centring")?;
    let lattice = Lattice::new(nodes.map(|count| count as usize), spacing, first)
        .and_then(|lattice| lattice.with_centring(centring.unwrap_or_default()));
    reader.accepted(lattice)
}
