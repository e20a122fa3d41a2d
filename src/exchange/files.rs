//! Meshes and raw numbers in files beside the main one.

use glam::DVec3;

/// A mesh as PLY: little endian, coordinates as `float`.
///
/// Both renderers read them into `float32`, so more digits would be lost there.
fn ply(vertices: &[DVec3], faces: &[[usize; 3]]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    )
    .into_bytes();
    for vertex in vertices {
        for coordinate in vertex.to_array() {
            bytes.extend((coordinate as f32).to_le_bytes());
        }
    }
    for face in faces {
        bytes.push(3);
        for &corner in face {
            bytes.extend((corner as u32).to_le_bytes());
        }
    }
    bytes
}

/// Files beside the main one; [`file`](SharedFiles::file) writes equal ones once.
pub(super) struct SharedFiles<'n> {
    /// The name that all files begin with.
    pub name: &'n str,
    /// Files by name.
    pub files: Vec<(String, Vec<u8>)>,
}

impl SharedFiles<'_> {
    /// No files yet, for names that begin with `name`.
    pub(super) fn new(name: &str) -> SharedFiles<'_> {
        let files = Vec::new();
        SharedFiles { name, files }
    }

    /// The file of a mesh.
    pub(super) fn ply(&mut self, vertices: &[DVec3], faces: &[[usize; 3]]) -> String {
        self.file(["mesh", ".ply"], 0, ply(vertices, faces))
    }

    /// Name of the file that holds these bytes: the common name, then the two `ends` with a number between them,
    /// counted from `first`.
    pub(super) fn file(&mut self, ends: [&str; 2], first: usize, bytes: Vec<u8>) -> String {
        let begin = format!("{}.{}", self.name, ends[0]);
        let alike = self.files.iter().filter(|it| it.0.starts_with(&begin));
        if let Some((name, _)) = alike.clone().find(|(_, other)| *other == bytes) {
            return name.clone();
        }
        let file = format!("{begin}{}{}", first + alike.count(), ends[1]);
        self.files.push((file.clone(), bytes));
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_as_ply() {
        let bytes = ply(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]);
        let header = b"end_header\n";
        let end = bytes.windows(header.len()).position(|part| part == header);
        let data = &bytes[end.unwrap() + header.len()..];
        // Three vertices of three floats; a count and three numbers.
        assert_eq!(data.len(), 36 + 13);
        assert_eq!(data[12..16], 1_f32.to_le_bytes());
        assert_eq!(data[36..], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    }
}
