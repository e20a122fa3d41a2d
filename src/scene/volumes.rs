//! Volumes of a scene file, whatever they look like.

use super::files::Files;
use super::load::panel_tables;
use super::placement::PlacedGrid;
use super::reader::{Document, Reader};
use super::{InputFile, SCENE, Scene, SceneResult};
use crate::geometry::Transform;
use crate::volume::Grid;
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;

/// A volume of a scene file.
pub(crate) struct SceneVolume {
    /// Its values.
    pub grid: Arc<Grid<f32>>,
    /// The map of the grid into the world; none where they are the same.
    pub to_world: Option<Transform>,
    /// The files that it comes from.
    pub inputs: Vec<InputFile>,
}

impl Scene {
    /// The volumes of all classified panels of the scene file at `path`. Nothing else of it is read: transfer
    /// functions need not go with the values.
    pub(crate) fn load_volumes(path: &Path) -> SceneResult<Vec<SceneVolume>> {
        let (name, text) = (path.display().to_string(), Scene::text(path)?);
        let document = Document {
            path: &name,
            text: &text,
        };
        let mut files = Files::new(path.parent().unwrap_or(Path::new("")));
        let mut volumes = Vec::new();
        for table in &panel_tables(&document, document.parse()?)? {
            let log = RefCell::default();
            let root = Reader::new(&document, &SCENE, table, &log)?;
            let Some(classified) = root.table("classified")? else {
                continue;
            };
            for volume in &classified.one_or_more("volume")? {
                let PlacedGrid { grid, to_world } = files.placed_values(volume)?;
                let inputs = files.take_used();
                volumes.push(SceneVolume {
                    grid,
                    to_world,
                    inputs,
                });
            }
        }
        Ok(volumes)
    }
}
