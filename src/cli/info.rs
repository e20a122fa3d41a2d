//! `volref info FILE`

use super::Outcome;
use super::failure::{Exit, Failure, bad_input};
use super::output::{self, Json};
use super::suite::named_scene;
use crate::files::regular_file;
use crate::geometry::Transform;
use crate::math::{Sum, ln};
use crate::scene::{Scene, SceneVolume};
use crate::volume::{
    AxisOrder, Centring, Content, Encoding, Endian, Grid, Layout, LoadOptions, Loaded, LostValues,
    NonFinite, Orientation, Stored, load_hashed, volume_format, volume_formats,
};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Show the contents of a volume file: position, storage, values
#[derive(Debug, clap::Args)]
pub struct Arguments {
    // `help` lists the formats.
    #[arg(help = format!("Volume file: {}; or a scene, or a case of the suite, with a classified volume", volume_formats()))]
    file: PathBuf,
    /// Point clouds: nodes along the longest side of the grid [default: one point per voxel, on
    /// average]
    #[arg(long, value_name = "NODES", value_parser = clap::value_parser!(u64).range(2..=4096))]
    resolution: Option<u64>,
    /// Point clouds: empty nodes on each side
    #[arg(long, value_name = "NODES", default_value_t = 2,
          value_parser = clap::value_parser!(u64).range(0..=1024))]
    padding: u64,
    /// Whether the box ends at the outermost nodes or half a voxel beyond them [default: as in the
    /// file, or else nodes]
    #[arg(long, value_parser = [NODES, CELLS])]
    centring: Option<String>,
    /// Use the stored axes as x, y and z, whatever their direction
    #[arg(long)]
    as_stored: bool,
    /// Arrays and raw samples: the order of the indices [default: as the description says, or else zyx]
    #[arg(long, value_parser = AxisOrder::ALL.map(|(name, _)| name))]
    axes: Option<String>,
    /// Allow the header (or a symbolic link) to refer to data outside its own folder
    #[arg(long)]
    detached_anywhere: bool,
    #[command(flatten)]
    json: Json,
}

/// Names of [`Centring`].
const NODES: &str = "nodes";
const CELLS: &str = "cells";

/// Bars of the histogram.
const BINS: usize = 16;

/// Characters of the longest bar.
const LONGEST_BAR: f64 = 40.0;

#[derive(Serialize)]
struct Info {
    schema: &'static str,
    file: String,
    format: &'static str,
    files: Vec<FileJson>,
    nodes: [usize; 3],
    spacing: [f64; 3],
    first: [f64; 3],
    min: [f64; 3],
    max: [f64; 3],
    centring: &'static str,
    /// Rows of the map of the grid into the world, of oblique axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    to_world: Option<[[f64; 4]; 3]>,
    /// True if the file does not say which of its axes is x.
    #[serde(skip)]
    is_array: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    space: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    cloud: Option<CloudJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stored: Option<StoredJson>,
    values: ValueStatistics,
}

#[derive(Serialize)]
struct FileJson {
    path: String,
    blake3: String,
}

#[derive(Serialize)]
struct CloudJson {
    points: usize,
    min: [f64; 3],
    max: [f64; 3],
}

#[derive(Serialize)]
struct StoredJson {
    sizes: [usize; 3],
    r#type: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    endian: Option<&'static str>,
    encoding: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    scaling: Option<Scaling>,
    #[serde(skip_serializing_if = "Option::is_none")]
    not_in_float32: Option<LostJson>,
}

/// Stored values that 32 bits do not hold: their number, and the first.
#[derive(Serialize)]
struct LostJson {
    count: usize,
    /// Along the stored axes.
    voxel: [usize; 3],
    stored: f64,
    value: f64,
}

/// Summary of the stored samples s, whose values are `slope·s + intercept`.
#[derive(Serialize)]
struct Scaling {
    slope: f64,
    intercept: f64,
    min: f64,
    max: f64,
    mean: f64,
}

/// Statistics of the values of a grid; values that are not finite are only counted.
#[derive(Serialize)]
struct ValueStatistics {
    min: Option<f64>,
    max: Option<f64>,
    mean: Option<f64>,
    zeros: usize,
    non_zeros: usize,
    negative: usize,
    non_finite: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    first_non_finite: Option<NonFiniteJson>,
    histogram: Vec<Bin>,
}

