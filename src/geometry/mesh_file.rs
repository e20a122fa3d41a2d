//! Meshes from Wavefront OBJ files.

use super::polygon::first_of_fan;
use super::{Mesh, ObjFault, Statements, Word};
use crate::files::regular_file;
use glam::DVec3;
use std::collections::HashMap;
use std::path::Path;
use tobj::{LoadError, LoadOptions};

impl Mesh {
    /// The mesh in an OBJ file: all its objects and groups together, materials, points and lines
    /// ignored, free-form surfaces refused. Vertices at one position are one.
    ///
    /// A polygon becomes a fan from its first corner whose fan covers it, as seen along the axis nearest to its
    /// normal. One that no fan covers, or that crosses itself, is refused.
    pub fn load(path: &Path) -> Result<Mesh, ObjFault> {
        let bytes = regular_file::read(path, regular_file::MOST_BYTES);
        let bytes = bytes.map_err(|error| ObjFault::in_file(format!("cannot be read: {error}")))?;
        Mesh::from_obj(&bytes)
    }

    /// The mesh in the text of an OBJ file, as by [`load`](Mesh::load).
    pub fn from_obj(text: &[u8]) -> Result<Mesh, ObjFault> {
        let plain = PlainObj::of(text)?;
        let options = LoadOptions {
            single_index: true,
            ..LoadOptions::default()
        };
        let no_materials = |_: &Path| Err(LoadError::OpenFileFailed);
        let read = tobj::load_obj_buf(&mut plain.text.as_slice(), &options, no_materials);
        // Without objects, groups and materials there is one model.
        let (mut models, _) = read.map_err(|error| ObjFault::in_file(error.to_string()))?;
        let model = models.pop().ok_or_else(ObjFault::no_faces)?.mesh;
        let positions: Vec<DVec3> = (model.positions.chunks_exact(3))
            .map(DVec3::from_slice)
            .collect();
        let mut welded = Welded::default();
        let mut faces = Vec::new();
        let mut lines = Vec::new();
        let mut indices = model.indices.iter().map(|&vertex| vertex as usize);
        for (polygon, &position) in plain.polygons.iter().enumerate() {
            // Triangles alone have no list of the numbers of their corners.
            let count = (model.face_arities.get(polygon)).map_or(3, |&count| count as usize);
            let corners = indices.by_ref().take(count);
            let mut corners: Vec<usize> = corners
                .map(|vertex| welded.number(positions[vertex]))
                .collect();
            // A corner repeated is one.
            corners.dedup();
            while corners.len() > 1 && corners.first() == corners.last() {
                corners.pop();
            }
            let places: Vec<DVec3> = corners.iter().map(|&it| welded.vertices[it]).collect();
            let first = first_of_fan(&places).map_err(|message| ObjFault {
                position: Some(position),
                message: message.to_owned(),
            })?;
            corners.rotate_left(first);
            for at in 2..corners.len() {
                faces.push([corners[0], corners[at - 1], corners[at]]);
                lines.push(position[0]);
            }
        }
        Mesh::of_lines(welded.vertices, faces, lines)
    }
}

/// A file as `tobj` reads it, whatever program wrote it: vertices of three numbers, and polygons by the numbers of
/// their vertices, each in a line. `tobj` names no line, so that mistakes are found here.
#[derive(Default)]
struct PlainObj {
    text: Vec<u8>,
    /// Line and column where each polygon begins in the file.
    polygons: Vec<[usize; 2]>,
}

impl PlainObj {
    fn of(text: &[u8]) -> Result<PlainObj, ObjFault> {
        let mut plain = PlainObj::default();
        let mut count = 0;
        // Vertices may stand behind the faces that refer to them.
        let mut ahead: Option<(usize, [usize; 2])> = None;
        let mut statements = Statements::of(text)?;
        let mut words = Vec::new();
        while statements.read_next(&mut words) {
            let Some((keyword, values)) = words.split_first() else {
                continue;
            };
            match keyword.keyword()? {
                "v" => {
                    check_vertex(keyword, values)?;
                    count += 1;
                    plain.line(b"v", values[..3].iter().map(|word| word.bytes));
                }
                "f" => {
                    if values.len() < 3 {
                        return Err(keyword.fault(format!(
                            "a face has three corners or more, this one has {}: remove the line, or \
                             write `l` for a line and `p` for a point",
                            values.len()
                        )))?;
                    }
                    let mut corners = Vec::new();
                    for word in values {
                        let corner = corner(word, count)?;
                        if corner > count && ahead.is_none_or(|(most, _)| corner > most) {
                            ahead = Some((corner, word.position));
                        }
                        corners.push(corner.to_string());
                    }
                    plain.line(b"f", corners.iter().map(String::as_bytes));
                    plain.polygons.push(keyword.position);
                }
                "surf" => {
                    return Err(keyword.fault(
                        "a free-form surface is not a polygon: convert it to polygons, or export \
                         without curves and surfaces"
                            .to_owned(),
                    ))?;
                }
                _ => {}
            }
        }
        match ahead {
            Some((corner, position)) if corner > count => Err(ObjFault {
                position: Some(position),
                message: format!(
                    "this face refers to vertex {corner}, but the file has {count}: was it cut off, or \
                     put together from several files?"
                ),
            })?,
            _ if plain.polygons.is_empty() => Err(ObjFault::no_faces()),
            _ => Ok(plain),
        }
    }

    fn line<'w>(&mut self, keyword: &[u8], words: impl Iterator<Item = &'w [u8]>) {
        self.text.extend(keyword);
        for word in words {
            self.text.push(b' ');
            self.text.extend(word);
        }
        self.text.push(b'\n');
    }
}

fn check_vertex(keyword: &Word, values: &[Word]) -> Result<(), ObjFault> {
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
    for (word, name) in values.iter().zip(names) {
        let number = word.number(name)?;
        if *name == "w" && number != 1.0 {
            return Err(word.fault(format!(
                "w is {number}, and a vertex of a mesh has no weight (a point of a cloud has a density \
                 there): write x y z alone"
            )));
        }
    }
    Ok(())
}

/// The vertex, from 1, that a corner refers to where `count` vertices have been read: `7`, `7/1`, `7//1` or
/// `7/1/1`, or `-1` for the last one.
fn corner(word: &Word, count: usize) -> Result<usize, ObjFault> {
    let number = |bytes: &[u8]| std::str::from_utf8(bytes).ok()?.parse::<isize>().ok();
    let mut parts = word.bytes.split(|&byte| byte == b'/');
    let vertex = parts.next().and_then(number);
    let is_whole = |part: &[u8]| part.is_empty() || number(part).is_some();
    let vertex = vertex.filter(|_| parts.clone().count() <= 2 && parts.all(is_whole));
    match vertex {
        None => Err(word.fault(format!(
            "{:?} is not a corner of a face: write the number of its vertex, like 7, 7/1, 7//1 or 7/1/1",
            word.text()
        ))),
        Some(vertex @ 1..) => Ok(vertex.unsigned_abs()),
        // -1 is the last one; 0 is none.
        Some(back) => {
            let vertex = (count + 1).checked_add_signed(back);
            vertex.filter(|it| (1..=count).contains(it)).ok_or_else(|| {
                word.fault(format!(
                    "this face refers to vertex {back}, and {count} stand before it, counted from 1, or back from -1"
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
