//! A scene that shows a volume file, as people first want to see it.

use crate::geometry::Aabb;
use crate::math::linear_to_srgb;
use crate::optics::Colormap;
use crate::volume::{Content, volume_format};
use crate::volume::{Grid, LoadOptions, Loaded, NonFinite, Orientation, Stored, load_hashed};
use glam::DVec3;
use std::path::Path;

/// The options that were given; the rest follows from the file.
#[derive(Clone, Debug, Default)]
pub struct Recipe {
    /// A mode of `[classified]`; samples are composited without one.
    pub mode: Option<String>,
    /// Name of a [`Colormap`].
    pub colormap: Option<String>,
    /// Values of the first and the last colour.
    pub range: Option<[f64; 2]>,
    /// Distances between nodes, in place of the file's.
    pub spacing: Option<[f64; 3]>,
    /// Columns and rows of the image.
    pub size: Option<[u64; 2]>,
    /// Angle of the eye about the vertical, degrees.
    pub azimuth: Option<f64>,
    /// Angle of the eye above the horizon, degrees.
    pub elevation: Option<f64>,
}

/// Columns and rows of an image.
const SIZE: [u64; 2] = [512; 2];

/// Opacity of the top of the range over a reference length.
const OPACITY: f64 = 0.9;

/// Points of a table of colours: between them a published map is straight to 2 codes of 255.
const POINTS: usize = 9;

impl Recipe {
    /// The text of a scene of the volume file at `path`, which the scene calls `file`; and the value that stands for
    /// those that are not finite, if there are any.
    pub fn text(&self, path: &Path, file: &str) -> Result<(String, Option<f32>), String> {
        let loaded = |non_finite| {
            let options = LoadOptions {
                non_finite,
                orientation: Orientation::Oblique,
                ..LoadOptions::default()
            };
            load_hashed(path, &options).map_err(|error| error.to_string())
        };
        let mut volume = loaded(NonFinite::Kept)?;
        let is_finite = |value: &f32| value.is_finite();
        let lowest = volume.grid.values().iter().copied().filter(is_finite);
        let name = path.display();
        let nothing = || format!("{name}: no value is finite: there is nothing to show");
        let lowest = lowest.min_by(f32::total_cmp).ok_or_else(nothing)?;
        let is_whole = volume.grid.values().iter().all(is_finite);
        if !is_whole {
            volume = loaded(NonFinite::Replaced(lowest))?;
        }
        let grid = &volume.grid;
        let scale = self.scale(&volume, path)?;
        let bounds = grid.lattice().bounds();
        let bounds = volume.to_world.map_or(bounds, |map| map.bounds(&bounds));
        let [min, max] = [bounds.min, bounds.max].map(|it| it * scale.unwrap_or(DVec3::ONE));
        let bounds = Aabb { min, max };
        let [width, height] = self.size.unwrap_or(SIZE);
        let is_upright = is_of_graphics(path);
        let axis = if is_upright { 2 } else { 1 };
        let mut text = format!(
            "# Written by `volref render`.\n\n[film]\nwidth = {width}\nheight = {height}\n\n[camera]\n{}{}\n[classified]\n",
            if is_upright { "" } else { "up = [0, 0, 1]\n" },
            self.angles(&volume),
        );
        let range = match self.range {
            Some(range) => range,
            None => shortest(self.shown(grid, axis, &bounds)),
        };
        text += &self.look(grid, range, &bounds);
        text += &format!("\n[classified.volume]\nfile = {}\n", quoted(file));
        if !is_whole {
            text += &format!("replace_non_finite = {lowest}\n");
        }
        if let Some(scale) = scale {
            text += &format!("scale = {:?}\n", scale.to_array());
        }
        Ok((text, (!is_whole).then_some(lowest)))
    }

    /// Place of the eye: from the front and, of what has a surface, a little from the side and above. The front of a
    /// scan is its patient's: the axis y points to the back of that, but for RAS+.
    fn angles(&self, loaded: &Loaded) -> String {
        let to_back = match &loaded.stored {
            Stored::Samples { layout } => {
                layout.space.is_some_and(|space| space.starts_with("RAS"))
            }
            Stored::Cloud { .. } => false,
        };
        let [aside, above] = match self.mode.as_deref() {
            None | Some("isosurface") => [30.0, 20.0],
            Some(_) => [0.0, 0.0],
        };
        let front = if to_back { 180.0 } else { 0.0 };
        let azimuth = self.azimuth.unwrap_or(front + aside);
        let elevation = self.elevation.unwrap_or(above);
        format!("azimuth = {azimuth}\nelevation = {elevation}\n")
    }