#[derive(Serialize)]
struct NonFiniteJson {
    voxel: [usize; 3],
    value: String,
}

/// The values in `[from, to)`; in the last bin also `to`.
#[derive(Serialize)]
struct Bin {
    from: f64,
    to: f64,
    count: usize,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<Outcome, Failure> {
    output::check(&[arguments.json.file()], &[&arguments.file])?;
    if let Some(file) = scene_file(&arguments.file) {
        let info = of_scene(&Scene::load_volumes(&file)?, &arguments.file)?;
        let text = describe(&info);
        return arguments.json.instead_of(text, &info).map(Outcome::from);
    }
    let mut options = LoadOptions {
        centring: arguments.centring.as_deref().map(|name| match name {
            CELLS => Centring::Cells,
            _ => Centring::Nodes,
        }),
        non_finite: NonFinite::Kept,
        detached_anywhere: arguments.detached_anywhere,
        axes: arguments.axes.as_deref().and_then(AxisOrder::named),
        orientation: Orientation::Oblique,
        ..LoadOptions::default()
    };
    options.splatting.resolution = arguments.resolution.map(|nodes| nodes as usize);
    options.splatting.padding = arguments.padding as usize;
    if arguments.as_stored {
        options.orientation = Orientation::AsStored;
    }
    let loaded = load_hashed(&arguments.file, &options).map_err(bad_input)?;
    let info = info(&arguments, &loaded);
    let text = describe(&info);
    arguments.json.instead_of(text, &info).map(Outcome::from)
}

/// Longest text that is looked at for a scene.
const MOST_BYTES: u64 = 1 << 24;

/// The scene file behind an argument that names a scene or a case; descriptions of raw samples are TOML, too.
fn scene_file(given: &Path) -> Option<PathBuf> {
    let is_case = !given.exists() && given.extension().is_none();
    let file = match is_case {
        true => named_scene(given).ok()?.file,
        false => given.to_owned(),
    };
    let is_toml = file
        .extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("toml"));
    let text = is_toml.then(|| regular_file::read(&file, MOST_BYTES).ok())??;
    let table: toml::Table = String::from_utf8(text).ok()?.parse().ok()?;
    ["classified", "radiative", "curve", "panel"]
        .iter()
        .any(|model| table.contains_key(*model))
        .then_some(file)
}

/// The volume of a scene, of whose panels each shows one.
fn of_scene(volumes: &[SceneVolume], given: &Path) -> Result<Info, Failure> {
    let is_one = |other| volumes.iter().all(|it| Arc::ptr_eq(&it.grid, other));
    let Some(volume) = volumes.first().filter(|first| is_one(&first.grid)) else {
        let count = if volumes.is_empty() {
            "no"
        } else {
            "more than one"
        };
        let message = format!("{} has {count} classified volume", given.display());
        let help = "give the file of a volume, or a scene of one";
        return Err(Failure::new(Exit::BadInput, message, Some(help)));
    };
    let files = volume.inputs.iter().map(|input| FileJson {
        path: input.name.clone(),
        blake3: input.hash.clone(),
    });
    let format = match volume.inputs.is_empty() {
        true => "formula of a scene",
        false => "volume of a scene",
    };
    let placed = placed(&volume.grid, volume.to_world, given, format);
    let files = files.collect();
    Ok(Info { files, ..placed })
}

/// Facts of any grid.
fn placed(
    grid: &Grid<f32>,
    to_world: Option<Transform>,
    given: &Path,
    format: &'static str,
) -> Info {
    let lattice = grid.lattice();
    let bounds = lattice.bounds();
    Info {
        schema: "volref/info/1",
        file: given.display().to_string(),
        format,
        files: Vec::new(),
        nodes: lattice.nodes(),
        spacing: lattice.spacing().to_array(),
        first: lattice.first().to_array(),
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
        centring: match lattice.centring() {
            Centring::Nodes => NODES,
            Centring::Cells => CELLS,
        },
        to_world: to_world.map(|map| map.rows()),
        is_array: false,
        space: None,
        cloud: None,
        stored: None,
        values: ValueStatistics::of(grid),
    }
}

