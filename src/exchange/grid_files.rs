//! The grid of a classified volume, as a file of its own: bare samples, NRRD or NPY.
//!
//! Values are those of volref, float32 and little endian, x fastest, in the coordinates of the volume: a map that places
//! it in the world is not applied to them, and stands in the scene.

use super::{Export, Format, Refusal};
use crate::files::npy_header::npy_header;
use crate::scene::Scene;
use crate::volume::{Centring, Grid};
use std::fmt::Display;
use std::sync::Arc;

/// `NAME.nrrd`; or `NAME.raw` or `NAME.npy`, with sizes, type, spacing and origin beside it in `NAME.raw.toml` or
/// `NAME.npy.toml`, by which volref reads them.
pub(super) fn grid_files(scene: &Scene, format: Format, name: &str) -> Result<Export, Refusal> {
    let grid = only_grid(scene, format)?;
    let mut samples = match format {
        Format::Nrrd => nrrd_header(grid).into_bytes(),
        Format::Npy => {
            let [nx, ny, nz] = grid.lattice().nodes();
            npy_header(&[nz, ny, nx])
        }
        _ => Vec::new(),
    };
    let header = samples.len();
    samples.extend(grid.values().iter().flat_map(|value| value.to_le_bytes()));
    let file = format!("{name}.{format}");
    if format == Format::Nrrd {
        let files = vec![(file.clone(), samples)];
        return Ok(Export { main: file, files });
    }
    let main = format!("{file}.toml");
    let description = description(grid, &file, header).into_bytes();
    let files = vec![(main.clone(), description), (file, samples)];
    Ok(Export { main, files })
}

/// The grid of all volumes of all panels.
fn only_grid(scene: &Scene, format: Format) -> Result<&Grid<f32>, Refusal> {
    let refusal = |what| Refusal::of(format, "panel", what);
    let mut grids: Vec<&Arc<Grid<f32>>> = Vec::new();
    for panel in &scene.panels {
        if panel.classified().is_none() {
            let what =
                "this one has no classified volume; export media to `bundle`, `mitsuba` or `pbrt`";
            return Err(refusal(what));
        }
        grids.extend(panel.model.grids());
    }
    let first = grids[0];
    if grids.iter().any(|grid| !Arc::ptr_eq(grid, first)) {
        return Err(refusal("several volumes; write a scene of each"));
    }
    Ok(first)
}

fn joined<T: Display>(items: [T; 3], separator: &str) -> String {
    items.map(|item| item.to_string()).join(separator)
}

fn centring(grid: &Grid<f32>) -> [&'static str; 2] {
    match grid.lattice().centring() {
        Centring::Nodes => ["nodes", "node"],
        Centring::Cells => ["cells", "cell"],
    }
}

/// Axes x, y, z, by the directions of the steps along them.
fn nrrd_header(grid: &Grid<f32>) -> String {
    let lattice = grid.lattice();
    let [x, y, z] = lattice.spacing().to_array();
    let [_, each] = centring(grid);
    format!(
        "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: {}\n\
         space directions: ({x},0,0) (0,{y},0) (0,0,{z})\nspace origin: ({})\n\
         kinds: domain domain domain\ncenterings: {each} {each} {each}\n\
         endian: little\nencoding: raw\n\n",
        joined(lattice.nodes(), " "),
        joined(lattice.first().to_array(), ","),
    )
}

/// Description of raw samples, as volref reads it.
fn description(grid: &Grid<f32>, file: &str, header_bytes: usize) -> String {
    let lattice = grid.lattice();
    let number = |number: f64| format!("{number:?}");
    let [nodes, spacing, origin] = [
        joined(lattice.nodes(), ", "),
        joined(lattice.spacing().to_array().map(number), ", "),
        joined(lattice.first().to_array().map(number), ", "),
    ];
    let [centring, _] = centring(grid);
    format!(
        "file = {file:?}\ntype = \"float32\"\nendian = \"little\"\n\
         nodes = [{nodes}] # x, y, z; x runs fastest in the file\n\
         spacing = [{spacing}]\norigin = [{origin}] # position of the first node\n\
         centring = {centring:?}\nheader_bytes = {header_bytes}\n"
    )
}
