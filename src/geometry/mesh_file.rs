//! Meshes from Wavefront OBJ files.

use super::polygon::triangles;
use super::{Mesh, MeshError, ObjFault, Skipped, Statements, Word};
use crate::files::regular_file;
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;

/// Largest file read, in bytes: 4 GiB, some hundred million triangles.
const MOST_BYTES: u64 = 1 << 32;

impl Mesh {
    /// The mesh in an OBJ file: all its objects and groups together, materials, points and lines
    /// ignored, free-form surfaces refused. Vertices at one position are one.
    ///
    /// A polygon may be concave, have corners within its edges, and holes that a slit joins to its
    /// outline. One that is not flat is triangulated as it is seen along the axis nearest to its
    /// normal; one that crosses itself there is refused.
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
        let mesh = Mesh::from_obj(&bytes).map_err(|error| match format_by_name(path) {
            Some(name) => ObjFault::of_format(name).into(),
            None => error,
        })?;
        Ok((mesh, blake3::hash(&bytes).to_hex().to_string()))
    }

    /// The mesh in the text of an OBJ file, as by [`load`](Mesh::load).
    pub fn from_obj(text: &[u8]) -> Result<Mesh, MeshError> {
        let polygons = Polygons::read(text)?;
        let mut welded = Welded::default();
        let mut faces = Vec::new();
        let mut lines = Vec::new();
        let mut start = 0;
        for &(end, [line, column]) in &polygons.ends {
            let corners = polygons.corners[start..end].iter();
            let corners = corners.map(|&vertex| welded.number(polygons.vertices[vertex]));
            let mut corners: Vec<usize> = corners.collect();
            start = end;
            // A corner repeated is one.
            corners.dedup();
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            let positions: Vec<DVec3> = corners.iter().map(|&it| welded.vertices[it]).collect();
            let triangles = triangles(&positions).map_err(|message| ObjFault {
                position: Some([line, column]),
                message,
            })?;
            for triangle in triangles {
                faces.push(triangle.map(|corner| corners[corner]));
                lines.push(line);
            }
        }
        Mesh::of_lines(welded.vertices, faces, lines)
    }
}

/// The format of a mesh that is not OBJ, by its extension.
fn format_by_name(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_ascii_lowercase();
    Some(match extension.to_str()? {
        "ply" => "PLY",
        "stl" => "STL",
        "off" => "OFF",
        "gltf" | "glb" => "glTF",
        _ => return None,
    })
}

/// The polygons of a file, as they stand there.
#[derive(Default)]
struct Polygons {
    vertices: Vec<DVec3>,
    /// Vertices of all polygons, from 0.
    corners: Vec<usize>,
    /// The end of each in `corners`, and line and column where it begins.
    ends: Vec<(usize, [usize; 2])>,
}

impl Polygons {
    fn read(text: &[u8]) -> Result<Polygons, MeshError> {
        let mut polygons = Polygons::default();
        // Vertices may stand behind the faces that refer to them.
        let mut ahead: Option<(usize, [usize; 2])> = None;
        let mut skipped = Skipped::default();
        let mut statements = Statements::of(text)?;
        let mut words = Vec::new();
        while statements.read_next(&mut words)? {
            let Some((keyword, values)) = words.split_first() else {
                continue;
            };
            match keyword.keyword()? {
                "v" => polygons.vertices.push(vertex(keyword, values)?),
                "f" => {
                    if values.len() < 3 {
                        return Err(keyword.fault(format!(
                            "a face has three corners or more, this one has {}: remove the line, or \
                             write `l` for a line and `p` for a point",
                            values.len()
                        )))?;
                    }
                    let count = polygons.vertices.len();
                    for word in values {
                        let corner = corner(word, count)?;
                        if corner >= count && ahead.is_none_or(|(most, _)| corner > most) {
                            ahead = Some((corner, word.position));
                        }
                        polygons.corners.push(corner);
                    }
                    polygons
                        .ends
                        .push((polygons.corners.len(), keyword.position));
                }
                "surf" => {
                    return Err(keyword.fault(
                        "a free-form surface is not a polygon: convert it to polygons, or export \
                         without curves and surfaces"
                            .to_owned(),
                    ))?;
                }
                other => skipped.count(other),
            }
        }
        let count = polygons.vertices.len();
        match ahead {
            Some((corner, position)) if corner >= count => Err(ObjFault {
                position: Some(position),
                message: format!(
                    "this face refers to vertex {}, but the file has {count}: was it cut off, or \
                     put together from several files?",
                    corner + 1
                ),
            })?,
            _ if polygons.ends.is_empty() && skipped.is_empty() => Err(MeshError::Empty),
            _ if polygons.ends.is_empty() => Err(ObjFault::in_file(&format!(
                "the mesh has no faces; beside points this file has {skipped}: export it as polygons"
            )))?,
            _ => Ok(polygons),
        }
    }
}