fn info(arguments: &Arguments, loaded: &Loaded) -> Info {
    let placed = placed(
        &loaded.grid,
        loaded.to_world,
        &arguments.file,
        loaded.format,
    );
    let (cloud, stored, space) = match &loaded.stored {
        Stored::Cloud { points, extent } => {
            let cloud = CloudJson {
                points: *points,
                min: extent.min.to_array(),
                max: extent.max.to_array(),
            };
            (Some(cloud), None, None)
        }
        Stored::Samples { layout, lost } => {
            let stored = stored(layout, lost.as_ref(), &placed.values);
            (None, Some(stored), layout.space)
        }
    };
    let files = loaded.files.iter().map(|file| FileJson {
        path: file.path.display().to_string(),
        blake3: file.hash.clone(),
    });
    Info {
        files: files.collect(),
        is_array: volume_format(&arguments.file).is_some_and(|it| it.content == Content::Array)
            && arguments.axes.is_none(),
        space,
        cloud,
        stored,
        ..placed
    }
}

fn stored(layout: &Layout, lost: Option<&LostValues>, values: &ValueStatistics) -> StoredJson {
    let scaling = layout.scaling.and_then(|(slope, intercept)| {
        // Whole numbers come back exactly, but for the rounding of values to f32.
        let sample = |value: f64| {
            let sample = (value - intercept) / slope;
            if layout.element.is_whole() {
                sample.round()
            } else {
                sample
            }
        };
        let (one, other) = (sample(values.min?), sample(values.max?));
        Some(Scaling {
            slope,
            intercept,
            min: one.min(other),
            max: one.max(other),
            mean: (values.mean? - intercept) / slope,
        })
    });
    let order = match layout.endian {
        Endian::Little => "little",
        Endian::Big => "big",
    };
    let binary = layout.encoding != Encoding::Text;
    StoredJson {
        sizes: layout.axes.sizes,
        r#type: layout.element.name(),
        endian: (binary && layout.element.bytes() > 1).then_some(order),
        encoding: match layout.encoding {
            Encoding::Raw => "raw",
            Encoding::Gzip => "gzip",
            Encoding::Zlib => "zlib",
            Encoding::Text => "text",
        },
        scaling,
        not_in_float32: lost.map(|lost| LostJson {
            count: lost.count,
            voxel: lost.voxel,
            stored: lost.stored,
            value: f64::from(lost.stored as f32),
        }),
    }
}

impl ValueStatistics {
    fn of(grid: &Grid<f32>) -> ValueStatistics {
        let finite = || grid.values().iter().copied().filter(|v| v.is_finite());
        let count = |of: fn(f32) -> bool| finite().filter(|&value| of(value)).count();
        let all = finite().count();
        let zeros = count(|value| value == 0.0);
        let (low, high) = finite()
            .map(f64::from)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            });
        let sum: Sum = finite().map(f64::from).collect();
        let some = |value: f64| (all > 0).then_some(value);
        let first = grid.values().iter().position(|value| !value.is_finite());
        ValueStatistics {
            min: some(low),
            max: some(high),
            mean: some(sum.value() / all as f64),
            zeros,
            non_zeros: all - zeros,
            negative: count(|value| value < 0.0),
            non_finite: grid.values().len() - all,
            first_non_finite: first.map(|index| NonFiniteJson {
                voxel: grid.lattice().node(index),
                value: grid.values()[index].to_string(),
            }),
            histogram: histogram(finite(), low, high),
        }
    }
}

/// Bins of equal width from `low` to `high`; a single one if all values are equal.
fn histogram(values: impl Iterator<Item = f32>, low: f64, high: f64) -> Vec<Bin> {
    let width = high - low;
    let bins = match width {
        _ if width > 0.0 => BINS,
        _ if width == 0.0 => 1,
        // No value at all.
        _ => return Vec::new(),
    };
    let mut counts = vec![0; bins];
    for value in values {
        let position = (f64::from(value) - low) / width * bins as f64;
        // All the same gives 0/0, which becomes 0.
        counts[(position as usize).min(bins - 1)] += 1;
    }
    let edge = |bin: usize| low + width * (bin as f64 / bins as f64);
    let bin = |(bin, count)| Bin {
        from: edge(bin),
        to: edge(bin + 1),
        count,
    };
    counts.into_iter().enumerate().map(bin).collect()
}

