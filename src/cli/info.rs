//! `volref info FILE`

use super::Outcome;
use super::failure::{Failure, bad_input};
use super::output::{self, Json};
use crate::math::{Sum, ln};
use crate::report::widest;
use crate::volume::{
    Centring, Encoding, Endian, FileRead, Grid, Layout, LoadOptions, Loaded, NonFinite,
    Orientation, Stored, load_hashed, volume_formats,
};
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Show the contents of a volume file: position, storage, values
#[derive(Debug, clap::Args)]
pub struct Arguments {
    // `help` lists the formats.
    #[arg(help = format!("Volume file: {}", volume_formats()))]
    file: PathBuf,
    /// Allow the header (or a symbolic link) to refer to data outside its own folder
    #[arg(long)]
    detached_anywhere: bool,
    #[command(flatten)]
    json: Json,
}

/// Bars of the histogram.
const BINS: usize = 16;

/// Characters of the longest bar.
const LONGEST_BAR: f64 = 40.0;

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
    first_non_finite: Option<FirstNonFinite>,
    histogram: Vec<Bin>,
}

#[derive(Serialize)]
struct FirstNonFinite {
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
    let options = LoadOptions {
        non_finite: NonFinite::Kept,
        detached_anywhere: arguments.detached_anywhere,
        orientation: Orientation::Oblique,
        ..LoadOptions::default()
    };
    let loaded = load_hashed(&arguments.file, &options).map_err(bad_input)?;
    let facts = Facts::of(&arguments.file, &loaded);
    let text = arguments.json.instead_of(facts.text, &facts.json);
    text.map(Outcome::from)
}

/// Facts as a table of names and values, and as JSON.
struct Facts {
    text: String,
    json: Value,
}

impl Facts {
    fn row(&mut self, name: &str, value: impl Display) {
        self.text.push_str(&format!("{name:<10}  {value}\n"));
    }

    fn of(given: &Path, it: &Loaded) -> Facts {
        let file = |file: &FileRead| json!({ "path": file.path, "blake3": file.hash });
        let given = given.display();
        let mut facts = Facts {
            text: format!("{given}: {}\n\n", it.format),
            json: json!({
                "schema": "volref/info/1",
                "file": given.to_string(),
                "format": it.format,
                "files": it.files.iter().map(file).collect::<Vec<_>>(),
            }),
        };
        if let Stored::Cloud { points, extent } = &it.stored {
            let [min, max] = [extent.min, extent.max].map(|corner| corner.to_array());
            facts.json["cloud"] = json!({ "points": points, "min": min, "max": max });
            facts.row("points", points);
            facts.row("extent", between(min, max));
        }
        facts.place(it);
        let values = ValueStatistics::of(&it.grid);
        if let Stored::Samples { layout } = &it.stored {
            facts.stored(&it.grid, layout);
        }
        if let (Some(min), Some(max), Some(mean)) = (values.min, values.max, values.mean) {
            let [min, max, mean] = [min, max, mean].map(digits);
            facts.row("values", format!("{min} to {max}, mean {mean}"));
        }
        let mut signs = format!("{} zero, {} nonzero", values.zeros, values.non_zeros);
        if values.negative > 0 {
            signs.push_str(&format!(", {} of them negative", values.negative));
        }
        facts.row("", signs);
        if let Some(FirstNonFinite { voxel, value }) = &values.first_non_finite {
            let ([i, j, k], count) = (voxel, values.non_finite);
            let words = format!("{count}, first at voxel ({i}, {j}, {k}): {value}");
            facts.row("not finite", words);
        }
        if let Some(file) = it.files.get(1) {
            facts.row("data in", file.path.display());
        }
        facts.text.push_str(&plot(&values.histogram));
        facts.json["values"] = json!(values);
        facts
    }

