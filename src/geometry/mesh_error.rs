//! Errors in meshes.

use crate::decoder::Stopped;
use glam::DVec3;
use std::path::PathBuf;
use thiserror::Error;

/// Reason for refusing a mesh. Faces are counted from 1, as triangles: polygons of a file are
/// triangulated first.
#[derive(Debug, Error)]
pub enum MeshError {
    /// The file cannot be opened or read.
    #[error("cannot read the mesh {path}: {source}")]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The text is not a Wavefront OBJ file.
    #[error(
        "not a mesh in Wavefront OBJ format: {0}; faces refer to vertices of the same file, counted from 1"
    )]
    Format(#[from] tobj::LoadError),
    /// The reader panicked.
    #[error("not a mesh in Wavefront OBJ format: {0}")]
    Stopped(#[from] Stopped),
    /// The mesh has no faces.
    #[error("the mesh has no faces; a file of bare points is a point cloud, not a mesh")]
    Empty,
    /// A face refers to a vertex that does not exist.
    #[error("face {face} refers to vertex {vertex}, but there are {count} (counted from 0)")]
    NoSuchVertex {
        /// Number of the face, from 1.
        face: usize,
        /// The vertex it refers to, from 0.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("face {face} has the vertex {vertex}; coordinates must be finite")]
    NotFinite {
        /// Number of the face, from 1.
        face: usize,
        /// The offending vertex.
        vertex: DVec3,
    },
    /// A face's corners lie on a line, up to rounding: it has no normal.
    #[error("face {face} has no area: its corners {}, {} and {} lie on a line; remove it", corners[0], corners[1], corners[2])]
    Degenerate {
        /// Number of the face, from 1.
        face: usize,
        /// Its corners.
        corners: [DVec3; 3],
    },
    /// The area is too large or too small for a number.
    #[error("the mesh's area is {0}: its size leaves the range of numbers; choose other units")]
    Range(f64),
    /// The surface has a border and encloses nothing.
    #[error(
        "the mesh is open: the edge from {from} to {to} belongs to face {face} only; a medium needs a closed boundary, so fill the hole"
    )]
    Open {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// The only face there, from 1.
        face: usize,
    },
    /// More than two faces meet at an edge.
    #[error(
        "{count} faces meet at the edge from {from} to {to}, among them face {face}; a closed boundary has exactly two at each"
    )]
    Branching {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// One of the faces, from 1.
        face: usize,
        /// How many there are.
        count: usize,
    },
    /// Two neighbours disagree about which side is outside.
    #[error("faces {} and {} run along the edge from {from} to {to} in the same direction, so one of them is inside out; reverse the order of its corners", faces[0], faces[1])]
    Orientation {
        /// One end of the edge.
        from: DVec3,
        /// The other end.
        to: DVec3,
        /// The two faces, from 1.
        faces: [usize; 2],
    },
    /// All normals point inward.
    #[error(
        "the mesh is inside out (it encloses the volume {volume}); reverse the order of the corners of every face"
    )]
    InsideOut {
        /// Signed volume, in world units cubed: zero or negative.
        volume: f64,
    },
}