fn describe(info: &Info) -> String {
    let mut text = format!("{}: {}\n\n", info.file, info.format);
    let mut row = |name: &str, value: String| text.push_str(&format!("{name:<10}  {value}\n"));
    if let Some(cloud) = &info.cloud {
        row("points", cloud.points.to_string());
        row("extent", between(cloud.min, cloud.max));
    }
    let [nx, ny, nz] = info.nodes;
    let count = nx * ny * nz;
    row("nodes", format!("{nx} × {ny} × {nz}, {count} in total"));
    if info.is_array {
        row(
            "axes",
            "z, y, x; an array (x, y, z), as of nibabel, needs `axes = \"xyz\"`".to_owned(),
        );
    }
    let [x, y, z] = info.spacing;
    let spacing = if x == y && y == z {
        digits(x)
    } else {
        vector(info.spacing)
    };
    row("spacing", spacing);
    row("first node", vector(info.first));
    let bounds = between(info.min, info.max);
    row("box", format!("{bounds}, centred on {}", info.centring));
    for (index, numbers) in info.to_world.iter().flatten().enumerate() {
        let name = if index == 0 { "to world" } else { "" };
        row(name, numbers.map(digits).join(", "));
    }
    if let Some(space) = info.space {
        row("space", space.to_owned());
    }
    if let Some(stored) = &info.stored {
        let mut as_stored = stored.r#type.to_owned();
        if let Some(endian) = stored.endian {
            as_stored.push_str(&format!(", {endian} endian"));
        }
        as_stored.push_str(&format!(", {}", stored.encoding));
        if stored.sizes != info.nodes {
            let [a, b, c] = stored.sizes;
            as_stored.push_str(&format!(", {a} × {b} × {c} in other order"));
        }
        row("stored", as_stored);
        if let Some(scaling) = &stored.scaling {
            row("", summary(scaling.min, scaling.max, scaling.mean));
            let plus = format!(" + {}", digits(scaling.intercept)).replace("+ -", "- ");
            row(
                "",
                format!("value = {} · stored{plus}", digits(scaling.slope)),
            );
        }
    }
    let values = &info.values;
    if let (Some(min), Some(max), Some(mean)) = (values.min, values.max, values.mean) {
        row("values", summary(min, max, mean));
    }
    let mut signs = format!("{} zero, {} nonzero", values.zeros, values.non_zeros);
    if values.negative > 0 {
        signs.push_str(&format!(", {} of them negative", values.negative));
    }
    row("", signs);
    if let Some(lost) = info
        .stored
        .as_ref()
        .and_then(|it| it.not_in_float32.as_ref())
    {
        let LostJson {
            count,
            voxel: [i, j, k],
            stored,
            value,
        } = lost;
        let first = format!("voxel ({i}, {j}, {k}), counted as stored: {stored} becomes {value}");
        row(
            "float32",
            format!("does not hold {count}, first at {first}"),
        );
    }
    if let Some(NonFiniteJson { voxel, value }) = &values.first_non_finite {
        let ([i, j, k], count) = (voxel, values.non_finite);
        let first = format!("{count}, first at voxel ({i}, {j}, {k}): {value}");
        row("not finite", first);
    }
    if let Some(file) = info.files.get(1) {
        row("data in", file.path.clone());
    }
    text.push_str(&plot(&values.histogram));
    text
}

