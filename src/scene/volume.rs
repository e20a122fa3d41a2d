//! The file of a grid, and its options.

use super::SceneResult;
use super::format::{Key, Kind, Range, Rule, Table};
use super::node_formula::{FORMULA, FORMULA_KEYS, ORIGIN, SPACING};
use super::placement::{STEPS, TRANSFORM};
use super::reader::Reader;
use super::record::Choice;
use crate::volume::{
    AxisOrder, Centring, Content, Interpolation, Lattice, LoadOptions, NonFinite, Orientation,
    Splatting, volume_format,
};
use std::path::Path;

/// The declaration of a table that names a volume file.
pub(super) const VOLUME: Table =
    Table::new("The file a grid of densities comes from.").with(&[&KEYS]).keys(&[
        Key::required("file", Kind::Text).doc(FILE),
        ORIENTATION.doc("Grids only: \"world\" (default) permutes and flips the axes of the file to match the world axes and rejects oblique ones; \"as-stored\" uses them as x, y and z unchanged."),
        SPACING.doc("For an .npy or .npz file: distance between nodes along x, y and z, world units; 1 if left out."),
        ORIGIN.doc("For an .npy or .npz file: position of the first node, world units; the origin if left out."),
    ]);

/// Rules of [`PLACED`].
pub(super) const PLACED_RULES: [Rule; 4] = [
    Rule::ExactlyOne("source", &["file", "field"]),
    Rule::Apart([&["file"], &FORMULA_KEYS]),
    Rule::Apart([&["field"], OF_FILES]),
    Rule::Apart([&["transform"], &["scale", "rotate", "translate"]]),
];

/// Keys of volumes from files alone.
const OF_FILES: &[&str] = &[
    "resolution",
    "padding",
    "replace_non_finite",
    "orientation",
    "detached_anywhere",
    "axes",
];

/// The keys of a file, or of a formula, with a map that places the volume in the world.
pub(super) const PLACED: [&[Key]; 4] = [
    &KEYS,
    &[
        Key::optional("file", Kind::Text).doc(FILE),
        ORIENTATION.doc("Grids only: \"world\" (default) keeps the axes of the file where it places them in the world; \"as-stored\" uses them as x, y and z unchanged."),
        TRANSFORM,
    ],
    &STEPS,
    &FORMULA,
];

const FILE: &str = "Point cloud or grid, in a format that `volref info --help` lists, relative to the folder of the scene.";

const ORIENTATION: Key = Key::optional("orientation", Kind::Choice(&["world", "as-stored"]));

const KEYS: [Key; 6] = [
    Key::derived("resolution", Kind::Count(2, 4096), "one point per voxel, on average")
        .doc("Point clouds only: nodes along the longest side of the grid the points are splatted to, padding included."),
    Key::or("padding", Kind::Count(0, 1024), "2")
        .doc("Point clouds only: empty nodes kept around the cloud on each side."),
    Key::optional("centring", Kind::Choice(Centring::WORDS))
        .doc("Grids only: whether the box ends at the outermost nodes, or half a voxel beyond them; a .vol keeps its box, all others their nodes. If left out, as the file says, or else nodes."),
    Key::optional("replace_non_finite", Kind::Number(Range::STORED))
        .doc("Grids only: the value that takes the place of NaN and infinity. If left out, they are an error."),
    Key::optional("detached_anywhere", Kind::Flag)
        .doc("Grids only: whether a header may name a data file outside its own folder, directly or through a symbolic link. Default: false."),
    Key::optional("axes", Kind::Choice(AxisOrder::WORDS))
        .doc("Arrays (.npy, .npz) and described raw samples only: the order of their indices, in memory of C order: of \"zyx\" x runs fastest, of \"xyz\" z does. If left out, as the description says, or else \"zyx\"."),
];

choice! { impl Centring { Nodes = "nodes", Cells = "cells", } }
choice! { impl AxisOrder { Zyx = "zyx", Xyz = "xyz", } }
choice! { impl Interpolation { Trilinear = "trilinear", Nearest = "nearest", } }

/// Keys that files of some contents alone take.
const TAKEN: [(&str, &[Content]); 9] = [
    ("resolution", &[Content::Points]),
    ("padding", &[Content::Points]),
    ("centring", GRIDS),
    ("replace_non_finite", GRIDS),
    ("orientation", GRIDS),
    ("detached_anywhere", GRIDS),
    ("spacing", &[Content::Array]),
    ("origin", &[Content::Array]),
    ("axes", &[Content::Samples, Content::Array]),
];

const GRIDS: &[Content] = &[Content::Grid, Content::Samples, Content::Array];

/// The request of a table that names a volume file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VolumeRequest {
    /// As the scene names it.
    pub file: String,
    /// Options of its reader.
    pub options: LoadOptions,
}

impl VolumeRequest {
    /// The request of a grid, wherever it is, with this value in place of NaN and infinity.
    pub(super) fn of_grid(file: String, replaced: Option<f64>) -> VolumeRequest {
        let mut options = LoadOptions::default();
        if let Some(value) = replaced {
            options.non_finite = NonFinite::Replaced(value as f32);
        }
        options.splatting.padding = 0;
        options.orientation = Orientation::Oblique;
        VolumeRequest { file, options }
    }

    /// The request of a table; `oblique` says whether axes may point anywhere.
    pub(super) fn read(reader: &Reader, oblique: bool) -> SceneResult<VolumeRequest> {
        let file: String = reader.get("file")?;
        let format = volume_format(Path::new(&file));
        let mut options = LoadOptions::default();
        // A file in no known format is reported when it is loaded.
        let content = format.map(|format| format.content);
        for (key, by) in TAKEN {
            if reader.has(key) && content.is_some_and(|it| !by.contains(&it)) {
                let message = format!("`{key}` does not apply to {file:?}");
                return Err(reader.error(key, message));
            }
        }
        options.splatting.padding = 0;
        if matches!(content, None | Some(Content::Points)) {
            let resolution: Option<u32> = reader.get("resolution")?;
            options.splatting = Splatting {
                resolution: resolution.map(|nodes| nodes as usize),
                padding: reader.get::<u32>("padding")? as usize,
            };
        }
        options.centring = reader.get("centring")?;
        if let Some(value) = reader.optional::<f64>("replace_non_finite")? {
            options.non_finite = NonFinite::Replaced(value as f32);
        }
        if reader.optional::<String>("orientation")?.as_deref() == Some("as-stored") {
            options.orientation = Orientation::AsStored;
        } else if oblique {
            options.orientation = Orientation::Oblique;
        }
        options.detached_anywhere = reader.optional("detached_anywhere")?.unwrap_or(false);
        options.axes = reader.get("axes")?;
        options.spacing = reader.get("spacing")?;
        options.origin = reader.get("origin")?;
        if let Some(spacing) = options.spacing {
            reader.accepted(Lattice::check_spacing(spacing))?;
        }
        Ok(VolumeRequest { file, options })
    }
}