    /// Position and size.
    fn place(&mut self, it: &Loaded) {
        let lattice = it.grid.lattice();
        let nodes @ [nx, ny, nz] = lattice.nodes();
        let [spacing, first] = [lattice.spacing(), lattice.first()].map(|it| it.to_array());
        let bounds = lattice.bounds();
        let [min, max] = [bounds.min, bounds.max].map(|corner| corner.to_array());
        let centring = match lattice.centring() {
            Centring::Nodes => "nodes",
            Centring::Cells => "cells",
        };
        let count = nx * ny * nz;
        self.row("nodes", format!("{nx} × {ny} × {nz}, {count} in total"));
        let is_cubic = spacing.iter().all(|of| *of == spacing[0]);
        match is_cubic {
            true => self.row("spacing", digits(spacing[0])),
            false => self.row("spacing", vector(spacing)),
        }
        self.row("first node", vector(first));
        let sides = between(min, max);
        self.row("box", format!("{sides}, centred on {centring}"));
        self.json["nodes"] = json!(nodes);
        self.json["spacing"] = json!(spacing);
        self.json["first"] = json!(first);
        self.json["min"] = json!(min);
        self.json["max"] = json!(max);
        self.json["centring"] = json!(centring);
        if let Some(rows) = it.to_world.map(|map| map.rows()) {
            self.json["to_world"] = json!(rows);
            for (name, numbers) in ["to world", "", ""].iter().zip(rows) {
                self.row(name, numbers.map(digits).join(", "));
            }
        }
    }

    /// How samples are stored.
    fn stored(&mut self, grid: &Grid<f32>, layout: &Layout) {
        if let Some(space) = layout.space {
            self.json["space"] = json!(space);
            self.row("space", space);
        }
        let (sizes, element) = (layout.axes.sizes, layout.element);
        let encoding = layout.encoding.name();
        let mut json = json!({ "sizes": sizes, "type": element.name(), "encoding": encoding });
        let mut words = element.name().to_owned();
        if layout.encoding != Encoding::Text && element.bytes() > 1 {
            let endian = ["little", "big"][usize::from(layout.endian == Endian::Big)];
            json["endian"] = json!(endian);
            words.push_str(&format!(", {endian} endian"));
        }
        words.push_str(&format!(", {encoding}"));
        if sizes != grid.lattice().nodes() {
            let [a, b, c] = sizes;
            words.push_str(&format!(", {a} × {b} × {c} in other order"));
        }
        self.row("stored", words);
        if let Some((slope, intercept)) = layout.scaling {
            json["scaling"] = json!({ "slope": slope, "intercept": intercept });
            let plus = format!(" + {}", digits(intercept)).replace("+ -", "- ");
            self.row("", format!("value = {} · stored{plus}", digits(slope)));
        }
        self.json["stored"] = json;
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
            first_non_finite: first.map(|index| FirstNonFinite {
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

/// A logarithmic bar for each bin: a dominant one, such as the air around an object, would hide all others.
fn plot(bins: &[Bin]) -> String {
    let Some(largest) = bins.iter().map(|bin| bin.count).max() else {
        return String::new();
    };
    let size = |count: usize| ln(1.0 + count as f64);
    let edges = |bin: &Bin| [bin.from, bin.to].map(|edge| rounded(edge, 3));
    let edges: Vec<[String; 2]> = bins.iter().map(edges).collect();
    let [from_width, to_width] = [0, 1].map(|side| widest(edges.iter().map(|edge| &edge[side])));
    let count_width = largest.to_string().len();
    let mut text = "\nhistogram, bars logarithmic\n".to_owned();
    for (Bin { count, .. }, [from, to]) in bins.iter().zip(&edges) {
        let bar = (LONGEST_BAR * size(*count) / size(largest)).ceil();
        let bar = "▇".repeat(bar as usize);
        let line =
            format!("  {from:>from_width$} to {to:>to_width$}  {count:>count_width$}  {bar}");
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
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
    fn bars_are_logarithmic() {
        let bin = |count| Bin {
            from: 0.0,
            to: 0.5,
            count,
        };
        // ln 6 is 0.75 of ln 11.
        let (all, part) = ("▇".repeat(40), "▇".repeat(30));
        assert_eq!(
            plot(&[bin(10), bin(5), bin(0)]),
            format!(
                "\nhistogram, bars logarithmic\n  0 to 0.5  10  {all}\n  0 to 0.5   5  {part}\n  0 to 0.5   0\n"
            )
        );
    }
}
