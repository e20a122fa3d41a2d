//! Meshes from Wavefront OBJ files.

use super::{Mesh, MeshError};
use crate::decoder;
use crate::regular_file;
use glam::DVec3;
use std::collections::HashMap;
use std::io::BufRead;
use std::path::Path;

/// Largest file read, in bytes: 4 GiB, some hundred million triangles.
const MOST_BYTES: u64 = 1 << 32;

impl Mesh {
    /// The mesh in an OBJ file: all its objects and groups together, polygons triangulated,
    /// materials ignored.
    pub fn load(path: &Path) -> Result<Mesh, MeshError> {
        Mesh::load_hashed(path).map(|(mesh, _)| mesh)
    }

    /// [`load`](Mesh::load), and the BLAKE3 hash of the bytes read.
    pub fn load_hashed(path: &Path) -> Result<(Mesh, String), MeshError> {
        let unreadable = |source| MeshError::Unreadable {
            path: path.to_owned(),
            source,
        };
        let bytes =
            regular_file::read(path, MOST_BYTES).map_err(|error| unreadable(error.into()))?;
        let mesh = Mesh::from_obj(bytes.as_slice())?;
        Ok((mesh, blake3::hash(&bytes).to_hex().to_string()))
    }

    /// The mesh in the text of an OBJ file, as by [`load`](Mesh::load).
    pub fn from_obj(mut text: impl BufRead) -> Result<Mesh, MeshError> {
        let options = tobj::LoadOptions {
            triangulate: true,
            ignore_points: true,
            ignore_lines: true,
            ..Default::default()
        };
        // Whatever the materials are, they are not looked for.
        let no_materials = |_: &Path| Err(tobj::LoadError::GenericFailure);
        let read = || tobj::load_obj_buf(&mut text, &options, no_materials);
        let (models, _) = decoder::run(read)??;
        let mut welded = Welded::default();
        for model in &models {
            welded.add(&model.mesh)?;
        }
        Mesh::new(welded.vertices, welded.faces)
    }
}

/// Faces with equal numbers for equal positions. `tobj` numbers the vertices of each object
/// separately, so neighbours in different objects would not share vertices.
#[derive(Default)]
struct Welded {
    vertices: Vec<DVec3>,
    faces: Vec<[usize; 3]>,
    number_of: HashMap<[u64; 3], usize>,
}

impl Welded {
    fn add(&mut self, mesh: &tobj::Mesh) -> Result<(), MeshError> {
        let numbers: Vec<usize> = mesh
            .positions
            .chunks_exact(3)
            .map(|position| self.number(DVec3::from_slice(position)))
            .collect();
        for corners in mesh.indices.chunks_exact(3) {
            let number = self.faces.len() + 1;
            let mut face = [0; 3];
            for (corner, &index) in face.iter_mut().zip(corners) {
                *corner = *numbers.get(index as usize).ok_or(MeshError::NoSuchVertex {
                    face: number,
                    vertex: index as usize,
                    count: numbers.len(),
                })?;
            }
            self.faces.push(face);
        }
        Ok(())
    }

    fn number(&mut self, position: DVec3) -> usize {
        // Adding 0 turns −0 into 0 and changes nothing else.
        let bits = (position + 0.0).to_array().map(f64::to_bits);
        *self.number_of.entry(bits).or_insert_with(|| {
            self.vertices.push(position);
            self.vertices.len() - 1
        })
    }
}