    /// Factors from the spacing of the file to the one asked for.
    fn scale(&self, loaded: &Loaded, path: &Path) -> Result<Option<DVec3>, String> {
        let Some(spacing) = self.spacing else {
            return Ok(None);
        };
        if loaded.to_world.is_some() || matches!(loaded.stored, Stored::Cloud { .. }) {
            return Err(format!(
                "--spacing: {}: its points, or its oblique axes, have positions of their own",
                path.display()
            ));
        }
        let own = loaded.grid.lattice().spacing();
        Ok(Some(DVec3::from_array(spacing) / own))
    }

    /// The range of what the mode shows: values, or means or sums of them along the `axis` of the view.
    fn shown(&self, grid: &Grid<f32>, axis: usize, bounds: &Aabb) -> [f64; 2] {
        let length = match self.mode.as_deref() {
            Some("mean") => 1.0,
            Some("sum") => bounds.size()[axis],
            _ => return grid.usual_range(),
        };
        let means = grid.means_along(axis).usual_range();
        means.map(|mean| mean * length)
    }

    /// The keys of `[classified]` and the tables of the look.
    fn look(&self, grid: &Grid<f32>, range: [f64; 2], bounds: &Aabb) -> String {
        let edge = bounds.size().max_element();
        let [low, high] = range;
        let phong =
            "\n[classified.phong]\nambient = 0.4\ndiffuse = 0.9\nspecular = 0.25\nshininess = 24\n";
        let named = |or: &str| self.colormap.clone().unwrap_or_else(|| or.to_owned());
        match self.mode.as_deref() {
            Some("isosurface") => {
                let value = low + (high - low) * grid.threshold(range);
                let colour = match &self.colormap {
                    Some(_) => linear(&named(""), 0.75),
                    None => "\"#e8dcc4\"".to_owned(),
                };
                format!(
                    "mode = \"isosurface\"\n\n[[classified.isosurface]]\nvalue = {value}\ncolour = {colour}\n{phong}"
                )
            }
            Some(mode @ "attenuated-maximum") => format!(
                "mode = {mode:?}\nattenuation = {}\n\n[classified.window]\nlow = {low}\nhigh = {high}\n",
                digits(2.0 / edge)
            ),
            Some(mode) => format!(
                "mode = {mode:?}\n\n[transfer_function]\nrange = {range:?}\ncolormap = {}\n",
                quoted(&named("display-grey"))
            ),
            None => {
                // A volume much of which is 0 is empty there, and soft elsewhere, as smoke is; other backgrounds are
                // air or noise.
                let (begin, share, colormap) = match low == 0.0 && grid.is_empty_below(low) {
                    true => (0.0, 0.04, named("inferno")),
                    false => (grid.threshold(range), 0.1, named("bone")),
                };
                let mut text = format!(
                    "early_termination = 0.001\n{phong}\n[transfer_function]\nrange = {range:?}\n\
                     reference_length = {}\npoint = [\n",
                    digits(edge * share)
                );
                for index in 0..POINTS {
                    let part = index as f64 / (POINTS - 1) as f64;
                    let value = begin + (1.0 - begin) * part;
                    let colour = linear(&colormap, 0.3 + 0.7 * part);
                    // Rises steeply at first, or what is thin were too faint.
                    let opacity = OPACITY * part.sqrt();
                    text += &format!(
                        "    {{ value = {}, colour = {colour}, opacity = {} }},\n",
                        digits(value),
                        digits(opacity)
                    );
                }
                text + "]\n"
            }
        }
    }
}

/// True of formats of graphics, in which y points up; in those of scans and of arrays z does.
fn is_of_graphics(path: &Path) -> bool {
    volume_format(path).is_some_and(|format| {
        format.content == Content::Points || [".bin", ".vol"].contains(&format.extensions[0])
    })
}

/// Numbers with no more digits than a file of 32-bit values has.
fn shortest(range: [f64; 2]) -> [f64; 2] {
    let short = range.map(|end| (end as f32).to_string().parse().unwrap_or(end));
    if short[0] < short[1] { short } else { range }
}

/// A number in four significant digits.
fn digits(number: f64) -> f64 {
    format!("{number:.3e}").parse().unwrap_or(number)
}

/// `text` as a string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// The colour of a named map at a position, as a key of a scene.
fn linear(colormap: &str, position: f64) -> String {
    let colormap = Colormap::named(colormap).expect("a declared name");
    let code = |channel| (linear_to_srgb(channel) * 255.0).round() as u8;
    let [red, green, blue] = colormap.at(position).to_array().map(code);
    format!("\"#{red:02x}{green:02x}{blue:02x}\"")
}