fn vertex(keyword: &Word, values: &[Word]) -> Result<DVec3, ObjFault> {
    let names: &[&str] = match values.len() {
        3 => &["x", "y", "z"],
        4 => &["x", "y", "z", "w"],
        6 | 7 => &["x", "y", "z", "red", "green", "blue", "opacity"],
        count => {
            return Err(keyword.fault(format!(
                "a `v` line of a mesh has 3 numbers (x y z) or 6 (x y z red green blue), this one \
                 has {count}"
            )));
        }
    };
    let mut numbers = [1.0; 7];
    for ((number, word), name) in numbers.iter_mut().zip(values).zip(names) {
        *number = word.number(name)?;
    }
    let [x, y, z, w, ..] = numbers;
    if values.len() == 4 && w != 1.0 {
        return Err(values[3].fault(format!(
            "w is {w}, and a vertex of a mesh has no weight (a point of a cloud has a density \
             there): write x y z alone"
        )));
    }
    Ok(DVec3::new(x, y, z))
}

/// The vertex, from 0, that a corner refers to where `count` vertices have been read: `7`, `7/1`, `7//1` or
/// `7/1/1`, or `-1` for the last one.
fn corner(word: &Word, count: usize) -> Result<usize, ObjFault> {
    let number = |bytes: &[u8]| std::str::from_utf8(bytes).ok()?.parse::<i64>().ok();
    let mut parts = word.bytes.split(|&byte| byte == b'/');
    let vertex = parts.next().and_then(number);
    let is_whole = |part: &[u8]| part.is_empty() || number(part).is_some();
    let vertex = vertex.filter(|_| parts.clone().count() <= 2 && parts.all(is_whole));
    match vertex {
        None => Err(word.fault(format!(
            "{:?} is not a corner of a face: write the number of its vertex, like 7, 7/1, 7//1 or 7/1/1",
            word.text()
        ))),
        Some(0) => {
            Err(word.fault("vertex 0 is none: they are counted from 1, or back from -1".to_owned()))
        }
        Some(vertex @ 1..) => Ok(usize::try_from(vertex - 1).unwrap_or(usize::MAX - 1)),
        Some(back) => {
            let back = usize::try_from(back.unsigned_abs()).unwrap_or(usize::MAX);
            count.checked_sub(back).ok_or_else(|| {
                word.fault(format!(
                    "this face refers to the vertex {back} lines back, but there are {count} before it"
                ))
            })
        }
    }
}

/// Vertices with equal numbers for equal positions: neighbours that programs give vertices of their
/// own still share edges.
#[derive(Default)]
struct Welded {
    vertices: Vec<DVec3>,
    number_of: HashMap<[u64; 3], usize>,
}

impl Welded {
    fn number(&mut self, position: DVec3) -> usize {
        // Adding 0 turns −0 into 0 and changes nothing else.
        let bits = (position + 0.0).to_array().map(f64::to_bits);
        *self.number_of.entry(bits).or_insert_with(|| {
            self.vertices.push(position);
            self.vertices.len() - 1
        })
    }
}
