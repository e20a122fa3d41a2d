//! The files that scenes name: each is read once and recorded with its hash.

use super::node_formula::read_formula;
use super::placement::PlacedGrid;
use super::reader::Reader;
use super::volume::VolumeRequest;
use super::{SceneError, SceneResult};
use crate::files::regular_file;
use crate::files::regular_file::ReadError;
use crate::geometry::{ClosedMesh, Mesh, ObjFault};
use crate::volume::{self, FileRead, Grid, Lattice, NodeFormula};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// An input file of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// As the scene names it.
    pub name: String,
    /// BLAKE3 of its bytes.
    pub hash: String,
}

/// A grid, how it was asked for, and the files it came from.
type LoadedGrid = (VolumeRequest, PlacedGrid, Vec<InputFile>);

/// Longest text read.
const MOST_TEXT_BYTES: u64 = 1 << 20;

/// The files of a scene; one asked for by several panels, or several times by one, is read once.
pub(super) struct Files<'p> {
    folder: &'p Path,
    grids: Vec<LoadedGrid>,
    formulas: Vec<(NodeFormula, Arc<Grid<f32>>)>,
    meshes: BTreeMap<String, (Arc<Mesh>, InputFile)>,
    used: Vec<InputFile>,
}

impl<'p> Files<'p> {
    /// Names of files are relative to `folder`.
    pub(super) fn new(folder: &'p Path) -> Files<'p> {
        Files {
            folder,
            grids: Vec::new(),
            formulas: Vec::new(),
            meshes: BTreeMap::new(),
            used: Vec::new(),
        }
    }

    /// The files used since the last call, each once, in the order of their first use.
    pub(super) fn take_used(&mut self) -> Vec<InputFile> {
        std::mem::take(&mut self.used)
    }

    fn note(&mut self, file: &InputFile) {
        if !self.used.contains(file) {
            self.used.push(file.clone());
        }
    }

    /// The densities that a table of [volume keys](super::volume::VOLUME) asks for: finite and
    /// not negative. `help` is for those who have others.
    pub(super) fn densities(&mut self, reader: &Reader, help: &str) -> SceneResult<Arc<Grid<f32>>> {
        let request = VolumeRequest::read(reader, false)?;
        let PlacedGrid { grid, .. } = self.loaded(reader, request)?;
        Files::check_densities(reader, &grid, help)?;
        Ok(grid)
    }

    /// Refuses values that are no densities. `help` is for those who have others.
    pub(super) fn check_densities(
        reader: &Reader,
        grid: &Grid<f32>,
        help: &str,
    ) -> SceneResult<()> {
        let key = reader.first_of(&["field"]).unwrap_or("file");
        grid.check_densities()
            .map_err(|error| reader.mistake(key, error.to_string(), help))
    }

    /// The values that a table of [placed volumes](super::volume::PLACED) asks for: finite.
    pub(super) fn placed_values(&mut self, reader: &Reader) -> SceneResult<PlacedGrid> {
        if reader.has("field") {
            let (formula, lattice) = read_formula(reader)?;
            let grid = self.computed(reader, formula, lattice)?;
            let to_world = None;
            return PlacedGrid { grid, to_world }.moved(reader);
        }
        let request = VolumeRequest::read(reader, true)?;
        self.loaded(reader, request)?.moved(reader)
    }

    /// The grid of a formula: those of a scene together have as many nodes as one may have.
    fn computed(
        &mut self,
        reader: &Reader,
        formula: NodeFormula,
        lattice: Lattice,
    ) -> SceneResult<Arc<Grid<f32>>> {
        let mut known = self.formulas.iter();
        if let Some((_, grid)) =
            known.find(|(of, grid)| *of == formula && *grid.lattice() == lattice)
        {
            return Ok(grid.clone());
        }
        let others = self.formulas.iter();
        let others = others.map(|(_, grid)| grid.lattice().node_count());
        let count = others.sum::<usize>() + lattice.node_count();
        refuse! { reader:
            "nodes" if count > NodeFormula::MOST_NODES, format!(
                "the formulas of this scene have {count} nodes together, too many: at most 2^27 are computed, which take 512 MiB"
            ), "give fewer nodes, or fewer panels";
        }
        let grid = Arc::new(reader.accepted(formula.grid(lattice))?);
        self.formulas.push((formula, grid.clone()));
        Ok(grid)
    }

    /// The grid that `request`, made by the table of `reader`, asks for, where its file puts it.
    pub(super) fn loaded(
        &mut self,
        reader: &Reader,
        request: VolumeRequest,
    ) -> SceneResult<PlacedGrid> {
        let known = self.grids.iter().find(|(other, ..)| *other == request);
        if let Some((_, grid, inputs)) = known.cloned() {
            inputs.iter().for_each(|input| self.note(input));
            return Ok(grid);
        }
        let path = self.folder.join(&request.file);
        let loaded = volume::load_hashed(&path, &request.options);
        let loaded = reader.accepted_at("file", loaded)?;
        let input = |file: FileRead| InputFile {
            name: self.name_of(&file.path),
            hash: file.hash,
        };
        let mut inputs: Vec<InputFile> = loaded.files.into_iter().map(input).collect();
        inputs[0].name.clone_from(&request.file);
        inputs.iter().for_each(|input| self.note(input));
        let grid = PlacedGrid {
            grid: Arc::new(loaded.grid),
            to_world: loaded.to_world,
        };
        self.grids.push((request, grid.clone(), inputs));
        Ok(grid)
    }

    /// A path as the scene would name it.
    fn name_of(&self, path: &Path) -> String {
        let relative = path.strip_prefix(self.folder).unwrap_or(path);
        relative.display().to_string()
    }

    /// The bytes of the file `name`, which a table names.
    fn bytes(
        &mut self,
        reader: &Reader,
        name: &str,
        most: u64,
    ) -> SceneResult<(Vec<u8>, InputFile)> {
        let path = self.folder.join(name);
        let bytes = regular_file::read(&path, most).map_err(|error| {
            let message = match error {
                ReadError::Missing(_) => format!("there is no file {name}"),
                _ => format!("{} cannot be read: {error}", path.display()),
            };
            reader.error("file", message)
        })?;
        let input = InputFile {
            name: name.to_owned(),
            hash: blake3::hash(&bytes).to_hex().to_string(),
        };
        self.note(&input);
        Ok((bytes, input))
    }

    /// The text that a table `{ file }` names, and its name for messages.
    pub(super) fn text(&mut self, reader: &Reader, name: &str) -> SceneResult<(String, String)> {
        let (bytes, _) = self.bytes(reader, name, MOST_TEXT_BYTES)?;
        let text = String::from_utf8(bytes);
        let text = text.map_err(|_| reader.error("file", format!("{name} is not UTF-8 text")))?;
        Ok((self.folder.join(name).display().to_string(), text))
    }

    /// The mesh that a table `{ file }` names.
    pub(super) fn mesh(&mut self, reader: &Reader) -> SceneResult<Arc<Mesh>> {
        let name: String = reader.get("file")?;
        self.mesh_named(reader, name)
    }

    /// The mesh that a table `{ file }` names, which must be closed.
    pub(super) fn closed_mesh(&mut self, reader: &Reader) -> SceneResult<ClosedMesh> {
        let name: String = reader.get("file")?;
        let mesh = self.mesh_named(reader, name.clone())?;
        ClosedMesh::new(mesh).map_err(|error| bad_mesh(reader, &name, &error))
    }

    fn mesh_named(&mut self, reader: &Reader, name: String) -> SceneResult<Arc<Mesh>> {
        if let Some((mesh, input)) = self.meshes.get(&name).cloned() {
            self.note(&input);
            return Ok(mesh);
        }
        let (bytes, input) = self.bytes(reader, &name, regular_file::MOST_BYTES)?;
        let mesh = Mesh::from_obj(&bytes).map_err(|error| bad_mesh(reader, &name, &error))?;
        let mesh = Arc::new(mesh);
        self.meshes.insert(name, (mesh.clone(), input));
        Ok(mesh)
    }
}

fn bad_mesh(reader: &Reader, name: &str, error: &ObjFault) -> Box<SceneError> {
    // Begins with line and column, if it is in a line.
    let blank = ["", " "][usize::from(error.position.is_none())];
    reader.error("file", format!("{name}:{blank}{error}"))
}
