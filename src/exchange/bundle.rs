//! A scene as a plain bundle: a JSON file that describes the whole computation in words
//! and numbers, beside raw densities and meshes. It is self-contained, for authors of renderers.
//!
//! Formulas stand beside the numbers they use, and name them by their keys. They are ASCII, so
//! that they can be read with any editor and pasted into code.

mod asks;
mod clips;
mod inline_arrays;
mod modes;
mod plot;
mod radiative;
mod several;
mod shapes;
mod volume;

use super::files::SharedFiles;
use super::{Export, Format, Refusal};
use crate::geometry::Mesh;
use crate::optics::{TransferPoint, TransferPoints};
use crate::render::{Plan, PlotLayout, plans};
use crate::scene::{Conventions, Model, Panel, Scene};
use crate::volume::Grid;
use inline_arrays::{Entries, Json, entries};

/// The bundle of `scene`: `NAME.json`, and beside it `NAME.grid-1.raw` and so on for each volume,
/// `NAME.backdrop-1.raw` for each plot, `NAME.vertices-1.raw` and `NAME.triangles-1.raw` for each mesh of a
/// radiative scene. The same scene gives the same bytes. Refused are other conventions than volref's.
/// The exposure is that of 8-bit images, in stops, where it is known.
pub(super) fn bundle(scene: &Scene, name: &str, exposure: Option<f64>) -> Result<Export, Refusal> {
    let mut raw = SharedFiles::new(name);
    let mut panels = Vec::new();
    let mut first_column = 0;
    for panel in &scene.panels {
        let mut picture = entries! {
            "title": panel.title.clone(), "first_column": first_column, "width": panel.width,
            "height": panel.height,
        };
        picture.extend(content(panel, &mut raw)?);
        panels.push(picture);
        first_column += panel.width;
    }
    let description = Json::Object(entries! {
        "schema": "volref/bundle/1", "name": name, "image": image(scene, exposure),
        "judged": judged(plans(scene).iter().any(Plan::is_sampled)), "panels": panels,
    });
    let main = format!("{name}.json");
    let text = description.text("") + "\n";
    let mut files = vec![(main.clone(), text.into_bytes())];
    files.extend(raw.files);
    Ok(Export { main, files })
}

fn content(panel: &Panel, raw: &mut SharedFiles) -> Result<Entries, Refusal> {
    match &panel.model {
        Model::Classified(scene) if scene.conventions != Conventions::default() => {
            let what = "a bundle describes volref's conventions only; leave the table out";
            Err(Refusal::of(Format::Bundle, "classified.conventions", what))
        }
        Model::Classified(scene) => {
            let mut entries = if scene.has_objects() {
                several::described(scene, raw)
            } else {
                volume::described(scene, raw.grid(&scene.grid))
            };
            // After what the panel shows.
            entries.insert(1, ("asks", asks::asks(scene)));
            Ok(entries)
        }
        Model::Curve(curve) => {
            let layout = PlotLayout::new(curve, panel.width, panel.height);
            let file = raw.floats("backdrop", layout.backdrop().as_flattened());
            Ok(plot::described(curve, &layout, file))
        }
        Model::Radiative(scene) => Ok(radiative::described(panel, scene, raw)),
    }
}

fn image(scene: &Scene, exposure: Option<f64>) -> Entries {
    let panels = "side by side from left to right: panel k fills the columns from its first_column on, all rows";
    let pixels = "linear RGB radiance as 32-bit floats, without gamma, exposure or clipping, top row first; colours \
                  as they reach the eye, that is already multiplied by opacity";
    let files = "EXR with channels R, G, B; PFM (which stores the bottom row first); or NPY \
                 of shape (height, width, 3), type float32, C order";
    let mut image: Entries = entries! {
        "width": scene.width(), "height": scene.height(), "panels": panels, "pixels": pixels,
        "files": files,
    };
    if let Some(stops) = exposure {
        let codes = "a PNG of 8 bits holds the codes of radiance * 2^exposure, cut off at 1: sRGB, or \
                     linear if that is declared";
        image.extend(entries! { "exposure": stops, "codes": codes });
    }
    image
}

/// The gate: by noise in words, else the deterministic one. It is the business of [`crate`]'s comparisons,
/// which lie above this room; `tests/cli/peers.rs` holds these numbers against what they do.
fn judged(by_noise: bool) -> Entries {
    if by_noise {
        let rule = "your image and the right one may differ by no more than the noise of both, in the mean of the \
                    whole, of rows, of columns and of blocks of 8 by 8 pixels, and pixel by pixel; noise that you do \
                    not state is estimated from the image";
        return entries! { "rule": rule };
    }
    let rule = "a pixel agrees if in every channel |yours - right| <= tolerance(right), where tolerance(c) = \
                absolute + relative*|c|; at most outlier_share of the pixels may disagree, none by more than \
                hard_cap tolerances, and the mean of a channel may be off by bias_share*tolerance(mean)";
    entries! {
        "rule": rule, "absolute": 1e-3, "relative": 0.01, "outlier_share": 2e-4, "hard_cap": 20.0,
        "bias_share": 0.1,
    }
}

/// The points of a transfer function that is a table.
fn points(points: &TransferPoints) -> Vec<Entries> {
    let point = |point: &TransferPoint| {
        entries! { "value": point.value, "opacity": point.opacity, "colour": point.colour }
    };
    points.points().iter().map(point).collect()
}

/// The files beside the JSON are bare numbers, little endian.
impl SharedFiles<'_> {
    /// A mesh, its vertices and its triangles in files of their own.
    fn mesh(&mut self, mesh: &Mesh) -> Entries {
        let coordinates = mesh.vertices().iter().flat_map(|it| it.to_array());
        let vertices = coordinates.flat_map(f64::to_le_bytes).collect();
        let corners = mesh.faces().as_flattened().iter();
        let triangles = corners.flat_map(|&corner| (corner as u32).to_le_bytes());
        let triangles = triangles.collect();
        entries! {
            "kind": "mesh", "vertices": self.raw("vertices", vertices),
            "vertex_count": mesh.vertices().len(), "triangles": self.raw("triangles", triangles),
            "triangle_count": mesh.faces().len(),
        }
    }

    /// Name of the file with the values of `grid`.
    fn grid(&mut self, grid: &Grid<f32>) -> String {
        self.floats("grid", grid.values())
    }

    /// Name of the file that holds these numbers.
    fn floats(&mut self, kind: &str, values: &[f32]) -> String {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes());
        self.raw(kind, bytes.collect())
    }

    /// Name of the file that holds these bytes.
    fn raw(&mut self, kind: &str, bytes: Vec<u8>) -> String {
        self.file([&format!("{kind}-"), ".raw"], 1, bytes)
    }
}