/// A bar for each bin. A dominant bin, such as the air around an object, would hide all others:
/// then the bars are logarithmic.
fn plot(bins: &[Bin]) -> String {
    let mut counts: Vec<usize> = bins.iter().map(|bin| bin.count).collect();
    counts.sort_unstable();
    let (Some(&largest), second) = (counts.last(), counts.iter().rev().nth(1)) else {
        return String::new();
    };
    let logarithmic = second.is_some_and(|&second| largest > 10 * second);
    let size = |count: usize| {
        if logarithmic {
            ln(1.0 + count as f64)
        } else {
            count as f64
        }
    };
    let edges = bins.iter().map(|bin| [short(bin.from), short(bin.to)]);
    let widest = |side: usize| {
        edges
            .clone()
            .map(|edge| edge[side].len())
            .max()
            .unwrap_or(0)
    };
    let (from_width, to_width) = (widest(0), widest(1));
    let count_width = largest.to_string().len();
    let scale = if logarithmic {
        ", bars logarithmic"
    } else {
        ""
    };
    let mut text = format!("\nhistogram{scale}\n");
    for (bin, [from, to]) in bins.iter().zip(edges.clone()) {
        let bar = LONGEST_BAR * size(bin.count) / size(largest);
        // A bin that is not empty has a bar.
        let bar = if bin.count > 0 { bar.ceil() } else { 0.0 };
        let line = format!(
            "  {from:>from_width$} to {to:>to_width$}  {:>count_width$}  {}",
            bin.count,
            "▇".repeat(bar as usize)
        );
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn summary(min: f64, max: f64, mean: f64) -> String {
    // Range in all digits of the 32 bits, by which they can be told from their neighbours.
    let [min, max] = [min, max].map(all_digits);
    format!("{min} to {max}, mean {}", digits(mean))
}

fn between(min: [f64; 3], max: [f64; 3]) -> String {
    format!("{} to {}", vector(min), vector(max))
}

fn vector(vector: [f64; 3]) -> String {
    let [x, y, z] = vector.map(digits);
    format!("({x}, {y}, {z})")
}

/// A number to seven significant digits.
fn digits(number: f64) -> String {
    rounded(number, 6)
}

/// A number that 32 bits hold, with the fewest digits that no other has; any other to seven.
fn all_digits(number: f64) -> String {
    let held = number as f32;
    if f64::from(held) != number {
        return digits(number);
    }
    match held.abs() {
        0.0 | 1e-4..1e9 => held.to_string(),
        _ => format!("{held:e}"),
    }
}

/// A number to four significant digits.
fn short(number: f64) -> String {
    rounded(number, 3)
}

fn rounded(number: f64, decimals: usize) -> String {
    let scientific = format!("{number:.decimals$e}");
    let rounded: f64 = scientific.parse().unwrap_or(number);
    let size = rounded.abs();
    if size != 0.0 && !(1e-4..1e9).contains(&size) {
        return format!("{rounded:e}");
    }
    rounded.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_to_seven_digits() {
        for (number, shown) in [
            (0.0, "0"),
            (1.0 / 55.0, "0.01818182"),
            (526.870_91, "526.8709"),
            (-1024.0, "-1024"),
            (1.5e-7, "1.5e-7"),
            (f64::from(f32::MAX), "3.402823e38"),
        ] {
            assert_eq!(digits(number), shown);
        }
    }

    #[test]
    fn every_value_is_in_a_bin() {
        let values = [-1.0, -1.0, 0.0, 0.5, 1.0_f32];
        let bins = histogram(values.into_iter(), -1.0, 1.0);
        let filled: Vec<_> = bins.iter().map(|bin| bin.count).collect();
        assert_eq!(filled, [2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1]);
        let one = histogram([3.0_f32; 4].into_iter(), 3.0, 3.0);
        assert_eq!(
            (one.len(), one[0].count, one[0].from, one[0].to),
            (1, 4, 3.0, 3.0)
        );
        assert!(histogram([].into_iter(), f64::INFINITY, f64::NEG_INFINITY).is_empty());
    }

    #[test]
    fn bars_are_logarithmic_where_one_dwarfs_the_others() {
        let bin = |count| Bin {
            from: 0.0,
            to: 0.5,
            count,
        };
        let linear = plot(&[bin(10), bin(5), bin(0)]);
        assert_eq!(
            linear,
            format!(
                "\nhistogram\n  0 to 0.5  10  {}\n  0 to 0.5   5  {}\n  0 to 0.5   0\n",
                "▇".repeat(40),
                "▇".repeat(20)
            )
        );
        assert!(plot(&[bin(1000), bin(5)]).starts_with("\nhistogram, bars logarithmic\n"));
    }
}
